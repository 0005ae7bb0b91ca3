/* functions_8.c - elementary functions of 8 lanes: functions_text.h on 512-bit vectors
 * (AVX-512).
 * Speed: P8-toda-32: 4.8x by gauss(8, 6), against the C library lane by lane. */
#include "numbers/functions.h"

#if defined(__x86_64__)

#include <immintrin.h>
#include <math.h>

typedef double real __attribute__((vector_size(64)));
typedef uint64_t whole __attribute__((vector_size(64)));

#define TARGET __attribute__((target("avx512f,avx512dq,avx512vl,fma")))
#define INLINE TARGET __attribute__((always_inline)) static inline

/* c in all lanes; then a b + c with one rounding, the smaller and the larger as instructions
 * have them, b where a is no number */
INLINE real all(double c) {
    return (real)_mm512_set1_pd(c);
}

INLINE real fused(real a, real b, real c) {
    return (real)_mm512_fmadd_pd((__m512d)a, (__m512d)b, (__m512d)c);
}

INLINE real smaller(real a, real b) {
    return (real)_mm512_min_pd((__m512d)a, (__m512d)b);
}

INLINE real larger(real a, real b) {
    return (real)_mm512_max_pd((__m512d)a, (__m512d)b);
}

/* some lane says yes */
INLINE int any(whole mask) {
    return _mm512_movepi64_mask((__m512i)mask) != 0;
}

/* entries of a table of 16 in two registers, one instruction */
INLINE real picked(const double *table, whole n) {
    return (real)_mm512_permutex2var_pd(_mm512_load_pd(table), (__m512i)n,
                                        _mm512_load_pd(table + 8));
}

/* y 2^k in one instruction, which rounds as the two steps of other widths do */
INLINE real times_power(real y, real k) {
    return (real)_mm512_scalef_pd((__m512d)y, (__m512d)k);
}

#include "numbers/functions_text.h"

#include "numbers/functions_entry.h"

#define OWN_FUNCTION dm_own_function8
#include "numbers/functions_in_lanes.h"

#else

dm_function *dm_own_function8(dm_function_name name) {
    (void)name;
    return 0;
}

#endif
