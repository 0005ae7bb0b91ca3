/* complex_lu.h - dense LU of complex matrices with partial pivoting, real and imaginary parts in
 * arrays of their own; row-major. */
#ifndef DM_COMPLEX_LU_H
#define DM_COMPLEX_LU_H

#include "base/status.h"

#include <stdint.h>

/* re + i im, [n*n], becomes its factors as in lu.h, reciprocals of U's diagonal on it.
 * DM_SINGULAR: a pivot is zero; DM_NOT_FINITE: one is no number. */
dm_status dm_complex_lu_factor(double *re, double *im, uint32_t *pivot, uint32_t n);

/* x + i y = A^-1 (x + i y) in place, from the factors. */
void dm_complex_lu_solve(double *x, double *y, const double *re, const double *im,
                         const uint32_t *pivot, uint32_t n);

#endif
