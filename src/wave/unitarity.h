/* unitarity.h - what a variational rule of one step does to the norm of a wave. */
#ifndef DM_UNITARITY_H
#define DM_UNITARITY_H

#include "integ/method/stage_table.h"

/* |psi_1|/|psi_0| after one step on a mode with h E/hbar = theta, from the momentum p = -(i hbar/2)
 * psi that L = (i hbar/2)(psi* psi' - psi psi*') - E |psi|^2 asks for; NaN: the step has no
 * solution. It is 1 for as many Gauss nodes as the degree, and for nothing else. */
double dm_wave_growth(const dm_galerkin *g, double theta);

/* Is it a rule of Gauss nodes, as many as its degree? */
int dm_is_gauss(const dm_galerkin *g);

#endif
