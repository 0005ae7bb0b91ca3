/* P6: pendulum on a stiff spring, V = k/2 (r - 1)^2 + 9.81 y, from rest at (sin 1, -cos 1) */
#include "bound.h"

enum { N = 2 };
static const double T = 16.0, GRAVITY = 9.81;

#define PULL(root)                                                                                 \
    const __typeof__(q[0] * 1.0) w = k * root(q[0] * q[0] + q[1] * q[1]) - k;                      \
    a[0] = w * q[0], a[1] = w * q[1] - GRAVITY;

#define FOR_STIFFNESS(name, stiffness)                                                             \
    INLINE void name##_pull(double *a, const double *q) {                                          \
        const double k = stiffness;                                                                \
        PULL(inverse_root)                                                                         \
    }                                                                                              \
    INLINE void name##_pull_v(double *a, const double *q, const double *v) {                       \
        (void)v;                                                                                   \
        name##_pull(a, q);                                                                         \
    }                                                                                              \
    INLINE void name##_pull8(v8 *a, const v8 *q, const v8 *v) {                                    \
        const double k = stiffness;                                                                \
        (void)v;                                                                                   \
        PULL(inverse_root8)                                                                        \
    }                                                                                              \
    static void name##_split(double *out, const bench_method *m, long steps) {                     \
        double q[N] = {sin(1.0), -cos(1.0)}, v[N] = {0.0, 0.0};                                    \
        split(out, m->table, steps, N, name##_pull, q, v, T);                                      \
    }                                                                                              \
    static void name##_gauss(double *out, const bench_method *m, long steps) {                     \
        double q[N] = {sin(1.0), -cos(1.0)}, v[N] = {0.0, 0.0};                                    \
        GAUSS_CASES(out, m, N, 0, steps, name##_pull8, q, v, T)                                    \
    }                                                                                              \
    static void name##_rk8(double *out, const bench_method *m, long steps) {                       \
        double q[N] = {sin(1.0), -cos(1.0)}, v[N] = {0.0, 0.0};                                    \
        (void)m;                                                                                   \
        rk8(out, steps, N, name##_pull_v, q, v, T);                                                \
    }                                                                                              \
    static void name##_stoermer(double *out, const bench_method *m, long steps) {                  \
        double q[N] = {sin(1.0), -cos(1.0)}, v[N] = {0.0, 0.0};                                    \
        STOERMER_CASES(out, m, N, steps, name##_pull8, q, v, T)                                    \
    }                                                                                              \
    static const bench_method name[] = {GAUSS_METHODS(name##_gauss),                               \
                                        SPLITTING_METHODS(name##_split),                           \
                                        {"rk8", name##_rk8, NULL, 0},                              \
                                        STOERMER_METHODS(name##_stoermer),                         \
                                        {NULL, NULL, NULL, 0}};

FOR_STIFFNESS(soft, 1e2)
FOR_STIFFNESS(stiff, 1e4)
FOR_STIFFNESS(very_stiff, 1e6)

const bench_problem bench_spring[] = {{"P6-1e2", N, soft},
                                      {"P6-1e4", N, stiff},
                                      {"P6-1e6", N, very_stiff},
                                      {NULL, 0, NULL}};
