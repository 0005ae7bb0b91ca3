/* sprk_order.c - the order of a partitioned Runge-Kutta pair, measured by one step of growing
 * smallness. Up to order 6 on a Hamiltonian whose terms couple everything: order conditions by
 * trees would be as many as a thousand there. Above, the next terms of the error hide the
 * exponent until round-off comes; a step on the circular orbit of Kepler's problem has an error
 * of one term with small corrections. */
#include "integ/rules/sprk.h"

#include <math.h>
#include <string.h>

enum { N = 2, MOST_SWEEPS = 400 };

enum { MIXED, SEPARABLE, CIRCLE };

/* H = (p1^2 + p2^2)/2 + q1^4/4 + q1 q2^2/2 + q2^2/2 + q1 q2/3; mixed: + p1^2 q2/4 + p2^2 q1^2/6
 * + p1 p2 q1/4 */
static void coupled(long double *v, long double *f, const long double *q, const long double *p,
                    int mixed) {
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

static void field(long double *v, long double *f, const long double *q, const long double *p,
                  int problem) {
    if (problem != CIRCLE) {
        coupled(v, f, q, p, problem == MIXED);
        return;
    }
    const long double r2 = q[0] * q[0] + q[1] * q[1], r3 = r2 * sqrtl(r2);
    for (int k = 0; k < N; k++) v[k] = p[k], f[k] = -q[k] / r3;
}

typedef struct {
    long double q[N], p[N];
} point;

/* y + h sum_j (w_j V_j, W_j F_j) */
static point combine(const dm_tableau *t, const point *y, long double h, const long double *w,
                     const long double *W, const point *slope) {
    point sum = *y;
    for (int j = 0; j < t->s; j++)
        for (int k = 0; k < N; k++) {
            sum.q[k] += h * w[j] * slope[j].q[k];
            sum.p[k] += h * W[j] * slope[j].p[k];
        }
    return sum;
}

/* one step; the stages by sweeps until they stand still */
static void step(point *y, const dm_tableau *t, long double h, int problem) {
    point slope[DM_SPRK_STAGES];
    long double change = 1.0L;
    memset(slope, 0, sizeof slope);
    for (int sweep = 0; sweep < MOST_SWEEPS && change > 0.0L; sweep++) {
        change = 0.0L;
        for (int i = 0; i < t->s; i++) {
            const point at = combine(t, y, h, t->a[i], t->A[i], slope), old = slope[i];
            field(slope[i].q, slope[i].p, at.q, at.p, problem);
            for (int k = 0; k < N; k++)
                change += fabsl(slope[i].q[k] - old.q[k]) + fabsl(slope[i].p[k] - old.p[k]);
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

/* of one step h; against rotation by h, or two steps of half the size by Gauss collocation of
 * order 24 */
static double error_of(const dm_tableau *t, long double h, int problem) {
    static const point start = {{0.7L, -0.4L}, {0.5L, 0.9L}}, round = {{1.0L, 0.0L}, {0.0L, 1.0L}};
    dm_tableau best;
    point y = problem == CIRCLE ? round : start, exact = start;
    long double sum = 0.0L;
    step(&y, t, h, problem);
    if (problem == CIRCLE) {
        exact = (point){{cosl(h), sinl(h)}, {-sinl(h), cosl(h)}};
    } else {
        gauss_pair(&best, 12);
        for (int k = 0; k < 2; k++) step(&exact, &best, 0.5L * h, problem);
    }
    for (int k = 0; k < N; k++) {
        const long double dq = y.q[k] - exact.q[k], dp = y.p[k] - exact.p[k];
        sum += dq * dq + dp * dp;
    }
    return (double)sqrtl(sum);
}

/* the error goes like h^(p + 1); between the last two steps whose error is above round-off, also
 * where long double has 53 bits */
static int exponent(const dm_tableau *t, double h, int problem) {
    static const double FLOOR = 1e-14, SMALLER = 0.8, LEAST = 2e-3;
    double last = error_of(t, (long double)h, problem), p = 0.0;
    for (h *= SMALLER; h > LEAST; h *= SMALLER) {
        const double e = error_of(t, (long double)h, problem);
        if (p != 0.0 && e < FLOOR) break;
        p = log(last / e) / log(1.0 / SMALLER);
        last = e;
    }
    return isfinite(p) ? (int)floor(p + 0.5) - 1 : 0;
}

/* Where the error of the coupled problem would vanish in round-off the circle tells. */
int dm_tableau_order(const dm_tableau *t, int separable) {
    enum { HIGH = 7 };
    const int p = exponent(t, 0.8, separable ? SEPARABLE : MIXED);
    return p < HIGH ? p : exponent(t, 2.0, CIRCLE);
}
