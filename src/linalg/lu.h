/* lu.h - dense LU with partial pivoting for the small systems of one step; row-major. */
#ifndef DM_LU_H
#define DM_LU_H

#include "base/status.h"

#include <stdint.h>

/* A[n*n] becomes its factors (L with unit diagonal below, U on and above it, rows exchanged
 * as pivot[n] tells; the diagonal holds the reciprocals of U's).
 * DM_SINGULAR: a pivot is zero; DM_NOT_FINITE: a pivot is NaN or infinite. */
dm_status dm_lu_factor(double *A, uint32_t *pivot, uint32_t n);

/* x = A^-1 x in place, from the factors. */
void dm_lu_solve(double *x, const double *LU, const uint32_t *pivot, uint32_t n);

/* x = A^-T x in place, from the factors. */
void dm_lu_solve_transposed(double *x, const double *LU, const uint32_t *pivot, uint32_t n);

/* inverse[n*n] of A, which becomes its factors; pivot[n], column[n] are scratch.
 * DM_SINGULAR also when a pivot is zero to round-off of its column. */
dm_status dm_lu_inverse(double *inverse, double *A, uint32_t *pivot, double *column, uint32_t n);

/* A[n*n] becomes D A D, D = diag(unit[n]) of powers of two, which round nothing: a largest entry
 * of about 1 in every row and column, whatever the units of unknowns. 0: a row and its column are
 * zero, or there is a NaN. */
int dm_equilibrate(double *A, double *unit, uint32_t n);

#endif
