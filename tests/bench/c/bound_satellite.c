/* P2: J2 satellite, V = -1/r + J2 / (2 r^3) (3 z^2 / r^2 - 1) */
#include "bound.h"

enum { N = 3 };
static const double T = 628.31853071795864769, J2 = 0.05;

/* a = -q (1 + c (1 - 5 z^2/r^2)) / r^3 - (0, 0, 2 c z / r^3), c = 1.5 J2 / r^2 */
INLINE void attraction(double *a, const double *q) {
    const double z2 = q[2] * q[2], r2 = q[0] * q[0] + q[1] * q[1] + z2;
    const double w = inverse_cube(r2), inverse = w * w * (r2 * r2); /* 1 / r^2 */
    const double c = 1.5 * J2 * inverse, common = -w * (1.0 + c * (1.0 - 5.0 * z2 * inverse));
    a[0] = common * q[0], a[1] = common * q[1];
    a[2] = (common - 2.0 * c * w) * q[2];
}

INLINE void attraction_v(double *a, const double *q, const double *v) {
    (void)v;
    attraction(a, q);
}

INLINE void attraction8(v8 *a, const v8 *q, const v8 *v) {
    const v8 z2 = q[2] * q[2], r2 = q[0] * q[0] + q[1] * q[1] + z2;
    const v8 w = inverse_cube8(r2), inverse = w * w * (r2 * r2);
    const v8 c = 1.5 * J2 * inverse, common = -w * (1.0 + c * (1.0 - 5.0 * z2 * inverse));
    (void)v;
    a[0] = common * q[0], a[1] = common * q[1];
    a[2] = (common - 2.0 * c * w) * q[2];
}

static void start(double *q, double *v) {
    const double speed = sqrt(1.1 / 0.9);
    q[0] = 0.9, q[1] = q[2] = v[0] = 0.0;
    v[1] = speed * cos(0.6), v[2] = speed * sin(0.6);
}

static void by_split(double *out, const bench_method *m, long steps) {
    double q[N], v[N];
    start(q, v);
    split(out, m->table, steps, N, attraction, q, v, T);
}

static void by_gauss(double *out, const bench_method *m, long steps) {
    double q[N], v[N];
    start(q, v);
    GAUSS_CASES(out, m, N, 0, steps, attraction8, q, v, T)
}

static void by_rk8(double *out, const bench_method *m, long steps) {
    double q[N], v[N];
    (void)m;
    start(q, v);
    rk8(out, steps, N, attraction_v, q, v, T);
}

static void by_stoermer(double *out, const bench_method *m, long steps) {
    double q[N], v[N];
    start(q, v);
    STOERMER_CASES(out, m, N, steps, attraction8, q, v, T)
}

static const bench_method methods[] = {GAUSS_METHODS(by_gauss),
                                       SPLITTING_METHODS(by_split),
                                       {"rk8", by_rk8, NULL, 0},
                                       STOERMER_METHODS(by_stoermer),
                                       {NULL, NULL, NULL, 0}};

const bench_problem bench_satellite[] = {{"P2", N, methods}, {NULL, 0, NULL}};
