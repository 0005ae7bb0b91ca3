/* sharp.c - from 1-forms to fields of vectors, and the divergence. */
#include "dec/field.h"

#include <math.h>
#include <string.h>

/* a on the edge from vertex i of a cell to its vertex j */
static double on_edge(const double *a, const dm_complex *K, const dm_cell *c, uint32_t i,
                      uint32_t j) {
    const double value = a[dm_complex_face(K, K->n, c->top, 1u << i | 1u << j)];
    return i < j ? value : -value;
}

dm_status dm_sharp_vertices(double *out, const dm_complex *K, const dm_metric *metric,
                            const double *points, uint32_t N, const double *a, int pinv,
                            dm_sharp_fault *fault) {
    dm_cell c;
    double slopes[DM_DIMENSION + 1], rates[DM_DIMENSION + 1];
    const double least = dm_metric_least(K, metric, 0);
    *fault = (dm_sharp_fault){0, dm_metric_zero(K, metric, 0)};
    if (fault->cell != UINT32_MAX && !pinv) return DM_SINGULAR;
    memset(out, 0, (size_t)K->count[0] * N * sizeof *out);
    for (uint32_t top = 0; top < K->count[K->n]; top++) {
        dm_cell_read(&c, K, metric, top);
        for (uint32_t i = 0; i <= K->n; i++) {
            const double dual = metric->dual[0][c.vertex[i]];
            if (!(fabs(dual) > least)) continue;
            for (uint32_t j = 0; j <= K->n; j++) slopes[j] = i == j ? 0.0 : on_edge(a, K, &c, i, j);
            dm_cell_raise(rates, &c, slopes);
            dm_cell_add(out + (size_t)c.vertex[i] * N, &c, points, N, rates,
                        c.metric.share[1u << i] / dual);
        }
    }
    return DM_OK;
}

/* the direction from edge i, j towards the other vertices, across it: rates of a unit vector */
static void across(double *rates, const dm_cell *c, uint32_t i, uint32_t j) {
    const uint32_t n = c->n;
    const double edge2 = c->metric.length2[i][j];
    double offset = 0.0, length2 = 0.0;
    /* from the midpoint to the mean of the others: 1 / (n - 1) each, -1/2 at i and j */
    for (uint32_t m = 0; m <= n; m++) rates[m] = m == i || m == j ? -0.5 : 1.0 / (n - 1);
    /* its part along the edge, by (p_m - p_i) . e = (|im|^2 + |e|^2 - |jm|^2) / 2 */
    for (uint32_t m = 0; m <= n; m++)
        offset += rates[m] * (c->metric.length2[i][m] + edge2 - c->metric.length2[j][m]) / 2.0;
    rates[i] += offset / edge2;
    rates[j] -= offset / edge2;
    for (uint32_t m = 0; m <= n; m++) /* |X|^2 = -sum over pairs of rates times lengths squared */
        for (uint32_t p = 0; p < m; p++) length2 -= rates[m] * rates[p] * c->metric.length2[m][p];
    for (uint32_t m = 0; m <= n; m++) rates[m] /= sqrt(length2);
}

void dm_sharp_thesis(double *out, const dm_complex *K, const dm_metric *metric,
                     const double *points, uint32_t N, const double *a) {
    dm_cell c;
    double rates[DM_DIMENSION + 1];
    memset(out, 0, (size_t)K->count[0] * N * sizeof *out);
    for (uint32_t top = 0; K->n > 1 && top < K->count[K->n]; top++) {
        dm_cell_read(&c, K, metric, top);
        const double volume = metric->volume[K->n][top];
        for (uint32_t i = 0; i <= K->n; i++)
            for (uint32_t j = 0; j <= K->n; j++) {
                if (i == j) continue;
                const double value = on_edge(a, K, &c, i, j);
                across(rates, &c, i, j);
                dm_cell_add(out + (size_t)c.vertex[i] * N, &c, points, N, rates,
                            value * c.metric.share[1u << i] / volume);
            }
    }
}

/* sum over i < j of a_ij (lambda_i grad phi_j - lambda_j grad phi_i) at the centre */
void dm_sharp_cells(double *out, const dm_complex *K, const dm_metric *metric, const double *points,
                    uint32_t N, const double *a) {
    dm_cell c;
    double slopes[DM_DIMENSION + 1], rates[DM_DIMENSION + 1];
    memset(out, 0, (size_t)K->count[K->n] * N * sizeof *out);
    for (uint32_t top = 0; top < K->count[K->n]; top++) {
        dm_cell_read(&c, K, metric, top);
        memset(slopes, 0, sizeof slopes);
        for (uint32_t i = 0; i <= K->n; i++)
            for (uint32_t j = i + 1; j <= K->n; j++) {
                const double value = on_edge(a, K, &c, i, j);
                slopes[j] += value * c.metric.centre[i];
                slopes[i] -= value * c.metric.centre[j];
            }
        dm_cell_raise(rates, &c, slopes);
        dm_cell_add(out + (size_t)top * N, &c, points, N, rates, 1.0);
    }
}

/* In rates, X . m_j = sign h_j rate_j, so facet j asks for rate_j = t_j / h_j with the weight
 * w_j h_j^2. What the sum of all is off from 0 is shared out by the inverse weights; a facet that
 * says nothing takes it all. 0: two of them. */
static int least_squares(double *rates, const double *target, const double *weight, uint32_t n) {
    uint32_t silent = 0;
    double sum = 0.0, flexible = 0.0;
    for (uint32_t j = 0; j <= n; j++) {
        rates[j] = weight[j] > 0.0 ? target[j] : 0.0;
        sum += rates[j];
        silent += !(weight[j] > 0.0);
    }
    for (uint32_t j = 0; j <= n; j++) flexible += silent ? !(weight[j] > 0.0) : 1.0 / weight[j];
    for (uint32_t j = 0; j <= n; j++)
        rates[j] -= sum * (silent ? !(weight[j] > 0.0) : 1.0 / weight[j]) / flexible;
    return silent < 2;
}

dm_status dm_sharp_dual(double *out, const dm_complex *K, const dm_metric *metric,
                        const double *points, uint32_t N, const double *b, int pinv,
                        dm_sharp_fault *fault) {
    dm_cell c;
    double target[DM_DIMENSION + 1], weight[DM_DIMENSION + 1], rates[DM_DIMENSION + 1];
    const uint32_t n = K->n, all = (2u << n) - 1;
    const double least = dm_metric_least(K, metric, n - 1);
    memset(out, 0, (size_t)K->count[n] * N * sizeof *out);
    for (uint32_t top = 0; top < K->count[n]; top++) {
        dm_cell_read(&c, K, metric, top);
        for (uint32_t j = 0; j <= n; j++) {
            const uint32_t f = K->face[n][(size_t)top * (n + 1) + j];
            const double dual = metric->dual[n - 1][f], h = dm_cell_height(&c, j);
            const double ratio = c.metric.share[all & ~(1u << j)] / dual;
            weight[j] = fabs(dual) > least ? ratio * ratio * h * h : 0.0;
            target[j] = c.sign * ((n - j) % 2 ? -1.0 : 1.0) * b[f] / dual / h;
        }
        if (least_squares(rates, target, weight, n))
            dm_cell_add(out + (size_t)top * N, &c, points, N, rates, 1.0);
        else if (!pinv)
            return *fault = (dm_sharp_fault){n, top}, DM_SINGULAR;
    }
    return DM_OK;
}

/* ---- divergence ---- */

/* flux along the edges of a cell, out of the dual cells of their vertices */
static void add_fluxes(double *out, const dm_vector_field *X, const dm_cell *c) {
    double rates[DM_DIMENSION + 1];
    const uint32_t n = c->n;
    for (uint32_t i = 0; i <= n; i++)
        for (uint32_t j = i + 1; j <= n; j++) {
            double along = 0.0; /* X . (p_j - p_i) */
            const uint32_t set = 1u << i | 1u << j;
            dm_field_rates(rates, X, c, set);
            for (uint32_t m = 0; m <= n; m++)
                along += rates[m] * (c->metric.length2[i][m] - c->metric.length2[j][m]) / 2.0;
            const double flux = c->metric.share[set] * along / sqrt(c->metric.length2[i][j]);
            out[c->vertex[i]] += flux;
            out[c->vertex[j]] -= flux;
        }
}

/* mean of a linear field over the part of a facet of n vertices that is next to one of them: by
 * barycentres, which for an edge are the circumcentres */
static double own_weight(uint32_t n) {
    double sum = 0.0;
    for (uint32_t i = 1; i <= n; i++) sum += 1.0 / i;
    return sum / n;
}

/* flux through the parts of facet j, which lies in the boundary, that belong to its vertices */
static void add_boundary(double *out, const dm_complex *K, const dm_metric *metric,
                         const dm_vector_field *X, const dm_cell *c, uint32_t j) {
    dm_cell_metric facet;
    double mean[DM_DIMENSION + 1], own[DM_DIMENSION + 1];
    const uint32_t n = c->n, set = ((2u << n) - 1) & ~(1u << j);
    const double h = dm_cell_height(c, j), a = own_weight(n);
    const double others = n > 1 ? (1.0 - a) / (n - 1) : 0.0; /* of each other vertex */
    dm_metric_simplex(&facet, K, metric, n - 1, K->face[n][(size_t)c->top * (n + 1) + j]);
    dm_field_rates(mean, X, c, set);
    for (uint32_t i = 0, at = 0; i <= n; i++) {
        if (i == j) continue;
        dm_field_rates(own, X, c, 1u << i);
        const double rate = own[j] * (a - others) + mean[j] * n * others;
        out[c->vertex[i]] -= rate * h * facet.share[1u << at++]; /* rate j points inwards */
    }
}

dm_status dm_divergence(double *out, const dm_complex *K, const dm_metric *metric,
                        const dm_vector_field *X, int boundary, dm_sharp_fault *fault) {
    dm_cell c;
    const uint32_t n = K->n;
    *fault = (dm_sharp_fault){0, dm_metric_zero(K, metric, 0)};
    if (fault->cell != UINT32_MAX) return DM_SINGULAR;
    memset(out, 0, K->count[0] * sizeof *out);
    for (uint32_t top = 0; top < K->count[n]; top++) {
        dm_cell_read(&c, K, metric, top);
        add_fluxes(out, X, &c);
        for (uint32_t j = 0; boundary && j <= n; j++) {
            const uint32_t f = K->face[n][(size_t)top * (n + 1) + j];
            if (K->coface_at[n - 1][f + 1] - K->coface_at[n - 1][f] == 1)
                add_boundary(out, K, metric, X, &c, j);
        }
    }
    for (uint32_t v = 0; v < K->count[0]; v++) out[v] /= metric->dual[0][v];
    return DM_OK;
}
