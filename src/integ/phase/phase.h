/* phase.h - stage methods on a Hamiltonian H(q, p, t) as it stands, with V = H_p and F = -H_q at
 * the stages (Q_i, P_i, t + c_i h):
 *   Q_i = q0 + h sum_j a_ij V_j,  P_i = p0 + h sum_j A_ij F_j,  A_ij = b_j (1 - a_ji / b_i),
 *   q1 = q0 + h sum_j b_j V_j,    p1 = p0 + h sum_j b_j F_j      (HLW VI.4.2, VI.6.2).
 * It is the step of integ/stage where H has a Lagrangian; where H_pp is singular there is none,
 * and this is symplectic all the same. */
#ifndef DM_PHASE_H
#define DM_PHASE_H

#include "integ/method/stage_table.h"

/* Reads the basis of a row, with as many velocities as points, at the same places. */
extern const dm_engine dm_engine_phase;

/* Reads the kicks and drifts of a row, for H = T(p) + V(q, t): p -= b h V_q, q += a h T_p. */
extern const dm_engine dm_engine_phase_split;

/* The engine that steps a rule with a basis, or kicks and drifts, on a DM_HAMILTONIAN model. */
const dm_engine *dm_phase_choose(const dm_rule *rule, const dm_model *m);

#endif
