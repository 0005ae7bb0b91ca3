/* forces.h - the problems as a careful user of a library would write them in C or C++:
 * acceleration from position (and velocity), -O3 -march=native, nothing special to a method. */
#ifndef BENCH_FORCES_H
#define BENCH_FORCES_H

#include <math.h>
#include <stdint.h>
#include <string.h>

static inline void kepler_start(double *q, double *v, double e) {
    q[0] = 1.0 - e, q[1] = 0.0;
    v[0] = 0.0, v[1] = sqrt((1.0 + e) / (1.0 - e));
}

static inline void kepler(double *a, const double *q) {
    const double r2 = q[0] * q[0] + q[1] * q[1], w = -1.0 / (r2 * sqrt(r2));
    a[0] = w * q[0], a[1] = w * q[1];
}

/* P5: y = (unit quaternion (w, x, y, z), body momentum); top: mgl = 1 on the third axis */
static inline void body_start(double *y, int top) {
    const double c = top ? cos(0.2) : 1.0, s = top ? sin(0.2) : 0.0;
    const double start[7] = {c, s, 0.0, 0.0, top ? 0.2 : 0.9, top ? 0.1 : 0.3, top ? 1.5 : 1.2};
    memcpy(y, start, sizeof start);
}

static inline void body(double *f, const double *y, int top) {
    const double *q = y, *p = y + 4;
    const double u = p[0], v = top ? p[1] / 1.2 : 0.5 * p[1], w = top ? p[2] / 0.6 : p[2] / 3.0;
    f[0] = -0.5 * (q[1] * u + q[2] * v + q[3] * w);
    f[1] = 0.5 * (q[0] * u + q[2] * w - q[3] * v);
    f[2] = 0.5 * (q[0] * v + q[3] * u - q[1] * w);
    f[3] = 0.5 * (q[0] * w + q[1] * v - q[2] * u);
    f[4] = p[1] * w - p[2] * v;
    f[5] = p[2] * u - p[0] * w;
    f[6] = p[0] * v - p[1] * u;
    if (!top) return;
    f[4] += 2.0 * (q[2] * q[3] + q[0] * q[1]);
    f[5] -= 2.0 * (q[1] * q[3] - q[0] * q[2]);
}

/* entries of the rotation matrix, by rows */
static inline void body_row(double *R, const double *q) {
    const double w = q[0], x = q[1], y = q[2], z = q[3];
    R[0] = w * w + x * x - y * y - z * z, R[1] = 2.0 * (x * y - w * z);
    R[2] = 2.0 * (x * z + w * y), R[3] = 2.0 * (x * y + w * z);
    R[4] = w * w - x * x + y * y - z * z, R[5] = 2.0 * (y * z - w * x);
    R[6] = 2.0 * (x * z - w * y), R[7] = 2.0 * (y * z + w * x);
    R[8] = w * w - x * x - y * y + z * z;
}

static inline void satellite_start(double *q, double *v) {
    const double speed = sqrt(1.1 / 0.9);
    q[0] = 0.9, q[1] = q[2] = v[0] = 0.0;
    v[1] = speed * cos(0.6), v[2] = speed * sin(0.6);
}

static inline void satellite(double *a, const double *q) {
    const double J2 = 0.05, z2 = q[2] * q[2], r2 = q[0] * q[0] + q[1] * q[1] + z2;
    const double inverse = 1.0 / r2, w = inverse * sqrt(inverse), c = 1.5 * J2 * inverse;
    const double common = -w * (1.0 + c * (1.0 - 5.0 * z2 * inverse));
    a[0] = common * q[0], a[1] = common * q[1], a[2] = (common - 2.0 * c * w) * q[2];
}

static inline void planets_start(double *q, double *v) {
    static const double state[36] = {0,           0,           0,           -3.5023653,
                                     -3.8169847,  -1.5507963,  9.0755314,   -3.0458353,
                                     -1.6483708,  8.3101420,   -16.2901086, -7.2521278,
                                     11.4707666,  -25.7294829, -10.8169456, -15.5387357,
                                     -25.2225594, -3.1902382,  0,           0,
                                     0,           0.00565429,  -0.00412490, -0.00190589,
                                     0.00168318,  0.00483525,  0.00192462,  0.00354178,
                                     0.00137102,  0.00055029,  0.00288930,  0.00114527,
                                     0.00039677,  0.00276725,  -0.00170702, -0.00136504};
    memcpy(q, state, 18 * sizeof *q);
    memcpy(v, state + 18, 18 * sizeof *v);
}

static inline void planets(double *a, const double *q) {
    static const double mass[6] = {1.00000597682,      0.000954786104043,  0.000285583733151,
                                   0.0000437273164546, 0.0000517759138449, 1 / 1.3e8};
    memset(a, 0, 18 * sizeof *a);
    for (int i = 1; i < 6; i++)
        for (int j = 0; j < i; j++) {
            const double x = q[3 * i] - q[3 * j], y = q[3 * i + 1] - q[3 * j + 1];
            const double z = q[3 * i + 2] - q[3 * j + 2], r2 = x * x + y * y + z * z;
            const double w = 2.95912208286e-4 / (r2 * sqrt(r2)), d[3] = {x, y, z};
            for (int k = 0; k < 3; k++) {
                a[3 * i + k] -= w * mass[j] * d[k];
                a[3 * j + k] += w * mass[i] * d[k];
            }
        }
}

/* unit rods u = q, w = q + 3 and the multipliers that keep them unit */
static inline void pendulum_start(double *q, double *v) {
    memset(v, 0, 6 * sizeof *v);
    q[0] = sin(0.8), q[1] = 0.0, q[2] = -cos(0.8);
    q[3] = sin(0.4), q[4] = 0.0, q[5] = -cos(0.4);
    v[1] = 1.0, v[4] = -0.5;
}

static inline double dot3(const double *x, const double *y) {
    return x[0] * y[0] + x[1] * y[1] + x[2] * y[2];
}

static inline void pendulum(double *a, const double *q, const double *v) {
    const double g = 9.81, uu = dot3(q, q), uw = dot3(q, q + 3), ww = dot3(q + 3, q + 3);
    const double r1 = dot3(v, v) - g * q[2], r2 = dot3(v + 3, v + 3);
    const double inverse = 1.0 / (2.0 * uu * ww - uw * uw);
    const double lambda = (2.0 * ww * r1 + uw * r2) * inverse, mu = (uw * r1 + uu * r2) * inverse;
    for (int i = 0; i < 3; i++) {
        a[i] = mu * q[3 + i] - lambda * q[i];
        a[3 + i] = lambda * q[i] - 2.0 * mu * q[3 + i];
    }
    a[2] -= g;
}

static inline void spring_start(double *q, double *v) {
    q[0] = sin(1.0), q[1] = -cos(1.0), v[0] = v[1] = 0.0;
}

static inline void spring(double *a, const double *q, double k) {
    const double w = k / sqrt(q[0] * q[0] + q[1] * q[1]) - k;
    a[0] = w * q[0], a[1] = w * q[1] - 9.81;
}

static inline void chain_start(double *q, double *v, int n) {
    uint32_t s = 12345;
    double mean = 0.0;
    for (int i = 0; i < n; i++) {
        s = s * 1664525u + 1013904223u;
        v[i] = (double)(s >> 8) / 8388608.0 - 1.0;
        mean += v[i];
    }
    for (int i = 0; i < n; i++) q[i] = 0.0, v[i] -= mean / n;
}

static inline void toda(double *a, const double *q, int n) {
    double before = exp(q[n - 1] - q[0]);
    const double first = before;
    for (int i = 0; i < n; i++) {
        const double after = i + 1 < n ? exp(q[i] - q[i + 1]) : first;
        a[i] = before - after;
        before = after;
    }
}

/* differences first, so that compilers make lanes of it */
static inline void fpu(double *a, const double *q, int n) {
    const double ends = q[n - 1] - q[0], last = ends + ends * ends * ends;
    for (int i = 1; i + 1 < n; i++) {
        const double l = q[i - 1] - q[i], r = q[i] - q[i + 1];
        a[i] = (l + l * l * l) - (r + r * r * r);
    }
    const double l = q[0] - q[1], r = q[n - 2] - q[n - 1];
    a[0] = last - (l + l * l * l);
    a[n - 1] = (r + r * r * r) - last;
}

/* masses from rods, in place, 32 rows */
static inline void pendulum_positions(double *out) {
    for (int row = 0; row < 32; row++)
        for (int i = 0; i < 3; i++) out[6 * row + 3 + i] += out[6 * row + i];
}

#endif
