/* inverse.h - the inverse of a small dense matrix, where it is wanted itself; row-major. */
#ifndef DM_INVERSE_H
#define DM_INVERSE_H

#include "base/status.h"

#include <stdint.h>

/* A[n*n] becomes its inverse, by Gauss-Jordan elimination with partial pivoting; pivot[n] is
 * scratch. DM_SINGULAR: a pivot is zero; DM_NOT_FINITE: a pivot is NaN or infinite. */
dm_status dm_invert(double *A, uint32_t *pivot, uint32_t n);

#endif
