/* routh - a midpoint step (gauss(1)) of the J2 satellite of tests/bench/routh.lua by hand, to
 * round-off: in (r, z) at the momentum mu; in (theta, r, z) with theta' found by hand, as mu /
 * r^2 of the midpoint; in (theta, r, z) with all three velocities solved for by Newton's method.
 * cc -O3 -march=native -o routh tests/bench/c/by_hand/routh.c -lm */
#include "routh_race.h"

#include <math.h>

enum { TERMS = 4 };

static const double J2 = 0.05, h = 0.05, theta0 = 0.0, x0[2] = {1.0, 0.0},
                    v0[3] = {0.96, 0.0, 0.28};

/* state: q[3] and p[3], theta first, with low-order parts; what is kept of the last steps for
 * the next guess */
typedef struct {
    double q[3], p[3], q_low[3], p_low[3];
    double last[TERMS][3];
    long iterations;
} orbit;

static inline void add(double *high, double *low, double d) {
    const double e = *low + d, sum = *high + e;
    *low = e + (*high - sum);
    *high = sum;
}

/* -grad of V = -1/rho + J2/rho^3 (1.5 z^2/rho^2 - 0.5) in (r, z), and its derivatives (rr, rz,
 * zz) */
static inline void pull(double *f, double *df, double r, double z) {
    const double i2 = 1.0 / (r * r + z * z), i = sqrt(i2), i3 = i * i2, i5 = i3 * i2, i7 = i5 * i2;
    const double s = 1.5 * J2 * i5, w = 7.5 * J2 * z * z * i7; /* V = -i + s z^2 - J2 i3/2 */
    const double radial = -i3 + w - s;
    f[0] = radial * r;
    f[1] = (radial - 2.0 * s) * z;
    if (!df) return;
    /* d radial = (3 i5 - 7 w i2 + 5 s i2) (r dr + z dz) + 2 w dz/z */
    const double slope = 3.0 * i5 - 7.0 * w * i2 + 5.0 * s * i2, wz = 15.0 * J2 * z * i7;
    const double turn = slope * z + wz;
    df[0] = radial + slope * r * r;
    df[1] = turn * r;
    df[2] = radial - 2.0 * s + turn * z + 10.0 * s * i2 * z * z;
}

/* x[n] = the value after those of the last steps by the cubic through them */
static inline void foresee(double *x, const orbit *o, int n) {
    for (int k = 0; k < n; k++)
        x[k] = 4.0 * (o->last[0][k] + o->last[2][k]) - 6.0 * o->last[1][k] - o->last[3][k];
}

static inline void remember(orbit *o, const double *x, int n) {
    for (int i = TERMS - 1; i > 0; i--)
        for (int k = 0; k < n; k++) o->last[i][k] = o->last[i - 1][k];
    for (int k = 0; k < n; k++) o->last[0][k] = x[k];
}

/* what is left does not count, as in linalg/solve/newton.c: |dx| now and before */
static inline int is_last(double now, double before) {
    return now <= 4e-15 || now / before * now <= 4e-20;
}

/* m = x + h/2 p + h^2/4 F(m), F = pull + mu^2/r^3, by a Newton step, then chords */
static inline void step_shape(orbit *o, int with_theta) {
    const double mu = o->p[0], *x = o->q + 1, *p = o->p + 1, w = 0.25 * h * h;
    double F[2], f[2], df[3], m[2], d[2], a = 1, b = 0, c = 1, det = 1, before = 0;
    foresee(F, o, 2);
    for (int k = 0; k < 2; k++) m[k] = x[k] + (o->q_low[k + 1] + 0.5 * h * (p[k] + 0.5 * h * F[k]));
    for (int i = 0; i < 20; i++) {
        const double ir = 1.0 / m[0], push = mu * mu * ir * ir * ir;
        pull(f, i ? NULL : df, m[0], m[1]);
        if (i == 0) {
            a = 1.0 - w * (df[0] - 3.0 * push * ir), b = -w * df[1], c = 1.0 - w * df[2];
            det = 1.0 / (a * c - b * b);
        }
        const double r = f[0] + push - F[0], z = f[1] - F[1];
        d[0] = (c * r - b * z) * det, d[1] = (a * z - b * r) * det;
        for (int k = 0; k < 2; k++) F[k] += d[k], m[k] += w * d[k];
        const double now = w * fmax(fabs(d[0]), fabs(d[1]));
        o->iterations++;
        if (is_last(now, i ? before : 10.0 * now)) break;
        before = now;
    }
    remember(o, F, 2);
    if (with_theta) add(o->q, o->q_low, h * mu / (m[0] * m[0]));
    for (int k = 0; k < 2; k++) {
        add(o->q + k + 1, o->q_low + k + 1, h * (p[k] + 0.5 * h * F[k]));
        add(o->p + k + 1, o->p_low + k + 1, h * F[k]);
    }
}

/* J[3][3] d = -R; the first unknown meets the second only */
static inline void solve(double *d, const double *R, double m2, double u, double a, double b,
                         double c) {
    const double im = 1.0 / m2, first = a + u * u * im, det = 1.0 / (first * c - b * b);
    const double r = -R[1] - u * im * R[0];
    d[1] = (c * r + b * R[2]) * det;
    d[2] = (-first * R[2] - b * r) * det;
    d[0] = (-R[0] - u * d[1]) * im;
}

/* L_v(m, V) - p - h/2 L_q(m, V) = 0, m = q + h/2 V, for V = (theta', r', z') */
static inline void step_all(orbit *o) {
    const double e = 0.5 * h, w = e * e;
    double V[3], f[2], df[3], d[3], R[3], m2 = 1, u = 0, a = 1, b = 0, c = 1, before = 0, m[3];
    foresee(V, o, 3);
    for (int i = 0; i < 20; i++) {
        for (int k = 1; k < 3; k++) m[k] = o->q[k] + (o->q_low[k] + e * V[k]);
        pull(f, i ? NULL : df, m[1], m[2]);
        f[0] += m[1] * V[0] * V[0];
        R[0] = m[1] * m[1] * V[0] - o->p[0];
        for (int k = 1; k < 3; k++) R[k] = V[k] - o->p[k] - (o->p_low[k] + e * f[k - 1]);
        if (i == 0) {
            m2 = m[1] * m[1], u = h * m[1] * V[0], a = 1.0 - w * (df[0] + V[0] * V[0]);
            b = -w * df[1], c = 1.0 - w * df[2];
        }
        solve(d, R, m2, u, a, b, c);
        for (int k = 0; k < 3; k++) V[k] += d[k];
        const double now = fmax(fabs(d[0]), fmax(fabs(d[1]), fabs(d[2])));
        o->iterations++;
        if (is_last(now, i ? before : 10.0 * now)) break;
        before = now;
    }
    remember(o, V, 3);
    for (int k = 1; k < 3; k++) /* L_q at the root, from the step equation */
        add(o->p + k, o->p_low + k, 2.0 * (V[k] - o->p[k] - o->p_low[k]));
    for (int k = 0; k < 3; k++) add(o->q + k, o->q_low + k, h * V[k]);
}

static race_end run(int how) {
    orbit o = {{theta0, x0[0], x0[1]}, {x0[0] * x0[0] * v0[0], v0[1], v0[2]}, {0}, {0}, {{0}}, 0};
    for (int i = 0; i < TERMS; i++)
        for (int k = 0; k < 3; k++) o.last[i][k] = how == 2 ? v0[k] : 0.0;
    if (how == 0)
        for (long k = 0; k < STEPS; k++) step_shape(&o, 0);
    else if (how == 1)
        for (long k = 0; k < STEPS; k++) step_shape(&o, 1);
    else
        for (long k = 0; k < STEPS; k++) step_all(&o);
    return (race_end){o.iterations, o.q[1]};
}

int main(void) {
    race(run, "r");
    return 0;
}
