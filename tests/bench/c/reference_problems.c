/* The data of docs/benchmarks.md, word for word. */
#include "reference.h"

#include <stdint.h>

const reference_problem *reference_now;

/* P1: Kepler, q at the pericentre */
static void kepler_start(real *q, real *v) {
    const real e = (real)(int)(reference_now->parameter * 10 + 0.5) / 10;
    q[0] = 1 - e, q[1] = 0;
    v[0] = 0, v[1] = FN(sqrt)((1 + e) / (1 - e));
}

static void kepler(real *a, const real *q, const real *v) {
    const real r2 = q[0] * q[0] + q[1] * q[1], r = FN(sqrt)(r2);
    (void)v;
    for (int i = 0; i < 2; i++) a[i] = -q[i] / (r * r2);
}

/* P2: V = -1/r + J2 / (2 r^3) (3 z^2 / r^2 - 1) */
static void satellite_start(real *q, real *v) {
    const real speed = FN(sqrt)(REAL(1.1) / REAL(0.9));
    q[0] = REAL(0.9), q[1] = q[2] = v[0] = 0;
    v[1] = speed * FN(cos)(REAL(0.6));
    v[2] = speed * FN(sin)(REAL(0.6));
}

static void satellite(real *a, const real *q, const real *v) {
    const real J2 = REAL(0.05), r2 = q[0] * q[0] + q[1] * q[1] + q[2] * q[2];
    const real r3 = r2 * FN(sqrt)(r2), z2 = q[2] * q[2] / r2;
    const real common = -(1 + REAL(1.5) * J2 / r2 * (1 - 5 * z2)) / r3;
    (void)v;
    a[0] = common * q[0], a[1] = common * q[1];
    a[2] = (common - 3 * J2 / (r2 * r3)) * q[2];
}

/* P3: Sun and five (HLW, table I.2.2): AU, days */
static const real MASS[6] = {REAL(1.00000597682),      REAL(0.000954786104043),
                             REAL(0.000285583733151),  REAL(0.0000437273164546),
                             REAL(0.0000517759138449), 1 / REAL(1.3e8)};
static const real PLANETS[36] = {0,
                                 0,
                                 0,
                                 REAL(-3.5023653),
                                 REAL(-3.8169847),
                                 REAL(-1.5507963),
                                 REAL(9.0755314),
                                 REAL(-3.0458353),
                                 REAL(-1.6483708),
                                 REAL(8.3101420),
                                 REAL(-16.2901086),
                                 REAL(-7.2521278),
                                 REAL(11.4707666),
                                 REAL(-25.7294829),
                                 REAL(-10.8169456),
                                 REAL(-15.5387357),
                                 REAL(-25.2225594),
                                 REAL(-3.1902382),
                                 0,
                                 0,
                                 0,
                                 REAL(0.00565429),
                                 REAL(-0.00412490),
                                 REAL(-0.00190589),
                                 REAL(0.00168318),
                                 REAL(0.00483525),
                                 REAL(0.00192462),
                                 REAL(0.00354178),
                                 REAL(0.00137102),
                                 REAL(0.00055029),
                                 REAL(0.00288930),
                                 REAL(0.00114527),
                                 REAL(0.00039677),
                                 REAL(0.00276725),
                                 REAL(-0.00170702),
                                 REAL(-0.00136504)};

static void planets_start(real *q, real *v) {
    for (int i = 0; i < 18; i++) q[i] = PLANETS[i], v[i] = PLANETS[18 + i];
}

static void planets(real *a, const real *q, const real *v) {
    const real G = REAL(2.95912208286e-4);
    (void)v;
    for (int i = 0; i < 18; i++) a[i] = 0;
    for (int i = 0; i < 6; i++)
        for (int j = 0; j < i; j++) {
            real d[3], r2 = 0;
            for (int k = 0; k < 3; k++) {
                d[k] = q[3 * i + k] - q[3 * j + k];
                r2 += d[k] * d[k];
            }
            const real w = G / (r2 * FN(sqrt)(r2));
            for (int k = 0; k < 3; k++) {
                a[3 * i + k] -= w * MASS[j] * d[k];
                a[3 * j + k] += w * MASS[i] * d[k];
            }
        }
}

/* P4: double spherical pendulum; q = the two unit rods, so that the masses are at u and u + w.
 * Multipliers: u'' = g - lambda u + mu w, w'' = lambda u - 2 mu w (unit masses), from |u| = |w|
 * = 1 */
static void pendulum_start(real *q, real *v) {
    const real s[2] = {FN(sin)(REAL(0.8)), FN(sin)(REAL(0.4))};
    const real c[2] = {FN(cos)(REAL(0.8)), FN(cos)(REAL(0.4))};
    for (int i = 0; i < 6; i++) v[i] = 0;
    for (int i = 0; i < 2; i++) q[3 * i] = s[i], q[3 * i + 1] = 0, q[3 * i + 2] = -c[i];
    v[1] = 1, v[4] = REAL(-0.5);
}

static real dot3(const real *x, const real *y) {
    return x[0] * y[0] + x[1] * y[1] + x[2] * y[2];
}

static void pendulum(real *a, const real *q, const real *v) {
    const real *u = q, *w = q + 3, g = REAL(9.81);
    const real uu = dot3(u, u), uw = dot3(u, w), ww = dot3(w, w);
    /* u.u'' = -|u'|^2 and w.w'' = -|w'|^2 */
    const real r1 = dot3(v, v) - g * u[2], r2 = dot3(v + 3, v + 3);
    const real det = 2 * uu * ww - uw * uw;
    const real lambda = (2 * ww * r1 + uw * r2) / det, mu = (uw * r1 + uu * r2) / det;
    for (int i = 0; i < 3; i++) {
        a[i] = -lambda * u[i] + mu * w[i];
        a[3 + i] = lambda * u[i] - 2 * mu * w[i];
    }
    a[2] -= g;
}

static void masses(real *out, const real *q) {
    for (int i = 0; i < 3; i++) out[i] = q[i], out[3 + i] = q[i] + q[3 + i];
}

/* P6: V = k/2 (r - 1)^2 + 9.81 y */
static void spring_start(real *q, real *v) {
    q[0] = FN(sin)(REAL(1.0)), q[1] = -FN(cos)(REAL(1.0));
    v[0] = v[1] = 0;
}

static void spring(real *a, const real *q, const real *v) {
    const real r = FN(sqrt)(q[0] * q[0] + q[1] * q[1]);
    const real w = -reference_now->parameter * (1 - 1 / r);
    (void)v;
    a[0] = w * q[0], a[1] = w * q[1] - REAL(9.81);
}

/* P8: periodic chains, sum of W(q_i - q_(i+1)) */
static void chain_start(real *q, real *v) {
    uint32_t s = 12345;
    real mean = 0;
    const int n = reference_now->n;
    for (int i = 0; i < n; i++) {
        s = s * 1664525u + 1013904223u;
        v[i] = (real)(s >> 8) / 8388608 - 1;
        mean += v[i] / n;
        q[i] = 0;
    }
    for (int i = 0; i < n; i++) v[i] -= mean;
}

static real toda_slope(real d) {
    return FN(exp)(d);
}
static real fpu_slope(real d) {
    return d + d * d * d;
}

static void chain(real *a, const real *q, real (*slope)(real)) {
    const int n = reference_now->n;
    real before = slope(q[n - 1] - q[0]);
    for (int i = 0; i < n; i++) {
        const real after = slope(q[i] - q[(i + 1) % n]);
        a[i] = before - after;
        before = after;
    }
}

static void toda(real *a, const real *q, const real *v) {
    (void)v;
    chain(a, q, toda_slope);
}

static void fpu(real *a, const real *q, const real *v) {
    (void)v;
    chain(a, q, fpu_slope);
}

/* P5: q the entries of a rotation matrix R, v of R' = R hat(w); a = R (hat(w') + hat(w)^2) with
 * I w' = I w x w + torque, that of mgl = 1 on the third axis for the top (parameter 1);
 * what is off the rotations, G = (R^T R - 1)/2, would grow: G'' = -10 G' - 25 G is added */
static const real *body_moments(void) {
    static const real BODY[3] = {1, 2, 3}, TOP[3] = {1, REAL(1.2), REAL(0.6)};
    return reference_now->parameter > 0 ? TOP : BODY;
}

static void body_hat(real *out, const real *w) {
    const real hat[9] = {0, -w[2], w[1], w[2], 0, -w[0], -w[1], w[0], 0};
    for (int i = 0; i < 9; i++) out[i] = hat[i];
}

static void body_product(real *out, const real *a, const real *b) {
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            out[3 * i + j] = a[3 * i] * b[j] + a[3 * i + 1] * b[3 + j] + a[3 * i + 2] * b[6 + j];
}

static void body_start(real *q, real *v) {
    const real BODY[3] = {REAL(0.9), REAL(0.3), REAL(1.2)},
               TOP[3] = {REAL(0.2), REAL(0.1), REAL(1.5)}, tilt = REAL(0.4);
    const int top = reference_now->parameter > 0;
    const real c = top ? FN(cos)(tilt) : 1, s = top ? FN(sin)(tilt) : 0;
    const real R[9] = {1, 0, 0, 0, c, -s, 0, s, c};
    real w[3], hat[9];
    for (int i = 0; i < 3; i++) w[i] = (top ? TOP : BODY)[i] / body_moments()[i];
    for (int i = 0; i < 9; i++) q[i] = R[i];
    body_hat(hat, w);
    body_product(v, q, hat);
}

static void body(real *a, const real *q, const real *v) {
    const real *I = body_moments(), mgl = reference_now->parameter > 0;
    real W[9], rate[3], hat[9], turned[9];
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            W[3 * i + j] = q[i] * v[j] + q[3 + i] * v[3 + j] + q[6 + i] * v[6 + j];
    const real w[3] = {(W[7] - W[5]) / 2, (W[2] - W[6]) / 2, (W[3] - W[1]) / 2};
    rate[0] = ((I[1] - I[2]) * w[1] * w[2] + mgl * q[7]) / I[0];
    rate[1] = ((I[2] - I[0]) * w[2] * w[0] - mgl * q[6]) / I[1];
    rate[2] = (I[0] - I[1]) * w[0] * w[1] / I[2];
    body_hat(hat, rate);
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++) {
            const real G = q[i] * q[j] + q[3 + i] * q[3 + j] + q[6 + i] * q[6 + j] - (i == j);
            hat[3 * i + j] -= 5 * (W[3 * i + j] + W[3 * j + i]) + REAL(12.5) * G;
        }
    body_hat(W, w);
    body_product(turned, W, W);
    for (int i = 0; i < 9; i++) hat[i] += turned[i];
    body_product(a, q, hat);
}

#define PI REAL(3.14159265358979323846264338327950288)
const reference_problem reference_problems[] =
    {{"P1-0.6", 2, 200 * PI, 400, 0.6, kepler_start, kepler, NULL},
     {"P1-0.9", 2, 200 * PI, 4000, 0.9, kepler_start, kepler, NULL},
     {"P2", 3, 200 * PI, 160, 0, satellite_start, satellite, NULL},
     {"P3", 18, 200000, 64, 0, planets_start, planets, NULL},
     {"P4", 6, 10, 16, 0, pendulum_start, pendulum, masses},
     {"P5-body", 9, 100, 60, 0, body_start, body, NULL},
     {"P5-top", 9, 100, 60, 1, body_start, body, NULL},
     {"P6-1e2", 2, 16, 24, 1e2, spring_start, spring, NULL},
     {"P6-1e4", 2, 16, 120, 1e4, spring_start, spring, NULL},
     {"P6-1e6", 2, 16, 1200, 1e6, spring_start, spring, NULL},
     {"P8-toda-3", 3, 100, 32, 0, chain_start, toda, NULL},
     {"P8-toda-32", 32, 100, 40, 0, chain_start, toda, NULL},
     {"P8-toda-1024", 1024, 16, 8, 0, chain_start, toda, NULL},
     {"P8-fpu-3", 3, 100, 32, 0, chain_start, fpu, NULL},
     {"P8-fpu-32", 32, 100, 40, 0, chain_start, fpu, NULL},
     {"P8-fpu-1024", 1024, 16, 8, 0, chain_start, fpu, NULL},
     {NULL, 0, 0, 0, 0, NULL, NULL, NULL}};
