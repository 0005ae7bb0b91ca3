/* P4: double spherical pendulum, unit masses and rods. Coordinates are the two unit rods u, w:
 * u'' = g - lambda u + mu w, w'' = lambda u - 2 mu w with multipliers from |u| = |w| = 1. */
#include "bound.h"

enum { N = 6 };
static const double T = 10.0, GRAVITY = 9.81;

#define DOT(x, y) ((x)[0] * (y)[0] + (x)[1] * (y)[1] + (x)[2] * (y)[2])

/* the same text for a double and for lanes: 1/det is the only division */
#define TENSIONS(real)                                                                             \
    const real uw = DOT(q, q + 3), uu = DOT(q, q), ww = DOT(q + 3, q + 3);                         \
    const real r1 = DOT(v, v) - GRAVITY * q[2], r2 = DOT(v + 3, v + 3);                            \
    const real inverse = 1.0 / (2.0 * uu * ww - uw * uw);                                          \
    const real lambda = (2.0 * ww * r1 + uw * r2) * inverse;                                       \
    const real mu = (uw * r1 + uu * r2) * inverse;                                                 \
    for (int i = 0; i < 3; i++) {                                                                  \
        a[i] = mu * q[3 + i] - lambda * q[i];                                                      \
        a[3 + i] = lambda * q[i] - 2.0 * mu * q[3 + i];                                            \
    }                                                                                              \
    a[2] -= GRAVITY;

INLINE void tensions(double *a, const double *q, const double *v){TENSIONS(double)} INLINE
    void tensions8(v8 *a, const v8 *q, const v8 *v) {
    TENSIONS(v8)
}

static void start(double *q, double *v) {
    for (int i = 0; i < N; i++) v[i] = 0.0;
    q[0] = sin(0.8), q[1] = 0.0, q[2] = -cos(0.8);
    q[3] = sin(0.4), q[4] = 0.0, q[5] = -cos(0.4);
    v[1] = 1.0, v[4] = -0.5;
}

/* rods to masses */
static void positions(double *out) {
    for (int row = 0; row < BENCH_OUTPUTS; row++)
        for (int i = 0; i < 3; i++) out[N * row + 3 + i] += out[N * row + i];
}

static void by_gauss(double *out, const bench_method *m, long steps) {
    double q[N], v[N];
    start(q, v);
    GAUSS_CASES(out, m, N, 1, steps, tensions8, q, v, T)
    positions(out);
}

static void by_rk8(double *out, const bench_method *m, long steps) {
    double q[N], v[N];
    (void)m;
    start(q, v);
    rk8(out, steps, N, tensions, q, v, T);
    positions(out);
}

static const bench_method methods[] = {GAUSS_METHODS(by_gauss),
                                       {"rk8", by_rk8, NULL, 0},
                                       {NULL, NULL, NULL, 0}};

const bench_problem bench_pendulum[] = {{"P4", N, methods}, {NULL, 0, NULL}};
