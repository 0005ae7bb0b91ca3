#include "dec/dual_wedge.h"

#include <math.h>
#include <string.h>

/* the volume that the gradients of a set of vertices span */
static double spanned(const dm_cell *c, uint32_t set) {
    double G[DM_DIMENSION][DM_DIMENSION], det = 1.0;
    uint32_t v[DM_DIMENSION + 1], size = 0;
    for (uint32_t i = 0; i <= c->n; i++)
        if (set >> i & 1) v[size++] = i;
    for (uint32_t i = 0; i < size; i++)
        for (uint32_t j = 0; j <= i; j++) { /* Cholesky */
            double sum = c->gradients[v[i]][v[j]];
            for (uint32_t m = 0; m < j; m++) sum -= G[i][m] * G[j][m];
            if (i == j) {
                G[i][i] = sqrt(fmax(sum, 0.0));
                det *= G[i][i];
            } else {
                G[i][j] = sum / G[j][j];
            }
        }
    return det;
}

/* Dual forms in one top cell: `all` its vertices. A dual form of degree k is listed by faces of
 * n - k + 1 vertices; functions (k = 0) have no sign of the cell in them. */
typedef struct {
    const dm_complex *K;
    const dm_metric *metric;
    const dm_cell *c;
    uint32_t all;
} dual_cell;

/* a on the dual of the face without these vertices */
static double on_dual(const dual_cell *d, const double *a, uint32_t without) {
    return a[dm_complex_face(d->K, d->K->n, d->c->top, d->all & ~without)];
}

/* the sign of nu_I, I ascending, against the dual of the other vertices */
static double side_of(const dual_cell *d, uint32_t I) {
    return I ? d->c->sign * dm_parity(d->all & ~I, I) : 1.0;
}

/* a(nu_I) */
static double on_gradients(const dual_cell *d, const double *a, uint32_t I) {
    const uint32_t n = d->K->n, k = n - dm_bits(I);
    const uint32_t face = dm_complex_face(d->K, n, d->c->top, d->all & ~I);
    return side_of(d, I) * spanned(d->c, I) * a[face] / d->metric->dual[k][face];
}

static double consistent(const dual_cell *d, uint32_t base, uint32_t k, const double *a,
                         const double *b) {
    const uint32_t r = d->all & ~base;
    double sum = 0.0;
    for (uint32_t I = 0; I <= d->all; I++)
        if ((I & ~r) == 0 && dm_bits(I) == k)
            sum += dm_parity(I, r & ~I) * on_gradients(d, a, I) * on_gradients(d, b, r & ~I);
    return d->c->metric.share[base] * side_of(d, r) / spanned(d->c, r) * sum;
}

/* sum over orders of r, r before the base positively oriented, of a and b on the duals of
 * [first l of r, base] and [last k of r, base] */
static double printed(const dual_cell *d, uint32_t base, uint32_t k, uint32_t l, const double *a,
                      const double *b) {
    const uint32_t r = d->all & ~base;
    double sum = 0.0, times = 1.0;
    for (uint32_t i = 2; i <= k; i++) times *= i;
    for (uint32_t i = 2; i <= l; i++) times *= i;
    for (uint32_t I = 0; I <= d->all; I++) {
        if ((I & ~r) || dm_bits(I) != k) continue;
        const uint32_t J = r & ~I;
        /* without I: vertices J + base, which carry a; without J: those that carry b */
        double value = on_dual(d, a, I) * on_dual(d, b, J);
        if (r && (I == 0 || J == 0)) value *= d->c->sign; /* a function: about ascending vertices */
        sum += dm_parity(J, I) * dm_parity(J, base) * dm_parity(I, base) * value;
    }
    const double oriented = r ? d->c->sign * dm_parity(r, base) : 1.0;
    return times * oriented * sum;
}

dm_status dm_dual_wedge(double *out, const dm_complex *K, const dm_metric *metric,
                        dm_dual_rule rule, uint32_t k, const double *a, uint32_t l, const double *b,
                        dm_sharp_fault *fault) {
    dm_cell c;
    const uint32_t n = K->n, m = k + l;
    const dual_cell d = {K, metric, &c, (2u << n) - 1};
    for (uint32_t i = 0; rule == DM_DUAL_CONSISTENT && i < 2; i++) {
        const uint32_t degree = n - (i ? l : k), cell = dm_metric_zero(K, metric, degree);
        *fault = (dm_sharp_fault){degree, cell};
        if (cell != UINT32_MAX) return DM_SINGULAR;
    }
    memset(out, 0, K->count[n - m] * sizeof *out);
    for (uint32_t top = 0; top < K->count[n]; top++) {
        dm_cell_read(&c, K, metric, top);
        for (uint32_t base = 1; base <= d.all; base++) {
            if (dm_bits(base) != n - m + 1) continue;
            out[dm_complex_face(K, n, top, base)] += rule == DM_DUAL_CONSISTENT
                                                         ? consistent(&d, base, k, a, b)
                                                         : printed(&d, base, k, l, a, b);
        }
    }
    return DM_OK;
}
