/* metric.c - volumes by Gram determinants, duals by the recursion over flags of centres. */
#include "dec/metric.h"

#include <math.h>
#include <string.h>

/* Where a cell counts as flat: (k! volume)^2 against the longest edge to the power 2 k. Lengths in
 * doubles leave an error of some 1e-16 in that ratio. */
static const double FLAT = 1e-14;

void dm_metric_lengths(double *length2, const dm_complex *K, const double *points, uint32_t N) {
    for (uint32_t e = 0; e < K->count[1]; e++) {
        const double *a = points + (size_t)K->vertex[1][2 * e] * N;
        const double *b = points + (size_t)K->vertex[1][2 * e + 1] * N;
        double sum = 0.0;
        for (uint32_t i = 0; i < N; i++) sum += (b[i] - a[i]) * (b[i] - a[i]);
        length2[e] = sum;
    }
}

/* ---- one cell ---- */

/* edges of a cell of degree k, [k + 1][k + 1]: the edge of vertices i < j is found by dropping the
 * others, last ones first */
static void read_lengths(dm_cell_metric *c, const dm_complex *K, const double *length2, uint32_t k,
                         uint32_t cell) {
    c->n = k;
    for (uint32_t i = 0; i <= k; i++)
        for (uint32_t j = i + 1; j <= k; j++) {
            uint32_t at = cell;
            for (uint32_t d = k, p = k; d > 1; p--) {
                if (p == i || p == j) continue;
                at = K->face[d][(size_t)at * (d + 1) + p];
                d--;
            }
            c->length2[i][j] = c->length2[j][i] = length2[at];
        }
    for (uint32_t i = 0; i <= k; i++) c->length2[i][i] = 0.0;
}

/* vertices of a set, ascending; how many */
static uint32_t members(uint32_t *out, uint32_t set) {
    uint32_t count = 0;
    for (uint32_t i = 0; set >> i; i++)
        if (set >> i & 1) out[count++] = i;
    return count;
}

/* G_ij = e_i . e_j, e_i from the first vertex of the set to its others; Cholesky's factor takes its
 * place. Returns det G = (k! volume)^2, not positive where there is no such simplex */
static double factor_gram(double G[DM_DIMENSION][DM_DIMENSION], const dm_cell_metric *c,
                          const uint32_t *v, uint32_t k) {
    double det = 1.0;
    for (uint32_t i = 0; i < k; i++)
        for (uint32_t j = 0; j <= i; j++) {
            double sum = (c->length2[v[0]][v[i + 1]] + c->length2[v[0]][v[j + 1]] -
                          c->length2[v[i + 1]][v[j + 1]]) /
                         2.0;
            for (uint32_t m = 0; m < j; m++) sum -= G[i][m] * G[j][m];
            if (i == j) {
                det *= sum;
                if (!(sum > 0.0)) return det < 0.0 ? det : 0.0;
                G[i][i] = sqrt(sum);
            } else {
                G[i][j] = sum / G[j][j];
            }
        }
    return det;
}

/* barycentric coordinates of the circumcentre: 2 G mu = diagonal of G, lambda_0 = 1 - sum mu */
static void circumcentre(double *lambda, double G[DM_DIMENSION][DM_DIMENSION],
                         const dm_cell_metric *c, const uint32_t *v, uint32_t k) {
    double *mu = lambda + 1;
    lambda[0] = 1.0;
    for (uint32_t i = 0; i < k; i++) {
        mu[i] = c->length2[v[0]][v[i + 1]] / 2.0;
        for (uint32_t m = 0; m < i; m++) mu[i] -= G[i][m] * mu[m];
        mu[i] /= G[i][i];
    }
    for (uint32_t i = k; i-- > 0;) {
        for (uint32_t m = i + 1; m < k; m++) mu[i] -= G[m][i] * mu[m];
        mu[i] /= G[i][i];
        lambda[0] -= mu[i];
    }
}

static double factorial(uint32_t k) {
    double product = 1.0;
    for (uint32_t i = 2; i <= k; i++) product *= i;
    return product;
}

/* volume and centre of one face; 0: it is flat or cannot be */
static int measure(dm_cell_metric *c, uint32_t set, double *lambda, dm_centres centres) {
    double G[DM_DIMENSION][DM_DIMENSION] = {{0.0}}, longest = 0.0;
    uint32_t v[DM_DIMENSION + 1];
    const uint32_t k = members(v, set) - 1;
    for (uint32_t i = 0; i <= k; i++)
        for (uint32_t j = 0; j < i; j++) longest = fmax(longest, c->length2[v[i]][v[j]]);
    const double det = factor_gram(G, c, v, k);
    if (!(det > FLAT * pow(longest, k)) && k) return 0;
    c->volume[set] = sqrt(det) / factorial(k);
    if (centres == DM_CIRCUMCENTRES)
        circumcentre(lambda, G, c, v, k);
    else
        for (uint32_t i = 0; i <= k; i++) lambda[i] = 1.0 / (k + 1);
    return 1;
}

/* shares of all faces, from the cell down: a set comes after all sets that hold it */
static int share(dm_cell_metric *c, dm_centres centres) {
    const uint32_t all = (2u << c->n) - 1;
    double lambda[DM_DIMENSION + 1];
    for (uint32_t set = 1; set <= all; set++) c->share[set] = set == all ? 1.0 : 0.0;
    for (uint32_t set = 1; set <= all; set++)
        if (!measure(c, set, lambda, centres)) return 0;
    for (uint32_t G = all; G > 0; G--) {
        uint32_t v[DM_DIMENSION + 1];
        const uint32_t k = members(v, G) - 1;
        if (!measure(c, G, lambda, centres)) continue;
        if (G == all) memcpy(c->centre, lambda, (k + 1) * sizeof *lambda);
        if (k == 0) continue;
        for (uint32_t i = 0; i <= k; i++) { /* to F = G without v[i], of degree k - 1 */
            const uint32_t F = G & ~(1u << v[i]);
            const double height = k * c->volume[G] / c->volume[F];
            c->share[F] += lambda[i] * height * c->share[G] / (c->n - k + 1);
        }
    }
    return 1;
}

void dm_metric_centre(double *lambda, dm_cell_metric *c, uint32_t set, dm_centres centres) {
    double own[DM_DIMENSION + 1];
    uint32_t at = 0;
    measure(c, set, own, centres);
    for (uint32_t i = 0; i <= c->n; i++) lambda[i] = set >> i & 1 ? own[at++] : 0.0;
}

int dm_metric_simplex(dm_cell_metric *out, const dm_complex *K, const dm_metric *metric, uint32_t k,
                      uint32_t cell) {
    read_lengths(out, K, metric->length2, k, cell);
    return share(out, metric->centres);
}

void dm_metric_cell(dm_cell_metric *out, const dm_complex *K, const dm_metric *metric,
                    uint32_t top) {
    dm_metric_simplex(out, K, metric, K->n, top); /* it was measured when the mesh was made */
}

/* ---- all of them ---- */

static dm_status take(dm_metric *out, dm_arena *arena, const dm_complex *K) {
    out->length2 = dm_arena_take(arena, ((size_t)K->count[1] + 1) * sizeof(double));
    if (!out->length2) return DM_NO_MEMORY;
    for (uint32_t k = 0; k <= K->n; k++) {
        const size_t size = ((size_t)K->count[k] + 1) * sizeof(double);
        out->volume[k] = dm_arena_take(arena, size);
        out->dual[k] = dm_arena_take(arena, size);
        if (!out->volume[k] || !out->dual[k]) return DM_NO_MEMORY;
        memset(out->dual[k], 0, size);
    }
    return DM_OK;
}

/* each cell by itself: the volume of a face is the same number in every cell that has it */
static dm_status measure_degree(dm_metric *out, const dm_complex *K, uint32_t k, uint32_t *cell) {
    dm_cell_metric c;
    double lambda[DM_DIMENSION + 1];
    for (uint32_t i = 0; i < K->count[k]; i++) {
        *cell = i;
        if (k == 0) {
            out->volume[0][i] = 1.0;
            continue;
        }
        read_lengths(&c, K, out->length2, k, i);
        if (!measure(&c, (2u << k) - 1, lambda, out->centres)) return DM_SINGULAR;
        out->volume[k][i] = c.volume[(2u << k) - 1];
    }
    return DM_OK;
}

static void add_shares(dm_metric *out, const dm_complex *K, uint32_t top) {
    dm_cell_metric c;
    uint32_t v[DM_DIMENSION + 1];
    dm_metric_cell(&c, K, out, top);
    for (uint32_t set = 1; set < 2u << K->n; set++)
        out->dual[members(v, set) - 1][dm_complex_face(K, K->n, top, set)] += c.share[set];
}

dm_status dm_metric_build(dm_metric *out, dm_arena *arena, const dm_complex *K,
                          const double *length2, dm_centres centres, uint32_t *degree,
                          uint32_t *cell) {
    *out = (dm_metric){.centres = centres};
    dm_status status = take(out, arena, K);
    if (status != DM_OK) return status;
    memcpy(out->length2, length2, K->count[1] * sizeof *length2);
    for (uint32_t k = 0; k <= K->n; k++) {
        *degree = k;
        status = measure_degree(out, K, k, cell);
        if (status != DM_OK) return status;
    }
    for (uint32_t top = 0; top < K->count[K->n]; top++) add_shares(out, K, top);
    return DM_OK;
}
