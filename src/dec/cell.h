/* cell.h - one top cell with the vectors in it. A vector in a cell is kept as its rates: rate i is
 * the derivative of barycentric coordinate i along it, so X = sum of rate_i p_i and the rates add
 * up to 0. Slopes a_i stand for the gradient of sum a_i phi_i. Both go from one to the other by the
 * lengths of edges alone; points of any space only come in at the ends. */
#ifndef DM_CELL_H
#define DM_CELL_H

#include "dec/metric.h"

typedef struct {
    uint32_t n, top;
    const uint32_t *vertex; /* [n + 1], of the complex */
    int sign;               /* of the coherent orientation; 0: the mesh has none */
    dm_cell_metric metric;  /* volumes and shares of its faces */
    /* [i][j] = grad phi_i . grad phi_j of barycentric coordinates */
    double gradients[DM_DIMENSION + 1][DM_DIMENSION + 1];
} dm_cell;

void dm_cell_read(dm_cell *out, const dm_complex *K, const dm_metric *metric, uint32_t top);

/* Distance of vertex j from the facet opposite to it. */
double dm_cell_height(const dm_cell *c, uint32_t j);

/* rates[n + 1] of the part of X[N] that lies in the cell; points[][N] of all vertices. */
void dm_cell_rates(double *rates, const dm_cell *c, const double *points, uint32_t N,
                   const double *X);

/* X[N] += weight * the vector of these rates. */
void dm_cell_add(double *X, const dm_cell *c, const double *points, uint32_t N, const double *rates,
                 double weight);

/* rates[n + 1] of the gradient of sum a_i phi_i. */
void dm_cell_raise(double *rates, const dm_cell *c, const double *slopes);

/* 1 or -1: the parity of the vertices of set `first` followed by those of `second`, each in order,
 * against the order of both. */
int dm_parity(uint32_t first, uint32_t second);

/* How many vertices a set has. */
uint32_t dm_bits(uint32_t set);

/* The shares of top cells in the duals of cells of degree k, |*s in the cell| / |*s|. Where a dual
 * volume is zero (below 1e-12 of the largest) all top cells of the cell count alike. */
typedef struct {
    uint32_t k;
    const double *dual;
    double least;        /* below it a dual volume is zero */
    uint32_t *tops;      /* [count[k]]: top cells of each cell */
    uint32_t degenerate; /* how many have zero dual volume */
} dm_weights;

/* tops: memory of count[k] entries, which stays the caller's. */
void dm_weights_make(dm_weights *out, const dm_complex *K, const dm_metric *metric, uint32_t k,
                     uint32_t *tops);

/* The weight of c at cell `cell`, which is the set `set` of its vertices. */
double dm_weight(const dm_weights *w, const dm_cell *c, uint32_t set, uint32_t cell);

/* The first cell of degree k with zero dual volume, or UINT32_MAX. */
uint32_t dm_metric_zero(const dm_complex *K, const dm_metric *metric, uint32_t k);

/* Below it a dual volume of degree k counts as zero: 1e-12 of the largest. */
double dm_metric_least(const dm_complex *K, const dm_metric *metric, uint32_t k);

#endif
