/* lanes.h - eight doubles side by side, and the functions of them that the problems need. */
#ifndef BENCH_LANES_H
#define BENCH_LANES_H

#include <immintrin.h>
#include <math.h>

typedef double v8 __attribute__((vector_size(64)));
typedef double v8u __attribute__((vector_size(64), aligned(8)));

#define INLINE static inline __attribute__((always_inline))

/* the series of (1 - e)^(-3/2) and (1 - e)^(-1/2): e < 2^-12 leaves the term in e^5 below 2^-59 */
#define CUBE_SERIES(e, e2) (1.0 + e * 1.5 + e2 * (1.875 + e * 2.1875 + e2 * 2.4609375))
#define ROOT_SERIES(e, e2) (1.0 + e * 0.5 + e2 * (0.375 + e * 0.3125 + e2 * 0.2734375))

#ifdef __AVX512VL__

INLINE double seed(double x) {
    const __m128d y = _mm_set_sd(x);
    return _mm_cvtsd_f64(_mm_rsqrt14_sd(y, y));
}
INLINE v8 seed8(v8 x) {
    return (v8)_mm512_rsqrt14_pd((__m512d)x);
}

/* x^(-3/2), x^(-1/2): one table look-up and one correction of high order instead of root and
 * divide */
INLINE double inverse_cube(double x) {
    const double y = seed(x), e = 1.0 - x * y * y, e2 = e * e;
    return y * y * y * CUBE_SERIES(e, e2);
}
INLINE v8 inverse_cube8(v8 x) {
    const v8 y = seed8(x), e = 1.0 - x * y * y, e2 = e * e;
    return y * y * y * CUBE_SERIES(e, e2);
}
INLINE double inverse_root(double x) {
    const double y = seed(x), e = 1.0 - x * y * y, e2 = e * e;
    return y * ROOT_SERIES(e, e2);
}
INLINE v8 inverse_root8(v8 x) {
    const v8 y = seed8(x), e = 1.0 - x * y * y, e2 = e * e;
    return y * ROOT_SERIES(e, e2);
}
INLINE double sum8(v8 x) {
    return _mm512_reduce_add_pd((__m512d)x);
}

#else

INLINE v8 root8(v8 x) {
    for (int i = 0; i < 8; i++) x[i] = sqrt(x[i]);
    return x;
}
INLINE double inverse_cube(double x) {
    return 1.0 / (x * sqrt(x));
}
INLINE v8 inverse_cube8(v8 x) {
    return 1.0 / (x * root8(x));
}
INLINE double inverse_root(double x) {
    return 1.0 / sqrt(x);
}
INLINE v8 inverse_root8(v8 x) {
    return 1.0 / root8(x);
}
INLINE double sum8(v8 x) {
    return ((x[0] + x[4]) + (x[2] + x[6])) + ((x[1] + x[5]) + (x[3] + x[7]));
}

#endif

INLINE v8 load8(const double *x) {
    return *(const v8u *)(const void *)x;
}
INLINE void store8(double *x, v8 y) {
    *(v8u *)(void *)x = y;
}

/* neighbours: (x1, ..., x7, y0) and (x7, y0, ..., y6) */
INLINE v8 shift_left(v8 x, v8 y) {
    return __builtin_shufflevector(x, y, 1, 2, 3, 4, 5, 6, 7, 8);
}
INLINE v8 shift_right(v8 x, v8 y) {
    return __builtin_shufflevector(x, y, 7, 8, 9, 10, 11, 12, 13, 14);
}

/* exp(x) = 2^k exp(r), |r| <= log(2)/2; Taylor to r^13, whose next term is below 2^-58 */
INLINE v8 exp8(v8 x) {
    const double shift = 6755399441055744.0; /* 1.5 2^52: adding it rounds to a whole number */
    const v8 k = (x * 1.4426950408889634 + shift) - shift;
    const v8 r = (x - k * 6.93147180369123816490e-01) - k * 1.90821492927058770002e-10;
    const v8 r2 = r * r, r4 = r2 * r2;
    const v8 a = 1.0 + r + r2 * (0.5 + r * (1.0 / 6));
    const v8 b = (1.0 / 24 + r * (1.0 / 120)) + r2 * (1.0 / 720 + r * (1.0 / 5040));
    const v8 c = (1.0 / 40320 + r * (1.0 / 362880)) + r2 * (1.0 / 3628800 + r * (1.0 / 39916800));
    const v8 d = 1.0 / 479001600 + r * (1.0 / 6227020800.0);
    const v8 y = a + r4 * (b + r4 * (c + r4 * d));
#ifdef __AVX512F__
    return (v8)_mm512_scalef_pd((__m512d)y, (__m512d)k);
#else
    v8 z = y;
    for (int i = 0; i < 8; i++) z[i] = ldexp(y[i], (int)k[i]);
    return z;
#endif
}

/* heavy tops by rotations(2), groups of 8 lanes (turns.c); a sum, so that nothing is left out */
enum { TURNS_GROUPS = 8 };
double turns_lanes(long steps);

#endif
