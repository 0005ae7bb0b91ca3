/* curvature.h - second derivatives of sums over cells by the entries that they read, as a sparse
 * symmetric matrix. Its pattern, the union of the pairs of entries that meet in a cell, and the
 * place of every second derivative in it are found once; each is computed once and written to
 * both sides of the diagonal, so the matrix is symmetric to the last bit. */
#ifndef DM_CURVATURE_H
#define DM_CURVATURE_H

#include "chain/cells.h"
#include "linalg/sparse/sparse.h"

/* second derivatives of one sum */
typedef struct {
    dm_cell_loop loop;
    uint8_t (*pair)[2]; /* [outputs] the columns */
    int32_t *place[2];  /* [cells][outputs] in the values of A, and beyond the diagonal; -1: none */
} dm_curvature_sum;

typedef struct dm_curvature {
    dm_sparse A; /* [n, n], all of the diagonal is stored; its values are those of the last call */
    dm_curvature_sum *sum; /* [sums] */
    uint32_t sums;
    int constant; /* they depend on data alone */
    double *work;
} dm_curvature;

/* The sums of `count` leaves by x_0 .. x_(n - 1); entries that are held have no row. */
dm_status dm_curvature_open(dm_curvature *c, const dm_sum *const *sums, uint32_t count, uint32_t n,
                            dm_compile *compile, dm_arena *arena);

/* The values of c->A at x: sum of factor[k] d2 S_k. */
void dm_curvature_at(const dm_curvature *c, const double *factor, const double *x);

#endif
