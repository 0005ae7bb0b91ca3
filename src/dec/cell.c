#include "dec/cell.h"

#include <math.h>
#include <string.h>

uint32_t dm_bits(uint32_t set) {
    uint32_t count = 0;
    for (; set; set &= set - 1) count++;
    return count;
}

int dm_parity(uint32_t first, uint32_t second) {
    uint32_t swaps = 0;
    for (uint32_t j = 0; second >> j; j++)
        if (second >> j & 1) swaps += dm_bits(first >> (j + 1));
    return swaps % 2 ? -1 : 1;
}

/* ---- gradients ---- */

/* G_ij = e_i . e_j, e_i from vertex 0 to vertex i + 1 */
static void gram(double G[DM_DIMENSION][DM_DIMENSION], const dm_cell *c) {
    for (uint32_t i = 0; i < c->n; i++)
        for (uint32_t j = 0; j < c->n; j++)
            G[i][j] = (c->metric.length2[0][i + 1] + c->metric.length2[0][j + 1] -
                       c->metric.length2[i + 1][j + 1]) /
                      2.0;
}

/* Gauss-Jordan without pivots: G is positive definite, the mesh has been measured */
static void invert(double G[DM_DIMENSION][DM_DIMENSION], uint32_t n) {
    for (uint32_t k = 0; k < n; k++) {
        const double pivot = 1.0 / G[k][k];
        G[k][k] = 1.0;
        for (uint32_t j = 0; j < n; j++) G[k][j] *= pivot;
        for (uint32_t i = 0; i < n; i++) {
            if (i == k) continue;
            const double factor = G[i][k];
            G[i][k] = 0.0;
            for (uint32_t j = 0; j < n; j++) G[i][j] -= factor * G[k][j];
        }
    }
}

/* grad phi_i . grad phi_j is the inverse of G for i, j > 0; the gradients add up to 0 */
static void make_gradients(dm_cell *c) {
    double G[DM_DIMENSION][DM_DIMENSION];
    gram(G, c);
    invert(G, c->n);
    c->gradients[0][0] = 0.0;
    for (uint32_t i = 1; i <= c->n; i++) {
        double sum = 0.0;
        for (uint32_t j = 1; j <= c->n; j++) {
            c->gradients[i][j] = G[i - 1][j - 1];
            sum += G[i - 1][j - 1];
        }
        c->gradients[0][i] = c->gradients[i][0] = -sum;
        c->gradients[0][0] += sum;
    }
}

void dm_cell_read(dm_cell *out, const dm_complex *K, const dm_metric *metric, uint32_t top) {
    out->n = K->n;
    out->top = top;
    out->vertex = K->vertex[K->n] + (size_t)top * (K->n + 1);
    out->sign = K->orientation ? K->orientation[top] : 0;
    dm_metric_cell(&out->metric, K, metric, top);
    make_gradients(out);
}

double dm_cell_height(const dm_cell *c, uint32_t j) {
    return 1.0 / sqrt(c->gradients[j][j]);
}

void dm_cell_rates(double *rates, const dm_cell *c, const double *points, uint32_t N,
                   const double *X) {
    double along[DM_DIMENSION + 1] = {0.0}; /* X . e_j, e_j from vertex 0 */
    const double *p0 = points + (size_t)c->vertex[0] * N;
    for (uint32_t j = 1; j <= c->n; j++) {
        const double *p = points + (size_t)c->vertex[j] * N;
        for (uint32_t m = 0; m < N; m++) along[j] += X[m] * (p[m] - p0[m]);
    }
    dm_cell_raise(rates, c, along);
}

void dm_cell_add(double *X, const dm_cell *c, const double *points, uint32_t N, const double *rates,
                 double weight) {
    const double *p0 = points + (size_t)c->vertex[0] * N;
    for (uint32_t j = 1; j <= c->n; j++) {
        const double *p = points + (size_t)c->vertex[j] * N;
        for (uint32_t m = 0; m < N; m++) X[m] += weight * rates[j] * (p[m] - p0[m]);
    }
}

void dm_cell_raise(double *rates, const dm_cell *c, const double *slopes) {
    for (uint32_t i = 0; i <= c->n; i++) {
        rates[i] = 0.0;
        for (uint32_t j = 0; j <= c->n; j++) rates[i] += c->gradients[i][j] * slopes[j];
    }
}

/* ---- shares of top cells in duals ---- */

double dm_metric_least(const dm_complex *K, const dm_metric *metric, uint32_t k) {
    double largest = 0.0;
    for (uint32_t i = 0; i < K->count[k]; i++) largest = fmax(largest, fabs(metric->dual[k][i]));
    return 1e-12 * largest;
}

uint32_t dm_metric_zero(const dm_complex *K, const dm_metric *metric, uint32_t k) {
    const double least = dm_metric_least(K, metric, k);
    for (uint32_t i = 0; i < K->count[k]; i++)
        if (!(fabs(metric->dual[k][i]) > least)) return i;
    return UINT32_MAX;
}

void dm_weights_make(dm_weights *out, const dm_complex *K, const dm_metric *metric, uint32_t k,
                     uint32_t *tops) {
    *out = (dm_weights){k, metric->dual[k], dm_metric_least(K, metric, k), tops, 0};
    memset(tops, 0, K->count[k] * sizeof *tops);
    for (uint32_t i = 0; i < K->count[k]; i++)
        out->degenerate += !(fabs(metric->dual[k][i]) > out->least);
    for (uint32_t c = 0; out->degenerate && c < K->count[K->n]; c++)
        for (uint32_t set = 1; set < 2u << K->n; set++)
            if (dm_bits(set) == k + 1) tops[dm_complex_face(K, K->n, c, set)]++;
}

double dm_weight(const dm_weights *w, const dm_cell *c, uint32_t set, uint32_t cell) {
    if (fabs(w->dual[cell]) > w->least) return c->metric.share[set] / w->dual[cell];
    return 1.0 / w->tops[cell];
}
