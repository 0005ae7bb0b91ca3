/* lanes_text.h - numbers V of W members side by side, and decisions I made for each of them: a
 * text for files that exist once for every number of lanes and kind of processor. With W = 1 a V
 * is a plain double and an I is 0 or 1, so that the same lines make the code of one member.
 * Wanted before: W (1, 4 or 8), HOW, the target of the functions (empty for W = 1), and
 * DM_LANES_FUSED (0 or 1): products may be fused into sums. */
#ifndef DM_LANES_TEXT_H
#define DM_LANES_TEXT_H

#include <float.h>
#include <math.h>
#include <stddef.h>
#include <stdint.h>

#define INLINE HOW static inline __attribute__((always_inline, unused))

#if W == 1

typedef double V;
typedef int I;

/* WHERE(x < y): the lanes that have it so */
#define WHERE(condition) ((I)(condition))

/* W numbers from memory and back */
INLINE V load(const double *x) {
    return *x;
}

INLINE void store(double *x, V v) {
    *x = v;
}

/* one number, or whole number, in all lanes */
INLINE V same(double x) {
    return x;
}

INLINE I same_number(uint32_t x) {
    return (I)x;
}

INLINE I not_of(I yes) {
    return !yes;
}

/* a where yes, else b */
INLINE V pick(I yes, V a, V b) {
    return yes ? a : b;
}

INLINE I pick_number(I yes, I a, I b) {
    return yes ? a : b;
}

INLINE V pick_some(I yes, V a, V b) {
    (void)yes, (void)b;
    return a;
}

INLINE V magnitude(V x) {
    return fabs(x);
}

/* one bit a lane, and back */
INLINE uint32_t bits_of(I yes) {
    return (uint32_t)yes;
}

INLINE I mask_of(uint32_t bits) {
    return (I)bits;
}

#else

#include <immintrin.h>

typedef double V __attribute__((vector_size(8 * W)));
typedef long long I __attribute__((vector_size(8 * W))); /* -1: yes, 0: no; or numbers */
typedef V in_memory __attribute__((may_alias));

#define WHERE(condition) ((I)(condition))

INLINE V load(const double *x) {
    return *(const in_memory *)(const void *)x;
}

INLINE void store(double *x, V v) {
    *(in_memory *)(void *)x = v;
}

INLINE V same(double x) {
    return x - (V){0};
}

INLINE I same_number(uint32_t x) {
    return (I){0} + (long long)x;
}

INLINE I not_of(I yes) {
    return ~yes;
}

INLINE V pick(I yes, V a, V b) {
    return (V)((yes & (I)a) | (~yes & (I)b));
}

INLINE I pick_number(I yes, I a, I b) {
    return (yes & a) | (~yes & b);
}

/* pick where it is known that some lane says yes: for one lane it is a */
INLINE V pick_some(I yes, V a, V b) {
    return pick(yes, a, b);
}

INLINE V magnitude(V x) {
    return (V)((I)x & (I) ~(I)same(-0.0));
}

#if W == 8
INLINE uint32_t bits_of(I yes) {
    return _mm512_cmplt_epi64_mask((__m512i)yes, _mm512_setzero_si512());
}
INLINE I mask_of(uint32_t bits) {
    return (I)_mm512_maskz_set1_epi64((__mmask8)bits, -1);
}
#else
INLINE uint32_t bits_of(I yes) {
    return (uint32_t)_mm256_movemask_pd((__m256d)yes);
}
INLINE I mask_of(uint32_t bits) {
    return (I){-(long long)(bits & 1), -(long long)(bits >> 1 & 1), -(long long)(bits >> 2 & 1),
               -(long long)(bits >> 3 & 1)};
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

#endif

/* every lane says yes */
INLINE I all_lanes(void) {
    return mask_of((1u << W) - 1);
}

/* some lane says yes */
INLINE int some(I yes) {
    return bits_of(yes) != 0;
}

/* a NaN in a is passed over */
INLINE V larger_of(V a, V b) {
    return pick(WHERE(a > b), a, b);
}

INLINE I is_finite(V x) {
    return WHERE(magnitude(x) <= same(DBL_MAX));
}

/* place[i] = value[i] where `yes` */
INLINE void put_where(I yes, double *place, V value) {
    store(place, pick(yes, value, load(place)));
}

#endif
