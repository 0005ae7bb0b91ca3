/* sweep_wide.h - the end of a step of five to eight stages with AVX-512: eight sums over lanes
 * at a time by adding the halves of pairs of vectors, then compensation of eight entries of the
 * state at once. Entries are stored in parts of eight, four and two. */
#define WIDE __attribute__((target("avx512f,fma")))

#define INLINE static inline __attribute__((always_inline))

/* halves of a and b added up, side by side */
WIDE INLINE __m512d halves_of(__m512d a, __m512d b) {
    return _mm512_add_pd(_mm512_shuffle_f64x2(a, b, 0x44), _mm512_shuffle_f64x2(a, b, 0xEE));
}

WIDE INLINE __m512d quarters_of(__m512d a, __m512d b) {
    return _mm512_add_pd(_mm512_unpacklo_pd(a, b), _mm512_unpackhi_pd(a, b));
}

/* sums over stages on their way: b_m in two parts for q and p; lanes without a weight are no
 * stages, and may be at a pole */
typedef struct {
    const double *u[2];
    __m512d top[2], rest[2];
    __mmask8 used[2];
    uint32_t rows;
} increments;

/* b_m u_m of row k of q or p */
WIDE INLINE __m512d product_of(const increments *x, int part, uint32_t k) {
    const __m512d u = _mm512_maskz_loadu_pd(x->used[part], x->u[part] + (size_t)k * 8);
    return _mm512_add_pd(_mm512_mul_pd(x->top[part], u), _mm512_mul_pd(x->rest[part], u));
}

/* of entry k, of q and p together; zeros behind the last */
WIDE INLINE __m512d product(const increments *x, uint32_t k) {
    if (k < x->rows) return product_of(x, 0, k);
    return k < 2 * x->rows ? product_of(x, 1, k - x->rows) : _mm512_setzero_pd();
}

WIDE INLINE __mmask8 used_of(const double *top) {
    return _mm512_cmp_pd_mask(_mm512_loadu_pd(top), _mm512_setzero_pd(), _CMP_NEQ_OQ);
}

/* sum_m b_m u_m of the entries k, k + 1, ... k + 7 */
WIDE INLINE __m512d sums(const increments *x, uint32_t k) {
    const __m512d a = halves_of(product(x, k), product(x, k + 2));
    const __m512d b = halves_of(product(x, k + 1), product(x, k + 3));
    const __m512d c = halves_of(product(x, k + 4), product(x, k + 6));
    const __m512d d = halves_of(product(x, k + 5), product(x, k + 7));
    const __m512d ab = quarters_of(a, b), cd = quarters_of(c, d);
    return _mm512_add_pd(_mm512_shuffle_f64x2(ab, cd, 0x88), _mm512_shuffle_f64x2(ab, cd, 0xDD));
}

/* the first of x, an even number of them */
WIDE INLINE void put_away(double *to, __m512d x, uint32_t count) {
    if (count >= 8) {
        _mm512_storeu_pd(to, x);
        return;
    }
    const __m256d low = _mm512_castpd512_pd256(x), high = _mm512_extractf64x4_pd(x, 1);
    if (count >= 4) _mm256_storeu_pd(to, low);
    if (count % 4) _mm_storeu_pd(to + count - 2, _mm256_castpd256_pd128(count > 4 ? high : low));
}

WIDE static double finish_in_eights(const dm_sweep_end *a) {
    const dm_sweep_end at = *a;
    const uint32_t entries = 2 * at.rows;
    const increments x = {{at.u[0], at.u[1]},
                          {_mm512_loadu_pd(at.b[0]->top), _mm512_loadu_pd(at.b[1]->top)},
                          {_mm512_loadu_pd(at.b[0]->rest), _mm512_loadu_pd(at.b[1]->rest)},
                          {used_of(at.b[0]->top), used_of(at.b[1]->top)},
                          at.rows};
    double *high = at.state, *low = at.state + entries;
    __m512d bad = _mm512_setzero_pd();
    for (uint32_t k = 0; k < entries; k += 8) {
        const uint32_t left = entries - k;
        const __mmask8 there = (__mmask8)(left >= 8 ? 0xFFu : (1u << left) - 1u);
        const __m512d d = _mm512_fmadd_pd(sums(&x, k), _mm512_maskz_loadu_pd(there, at.factor + k),
                                          _mm512_maskz_loadu_pd(there, at.drift + k));
        const __m512d old = _mm512_maskz_loadu_pd(there, high + k);
        const __m512d e = _mm512_add_pd(_mm512_maskz_loadu_pd(there, low + k), d);
        const __m512d sum = _mm512_add_pd(old, e);
        const __m512d rest = _mm512_add_pd(e, _mm512_sub_pd(old, sum));
        put_away(high + k, sum, left);
        put_away(low + k, rest, left);
        bad = _mm512_fmadd_pd(rest, _mm512_setzero_pd(), bad); /* NaN where infinite */
    }
    return _mm512_reduce_add_pd(bad);
}

/* in the parts in which it was stored */
WIDE static void copy_in_eights(double *to, const double *state, uint32_t rows) {
    for (int part = 0; part < 2; part++) {
        for (uint32_t left = 2 * rows, step; left; left -= step) {
            step = left >= 8 ? 8 : left >= 4 ? 4 : 2;
            if (step == 8)
                _mm512_storeu_pd(to, _mm512_loadu_pd(state));
            else if (step == 4)
                _mm256_storeu_pd(to, _mm256_loadu_pd(state));
            else
                _mm_storeu_pd(to, _mm_loadu_pd(state));
            to += step, state += step;
        }
    }
}

#undef WIDE
#undef INLINE
