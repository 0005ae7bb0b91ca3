/* sem.h - symplectic-energy-momentum steps: the length of a step is one more unknown, and the
 * discrete energy is the equation for it (Kane, Marsden & Ortiz 1999; Leok 5.5). With curves of
 * degree s and a quadrature as in stage/stage.h, w_i = sum_j a_ij V_j, Q_i = q0 + h w_i,
 *   sum_i b_i [h (a_ij - beta_j) L_q(i) + d_ij L_v(i)] = beta_j p0,  E_d = E,
 *   E_d = -dS/dh = sum_i b_i (L_v . Qdot - L)(i)
 * for the velocities V_j and h. E is the energy of the first step, whose h is the solver's, or a
 * given one. Where no h in reach has this energy the step takes the h that comes nearest, never
 * below a fifth of the first, and says so. */
#ifndef DM_SEM_H
#define DM_SEM_H

#include "integ/method/method.h"

extern const dm_engine dm_engine_sem;

/* E_d of the step of length h from `state`, the state being unchanged. `s` is open for a rule of
 * dm_engine_sem and started. */
dm_status dm_sem_energy(dm_stepper *s, const double *state, double h, double *energy);

#endif
