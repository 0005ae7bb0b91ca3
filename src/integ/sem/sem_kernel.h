/* sem_kernel.h - two iterations for the velocity v and the length h of a symplectic-energy-momentum
 * step with one point, written out: with m = q0 + h v/2, all at (m, v),
 *   R = L_v - h/2 L_q - p0 = 0,  L_v . v - L - E = 0
 * by two of Newton's iterations from a guess, the second with the matrix of the first where that is
 * enough, and the equations at the end. Where L = T(v) - V(q) with
 * constant mass, R = v - w and E_d = w . M w/2 + V with w = M^-1 (p0 + h/2 L_q): an error of v then
 * enters the energy with h^2, and h needs no third iteration.
 * Speed: energy_scales, Kepler by sem(1): 16x, against the tables of any degree; with one
 * matrix, chain of 12: 1.2x. */
#ifndef DM_SEM_KERNEL_H
#define DM_SEM_KERNEL_H

#include "mech/model.h"

enum { DM_SEM_FEW = 6, DM_SEM_MOST = 16 }; /* coordinates: always, and where it is short */

/* It takes q0[n], its low-order part [n], p0[n], v[n] of the guess, and behind them h and E. */
static inline uint32_t dm_sem_inputs(uint32_t n) {
    return 4 * n + 2;
}

/* It gives v[n], h and L_q[n]; of the point before the last correction, which is of first order,
 * R[n], L_v . v and E_d; and dh/dE. */
static inline uint32_t dm_sem_outputs(uint32_t n) {
    return 3 * n + 4;
}

/* The kernel, from the model where it was made before; 0: there is none. *by_velocity: R is a
 * velocity, not a momentum. */
int dm_sem_kernel(dm_kernel *out, const dm_model *m, int *by_velocity);

#endif
