/* the reciprocal root of one number; jit_root.c has the same instructions for lanes */
#include "expr/functions.h"

#include "expr/processor.h"

#include <math.h>

#if defined(__x86_64__)

#include <immintrin.h>

static const double series[3] = DM_ROOT_SERIES;

/* where e is no number (x = 0, infinite, negative) the look-up is right as it is */
__attribute__((target("avx512f,avx512vl,avx512dq,fma"))) static double
rsqrt_avx512(double number) {
    const __m128d x = _mm_set_sd(number), y = _mm_rsqrt14_sd(x, x);
    const __m128d s = _mm_mul_sd(x, y), low = _mm_fmsub_sd(x, y, s);
    const __m128d e = _mm_fnmadd_sd(s, y, _mm_set_sd(1.0));
    __m128d p = _mm_fmadd_sd(_mm_set_sd(series[2]), e, _mm_set_sd(series[1]));
    p = _mm_fmadd_sd(p, e, _mm_set_sd(series[0]));
    const __m128d ye = _mm_mul_sd(_mm_fnmadd_sd(low, y, e), y);
    const __mmask8 number_here = _mm_cmp_sd_mask(e, e, _CMP_ORD_Q);
    return _mm_cvtsd_f64(_mm_mask3_fmadd_sd(ye, p, y, number_here));
}

double dm_rsqrt(double x) {
    return dm_processor() == DM_AVX512 ? rsqrt_avx512(x) : 1.0 / sqrt(x);
}

#else

double dm_rsqrt(double x) {
    return 1.0 / sqrt(x);
}

#endif
