#include "integ/stage/sweep/sweep.h"

#include "base/written_out.h"
#include "numbers/compensated.h"
#include "numbers/processor.h"

#include <math.h>
#include <stddef.h>
#ifdef __x86_64__
#include <immintrin.h>
#endif

/* vectors of the compiler (gcc, clang): what the processor lacks is done in parts */
typedef double v2 __attribute__((vector_size(16), aligned(8), may_alias));
typedef double v4 __attribute__((vector_size(32), aligned(8), may_alias));
typedef double v8 __attribute__((vector_size(64), aligned(8), may_alias));

/* ---- one stage ---- */

DM_WRITTEN_OUT double move_rows(const dm_sweep *a, uint32_t rows, const double *units) {
    double moved = 0.0;
#pragma GCC unroll 4
    for (uint32_t k = 0; k < rows; k++) {
        const double factor = a->factor ? a->factor[k] : 1.0;
        const double sum = a->base[k] + factor * (a->column[0] * a->u[k]);
        const double x = a->start[k] + sum, d = x - a->x[k];
        moved += (units ? d * units[k] : d) * d;
        a->x[k] = x;
    }
    return moved;
}

static double move_1(const dm_sweep *a) {
    if (a->unit) return move_rows(a, a->rows, a->unit);
    switch (a->rows) {
    case 1:
        return move_rows(a, 1, NULL);
    case 2:
        return move_rows(a, 2, NULL);
    case 3:
        return move_rows(a, 3, NULL);
    case 4:
        return move_rows(a, 4, NULL);
    default:
        return move_rows(a, a->rows, NULL);
    }
}

static void put_1(const dm_sweep *a) {
    move_1(a);
}

DM_WRITTEN_OUT double set_rows(const dm_sweep *a, uint32_t rows, double *own, double *least) {
    double size = 0.0, smallest = INFINITY;
#pragma GCC unroll 4
    for (uint32_t k = 0; k < rows; k++) {
        const double start = a->start[k], factor = a->factor ? a->factor[k] : 1.0;
        const double x = start + (a->base[k] + factor * (a->column[0] * a->u[k]));
        const double squares = start * start + x * x, counts = squares > 0.0 ? squares : INFINITY;
        size += own[k] = squares;
        smallest = counts < smallest ? counts : smallest;
        a->x[k] = x;
    }
    *least = smallest;
    return size;
}

static double set_1(const dm_sweep *a, double *own, double *least) {
    switch (a->rows) {
    case 1:
        return set_rows(a, 1, own, least);
    case 2:
        return set_rows(a, 2, own, least);
    case 3:
        return set_rows(a, 3, own, least);
    case 4:
        return set_rows(a, 4, own, least);
    default:
        return set_rows(a, a->rows, own, least);
    }
}

static void line_1(double *base, const double *low, const double *v, const dm_parts *c,
                   uint32_t rows) {
    for (uint32_t k = 0; k < rows; k++) base[k] = c->top[0] * v[k] + (c->rest[0] * v[k] + low[k]);
}

DM_WRITTEN_OUT double finish_rows(const dm_sweep_end *a, uint32_t n) {
    double *high = a->state, *low = a->state + 2 * (size_t)n, bad = 0.0;
    const dm_parts *b = a->b[0], *c = a->b[1];
#pragma GCC unroll 4
    for (uint32_t k = 0; k < n; k++) {
        const double u = a->u[0][k], f = a->u[1][k];
        dm_sum_add(high + k, low + k,
                   (b->top[0] * u + b->rest[0] * u) * a->factor[k] + a->drift[k]);
        dm_sum_add(high + n + k, low + n + k, c->top[0] * f + c->rest[0] * f);
        bad += 0.0 * (low[k] + low[n + k]);
    }
    return bad;
}

/* d of four rows or one: into high + low; NaN is added to `bad` where that is not finite */
static inline void add_four(double *high, double *low, const v4 *d, v4 *bad) {
    v4 *h = (v4 *)(void *)high, *l = (v4 *)(void *)low;
    const v4 old = *h, e = *l + *d, sum = old + e, rest = e + (old - sum);
    *l = rest;
    *h = sum;
    *bad += 0.0 * rest;
}

static inline void add_one(double *high, double *low, double d, double *bad) {
    dm_sum_add(high, low, d);
    *bad += 0.0 * *low;
}

#define FOUR(x) (*(const v4 *)(const void *)(x))

/* many rows, four at a time */
static double finish_many(const dm_sweep_end *a, uint32_t n) {
    double *high = a->state, *low = a->state + 2 * (size_t)n, bad = 0.0;
    const double *u = a->u[0], *f = a->u[1];
    const double b = a->b[0]->top[0], b_rest = a->b[0]->rest[0];
    const double c = a->b[1]->top[0], c_rest = a->b[1]->rest[0];
    v4 spoilt = {0};
    uint32_t k = 0;
    for (; k + 4 <= n; k += 4) {
        const v4 x = FOUR(u + k), y = FOUR(f + k);
        const v4 dq = (b * x + b_rest * x) * FOUR(a->factor + k) + FOUR(a->drift + k);
        const v4 dp = c * y + c_rest * y;
        add_four(high + k, low + k, &dq, &spoilt);
        add_four(high + n + k, low + n + k, &dp, &spoilt);
    }
    for (; k < n; k++) {
        const double dq = (b * u[k] + b_rest * u[k]) * a->factor[k] + a->drift[k];
        add_one(high + k, low + k, dq, &bad);
        add_one(high + n + k, low + n + k, c * f[k] + c_rest * f[k], &bad);
    }
    return bad + spoilt[0] + spoilt[1] + spoilt[2] + spoilt[3];
}

static double finish_1(const dm_sweep_end *a) {
    switch (a->rows) {
    case 1:
        return finish_rows(a, 1);
    case 2:
        return finish_rows(a, 2);
    case 3:
        return finish_rows(a, 3);
    case 4:
        return finish_rows(a, 4);
    default:
        return finish_many(a, a->rows);
    }
}

static void copy_state(double *to, const double *state, uint32_t rows) {
    const volatile double *from = state; /* one by one, as it was stored */
    for (uint32_t k = 0; k < rows; k++, to += 4, from += 4)
        to[0] = from[0], to[1] = from[1], to[2] = from[2], to[3] = from[3];
}

/* in fours and what is left, as rows were stored */
static void copy_blocks(double *to, const double *state, uint32_t rows) {
    for (int part = 0; part < 4; part++, to += rows, state += rows) {
        const volatile double *from = state;
        uint32_t k = 0;
        for (; k + 4 <= rows; k += 4) *(v4 *)(void *)(to + k) = FOUR(state + k);
        for (; k < rows; k++) to[k] = from[k];
    }
}

/* few rows in one loop: gauss(2), gauss(3) of Kepler's problem (docs/benchmarks/steps.md) */
static void copy_1(double *to, const double *state, uint32_t rows) {
    if (rows > 4)
        copy_blocks(to, state, rows);
    else
        copy_state(to, state, rows);
}

static const dm_sweep_row one = {1, put_1, set_1, move_1, line_1, finish_1, copy_1};

/* ---- 4 and 8, each for the processors that there are ---- */

#define TWO_ROUNDINGS(a, b, c) ((a) * (b) + (c))
#define LESSER_OF(a, b, k) ((a)[k] < (b)[k] ? (a)[k] : (b)[k])
#define LESSER_OF_2(a, b) ((v2){LESSER_OF(a, b, 0), LESSER_OF(a, b, 1)})
#define LESSER_OF_4(a, b)                                                                          \
    ((v4){LESSER_OF(a, b, 0), LESSER_OF(a, b, 1), LESSER_OF(a, b, 2), LESSER_OF(a, b, 3)})
#define TOTALS_OF_2(x, y) ((v2){(x)[0] + (x)[1], (y)[0] + (y)[1]})
#define TOTALS_OF_4(x, y)                                                                          \
    ((v2){((x)[0] + (x)[1]) + ((x)[2] + (x)[3]), ((y)[0] + (y)[1]) + ((y)[2] + (y)[3])})

#define ROW plain4
#define W 4
#define V v4
#define H v2
#define HOW
#define MADD TWO_ROUNDINGS
#define LESSER LESSER_OF_2
#define TOTALS TOTALS_OF_2
#include "integ/stage/sweep/sweep_row.h"

#define ROW plain8
#define W 8
#define V v8
#define H v4
#define HOW
#define MADD TWO_ROUNDINGS
#define LESSER LESSER_OF_4
#define TOTALS TOTALS_OF_4
#include "integ/stage/sweep/sweep_row.h"

#ifdef __x86_64__

__attribute__((target("avx"), always_inline)) static inline v2 halves(__m256d x) {
    return (v2)_mm_add_pd(_mm256_castpd256_pd128(x), _mm256_extractf128_pd(x, 1));
}

#define LESSER2(a, b) ((v2)_mm_min_pd((__m128d)(a), (__m128d)(b)))
#define LESSER4(a, b) ((v4)_mm256_min_pd((__m256d)(a), (__m256d)(b)))
#define FUSED4(a, b, c) ((v4)_mm256_fmadd_pd((__m256d)(a), (__m256d)(b), (__m256d)(c)))
/* halves of a and b added up, side by side; sums of neighbours of both */
#define SIDES(a, b)                                                                                \
    _mm256_add_pd(_mm256_permute2f128_pd((__m256d)(a), (__m256d)(b), 0x20),                        \
                  _mm256_permute2f128_pd((__m256d)(a), (__m256d)(b), 0x31))
#define ADDED_FOUR(x, y) ((v4)_mm256_hadd_pd(x, y))
#define ADDED2(x, y) ((v2)_mm_hadd_pd((__m128d)(x), (__m128d)(y)))
#define ADDED4(x, y) halves(_mm256_hadd_pd((__m256d)(x), (__m256d)(y)))
#define FUSED8(a, b, c) ((v8)_mm512_fmadd_pd((__m512d)(a), (__m512d)(b), (__m512d)(c)))

#define ROW avx4
#define W 4
#define V v4
#define H v2
#define HOW __attribute__((target("avx")))
#define MADD TWO_ROUNDINGS
#define LESSER LESSER2
#define TOTALS ADDED2
#include "integ/stage/sweep/sweep_row.h"

#define ROW avx8
#define W 8
#define V v8
#define H v4
#define HOW __attribute__((target("avx")))
#define MADD TWO_ROUNDINGS
#define LESSER LESSER4
#define TOTALS ADDED4
#include "integ/stage/sweep/sweep_row.h"

#define FOUR_TOTALS(a, b, c, d) ADDED_FOUR(SIDES(a, c), SIDES(b, d))
#define COPY copy_1
#define ROW fused4
#define W 4
#define V v4
#define H v2
#define HOW __attribute__((target("avx,fma")))
#define MADD FUSED4
#define LESSER LESSER2
#define TOTALS ADDED2
#include "integ/stage/sweep/sweep_row.h"

#include "integ/stage/sweep/sweep_wide.h"
#define FINISH finish_in_eights
#define COPY copy_in_eights
#define ROW wide8
#define W 8
#define V v8
#define H v4
#define HOW __attribute__((target("avx512f,fma")))
#define MADD FUSED8
#define LESSER LESSER4
#define TOTALS ADDED4
#include "integ/stage/sweep/sweep_row.h"

const dm_sweep_row *dm_sweep_find(uint32_t stages) {
    if (stages == 1) return &one;
    __builtin_cpu_init();
    const dm_processor_level level = dm_processor();
    const int avx = __builtin_cpu_supports("avx");
    if (stages <= 4) return level >= DM_FMA ? &fused4 : avx ? &avx4 : &plain4;
    return level == DM_AVX512 ? &wide8 : avx ? &avx8 : &plain8;
}
#else
const dm_sweep_row *dm_sweep_find(uint32_t stages) {
    if (stages == 1) return &one;
    return stages <= 4 ? &plain4 : &plain8;
}
#endif

/* ---- units ---- */

/* Two at a time; what is as good as zero has no size of its own. */
void dm_sweep_find_units(dm_sweep *a, double *unit, double size) {
    const double zero = DM_SWEEP_ZERO * size, mean = size / a->rows;
    uint32_t k = 0;
    for (; k + 2 <= a->rows; k += 2) {
        v2 *two = (v2 *)(void *)(unit + k);
        const v2 times = mean / *two;
        *two = (v2){(*two)[0] > zero ? times[0] : 1.0, (*two)[1] > zero ? times[1] : 1.0};
    }
    if (k < a->rows) unit[k] = unit[k] > zero ? mean / unit[k] : 1.0;
    a->unit = unit;
}
