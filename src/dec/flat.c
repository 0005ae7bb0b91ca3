/* flat.c - from fields of vectors to 1-forms. */
#include "dec/field.h"

#include <math.h>
#include <string.h>

void dm_field_rates(double *rates, const dm_vector_field *X, const dm_cell *c, uint32_t set) {
    if (X->on_cells) {
        dm_cell_rates(rates, c, X->points, X->N, X->values + (size_t)c->top * X->N);
        return;
    }
    double one[DM_DIMENSION + 1];
    const double weight = 1.0 / dm_bits(set);
    memset(rates, 0, (c->n + 1) * sizeof *rates);
    for (uint32_t i = 0; i <= c->n; i++) {
        if (!(set >> i & 1)) continue;
        dm_cell_rates(one, c, X->points, X->N, X->values + (size_t)c->vertex[i] * X->N);
        for (uint32_t j = 0; j <= c->n; j++) rates[j] += weight * one[j];
    }
}

double dm_field_tangent(double *values, const dm_complex *K, const dm_metric *metric,
                        const double *points, uint32_t N) {
    dm_cell c;
    double rates[DM_DIMENSION + 1], largest = 0.0;
    for (uint32_t top = 0; top < K->count[K->n]; top++) {
        double *X = values + (size_t)top * N, before = 0.0, after = 0.0;
        for (uint32_t m = 0; m < N; m++) before += X[m] * X[m];
        dm_cell_read(&c, K, metric, top);
        dm_cell_rates(rates, &c, points, N, X);
        memset(X, 0, N * sizeof *X);
        dm_cell_add(X, &c, points, N, rates, 1.0);
        for (uint32_t m = 0; m < N; m++) after += X[m] * X[m];
        largest = fmax(largest, before - after);
    }
    return sqrt(fmax(largest, 0.0));
}

/* X . (p_b - p_a) */
static double along(const dm_vector_field *X, const double *value, uint32_t a, uint32_t b) {
    const double *p = X->points + (size_t)a * X->N, *q = X->points + (size_t)b * X->N;
    double sum = 0.0;
    for (uint32_t m = 0; m < X->N; m++) sum += value[m] * (q[m] - p[m]);
    return sum;
}

static void flat_vertices(double *out, const dm_complex *K, const dm_vector_field *X) {
    for (uint32_t e = 0; e < K->count[1]; e++) {
        const uint32_t a = K->vertex[1][2 * (size_t)e], b = K->vertex[1][2 * (size_t)e + 1];
        out[e] = (along(X, X->values + (size_t)a * X->N, a, b) +
                  along(X, X->values + (size_t)b * X->N, a, b)) /
                 2.0;
    }
}

void dm_flat_primal(double *out, const dm_complex *K, const dm_metric *metric,
                    const dm_vector_field *X, uint32_t *tops, uint32_t *degenerate) {
    dm_weights weights;
    dm_cell c;
    *degenerate = 0;
    if (!X->on_cells) {
        flat_vertices(out, K, X);
        return;
    }
    dm_weights_make(&weights, K, metric, 1, tops);
    *degenerate = weights.degenerate;
    memset(out, 0, K->count[1] * sizeof *out);
    for (uint32_t top = 0; top < K->count[K->n]; top++) {
        dm_cell_read(&c, K, metric, top);
        for (uint32_t i = 0; i <= K->n; i++)
            for (uint32_t j = i + 1; j <= K->n; j++) {
                const uint32_t set = 1u << i | 1u << j, e = dm_complex_face(K, K->n, top, set);
                out[e] += dm_weight(&weights, &c, set, e) *
                          along(X, X->values + (size_t)top * X->N, c.vertex[i], c.vertex[j]);
            }
    }
}

/* (facet, m) is positive where m points to the vertex behind it, which is moved there through the
 * n - j vertices of the facet that follow it */
void dm_flat_dual(double *out, const dm_complex *K, const dm_metric *metric,
                  const dm_vector_field *X) {
    dm_cell c;
    double rates[DM_DIMENSION + 1];
    const uint32_t n = K->n, all = (2u << n) - 1;
    memset(out, 0, K->count[n - 1] * sizeof *out);
    for (uint32_t top = 0; top < K->count[n]; top++) {
        dm_cell_read(&c, K, metric, top);
        for (uint32_t j = 0; j <= n; j++) {
            const uint32_t set = all & ~(1u << j);
            const double sign = c.sign * ((n - j) % 2 ? -1.0 : 1.0);
            dm_field_rates(rates, X, &c, set);
            out[K->face[n][(size_t)top * (n + 1) + j]] +=
                sign * c.metric.share[set] * rates[j] * dm_cell_height(&c, j);
        }
    }
}
