#include "integ/sweep.h"

#include <stddef.h>

/* vectors of the compiler (gcc, clang): what the processor lacks is done in parts, to the same bits */
typedef double v4 __attribute__((vector_size(32), aligned(8), may_alias));
typedef double v8 __attribute__((vector_size(64), aligned(8), may_alias));

#define INLINE static inline __attribute__((always_inline))

INLINE double total4(const double *x) {
    return (x[0] + x[2]) + (x[1] + x[3]);
}

INLINE double total8(const double *x) {
    return ((x[0] + x[4]) + (x[2] + x[6])) + ((x[1] + x[5]) + (x[3] + x[7]));
}

/* the same text for every width; even and odd columns are summed apart, as neither waits for the other */
#define BODY(W, V, total)                                                                \
    INLINE double move_##V(const dm_sweep *a) {                                          \
        V moved = {0};                                                                   \
        for (uint32_t k = 0; k < a->rows; k++) {                                         \
            const double *u = a->u + (size_t)k * W;                                      \
            V *at = (V *)(void *)(a->sum + (size_t)k * W);                               \
            V even = {0}, odd = {0};                                                     \
            for (uint32_t m = 0; a->rest && m < a->columns; m++)                         \
                odd += *(const V *)(const void *)(a->rest + (size_t)m * W) * u[m];       \
            for (uint32_t m = 0; m < a->columns; m += 2)                                 \
                even += *(const V *)(const void *)(a->top + (size_t)m * W) * u[m];       \
            for (uint32_t m = 1; m < a->columns; m += 2)                                 \
                odd += *(const V *)(const void *)(a->top + (size_t)m * W) * u[m];        \
            const V sum =                                                                \
                *(const V *)(const void *)(a->base + (size_t)k * W) + (even + odd);      \
            const V d = sum - *at;                                                       \
            moved += d * d;                                                              \
            *at = sum;                                                                   \
            *(V *)(void *)(a->x + (size_t)k * W) = a->start[k] + (a->low[k] + sum);      \
        }                                                                                \
        return total((const double *)&moved);                                            \
    }                                                                                    \
    INLINE void collect_##V(double *out, const dm_sweep *a) {                            \
        const V top = *(const V *)(const void *)a->top;                                  \
        const V rest = *(const V *)(const void *)a->rest;                                \
        for (uint32_t k = 0; k < a->rows; k++) {                                         \
            const V u = *(const V *)(const void *)(a->u + (size_t)k * W);                \
            const V high = top * u, low = rest * u;                                      \
            out[k] = total((const double *)&low) + total((const double *)&high);         \
        }                                                                                \
    }                                                                                    \
    INLINE void scale_##V(double *out, const double *factor, const double *u,            \
                          uint32_t rows) {                                               \
        for (uint32_t k = 0; k < rows; k++)                                              \
            *(V *)(void *)(out + (size_t)k * W) =                                        \
                factor[k] * *(const V *)(const void *)(u + (size_t)k * W);               \
    }

BODY(4, v4, total4)
BODY(8, v8, total8)

/* ---- one stage ---- */

static double move_1(const dm_sweep *a) {
    double moved = 0.0;
    for (uint32_t k = 0; k < a->rows; k++) {
        const double part = a->rest ? a->rest[0] * a->u[k] : 0.0;
        const double sum = a->base[k] + (a->top[0] * a->u[k] + part);
        const double d = sum - a->sum[k];
        moved += d * d;
        a->sum[k] = sum;
        a->x[k] = a->start[k] + (a->low[k] + sum);
    }
    return moved;
}

static void collect_1(double *out, const dm_sweep *a) {
    for (uint32_t k = 0; k < a->rows; k++)
        out[k] = a->rest[0] * a->u[k] + a->top[0] * a->u[k];
}

static void scale_1(double *out, const double *factor, const double *u, uint32_t rows) {
    for (uint32_t k = 0; k < rows; k++) out[k] = factor[k] * u[k];
}

static const dm_sweep_row one = {1, move_1, collect_1, scale_1};

/* ---- 4 and 8, each for the processors that there are ---- */

#define ROW(name, W, V, how)                                                             \
    how static double move_##name(const dm_sweep *a) {                                   \
        return move_##V(a);                                                              \
    }                                                                                    \
    how static void collect_##name(double *out, const dm_sweep *a) {                     \
        collect_##V(out, a);                                                             \
    }                                                                                    \
    how static void scale_##name(double *out, const double *factor, const double *u,     \
                                 uint32_t rows) {                                        \
        scale_##V(out, factor, u, rows);                                                 \
    }                                                                                    \
    static const dm_sweep_row name = {W, move_##name, collect_##name, scale_##name};

ROW(plain4, 4, v4, )
ROW(plain8, 8, v8, )

#ifdef __x86_64__
ROW(avx4, 4, v4, __attribute__((target("avx"))))
ROW(avx8, 8, v8, __attribute__((target("avx"))))
ROW(wide8, 8, v8, __attribute__((target("avx512f"))))

const dm_sweep_row *dm_sweep_find(uint32_t stages) {
    if (stages == 1) return &one;
    __builtin_cpu_init();
    const int avx = __builtin_cpu_supports("avx");
    if (stages <= 4) return avx ? &avx4 : &plain4;
    if (__builtin_cpu_supports("avx512f")) return &wide8;
    return avx ? &avx8 : &plain8;
}
#else
const dm_sweep_row *dm_sweep_find(uint32_t stages) {
    if (stages == 1) return &one;
    return stages <= 4 ? &plain4 : &plain8;
}
#endif
