/* splitting.h - explicit splittings of q'' = a(q): tables, and one loop that the compiler makes
 * special to a force and a number of coordinates. The force is called N-fold inlined. */
#ifndef BENCH_SPLITTING_H
#define BENCH_SPLITTING_H

#include "lanes.h"
#include "search.h"

#include <string.h>

enum { KICKS = 40 };

/* in one step: drift lead, then pairs (kick, drift); the last drift or kick of a step and the
 * first of the next are one. `half` = what the first kick of a run has too much. */
typedef struct {
    int pairs;
    double lead, half;
    double kick[KICKS], drift[KICKS];
} splitting;

/* symmetric composition of s velocity Verlet steps gamma_1 h, ...; only (s + 1)/2 are given */
INLINE splitting compose(const double *gamma, int s) {
    splitting out = {.pairs = s, .half = 0.5 * gamma[0]};
    for (int k = 0; k < s; k++) {
        const int before = k ? k - 1 : 0;
        const double g = gamma[k < s - k ? k : s - 1 - k];
        const double last = gamma[before < s - before ? before : s - 1 - before];
        out.kick[k] = 0.5 * (g + last);
        out.drift[k] = g;
    }
    return out;
}

/* the same of position Verlet: drift, kick, drift */
INLINE splitting compose_drifts(const double *gamma, int s) {
    splitting out = {.pairs = s, .lead = 0.5 * gamma[0]};
    for (int k = 0; k < s; k++) {
        const int next = k + 1 < s ? k + 1 : 0;
        const double g = gamma[k < s - k ? k : s - 1 - k];
        out.kick[k] = g;
        out.drift[k] = 0.5 * (g + gamma[next < s - next ? next : s - 1 - next]);
    }
    return out;
}

/* kicks b_1 ... b_(s+1) around drifts a_1 ... a_s, both palindromes: half of each is given */
INLINE splitting kick_first(const double *b, const double *a, int s) {
    splitting out = {.pairs = s, .half = b[0]};
    for (int k = 0; k < s; k++) {
        out.kick[k] = k ? b[k < s + 1 - k ? k : s - k] : 2.0 * b[0];
        out.drift[k] = a[k < s - k ? k : s - 1 - k];
    }
    return out;
}

/* drifts a_1 ... a_(s+1) around kicks b_1 ... b_s */
INLINE splitting drift_first(const double *a, const double *b, int s) {
    splitting out = {.pairs = s, .lead = a[0]};
    for (int k = 0; k < s; k++) {
        const int next = k + 1;
        out.kick[k] = b[k < s - k ? k : s - 1 - k];
        out.drift[k] = next == s ? 2.0 * a[0] : a[next < s + 1 - next ? next : s - next];
    }
    return out;
}

enum { SPLITTINGS = 11 };
extern splitting bench_splittings[SPLITTINGS], bench_log_splittings[SPLITTINGS];
void bench_make_splittings(void);

/* rows for a problem, the likely ones first: they shorten the search for the others */
#define SPLITTING_METHODS(run)                                                                     \
    {"blanes-moan(6,11)", run, &bench_splittings[8], 0},                                           \
        {"blanes-moan(6,14)", run, &bench_splittings[9], 0},                                       \
        {"sofspa(10)", run, &bench_splittings[6], 0},                                              \
        {"kahan-li(8)", run, &bench_splittings[4], 0},                                             \
        {"suzuki-umeno(8)", run, &bench_splittings[5], 0},                                         \
        {"kahan-li(6)", run, &bench_splittings[3], 0},                                             \
        {"blanes-moan(4,6)", run, &bench_splittings[7], 0},                                        \
        {"sb3a(5)", run, &bench_splittings[10], 0}, {"suzuki(4)", run, &bench_splittings[2], 0},   \
        {"yoshida(4)", run, &bench_splittings[1], 0}, {                                            \
        "verlet", run, &bench_splittings[0], 0                                                     \
    }

typedef void acceleration(double *a, const double *q);

/* steps x 32 steps of length T/32/steps from (q0, v0) */
INLINE void split(double *out, const splitting *table, long steps, int n, acceleration *a,
                  double *q, double *v, double T) {
    const double h = T / BENCH_OUTPUTS / (double)steps;
    double kick[KICKS], drift[KICKS], f[n];
    for (int k = 0; k < table->pairs; k++)
        kick[k] = h * table->kick[k], drift[k] = h * table->drift[k];
    a(f, q);
    for (int i = 0; i < n; i++) v[i] -= h * table->half * f[i];
    for (int i = 0; i < n; i++) q[i] += h * table->lead * v[i];
    for (int row = 0; row < BENCH_OUTPUTS; row++) {
        for (long step = 0; step < steps; step++)
            for (int k = 0; k < table->pairs; k++) {
                a(f, q);
                for (int i = 0; i < n; i++) v[i] += kick[k] * f[i];
                for (int i = 0; i < n; i++) q[i] += drift[k] * v[i];
            }
        for (int i = 0; i < n; i++) out[row * n + i] = q[i] - h * table->lead * v[i];
    }
}

#endif
