/* P5: a free rigid body, and a heavy top, by their unit quaternion and body momentum: the explicit
 * Runge-Kutta method of order 8 of rk8.h for y' = f(y), unrolled, with compensated sums */
#include "bound.h"

enum { N = 9, Y = 7 };
static const double T = 100.0;

/* q' = q w/2, p' = p x w + torque */
INLINE void slope(double *f, const double *y, int top) {
    const double *q = y, *p = y + 4, half = 0.5;
    const double u = p[0], v = p[1] * (top ? 1.0 / 1.2 : 0.5),
                 w = p[2] * (top ? 1.0 / 0.6 : 1.0 / 3.0);
    const double a = half * u, b = half * v, c = half * w;
    f[0] = -(q[1] * a + q[2] * b + q[3] * c);
    f[1] = q[0] * a + q[2] * c - q[3] * b;
    f[2] = q[0] * b + q[3] * a - q[1] * c;
    f[3] = q[0] * c + q[1] * b - q[2] * a;
    f[4] = p[1] * w - p[2] * v;
    f[5] = p[2] * u - p[0] * w;
    f[6] = p[0] * v - p[1] * u;
    if (!top) return;
    f[4] += 2.0 * (q[2] * q[3] + q[0] * q[1]);
    f[5] -= 2.0 * (q[1] * q[3] - q[0] * q[2]);
}

INLINE void step(double *y, double *low, double h, int top) {
    double k[RK8][Y], at[Y];
#pragma GCC unroll 12
    for (int i = 0; i < RK8; i++) {
        for (int j = 0; j < Y; j++) at[j] = y[j] + row_sum(&k[0][j], Y, i);
        slope(k[i], at, top);
        for (int j = 0; j < Y; j++) k[i][j] *= h;
    }
    for (int j = 0; j < Y; j++) add_exactly(y + j, low + j, row_sum(&k[0][j], Y, RK8));
}

/* the rotation matrix by rows */
static void put_row(double *R, const double *q) {
    const double w = q[0], x = q[1], y = q[2], z = q[3];
    R[0] = w * w + x * x - y * y - z * z, R[1] = 2.0 * (x * y - w * z);
    R[2] = 2.0 * (x * z + w * y), R[3] = 2.0 * (x * y + w * z);
    R[4] = w * w - x * x + y * y - z * z, R[5] = 2.0 * (y * z - w * x);
    R[6] = 2.0 * (x * z - w * y), R[7] = 2.0 * (y * z + w * x);
    R[8] = w * w - x * x - y * y + z * z;
}

INLINE void run(double *out, long steps, int top) {
    double y[Y] = {1.0, 0.0, 0.0, 0.0, 0.9, 0.3, 1.2}, low[Y] = {0.0};
    const double h = T / BENCH_OUTPUTS / (double)steps;
    if (top) {
        const double start[Y] = {cos(0.2), sin(0.2), 0.0, 0.0, 0.2, 0.1, 1.5};
        for (int j = 0; j < Y; j++) y[j] = start[j];
    }
    for (int row = 0; row < BENCH_OUTPUTS; row++) {
        for (long k = 0; k < steps; k++) step(y, low, h, top);
        put_row(out + row * N, y);
    }
}

static void body_by_rk8(double *out, const bench_method *m, long steps) {
    (void)m;
    run(out, steps, 0);
}

static void top_by_rk8(double *out, const bench_method *m, long steps) {
    (void)m;
    run(out, steps, 1);
}

static const bench_method of_body[] = {{"rk8", body_by_rk8, NULL, 0}, {NULL, NULL, NULL, 0}};
static const bench_method of_top[] = {{"rk8", top_by_rk8, NULL, 0}, {NULL, NULL, NULL, 0}};

const bench_problem bench_body[] = {{"P5-body", N, of_body},
                                    {"P5-top", N, of_top},
                                    {NULL, 0, NULL}};
