/* reciprocal_root.c - x^(-1/2) and x^(-3/2) of one number; code/native/jit_root.c has the same
 * instructions for lanes, and with them the same bits. The series are explained in functions.h.
 * Speed: P3: 1.60x by gauss(8, 6), where forces are x^(-3/2); against root and division. */
#include "numbers/functions.h"

#include "numbers/processor.h"

#include <math.h>

#if defined(__x86_64__)

#include <immintrin.h>

#define TARGET __attribute__((target("avx512f,avx512vl,avx512dq,fma")))

static const double series[] = DM_ROOT_SERIES;

/* the look-up y ~ x^(-1/2) and its error 1 - x y^2 */
typedef struct {
    __m128d y, e0, e; /* e0: without the error of x y */
} look_up;

TARGET static look_up look_up_root(double number) {
    const __m128d x = _mm_set_sd(number), y = _mm_rsqrt14_sd(x, x);
    const __m128d s = _mm_mul_sd(x, y), low = _mm_fmsub_sd(x, y, s);
    const __m128d e0 = _mm_fnmadd_sd(s, y, _mm_set_sd(1.0));
    return (look_up){y, e0, _mm_fnmadd_sd(low, y, e0)};
}

/* c1 + c2 e */
TARGET static __m128d pair(__m128d e, int first) {
    return _mm_fmadd_sd(_mm_set_sd(series[first + 1]), e, _mm_set_sd(series[first]));
}

/* a (1 + e p); where e0 is no number (x = 0, infinite, negative) or a is infinite the look-up is
 * right as it is */
TARGET static double corrected(__m128d a, const look_up *l, __m128d p) {
    const __mmask8 finite = _mm_cmp_sd_mask(a, _mm_set_sd(INFINITY), _CMP_LT_OQ);
    const __mmask8 valid = _mm_mask_cmp_sd_mask(finite, l->e0, l->e0, _CMP_ORD_Q);
    return _mm_cvtsd_f64(_mm_mask3_fmadd_sd(_mm_mul_sd(l->e, a), p, a, valid));
}

/* three terms of the series */
TARGET static double root_avx512(double x) {
    const look_up l = look_up_root(x);
    const __m128d p = _mm_fmadd_sd(pair(l.e0, 1), l.e0, _mm_set_sd(series[0]));
    return corrected(l.y, &l, p);
}

/* y^2 is exact where y^3 is finite, so is y^3 */
TARGET static double cube_avx512(double number) {
    const __m128d x = _mm_set_sd(number), y = _mm_rsqrt14_sd(x, x);
    const __m128d square = _mm_mul_sd(y, y), cube = _mm_mul_sd(y, square);
    const __m128d e = _mm_fnmadd_sd(square, x, _mm_set_sd(1.0));
    const look_up l = {y, e, e};
    return corrected(cube, &l, _mm_fmadd_sd(pair(e, 5), _mm_mul_sd(e, e), pair(e, 3)));
}

/* the level of this process has the instruction */
static int by_look_up(void) {
    return dm_processor() == DM_AVX512;
}

#else

static int by_look_up(void) {
    return 0;
}

static double root_avx512(double x) {
    return x;
}

static double cube_avx512(double x) {
    return x;
}

#endif

/* Without AVX-512 root and division, two roundings. */
double dm_rsqrt(double x) {
    return by_look_up() ? root_avx512(x) : 1.0 / sqrt(x);
}

double dm_rsqrt3(double x) {
    return by_look_up() ? cube_avx512(x) : 1.0 / (x * sqrt(x));
}
