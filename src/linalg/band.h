/* band.h - LU with partial pivoting of a matrix that is a band after a renumbering of its
 * unknowns. */
#ifndef DM_BAND_H
#define DM_BAND_H

#include "base/status.h"

#include <signal.h>
#include <stddef.h>
#include <stdint.h>

/* Entry (i, j) of A stands at row order[i], column order[j] of the band, |order[i] - order[j]|
 * <= width. */
typedef struct {
    uint32_t n, width;
    const uint32_t *order;             /* [n] a permutation */
    const volatile sig_atomic_t *stop; /* ends dm_band_factor with DM_STOPPED; may be NULL */
} dm_band;

/* Doubles of the band: by columns, with room for what pivoting fills in. */
static inline size_t dm_band_size(const dm_band *b) {
    return b->n * (3 * (size_t)b->width + 1);
}

/* The entry (i, j) of A stands at dm_band_row(b, i) + dm_band_column(b, j). */
static inline size_t dm_band_row(const dm_band *b, uint32_t i) {
    return 2 * (size_t)b->width + b->order[i];
}
static inline size_t dm_band_column(const dm_band *b, uint32_t j) {
    return b->order[j] * 3 * (size_t)b->width;
}

/* The order of Cuthill and McKee (1969) for the entries that are not zero in pattern[n*n], and
 * the width it leads to; scratch[2n]. */
uint32_t dm_band_order(uint32_t *order, const double *pattern, uint32_t n, uint32_t *scratch);

/* A becomes its factors, pivot[n] the exchanges. DM_SINGULAR: a pivot is zero; DM_NOT_FINITE. */
dm_status dm_band_factor(double *A, uint32_t *pivot, const dm_band *b);

/* x = A^-1 x in place, from the factors; scratch[n]. */
void dm_band_solve(double *x, const double *A, const uint32_t *pivot, const dm_band *b,
                   double *scratch);

#endif
