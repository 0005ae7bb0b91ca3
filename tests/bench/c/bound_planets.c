/* P3: Sun and five outer planets (HLW, table I.2.2): AU, days; Sun at rest at the origin */
#include "bound.h"

#include <string.h>

enum { BODIES = 6, N = 3 * BODIES };
static const double T = 200000.0, G = 2.95912208286e-4;
static const double MASS[BODIES] = {1.00000597682,      0.000954786104043,  0.000285583733151,
                                    0.0000437273164546, 0.0000517759138449, 1 / 1.3e8};
static const double Q0[N] = {0,           0,           0,          -3.5023653,  -3.8169847,
                             -1.5507963,  9.0755314,   -3.0458353, -1.6483708,  8.3101420,
                             -16.2901086, -7.2521278,  11.4707666, -25.7294829, -10.8169456,
                             -15.5387357, -25.2225594, -3.1902382};
static const double V0[N] = {0,           0,           0,          0.00565429, -0.00412490,
                             -0.00190589, 0.00168318,  0.00483525, 0.00192462, 0.00354178,
                             0.00137102,  0.00055029,  0.00288930, 0.00114527, 0.00039677,
                             0.00276725,  -0.00170702, -0.00136504};

/* the fifteen pairs at once: lanes are pairs, in two groups of eight */
enum { PAIRS = 15 };
static const int FIRST[16] = {1, 2, 3, 4, 5, 2, 3, 4, 5, 3, 4, 5, 4, 5, 5, 5};
static const int SECOND[16] = {0, 0, 0, 0, 0, 1, 1, 1, 1, 2, 2, 2, 3, 3, 4, 4};

INLINE void attraction(double *a, const double *q) {
    double d[3][16] __attribute__((aligned(64))), w[16] __attribute__((aligned(64)));
#pragma GCC unroll 16
    for (int k = 0; k < 16; k++)
        for (int i = 0; i < 3; i++) d[i][k] = q[3 * FIRST[k] + i] - q[3 * SECOND[k] + i];
    for (int k = 0; k < 16; k += 8) {
        const v8 x = load8(d[0] + k), y = load8(d[1] + k), z = load8(d[2] + k);
        /* the sixteenth is the last again: its weight is not used */
        store8(w + k, G * inverse_cube8(x * x + y * y + z * z +
                                        (k ? (v8){0, 0, 0, 0, 0, 0, 0, 1} : (v8){0})));
    }
    memset(a, 0, N * sizeof *a);
#pragma GCC unroll 15
    for (int k = 0; k < PAIRS; k++) {
        const int i = FIRST[k], j = SECOND[k];
#pragma GCC unroll 3
        for (int c = 0; c < 3; c++) {
            a[3 * i + c] -= w[k] * MASS[j] * d[c][k];
            a[3 * j + c] += w[k] * MASS[i] * d[c][k];
        }
    }
}

INLINE void attraction_v(double *a, const double *q, const double *v) {
    (void)v;
    attraction(a, q);
}

/* here lanes are stages, and pairs come one after the other */
INLINE void attraction8(v8 *a, const v8 *q, const v8 *v) {
    (void)v;
    for (int i = 0; i < N; i++) a[i] = (v8){0};
#pragma GCC unroll 15
    for (int k = 0; k < PAIRS; k++) {
        const int i = 3 * FIRST[k], j = 3 * SECOND[k];
        const v8 x = q[i] - q[j], y = q[i + 1] - q[j + 1], z = q[i + 2] - q[j + 2];
        const v8 w = inverse_cube8(x * x + y * y + z * z);
        const v8 left = w * (-G * MASS[SECOND[k]]), right = w * (G * MASS[FIRST[k]]);
        a[i] += left * x, a[i + 1] += left * y, a[i + 2] += left * z;
        a[j] += right * x, a[j + 1] += right * y, a[j + 2] += right * z;
    }
}

static void start(double *q, double *v) {
    memcpy(q, Q0, sizeof Q0);
    memcpy(v, V0, sizeof V0);
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

const bench_problem bench_planets[] = {{"P3", N, methods}, {NULL, 0, NULL}};
