/* lattice_wide.c - states in and out of a lattice by AVX-512: 8 bodies of each of the 8 parts at
 * a time. */
#include "numbers/processor.h"
#include "chain/lattice_inside.h"

#if defined(__x86_64__)

#include <immintrin.h>

enum { GROUP = DM_STRIP_GROUP };

#define TARGET __attribute__((target("avx512f")))

/* rows a, b of every pair side by side: even columns, odd columns */
#define PAIR(low, high, a, b)                                                                      \
    const __m512d low = _mm512_unpacklo_pd(a, b), high = _mm512_unpackhi_pd(a, b)
/* pairs of four rows: the first and third columns of each, the second and fourth */
#define FOUR(even, odd, a, b)                                                                      \
    const __m512d even = _mm512_shuffle_f64x2(a, b, 0x88), odd = _mm512_shuffle_f64x2(a, b, 0xDD)

static inline __attribute__((always_inline)) TARGET __m512d row(const double *x) {
    return _mm512_loadu_pd(x);
}

/* columns k, k + 4 of what eight rows hold, four of them in a, four in b */
static inline __attribute__((always_inline)) TARGET void put(double *to, size_t step, __m512d a,
                                                             __m512d b) {
    _mm512_storeu_pd(to, _mm512_shuffle_f64x2(a, b, 0x88));
    _mm512_storeu_pd(to + 4 * step, _mm512_shuffle_f64x2(a, b, 0xDD));
}

/* eight rows of eight become columns */
static inline __attribute__((always_inline)) TARGET void turn(double *to, size_t to_row,
                                                              const double *x, size_t r) {
    PAIR(a0, a1, row(x), row(x + r));
    PAIR(b0, b1, row(x + 2 * r), row(x + 3 * r));
    PAIR(c0, c1, row(x + 4 * r), row(x + 5 * r));
    PAIR(d0, d1, row(x + 6 * r), row(x + 7 * r));
    FOUR(e0, e2, a0, b0);
    FOUR(e1, e3, a1, b1);
    FOUR(f0, f2, c0, d0);
    FOUR(f1, f3, c1, d1);
    put(to, to_row, e0, f0);
    put(to + to_row, to_row, e1, f1);
    put(to + 2 * to_row, to_row, e2, f2);
    put(to + 3 * to_row, to_row, e3, f3);
}

TARGET static void load(double *to, const double *x, uint32_t depth, uint32_t count) {
    for (uint32_t j = 0; j < count; j += GROUP) turn(to + (size_t)j * GROUP, GROUP, x + j, depth);
}

TARGET static void store(double *x, const double *from, uint32_t depth, uint32_t count) {
    for (uint32_t j = 0; j < count; j += GROUP) turn(x + j, depth, from + (size_t)j * GROUP, GROUP);
}

TARGET static int is_finite(const double *x, uint32_t depth) {
    const __m512d zero = _mm512_setzero_pd();
    __m512d sum = zero;
    for (uint32_t j = 0; j < depth; j++)
        sum = _mm512_fmadd_pd(zero, row(x + (size_t)j * GROUP), sum);
    return _mm512_cmp_pd_mask(sum, zero, _CMP_EQ_OQ) == 0xFF;
}

static int is_wide(void) {
    return dm_processor() == DM_AVX512;
}

/* depths of which eight in a row are there in every part */
static uint32_t whole(const dm_lattice *l) {
    const uint32_t before = (GROUP - 1) * l->depth;
    if (!is_wide() || l->block != 1 || l->bodies < before) return 0;
    return (l->bodies - before) & ~(uint32_t)(GROUP - 1);
}

uint32_t dm_lattice_wide_load(const dm_lattice *l, double *to, const double *x) {
    const uint32_t count = whole(l);
    if (count) load(to, x, l->depth, count);
    return count;
}

uint32_t dm_lattice_wide_store(const dm_lattice *l, double *x, const double *from) {
    const uint32_t count = whole(l);
    if (count) store(x, from, l->depth, count);
    return count;
}

int dm_lattice_wide_finite(const dm_lattice *l, const double *x, int *finite) {
    if (!is_wide()) return 0;
    *finite = is_finite(x, l->depth);
    return 1;
}

#else

uint32_t dm_lattice_wide_load(const dm_lattice *l, double *to, const double *x) {
    (void)l, (void)to, (void)x;
    return 0;
}

uint32_t dm_lattice_wide_store(const dm_lattice *l, double *x, const double *from) {
    (void)l, (void)x, (void)from;
    return 0;
}

int dm_lattice_wide_finite(const dm_lattice *l, const double *x, int *finite) {
    (void)l, (void)x, (void)finite;
    return 0;
}

#endif
