/* conjugate_gradient.h - conjugate gradients with the diagonal as preconditioner (Hestenes and
 * Stiefel 1952), for sparse symmetric positive semidefinite matrices: of a singular one the b must
 * be in its range, and x keeps what it has of the null space at the start. */
#ifndef DM_CONJUGATE_GRADIENT_H
#define DM_CONJUGATE_GRADIENT_H

#include "linalg/sparse/sparse.h"

typedef struct {
    double tolerance;         /* of |b - A x| / |b| */
    int32_t most;             /* iterations */
    volatile const int *stop; /* or NULL */
    int32_t iterations;       /* set: how many there were */
    double residual;          /* set: |b - A x| / |b| as the iteration knows it */
} dm_cg;

/* x[n] -> A^-1 b[n] from the x given; work[4 n]. DM_SINGULAR: A is not positive semidefinite;
 * DM_NO_CONVERGENCE, DM_STOPPED, DM_NOT_FINITE. */
dm_status dm_conjugate_gradient(double *x, const dm_sparse *A, const double *b, double *work,
                                dm_cg *how);

#endif
