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

#define OWN_FUNCTION dm_own_function4
#include "numbers/functions_in_lanes.h"

#else

dm_function *dm_own_function4(dm_function_name name) {
    (void)name;
    return 0;
}

#endif
