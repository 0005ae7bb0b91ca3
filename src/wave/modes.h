/* modes.h - an orthonormal basis in which a part of the energy is diagonal: the Fourier basis, for
 * the kinetic energy on a ring, or eigenvectors of a real symmetric matrix. */
#ifndef DM_MODES_H
#define DM_MODES_H

#include "wave/transforms.h"

/* Complex arrays hold re and im in turn; those of transforms are aligned to 64. */
typedef struct {
    uint32_t n;
    const double *energy; /* [n], ascending where there is a Q */
    const double *Q;      /* [n][n], a mode a row; NULL: Fourier */
    const dm_transforms *transforms;
    const dm_transform *forward, *backward;
} dm_modes;

enum { DM_DENSE_MODES = 1200 }; /* unknowns, at most: n^3 operations and n^2 numbers */

/* Eigenvectors of A[n][n], which becomes them. DM_NO_MEMORY, DM_NO_CONVERGENCE, DM_NOT_FINITE,
 * DM_STOPPED. */
dm_status dm_modes_dense(dm_modes *out, double *A, uint32_t n, dm_arena *arena,
                         volatile const int *stop);

/* c[n] = coefficients of a[n], and back; other arrays. Both keep sum |.|^2. */
void dm_to_modes(double *c, const dm_modes *modes, const double *a);
void dm_from_modes(double *a, const dm_modes *modes, const double *c);

#endif
