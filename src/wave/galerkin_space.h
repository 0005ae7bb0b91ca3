/* galerkin_space.h - Leok's space (5.8): trigonometric polynomials, whose mode N/2 is a cosine. */
#ifndef DM_GALERKIN_SPACE_H
#define DM_GALERKIN_SPACE_H

#include "wave/wave.h"

/* P[n][n], the potential energy of amplitudes: exact integrals of the interpolated V between the
 * functions of the space, P_kn = V_(k-n) for |k - n| <= N/2 without wrapping round, V_(+-N/2)
 * halved. The transforms of w are open. DM_NO_MEMORY. */
dm_status dm_galerkin_potential(double *P, const dm_wave *w, dm_arena *arena);

#endif
