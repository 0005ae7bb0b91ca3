/* stage_limits.h - when sweeps of a stage method end, for one member and for members side by side. */
#ifndef DM_STAGE_LIMITS_H
#define DM_STAGE_LIMITS_H

/* error left in the sums, relative to the state, for the usual tolerance 4e-15: 1e-19 */
static const double DM_SWEEP_LEFT = 2.5e-5;
static const double DM_SWEEP_CLEAN =
    1e-14; /* changes below are mostly rounding: foretold, not measured */
static const double DM_SWEEP_SETTLED =
    1e-4; /* changes below: u serves for the rest of a coefficient */
static const double DM_SWEEP_SLOW = 0.35; /* contraction that calls for Newton's method */
static const double DM_SWEEP_LEAST =
    0.01;                      /* contraction taken for granted before it is measured */
enum { DM_STAGE_SWEEPS = 60 }; /* at most */

#endif
