/*
** sprk_order.c - the order of a partitioned Runge-Kutta pair, measured. Order conditions by trees would be as many as
** a thousand at order 6; one step of a Hamiltonian whose terms couple everything shows the same.
*/
#include "integ/sprk.h"

#include <math.h>
#include <string.h>

enum { N = 2, MOST_SWEEPS = 400 };

/* H = (p1^2 + p2^2)/2 + q1^4/4 + q1 q2^2/2 + q2^2/2 + q1 q2/3, and mixed: + p1^2 q2/4 + p2^2 q1^2/6 + p1 p2 q1/4 */
static void field(long double *v, long double *f, const long double *q,
                  const long double *p, int mixed) {
    v[0] = p[0];
    v[1] = p[1];
    f[0] = -q[0] * q[0] * q[0] - q[1] * q[1] / 2 - q[1] / 3;
    f[1] = -q[0] * q[1] - q[1] - q[0] / 3;
    if (!mixed) return;
    v[0] += p[0] * q[1] / 2 + p[1] * q[0] / 4;
    v[1] += p[1] * q[0] * q[0] / 3 + p[0] * q[0] / 4;
    f[0] -= p[1] * p[1] * q[0] / 3 + p[0] * p[1] / 4;
    f[1] -= p[0] * p[0] / 4;
}

typedef struct {
    long double q[N], p[N];
} point;

/* y + h sum_j (w_j V_j, W_j F_j) */
static point combine(const dm_tableau *t, const point *y, long double h,
                     const long double *w, const long double *W, const point *slope) {
    point sum = *y;
    for (int j = 0; j < t->s; j++)
        for (int k = 0; k < N; k++) {
            sum.q[k] += h * w[j] * slope[j].q[k];
            sum.p[k] += h * W[j] * slope[j].p[k];
        }
    return sum;
}

/* one step; the stages by sweeps until they stand still */
static void step(point *y, const dm_tableau *t, long double h, int mixed) {
    point slope[DM_SPRK_STAGES];
    long double change = 1.0L;
    memset(slope, 0, sizeof slope);
    for (int sweep = 0; sweep < MOST_SWEEPS && change > 0.0L; sweep++) {
        change = 0.0L;
        for (int i = 0; i < t->s; i++) {
            const point at = combine(t, y, h, t->a[i], t->A[i], slope), old = slope[i];
            field(slope[i].q, slope[i].p, at.q, at.p, mixed);
            for (int k = 0; k < N; k++)
                change +=
                    fabsl(slope[i].q[k] - old.q[k]) + fabsl(slope[i].p[k] - old.p[k]);
        }
        if (change < 1e-17L) break;
    }
    *y = combine(t, y, h, t->b, t->B, slope);
}

static void gauss_pair(dm_tableau *t, int s) {
    dm_quadrature q;
    long double value[DM_QUADRATURE_NODES];
    dm_quadrature_gauss(&q, s);
    *t = (dm_tableau){.s = s};
    for (int i = 0; i < s; i++) {
        dm_lagrange(value, t->a[i], q.c, s, q.c[i]);
        t->b[i] = t->B[i] = q.b[i];
        memcpy(t->A[i], t->a[i], sizeof t->a[i]);
    }
}

static const point START = {{0.7L, -0.4L}, {0.5L, 0.9L}};

/* of one step h, against two of half the size by Gauss collocation of order 24 */
static long double error_of(const dm_tableau *t, long double h, int mixed) {
    dm_tableau best;
    point y = START, exact = START;
    long double sum = 0.0L;
    gauss_pair(&best, 12);
    step(&y, t, h, mixed);
    for (int k = 0; k < 2; k++) step(&exact, &best, 0.5L * h, mixed);
    for (int k = 0; k < N; k++) {
        const long double dq = y.q[k] - exact.q[k], dp = y.p[k] - exact.p[k];
        sum += dq * dq + dp * dp;
    }
    return sqrtl(sum);
}

/* halve the step while the error is far above round-off; the last exponent but one of the error is the order */
int dm_tableau_order(const dm_tableau *t, int separable) {
    static const long double FLOOR = 1e-16L;
    long double h = 0.4L, last = error_of(t, h, !separable);
    double exponent = 0.0;
    for (int k = 0; k < 12; k++) {
        h *= 0.5L;
        const long double e = error_of(t, h, !separable);
        if (k && e < FLOOR) break;
        exponent = log2((double)(last / e));
        last = e;
    }
    return isfinite(exponent) ? (int)floor(exponent + 0.5) - 1 : 0;
}
