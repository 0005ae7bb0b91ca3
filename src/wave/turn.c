/* turn.c - (a + b i)(c + d i) = a c - b d + (b c + a d) i in registers of one, two and four complex
 * numbers: the same products and sums, nothing is fused. */
#include "wave/turn.h"

#include "numbers/functions.h"
#include "numbers/processor.h"

#include <string.h>

/* one product: what all widths do */
static inline void turn_one(double *z, const double *e) {
    const double a = z[0], b = z[1];
    z[0] = a * e[0] - b * e[1];
    z[1] = b * e[0] + a * e[1];
}

/* where there are no wider registers, and what they leave at the end */
static void turn_plain(double *z, const double *e, size_t n) {
    for (size_t i = 0; i < 2 * n; i += 2) turn_one(z + i, e + i);
}

static void turn_twice_plain(double *z, const double *e, const double *f, size_t n) {
    for (size_t i = 0; i < 2 * n; i += 2) {
        turn_one(z + i, e + i);
        turn_one(z + i, f + i);
    }
}

#if defined(__x86_64__)

#include <immintrin.h>

#define IN_4 __attribute__((target("avx")))
#define IN_8 __attribute__((target("avx512f,avx512dq")))

IN_4 __attribute__((always_inline)) static inline __m256d turned_4(__m256d z, const double *e) {
    const __m256d phase = _mm256_load_pd(e);
    const __m256d straight = _mm256_mul_pd(z, _mm256_movedup_pd(phase));
    const __m256d crossed = _mm256_mul_pd(_mm256_permute_pd(z, 5), _mm256_permute_pd(phase, 15));
    return _mm256_addsub_pd(straight, crossed);
}

IN_4 static void turn_4(double *z, const double *e, size_t n) {
    size_t i = 0;
    for (; i + 4 <= 2 * n; i += 4) _mm256_store_pd(z + i, turned_4(_mm256_load_pd(z + i), e + i));
    turn_plain(z + i, e + i, n - i / 2);
}

IN_4 static void turn_twice_4(double *z, const double *e, const double *f, size_t n) {
    size_t i = 0;
    for (; i + 4 <= 2 * n; i += 4)
        _mm256_store_pd(z + i, turned_4(turned_4(_mm256_load_pd(z + i), e + i), f + i));
    turn_twice_plain(z + i, e + i, f + i, n - i / 2);
}

/* a - x is a + (-x) */
IN_8 __attribute__((always_inline)) static inline __m512d turned_8(__m512d z, const double *e) {
    const __m512d phase = _mm512_load_pd(e);
    const __m512d signs = _mm512_setr_pd(-0.0, 0.0, -0.0, 0.0, -0.0, 0.0, -0.0, 0.0);
    const __m512d straight = _mm512_mul_pd(z, _mm512_movedup_pd(phase));
    const __m512d crossed =
        _mm512_mul_pd(_mm512_permute_pd(z, 0x55), _mm512_permute_pd(phase, 0xff));
    return _mm512_add_pd(straight, _mm512_xor_pd(crossed, signs));
}

IN_8 static void turn_8(double *z, const double *e, size_t n) {
    size_t i = 0;
    for (; i + 8 <= 2 * n; i += 8) _mm512_store_pd(z + i, turned_8(_mm512_load_pd(z + i), e + i));
    turn_plain(z + i, e + i, n - i / 2);
}

IN_8 static void turn_twice_8(double *z, const double *e, const double *f, size_t n) {
    size_t i = 0;
    for (; i + 8 <= 2 * n; i += 8)
        _mm512_store_pd(z + i, turned_8(turned_8(_mm512_load_pd(z + i), e + i), f + i));
    turn_twice_plain(z + i, e + i, f + i, n - i / 2);
}

/* by the level of the processor, once for the whole array */
void dm_turn(double *z, const double *e, size_t n) {
    switch (dm_processor()) {
    case DM_AVX512:
        turn_8(z, e, n);
        break;
    case DM_FMA:
        turn_4(z, e, n);
        break;
    default:
        turn_plain(z, e, n);
    }
}

void dm_turn_twice(double *z, const double *e, const double *f, size_t n) {
    switch (dm_processor()) {
    case DM_AVX512:
        turn_twice_8(z, e, f, n);
        break;
    case DM_FMA:
        turn_twice_4(z, e, f, n);
        break;
    default:
        turn_twice_plain(z, e, f, n);
    }
}

#else

void dm_turn(double *z, const double *e, size_t n) {
    turn_plain(z, e, n);
}

void dm_turn_twice(double *z, const double *e, const double *f, size_t n) {
    turn_twice_plain(z, e, f, n);
}

#endif

/* sines and cosines of 4 or 8 angles (numbers/functions.h); scalar ones have another shape */
typedef void in_lanes(double *sine, double *cosine, const double *angle, const double *unused);

void dm_phases(double *e, const double *angle, size_t n) {
    const dm_processor_level level = dm_processor();
    const uint32_t lanes = level == DM_AVX512 ? 8 : level == DM_FMA ? 4 : 1;
    double s[8], c[8];
    in_lanes *f = lanes > 1 ? (in_lanes *)dm_function_for(DM_FUNCTION_SINCOS, lanes) : NULL;
    for (size_t i = 0; i < n; i += lanes) {
        if (f)
            f(s, c, angle + i, NULL);
        else
            s[0] = dm_sincos(angle[i], c);
        for (size_t l = 0; l < lanes && i + l < n; l++)
            e[2 * (i + l)] = c[l], e[2 * (i + l) + 1] = s[l];
    }
}
