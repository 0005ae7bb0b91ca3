/* step_matrix.h - the matrix of n unknowns that a step solves with: dense by rows where it is small
 * or full, else a band. */
#ifndef DM_STEP_MATRIX_H
#define DM_STEP_MATRIX_H

#include "linalg/band.h"

/* Entry (i, j) stands at row[i] + column[j]. */
typedef struct {
    dm_band band;
    int banded;
    size_t *row, *column; /* [n] */
    uint32_t *order;      /* [n] */
} dm_step_matrix;

/* Doubles of the lists of one. */
size_t dm_step_matrix_work(uint32_t unknowns);

/* Dense; and, where that pays, the band that the entries of J[n*n] fit in, scratch[2n]. */
void dm_step_matrix_open(dm_step_matrix *m, uint32_t n, double *memory);
void dm_step_matrix_narrow(dm_step_matrix *m, const double *J, uint32_t *scratch);

/* The same of a matrix of blocks: unknown i * count + k, where k and l meet as in pattern[count^2]
 * for all i and j. Unknowns of one k lie side by side. */
void dm_step_matrix_narrow_blocks(dm_step_matrix *m, const double *pattern, uint32_t count,
                                  uint32_t *scratch);

/* All entries, wherever they are kept. */
void dm_step_matrix_zero(double *J, const dm_step_matrix *m);

/* What Newton's method is told of it; NULL: it is dense. */
static inline const dm_band *dm_step_matrix_band(const dm_step_matrix *m) {
    return m->banded ? &m->band : NULL;
}

#endif
