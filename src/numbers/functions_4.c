/* functions_4.c - elementary functions of 4 lanes: functions_text.h on 256-bit vectors (AVX2,
 * FMA).
 * Speed: P8-toda-32: 1.58x by gauss(8, 6) with DMLUA_PROCESSOR=fma, against the C library. */
#include "numbers/functions.h"

#if defined(__x86_64__)

#include <immintrin.h>
#include <math.h>

typedef double real __attribute__((vector_size(32)));
typedef uint64_t whole __attribute__((vector_size(32)));

#define TARGET __attribute__((target("avx2,fma")))
#define INLINE TARGET __attribute__((always_inline)) static inline

/* c in all lanes; then a b + c with one rounding, the smaller and the larger as instructions
 * have them, b where a is no number */
INLINE real all(double c) {
    return (real)_mm256_set1_pd(c);
}

INLINE real fused(real a, real b, real c) {
    return (real)_mm256_fmadd_pd((__m256d)a, (__m256d)b, (__m256d)c);
}

INLINE real smaller(real a, real b) {
    return (real)_mm256_min_pd((__m256d)a, (__m256d)b);
}

INLINE real larger(real a, real b) {
    return (real)_mm256_max_pd((__m256d)a, (__m256d)b);
}

/* some lane says yes */
INLINE int any(whole mask) {
    return _mm256_movemask_pd((__m256d)mask);
}

/* entry n & 15 of a table of 16, lane by lane */
INLINE real picked(const double *table, whole n) {
    return (real){table[n[0] & 15], table[n[1] & 15], table[n[2] & 15], table[n[3] & 15]};
}

INLINE real times_power(real y, real k);

#include "numbers/functions_text.h"

/* in two steps, as the power itself may be out of range; the second rounds, as one step would */
INLINE real times_power(real y, real k) {
    const real half = fused(k, all(0.5), all(SHIFT)) - SHIFT;
    return y * power_of_2(half) * power_of_2(k - half);
}

#include "numbers/functions_entry.h"

/* through memory: how vectors are passed depends on the compiler's switches */
typedef real anywhere __attribute__((aligned(8)));

#define IN_LANES(f)                                                                                \
    TARGET static void f##_in_lanes(anywhere *d, anywhere *d2, const anywhere *a,                  \
                                    const anywhere *b) {                                           \
        (void)d2, (void)b;                                                                         \
        *d = f(*a);                                                                                \
    }
IN_LANES(exponentials)
IN_LANES(logarithms)
IN_LANES(sines)
IN_LANES(cosines)
IN_LANES(tangents)
IN_LANES(hyperbolic_sines)
IN_LANES(hyperbolic_cosines)
IN_LANES(hyperbolic_tangents)

TARGET static void both_in_lanes(anywhere *s, anywhere *c, const anywhere *a, const anywhere *b) {
    real cosine;
    (void)b;
    *s = both(*a, &cosine);
    *c = cosine;
}

/* by name; NULL where there is none of our own */
dm_function *dm_own_function4(dm_function_name name) {
    static dm_function *const table[DM_FUNCTION_COUNT] = {
        [DM_FUNCTION_EXP] = (dm_function *)exponentials_in_lanes,
        [DM_FUNCTION_LOG] = (dm_function *)logarithms_in_lanes,
        [DM_FUNCTION_SIN] = (dm_function *)sines_in_lanes,
        [DM_FUNCTION_COS] = (dm_function *)cosines_in_lanes,
        [DM_FUNCTION_TAN] = (dm_function *)tangents_in_lanes,
        [DM_FUNCTION_SINH] = (dm_function *)hyperbolic_sines_in_lanes,
        [DM_FUNCTION_COSH] = (dm_function *)hyperbolic_cosines_in_lanes,
        [DM_FUNCTION_TANH] = (dm_function *)hyperbolic_tangents_in_lanes,
        [DM_FUNCTION_SINCOS] = (dm_function *)both_in_lanes,
    };
    return table[name];
}

#else

dm_function *dm_own_function4(dm_function_name name) {
    (void)name;
    return 0;
}

#endif
