/* newton.h - the implicit midpoint step in position-momentum form, as one would write it in C for
 * any Lagrangian with hand-written derivatives: p0 = L_v - h/2 L_q at ((q0 + q1)/2, (q1 - q0)/h),
 * then p1 = p0 + h L_q; Newton with the exact matrix, to round-off. */
#ifndef BENCH_NEWTON_H
#define BENCH_NEWTON_H

enum { NEWTON_N = 9 };

typedef struct {
    double Lq[NEWTON_N], Lv[NEWTON_N];
    /* row q, column v */
    double Lqq[NEWTON_N * NEWTON_N], Lqv[NEWTON_N * NEWTON_N], Lvv[NEWTON_N * NEWTON_N];
} derivatives;

typedef struct {
    const char *name;
    int n;
    double h;
    double q[NEWTON_N], v[NEWTON_N];
    void (*lagrangian)(derivatives *out, const double *q, const double *v);
} implicit_model;

extern const implicit_model newton_satellite, newton_pendulum, newton_bodies;

/* `steps` steps from q, p, in place; iterations of all steps are added to *iterations.
 * Returns 0 when a step does not converge. */
int newton_run(double *q, double *p, const implicit_model *m, long steps, long *iterations);

#endif
