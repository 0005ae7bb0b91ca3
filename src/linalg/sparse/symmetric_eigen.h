/* symmetric_eigen.h - all eigenvalues and eigenvectors of a dense symmetric matrix: Householder's
 * tridiagonal form, then QL with implicit shifts (Martin, Reinsch, Wilkinson 1968; Dubrulle 1970).
 * Errors are about n roundings of the largest eigenvalue, also where eigenvalues coincide. */
#ifndef DM_SYMMETRIC_EIGEN_H
#define DM_SYMMETRIC_EIGEN_H

#include "base/status.h"

#include <stdint.h>

/* A[n][n] symmetric (the lower triangle is read) becomes the eigenvectors, a row each, of length 1
 * and orthogonal; value[n] ascending. work[n]. DM_NO_CONVERGENCE, DM_NOT_FINITE, DM_STOPPED. */
dm_status dm_symmetric_eigen(double *A, double *value, double *work, uint32_t n,
                             volatile const int *stop);

#endif
