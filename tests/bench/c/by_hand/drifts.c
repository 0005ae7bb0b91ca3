/* drifts.c - how the angular momentum of Kepler's problem drifts in steps that a good programmer
 * writes: compensated sums, Newton's method with the exact matrix until its increments are
 * round-off; rows of docs/benchmarks/drifts.md. Slope per unit of time of ten ellipses, mean and
 * standard error by their spread. Arguments: steps a start, h.
 *   gcc -O2 -o build/drifts tests/bench/c/by_hand/drifts.c -lm && build/drifts 1e6 0.05
 *   midpoint   v of the segment q0 + t v as unknown, p1 = p0 + h F(q0 + h v / 2): what curve(euler,
 *              1/2) solves for
 *   del        p0 + D1 Ld(q0, q0 + z) = 0 for z by the formula of Ld, p1 = p0 + (D1 + D2) */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { STARTS = 10, MOST = 20 };

typedef struct {
    double q[2], p[2], low_q[2], low_p[2];
    double z[4][2]; /* of the last steps, the last first */
    int count;
} state;

static void add(double *high, double *low, double x) {
    const double a = *high, e = *low + x, sum = a + e;
    *low = e + (a - sum);
    *high = sum;
}

/* x = A^-1 x, A symmetric */
static void solve(double x[2], double a, double b, double c) {
    const double det = a * c - b * b, y = (c * x[0] - b * x[1]) / det;
    x[1] = (a * x[1] - b * x[0]) / det;
    x[0] = y;
}

/* the unknown continued by the cubic through the last four */
static void guess(const state *s, double z[2], double h) {
    for (int i = 0; i < 2; i++)
        z[i] = s->count < 4 ? h * s->p[i]
                            : 4 * s->z[0][i] - 6 * s->z[1][i] + 4 * s->z[2][i] - s->z[3][i];
}

static void keep(state *s, const double z[2]) {
    memmove(s->z[1], s->z[0], 3 * sizeof *s->z);
    memcpy(s->z[0], z, sizeof *s->z);
    s->count++;
}

/* -q/r^3 at q + d and its derivative */
static void force(double f[2], double df[3], const double q[2], const double d[2]) {
    const double x = q[0] + d[0], y = q[1] + d[1], r2 = x * x + y * y, s = 1.0 / (r2 * sqrt(r2));
    const double t = 3.0 * s / r2;
    f[0] = -x * s, f[1] = -y * s;
    df[0] = t * x * x - s, df[1] = t * x * y, df[2] = t * y * y - s;
}

/* Increments of Newton's method end at round-off, or where they do not shrink any more. */
static int is_done(const double r[2], const double z[2], double *last) {
    const double step = fmax(fabs(r[0]), fabs(r[1])), size = fmax(fabs(z[0]), fabs(z[1]));
    const int done = step <= 1e-17 * size || (step <= 1e-12 * size && step >= 0.1 * *last);
    *last = step;
    return done;
}

/* z = h v: z = h p0 + h^2/2 F(q0 + z / 2) */
static void midpoint(state *s, double h) {
    double z[2], r[2], f[2], df[3], d[2], last = INFINITY;
    guess(s, z, h);
    for (int k = 0; k < MOST; k++) {
        for (int i = 0; i < 2; i++) d[i] = s->low_q[i] + 0.5 * z[i];
        force(f, df, s->q, d);
        for (int i = 0; i < 2; i++)
            r[i] = z[i] - (h * s->p[i] + (h * s->low_p[i] + 0.5 * h * h * f[i]));
        const double w = 0.25 * h * h;
        solve(r, 1.0 - w * df[0], -w * df[1], 1.0 - w * df[2]);
        for (int i = 0; i < 2; i++) z[i] -= r[i];
        if (is_done(r, z, &last)) break;
    }
    for (int i = 0; i < 2; i++) add(s->q + i, s->low_q + i, z[i]);
    for (int i = 0; i < 2; i++) add(s->p + i, s->low_p + i, h * f[i]);
    keep(s, z);
}

/* Ld = h (L(q0, v) + L(q1, v)) / 2, v = (q1 - q0) / h */
static void del(state *s, double h) {
    const double zero[2] = {0};
    double z[2], r[2], f0[2], f1[2], df[3], last = INFINITY;
    guess(s, z, h);
    force(f0, df, s->q, zero);
    for (int k = 0; k < MOST; k++) {
        for (int i = 0; i < 2; i++) {
            const double D1 = -z[i] / h + h / 2 * f0[i];
            r[i] = -h * ((s->p[i] + D1) + s->low_p[i]);
        }
        for (int i = 0; i < 2; i++) z[i] -= r[i];
        if (is_done(r, z, &last)) break;
    }
    double d[2] = {s->low_q[0] + z[0], s->low_q[1] + z[1]};
    force(f1, df, s->q, d);
    for (int i = 0; i < 2; i++) add(s->q + i, s->low_q + i, z[i]);
    for (int i = 0; i < 2; i++) add(s->p + i, s->low_p + i, h / 2 * (f0[i] + f1[i]));
    keep(s, z);
}

/* ---- starts and slopes ---- */

static double uniform(void) {
    static unsigned long long x = 88172645463325252ull;
    x ^= x << 13, x ^= x >> 7, x ^= x << 17;
    return (double)(x >> 11) * 0x1p-53;
}

/* on an ellipse, anywhere, as tests/bench/dm/long_runs.lua has them */
static state ellipse(void) {
    const double e = 0.3 + 0.3 * uniform(), a = 0.9 + 0.3 * uniform(), E = 2 * M_PI * uniform();
    const double b = a * sqrt(1 - e * e), rate = pow(a, -1.5) / (1 - e * cos(E));
    const double angle = 2 * M_PI * uniform(), c = cos(angle), t = sin(angle);
    const double x = a * (cos(E) - e), y = b * sin(E);
    const double u = -a * sin(E) * rate, w = b * cos(E) * rate;
    return (state){.q = {c * x - t * y, t * x + c * y}, .p = {c * u - t * w, t * u + c * w}};
}

static long double momentum(const state *s) {
    const long double x = (long double)s->q[0] + s->low_q[0],
                      y = (long double)s->q[1] + s->low_q[1];
    return x * ((long double)s->p[1] + s->low_p[1]) - y * ((long double)s->p[0] + s->low_p[0]);
}

static void row(const char *name, void (*step)(state *, double), long steps, double h) {
    double sum = 0, square = 0;
    for (int k = 0; k < STARTS; k++) {
        state s = ellipse();
        const long double J = momentum(&s);
        for (long i = 0; i < steps; i++) step(&s, h);
        const double slope = (double)((momentum(&s) - J) / (h * (long double)steps));
        sum += slope / STARTS, square += slope * slope;
    }
    const double error = sqrt((square - STARTS * sum * sum) / (STARTS * (STARTS - 1)));
    printf("%-9s h = %-14.12g J %9.1e +- %7.1e a unit of time\n", name, h, sum, error);
    fflush(stdout);
}

int main(int count, char **word) {
    const long steps = count > 1 ? (long)atof(word[1]) : 1000000;
    const double h = count > 2 ? atof(word[2]) : 0.05;
    row("midpoint", midpoint, steps, h);
    row("del", del, steps, h);
    return 0;
}
