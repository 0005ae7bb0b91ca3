/* newton_limits.h - when Newton's method ends or goes another way, for one system and for
 * systems side by side. */
#ifndef DM_NEWTON_LIMITS_H
#define DM_NEWTON_LIMITS_H

static const double DM_NEWTON_ROUND_OFF = 1e-12; /* an increment that small may stall */
static const double DM_NEWTON_NOISE = 1e-13;     /* and so may a residual, of its terms */
static const double DM_NEWTON_FLOOR = 1e-9;      /* an increment that small may be all noise */
static const double DM_NEWTON_NEGLIGIBLE =
    1e-5; /* of the tolerance: error left that is not worth a step, 4e-20 relative */
static const double DM_NEWTON_SLOW = 0.1; /* rate that calls for a new Jacobian */
/* Unknowns whose sizes are within this ratio are judged by the largest of them, others each by its
 * own size, for so many iterations more at least. */
static const double DM_NEWTON_APART = 0x1p10, DM_NEWTON_PATIENCE = 4;
/* A displacement of so much of a coordinate counts for nothing beside it: of the tolerance that is
 * 4e-18 of the coordinate. */
static const double DM_NEWTON_BESIDE = 1e-3;
static const double DM_NEWTON_UNSEEN = 1e-15; /* and one of so much of it is round-off */
/* Iterations after which slow ones are of round-off: the matrix has been made anew. */
enum { DM_NEWTON_STALLED = 4 };

#endif
