#include "dec/wedge.h"

/* one term: faces as sets of vertices, the pivot, k! l! times the sign */
typedef struct {
    uint32_t a, b, pivot;
    double factor;
} term;

enum { MOST = (DM_DIMENSION + 1) * 70 }; /* (m + 1) C(m, k) at m = 8, k = 4 */

static uint32_t bits(uint32_t set) {
    uint32_t count = 0;
    for (; set; set &= set - 1) count++;
    return count;
}

/* transpositions between two sets, the first written before the second */
static uint32_t inversions(uint32_t first, uint32_t second) {
    uint32_t count = 0;
    for (uint32_t j = 0; second >> j; j++)
        if (second >> j & 1) count += bits(first >> (j + 1));
    return count;
}

static double factorial(uint32_t k) {
    double product = 1.0;
    for (uint32_t i = 2; i <= k; i++) product *= i;
    return product;
}

/* (before, pivot, behind) against ascending order, a[before, pivot] and b[pivot, behind] too */
static term make_term(uint32_t before, uint32_t p, uint32_t behind, double weight) {
    const uint32_t pivot = 1u << p;
    const uint32_t swaps = inversions(before, pivot | behind) + inversions(pivot, behind) +
                           inversions(before, pivot) + inversions(pivot, behind);
    return (term){before | pivot, pivot | behind, p, swaps % 2 ? -weight : weight};
}

static uint32_t make_terms(term *terms, dm_wedge_rule rule, uint32_t k, uint32_t l) {
    const uint32_t m = k + l, all = (2u << m) - 1;
    uint32_t count = 0;
    if (rule == DM_WEDGE_CUP) {
        const uint32_t before = (1u << k) - 1;
        terms[0] = make_term(before, k, all & ~before & ~(1u << k), 1.0);
        return 1;
    }
    const double weight =
        factorial(k) * factorial(l) / factorial(rule == DM_WEDGE_NATURAL ? m + 1 : m);
    for (uint32_t p = 0; p <= m; p++)
        for (uint32_t before = 0; before <= all; before++)
            if (bits(before) == k && !(before >> p & 1))
                terms[count++] = make_term(before, p, all & ~before & ~(1u << p), weight);
    return count;
}

void dm_wedge(double *out, const dm_complex *K, const dm_metric *metric, dm_wedge_rule rule,
              uint32_t k, const double *a, uint32_t l, const double *b) {
    const uint32_t m = k + l;
    const int weighted = rule == DM_WEDGE_METRIC;
    term terms[MOST];
    dm_cell_metric c;
    const uint32_t count = make_terms(terms, rule, k, l);
    for (uint32_t i = 0; i < K->count[m]; i++) {
        double sum = 0.0;
        if (weighted) dm_metric_simplex(&c, K, metric, m, i);
        for (uint32_t t = 0; t < count; t++) {
            const double x = a[dm_complex_face(K, m, i, terms[t].a)];
            const double y = b[dm_complex_face(K, m, i, terms[t].b)];
            const double w =
                weighted ? c.share[1u << terms[t].pivot] / c.volume[(2u << m) - 1] : 1.0;
            sum += terms[t].factor * w * (x * y);
        }
        out[i] = sum;
    }
}
