/* drifts_verlet.c - how angular momentum drifts by Verlet's rule as a good programmer writes it, with
 * compensated sums, where all forces are linear but one: rows of docs/benchmarks/drifts.md.
 *   L = (u.u + w.w)/2 - x.x/2 - 3 y.y/8 - x.y/4 - (y.y)^2/8 of two bodies x, y of the plane
 * Slope per unit of time of ten starts, mean and standard error by their spread. Arguments: steps a
 * start, h.
 *   gcc -O2 -o build/drifts_verlet tests/bench/c/by_hand/drifts_verlet.c -lm && build/drifts_verlet 1e6 0.05
 *   high       the drift has p without its low part, as the force has q
 *   whole      h low_p goes into the low part of q beside it
 *   exact      the same, and a product is added to what the sum lost before the low part (with
 *              -march=native it is not rounded then) */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

enum { STARTS = 10, N = 4 };

typedef struct {
    double q[N], p[N], low_q[N], low_p[N];
} state;

static void add(double *high, double *low, double x) {
    const double a = *high, e = *low + x, sum = a + e;
    *low = e + (a - sum);
    *high = sum;
}

/* high + low += a b */
static void add_product(double *high, double *low, double a, double b) {
    const double old = *high, sum = old + (a * b + *low);
    *low += a * b + (old - sum);
    *high = sum;
}

static void force(double f[N], const double q[N]) {
    const double yy = q[2] * q[2] + q[3] * q[3], k = 0.75 + 0.5 * yy;
    for (int i = 0; i < 2; i++) {
        f[i] = -(q[i] + 0.25 * q[2 + i]);
        f[2 + i] = -(k * q[2 + i] + 0.25 * q[i]);
    }
}

static void exact_step(state *s, double h) {
    double f[N];
    force(f, s->q);
    for (int i = 0; i < N; i++) add_product(s->p + i, s->low_p + i, h / 2, f[i]);
    for (int i = 0; i < N; i++) {
        add_product(s->q + i, s->low_q + i, h, s->p[i]);
        s->low_q[i] += h * s->low_p[i];
    }
    force(f, s->q);
    for (int i = 0; i < N; i++) add_product(s->p + i, s->low_p + i, h / 2, f[i]);
}

enum { HIGH, WHOLE, EXACT };

static void step(state *s, double h, int whole) {
    double f[N];
    force(f, s->q);
    for (int i = 0; i < N; i++) add(s->p + i, s->low_p + i, h / 2 * f[i]);
    for (int i = 0; i < N; i++) {
        if (whole) s->low_q[i] += h * s->low_p[i];
        add(s->q + i, s->low_q + i, h * s->p[i]);
    }
    force(f, s->q);
    for (int i = 0; i < N; i++) add(s->p + i, s->low_p + i, h / 2 * f[i]);
}

static double uniform(void) {
    static unsigned long long x = 88172645463325252ull;
    x ^= x << 13, x ^= x >> 7, x ^= x << 17;
    return (double)(x >> 11) * 0x1p-53;
}

static state start(void) {
    const double middle[2 * N] = {-0.7, 0.0, 0.3, 0.2, 0.0, -0.6, 0.2, 0.3};
    state s = {.q = {0}};
    for (int i = 0; i < N; i++) s.q[i] = middle[i] + 0.4 * (uniform() - 0.5);
    for (int i = 0; i < N; i++) s.p[i] = middle[N + i] + 0.3 * (uniform() - 0.5);
    return s;
}

static long double momentum(const state *s) {
    long double J = 0, x[2 * N];
    for (int i = 0; i < N; i++) x[i] = (long double)s->q[i] + s->low_q[i];
    for (int i = 0; i < N; i++) x[N + i] = (long double)s->p[i] + s->low_p[i];
    for (int i = 0; i < N; i += 2) J += x[i] * x[N + i + 1] - x[i + 1] * x[N + i];
    return J;
}

static void row(const char *name, int how, long steps, double h) {
    double sum = 0, square = 0;
    for (int k = 0; k < STARTS; k++) {
        state s = start();
        const long double J = momentum(&s);
        for (long i = 0; i < steps; i++)
            how == EXACT ? exact_step(&s, h) : step(&s, h, how == WHOLE);
        const double slope = (double)((momentum(&s) - J) / (h * (long double)steps));
        sum += slope / STARTS, square += slope * slope;
    }
    const double error = sqrt((square - STARTS * sum * sum) / (STARTS * (STARTS - 1)));
    printf("%-6s h = %-14.12g J %9.1e +- %7.1e a unit of time\n", name, h, sum, error);
    fflush(stdout);
}

int main(int count, char **word) {
    const long steps = count > 1 ? (long)atof(word[1]) : 1000000;
    const double h = count > 2 ? atof(word[2]) : 0.05;
    for (int again = 0; again < 2; again++) {
        row("high", HIGH, steps, h);
        row("whole", WHOLE, steps, h);
        row("exact", EXACT, steps, h);
    }
    return 0;
}
