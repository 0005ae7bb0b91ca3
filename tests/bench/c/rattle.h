/* rattle.h - RATTLE for the double spherical pendulum in R^6 as one would write it in C by hand:
 * unit masses and rods, gravity 9.81 along -z, |x1|^2 = |x2 - x1|^2 = 1. Two multipliers by
 * Newton's method with the exact 2 x 2 matrix, begun at the last ones, until the constraints
 * hold to round-off; then the velocities are made tangent. */
#ifndef BENCH_RATTLE_H
#define BENCH_RATTLE_H

extern const double rattle_q[6], rattle_v[6], rattle_h;

/* as newton_run: q, v in place; the same text twice, compiled plainly and for this processor */
int rattle_run(double *q, double *v, double h, long steps, long *iterations);
int rattle_run_wide(double *q, double *v, double h, long steps, long *iterations);

#endif
