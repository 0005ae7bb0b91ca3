/* lanes_text.h - vectors of W doubles, a member in each lane, and decisions made for each: for
 * files that exist once for every kind of processor. Wanted before: W (4 or 8), HOW, the target
 * of the functions, and DM_LANES_FUSED (0 or 1): products may be fused into sums. */
#ifndef DM_LANES_TEXT_H
#define DM_LANES_TEXT_H

#include <immintrin.h>
#include <stddef.h>
#include <stdint.h>

#define INLINE HOW static inline __attribute__((always_inline, unused))

typedef double V __attribute__((vector_size(8 * W)));
typedef long long I __attribute__((vector_size(8 * W))); /* -1: yes, 0: no */
typedef V in_memory __attribute__((may_alias));

INLINE V load(const double *x) {
    return *(const in_memory *)(const void *)x;
}

INLINE void store(double *x, V v) {
    *(in_memory *)(void *)x = v;
}

INLINE V same(double x) {
    return x - (V){0};
}

INLINE V pick(I yes, V a, V b) {
    return (V)((yes & (I)a) | (~yes & (I)b));
}

INLINE V magnitude(V x) {
    return (V)((I)x & (I) ~(I)same(-0.0));
}

INLINE V larger_of(V a, V b) {
    return pick((I)(a > b), a, b);
}

INLINE I is_finite(V x) {
    return (I)(x - x == (V){0});
}

#if W == 8
INLINE uint32_t bits_of(I yes) {
    return _mm512_cmplt_epi64_mask((__m512i)yes, _mm512_setzero_si512());
}
INLINE I mask_of(uint32_t bits) {
    return (I)_mm512_maskz_set1_epi64((__mmask8)bits, -1);
}
INLINE V square_root(V x) {
    return (V)_mm512_sqrt_pd((__m512d)x);
}
#else
INLINE uint32_t bits_of(I yes) {
    return (uint32_t)_mm256_movemask_pd((__m256d)yes);
}
INLINE I mask_of(uint32_t bits) {
    return (I){-(long long)(bits & 1), -(long long)(bits >> 1 & 1), -(long long)(bits >> 2 & 1),
               -(long long)(bits >> 3 & 1)};
}
INLINE V square_root(V x) {
    return (V)_mm256_sqrt_pd((__m256d)x);
}
#endif

/* a b + c, with one rounding where `fused` */
INLINE V madd(V a, V b, V c, int fused) {
#if !DM_LANES_FUSED
    (void)fused;
#elif W == 8
    if (fused) return (V)_mm512_fmadd_pd((__m512d)a, (__m512d)b, (__m512d)c);
#else
    if (fused) return (V)_mm256_fmadd_pd((__m256d)a, (__m256d)b, (__m256d)c);
#endif
    return a * b + c;
}

/* place[i] = value[i] where `yes` */
INLINE void put_where(I yes, double *place, V value) {
    store(place, pick(yes, value, load(place)));
}

#endif
