/* stage_limits.h - when sweeps of a stage method end, for one member and for members side by
 * side. */
#ifndef DM_STAGE_LIMITS_H
#define DM_STAGE_LIMITS_H

/* error left in the sums, relative to the state, for the usual tolerance 4e-15: 1e-19 */
static const double DM_SWEEP_LEFT = 2.5e-5;
/* squares: of changes of the sums, relative, and of their contraction */
static const double DM_SWEEP_CLEAN = 1e-28;      /* mostly rounding: foretold, not measured */
static const double DM_SWEEP_SETTLED = 1e-8;     /* u serves for the rest of a coefficient */
static const double DM_SWEEP_SLOW = 0.35 * 0.35; /* calls for Newton's method */
static const double DM_SWEEP_LEAST = 1e-4;       /* taken for granted before it is measured */
/* rows that far apart count by their own size, if they are not as good as zero: their moves,
 * squared, times the mean of all over it */
static const double DM_SWEEP_APART = 0x1p20, DM_SWEEP_ZERO = 0x1p-200;
/* pivots of M: determinants of up to three rows, which must have all their digits */
static const double DM_PIVOT_LEAST = 1e-290, DM_PIVOT_MOST = 1e290;

enum {
    DM_STAGE_SWEEPS = 60, /* at most */
    DM_SWEEP_RATIOS = 3   /* stages up to which coefficients of Gauss are ratios of small numbers:
                             products with them have a mean (numbers/weight.h) */
};

#endif
