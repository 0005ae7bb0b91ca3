#include "dec/extrusion.h"

#include <math.h>
#include <string.h>

/* the value from one top cell; rates: of the mean of X over the cell `set`, of k vertices */
static double extruded(const dm_complex *K, const dm_cell *c, uint32_t set, uint32_t k,
                       const double *a, const double *rates) {
    double sum = 0.0;
    for (uint32_t w = 0; w <= c->n; w++) {
        if (set >> w & 1) continue;
        const uint32_t face = dm_complex_face(K, K->n, c->top, set | 1u << w);
        const int place_is_odd = dm_bits(set & ((1u << w) - 1)) % 2;
        sum += (place_is_odd ? 1.0 : -1.0) * a[face] * rates[w];
    }
    return k * sum;
}

/* How far X points from the cell `set` into c: the least velocity away from a facet that holds it,
 * by the largest modulus of one; from -1 to 1, 0 along a facet. */
static double pointing(const dm_cell *c, uint32_t set, const double *rates, double direction) {
    double least = INFINITY, largest = 0.0;
    for (uint32_t w = 0; w <= c->n; w++) {
        if (set >> w & 1) continue;
        const double velocity = direction * rates[w] * dm_cell_height(c, w);
        least = fmin(least, velocity);
        largest = fmax(largest, fabs(velocity));
    }
    return largest > 0.0 ? least / largest : 0.0;
}

static const double SAME = 1e-12; /* scores within it are one: X points along a facet */

typedef struct {
    const dm_complex *K;
    const dm_metric *metric;
    const dm_vector_field *X;
    uint32_t k;
    const double *a;
    double direction;
} contraction;

/* best[cell]: the largest score among its top cells; those that X points into all score 0 */
static void find_sides(double *best, const contraction *x) {
    dm_cell c;
    double rates[DM_DIMENSION + 1];
    const uint32_t n = x->K->n;
    for (uint32_t i = 0; i < x->K->count[x->k - 1]; i++) best[i] = -INFINITY;
    for (uint32_t top = 0; top < x->K->count[n]; top++) {
        dm_cell_read(&c, x->K, x->metric, top);
        for (uint32_t set = 1; set < 2u << n; set++) {
            if (dm_bits(set) != x->k) continue;
            const uint32_t cell = dm_complex_face(x->K, n, top, set);
            dm_field_rates(rates, x->X, &c, set);
            best[cell] = fmax(best[cell], fmin(pointing(&c, set, rates, x->direction), 0.0));
        }
    }
}

/* the mean over the best ones; count[cell]: how many there are */
static void add_sides(double *out, const contraction *x, const double *best, uint32_t *count) {
    dm_cell c;
    double rates[DM_DIMENSION + 1];
    const uint32_t n = x->K->n, cells = x->K->count[x->k - 1];
    memset(count, 0, cells * sizeof *count);
    for (uint32_t top = 0; top < x->K->count[n]; top++) {
        dm_cell_read(&c, x->K, x->metric, top);
        for (uint32_t set = 1; set < 2u << n; set++) {
            if (dm_bits(set) != x->k) continue;
            const uint32_t cell = dm_complex_face(x->K, n, top, set);
            dm_field_rates(rates, x->X, &c, set);
            if (pointing(&c, set, rates, x->direction) < best[cell] - SAME) continue;
            out[cell] += extruded(x->K, &c, set, x->k, x->a, rates);
            count[cell]++;
        }
    }
    for (uint32_t i = 0; i < cells; i++)
        if (count[i]) out[i] /= count[i];
}

/* the mean over all top cells, by shares of the dual */
static void add_central(double *out, const contraction *x, const dm_weights *weights) {
    dm_cell c;
    double rates[DM_DIMENSION + 1];
    const uint32_t n = x->K->n;
    for (uint32_t top = 0; top < x->K->count[n]; top++) {
        dm_cell_read(&c, x->K, x->metric, top);
        for (uint32_t set = 1; set < 2u << n; set++) {
            if (dm_bits(set) != x->k) continue;
            const uint32_t cell = dm_complex_face(x->K, n, top, set);
            dm_field_rates(rates, x->X, &c, set);
            out[cell] +=
                dm_weight(weights, &c, set, cell) * extruded(x->K, &c, set, x->k, x->a, rates);
        }
    }
}

void dm_contract(double *out, const dm_complex *K, const dm_metric *metric,
                 const dm_vector_field *X, uint32_t k, const double *a, dm_side side,
                 uint32_t *work, double *scores, uint32_t *degenerate) {
    dm_weights weights;
    const contraction x = {K, metric, X, k, a, side == DM_SIDE_BACKWARD ? -1.0 : 1.0};
    *degenerate = 0;
    memset(out, 0, K->count[k - 1] * sizeof *out);
    if (side == DM_SIDE_CENTRAL) {
        dm_weights_make(&weights, K, metric, k - 1, work);
        *degenerate = weights.degenerate;
        add_central(out, &x, &weights);
    } else {
        find_sides(scores, &x);
        add_sides(out, &x, scores, work);
    }
}
