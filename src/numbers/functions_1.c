/* functions_1.c - elementary functions of one number, in the first of two lanes: the text of
 * functions_text.h for the narrowest vectors. What is defined before it is included are the few
 * operations that have an instruction of their own in every width. */
#include "numbers/functions.h"

#if defined(__x86_64__)

#include <immintrin.h>
#include <math.h>

typedef double real __attribute__((vector_size(16)));
typedef uint64_t whole __attribute__((vector_size(16)));

#define TARGET __attribute__((target("avx2,fma")))
#define INLINE TARGET __attribute__((always_inline)) static inline

/* c in all lanes */
INLINE real all(double c) {
    return (real)_mm_set1_pd(c);
}

/* a b + c, one rounding */
INLINE real fused(real a, real b, real c) {
    return (real)_mm_fmadd_pd((__m128d)a, (__m128d)b, (__m128d)c);
}

/* b where a is no number, as the instruction has it; larger alike */
INLINE real smaller(real a, real b) {
    return (real)_mm_min_pd((__m128d)a, (__m128d)b);
}

INLINE real larger(real a, real b) {
    return (real)_mm_max_pd((__m128d)a, (__m128d)b);
}

/* some lane says yes; the second one is not looked at */
INLINE int any(whole mask) {
    return _mm_movemask_pd((__m128d)mask) & 1;
}

/* entry n & 15 of a table of 16 */
INLINE real picked(const double *table, whole n) {
    return (real){table[n[0] & 15], 0.0};
}

INLINE real times_power(real y, real k);

#include "numbers/functions_text.h"

/* in two steps, as the power itself may be out of range; the second rounds, as one step would */
INLINE real times_power(real y, real k) {
    const real half = fused(k, all(0.5), all(SHIFT)) - SHIFT;
    return y * power_of_2(half) * power_of_2(k - half);
}

#include "numbers/functions_entry.h"

/* functions as machine code calls them: a number in, a number out */
TARGET static double exp_of(double x) {
    return exponentials((real){x, 0.0})[0];
}

TARGET static double log_of(double x) {
    return logarithms((real){x, 0.0})[0];
}

TARGET static double sin_of(double x) {
    return sines((real){x, 0.0})[0];
}

TARGET static double cos_of(double x) {
    return cosines((real){x, 0.0})[0];
}

TARGET static double tan_of(double x) {
    return tangents((real){x, 0.0})[0];
}

TARGET static double sinh_of(double x) {
    return hyperbolic_sines((real){x, 0.0})[0];
}

TARGET static double cosh_of(double x) {
    return hyperbolic_cosines((real){x, 0.0})[0];
}

TARGET static double tanh_of(double x) {
    return hyperbolic_tangents((real){x, 0.0})[0];
}

TARGET static double sincos_of(double x, double *cosine) {
    real c;
    const real s = both((real){x, 0.0}, &c);
    *cosine = c[0];
    return s[0];
}

/* by name; NULL where there is none of our own */
dm_function *dm_own_function1(dm_function_name name) {
    static dm_function *const table[DM_FUNCTION_COUNT] = {
        [DM_FUNCTION_EXP] = (dm_function *)exp_of,
        [DM_FUNCTION_LOG] = (dm_function *)log_of,
        [DM_FUNCTION_SIN] = (dm_function *)sin_of,
        [DM_FUNCTION_COS] = (dm_function *)cos_of,
        [DM_FUNCTION_TAN] = (dm_function *)tan_of,
        [DM_FUNCTION_SINH] = (dm_function *)sinh_of,
        [DM_FUNCTION_COSH] = (dm_function *)cosh_of,
        [DM_FUNCTION_TANH] = (dm_function *)tanh_of,
        [DM_FUNCTION_SINCOS] = (dm_function *)sincos_of,
    };
    return table[name];
}

#else

dm_function *dm_own_function1(dm_function_name name) {
    (void)name;
    return 0;
}

#endif
