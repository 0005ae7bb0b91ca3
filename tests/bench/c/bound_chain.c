/* P8: periodic chains, V = sum W(q_i - q_(i+1)): Toda W(d) = exp(d) - 1, FPU-beta W(d) = d^2/2 +
 * d^4/4. Long chains: lanes are neighbours; kick and drift of a stage are one pass over memory. */
#include "bound.h"

#include <stdint.h>

enum { LONG = 1024 };

INLINE v8 toda8(v8 d) {
    return exp8(d);
}
INLINE v8 fpu8(v8 d) {
    return d + d * d * d;
}
INLINE double toda1(double d) {
    return exp(d);
}
INLINE double fpu1(double d) {
    return d + d * d * d;
}

/* velocities from the generator s <- 1664525 s + 1013904223, mean removed */
static void start(double *q, double *v, int n) {
    uint32_t s = 12345;
    double mean = 0.0;
    for (int i = 0; i < n; i++) {
        s = s * 1664525u + 1013904223u;
        v[i] = (double)(s >> 8) / 8388608.0 - 1.0;
        mean += v[i];
    }
    for (int i = 0; i < n; i++) q[i] = 0.0, v[i] -= mean / n;
}

/* v += kick a(q), then q += drift v: what a bond needs of its right end is read before it moves.
 * q has room for n + 8; q[n] is the periodic neighbour. */
INLINE void pass(double *q, double *v, double kick, double drift, int n, v8 slope8(v8),
                 double slope1(double)) {
    v8 here = load8(q), last = {0, 0, 0, 0, 0, 0, 0, slope1(q[n - 1] - q[0])};
    q[n] = q[0];
    for (int i = 0; i < n; i += 8) {
        const v8 ahead = load8(q + i + 8), g = slope8(here - shift_left(here, ahead));
        const v8 u = load8(v + i) + kick * (shift_right(last, g) - g);
        store8(v + i, u);
        store8(q + i, here + drift * u);
        here = ahead, last = g;
    }
}

INLINE void split_chain(double *out, const splitting *table, long steps, int n, double T,
                        v8 slope8(v8), double slope1(double)) {
    static double q[LONG + 8] __attribute__((aligned(64))), v[LONG] __attribute__((aligned(64)));
    const double h = T / BENCH_OUTPUTS / (double)steps;
    double kick[KICKS], drift[KICKS];
    for (int k = 0; k < table->pairs; k++)
        kick[k] = h * table->kick[k], drift[k] = h * table->drift[k];
    start(q, v, n);
    pass(q, v, -h * table->half, 0.0, n, slope8, slope1);
    for (int i = 0; i < n; i++) q[i] += h * table->lead * v[i];
    for (int row = 0; row < BENCH_OUTPUTS; row++) {
        for (long step = 0; step < steps; step++)
            for (int k = 0; k < table->pairs; k++) pass(q, v, kick[k], drift[k], n, slope8, slope1);
        for (int i = 0; i < n; i++) out[row * n + i] = q[i] - h * table->lead * v[i];
    }
}

/* extrapolated Stoermer of order 2 levels over the whole chain, one leapfrog after the other */
INLINE void stoermer_chain(double *out, int levels, long steps, int n, double T, v8 slope8(v8),
                           double slope1(double)) {
    static double q[LONG + 8] __attribute__((aligned(64))), v[LONG] __attribute__((aligned(64)));
    static double Q[LONG + 8] __attribute__((aligned(64))), U[LONG] __attribute__((aligned(64)));
    static double dq[LONG], dv[LONG], q_low[LONG], v_low[LONG], f[LONG];
    const double h = T / BENCH_OUTPUTS / (double)steps;
    v8 w, share;
    neville(&w, &share, levels);
    start(q, v, n);
    for (int i = 0; i < n; i++) q_low[i] = v_low[i] = 0.0;
    for (int row = 0; row < BENCH_OUTPUTS; row++) {
        for (long step = 0; step < steps; step++) {
            for (int i = 0; i < n; i++) Q[i] = q[i], f[i] = dq[i] = dv[i] = 0.0;
            pass(Q, f, 1.0, 0.0, n, slope8, slope1); /* the force that all leapfrogs begin with */
            for (int j = 1; j <= levels; j++) {
                const double d = h / j, weight = w[j - 1];
                for (int i = 0; i < n; i++) U[i] = v[i] + 0.5 * d * f[i], Q[i] = q[i] + d * U[i];
                for (int k = 1; k < j; k++) pass(Q, U, d, d, n, slope8, slope1);
                pass(Q, U, 0.5 * d, 0.0, n, slope8, slope1);
                for (int i = 0; i < n; i++) {
                    dq[i] += weight * (Q[i] - q[i]);
                    dv[i] += weight * (U[i] - v[i]);
                }
            }
            for (int i = 0; i < n; i++) {
                add_exactly(q + i, q_low + i, dq[i]);
                add_exactly(v + i, v_low + i, dv[i]);
            }
        }
        for (int i = 0; i < n; i++) out[row * n + i] = q[i];
    }
}

/* Gauss with stages in lanes for the short chains */
INLINE void slopes8(v8 *a, const v8 *q, int n, v8 slope8(v8)) {
    v8 before = slope8(q[n - 1] - q[0]);
    for (int i = 0; i < n; i++) {
        const v8 after = slope8(q[i] - q[i + 1 == n ? 0 : i + 1]);
        a[i] = before - after;
        before = after;
    }
}

INLINE void slopes1(double *a, const double *q, int n, double slope1(double)) {
    double before = slope1(q[n - 1] - q[0]);
    for (int i = 0; i < n; i++) {
        const double after = slope1(q[i] - q[i + 1 == n ? 0 : i + 1]);
        a[i] = before - after;
        before = after;
    }
}

/* lanes are stages or leapfrogs: for chains of any length */
#define STAGES_IN_LANES(name, n, T, slope8)                                                        \
    INLINE void name##_force8(v8 *a, const v8 *q, const v8 *v) {                                   \
        (void)v;                                                                                   \
        slopes8(a, q, n, slope8);                                                                  \
    }                                                                                              \
    static void name##_gauss(double *out, const bench_method *m, long steps) {                     \
        double q[n], v[n];                                                                         \
        start(q, v, n);                                                                            \
        GAUSS_CASES(out, m, n, 0, steps, name##_force8, q, v, T)                                   \
    }                                                                                              \
    static void name##_lanes(double *out, const bench_method *m, long steps) {                     \
        double q[n], v[n];                                                                         \
        start(q, v, n);                                                                            \
        STOERMER_CASES(out, m, n, steps, name##_force8, q, v, T)                                   \
    }

/* lanes are neighbours: for lengths that are multiples of 8 */
#define NEIGHBOURS_IN_LANES(name, n, T, slope8, slope1)                                            \
    static void name##_split(double *out, const bench_method *m, long steps) {                     \
        split_chain(out, m->table, steps, n, T, slope8, slope1);                                   \
    }                                                                                              \
    static void name##_stoermer(double *out, const bench_method *m, long steps) {                  \
        stoermer_chain(out, m->k, steps, n, T, slope8, slope1);                                    \
    }

#define SHORT_CHAIN(name, n, T, slope8, slope1)                                                    \
    STAGES_IN_LANES(name, n, T, slope8)                                                            \
    INLINE void name##_force(double *a, const double *q) {                                         \
        slopes1(a, q, n, slope1);                                                                  \
    }                                                                                              \
    INLINE void name##_force_v(double *a, const double *q, const double *v) {                      \
        (void)v;                                                                                   \
        slopes1(a, q, n, slope1);                                                                  \
    }                                                                                              \
    static void name##_split(double *out, const bench_method *m, long steps) {                     \
        double q[n], v[n];                                                                         \
        start(q, v, n);                                                                            \
        split(out, m->table, steps, n, name##_force, q, v, T);                                     \
    }                                                                                              \
    static void name##_rk8(double *out, const bench_method *m, long steps) {                       \
        double q[n], v[n];                                                                         \
        (void)m;                                                                                   \
        start(q, v, n);                                                                            \
        rk8(out, steps, n, name##_force_v, q, v, T);                                               \
    }                                                                                              \
    static const bench_method name[] = {GAUSS_METHODS(name##_gauss),                               \
                                        SPLITTING_METHODS(name##_split),                           \
                                        {"rk8", name##_rk8, NULL, 0},                              \
                                        STOERMER_METHODS(name##_lanes),                            \
                                        {NULL, NULL, NULL, 0}};

#define MIDDLE_CHAIN(name, n, T, slope8, slope1)                                                   \
    STAGES_IN_LANES(name, n, T, slope8)                                                            \
    NEIGHBOURS_IN_LANES(name, n, T, slope8, slope1)                                                \
    static const bench_method name[] = {GAUSS_METHODS(name##_gauss),                               \
                                        SPLITTING_METHODS(name##_split),                           \
                                        STOERMER_METHODS(name##_stoermer),                         \
                                        {"stoermer(12) in lanes", name##_lanes, NULL, 6},          \
                                        {"stoermer(16) in lanes", name##_lanes, NULL, 8},          \
                                        {NULL, NULL, NULL, 0}};

#define LONG_CHAIN(name, n, T, slope8, slope1)                                                     \
    NEIGHBOURS_IN_LANES(name, n, T, slope8, slope1)                                                \
    static const bench_method name[] = {SPLITTING_METHODS(name##_split),                           \
                                        STOERMER_METHODS(name##_stoermer),                         \
                                        {NULL, NULL, NULL, 0}};

SHORT_CHAIN(toda3, 3, 100.0, toda8, toda1)
SHORT_CHAIN(fpu3, 3, 100.0, fpu8, fpu1)
MIDDLE_CHAIN(toda32, 32, 100.0, toda8, toda1)
MIDDLE_CHAIN(fpu32, 32, 100.0, fpu8, fpu1)
LONG_CHAIN(toda1024, LONG, 16.0, toda8, toda1)
LONG_CHAIN(fpu1024, LONG, 16.0, fpu8, fpu1)

const bench_problem bench_chain[] = {{"P8-toda-3", 3, toda3},
                                     {"P8-toda-32", 32, toda32},
                                     {"P8-toda-1024", LONG, toda1024},
                                     {"P8-fpu-3", 3, fpu3},
                                     {"P8-fpu-32", 32, fpu32},
                                     {"P8-fpu-1024", LONG, fpu1024},
                                     {NULL, 0, NULL}};
