/* stage.h - one solver for every method whose step is a polynomial velocity and a quadrature.
 * s velocities V_j at nodes gamma_j, L at r points c_i with weights b_i (Galerkin variational
 * integrators, Marsden-West 2001 sec. 2.2.6, Leok 2.4):
 *   Q_i = q0 + h sum_j a_ij V_j,  Qdot_i = sum_j d_ij V_j,  q1 = q0 + h sum_j beta_j V_j,
 *   sum_i b_i [h (a_ij - beta_j) L_q(i) + d_ij L_v(i)] = beta_j p0,  p1 = p0 + h sum_i b_i L_q(i)
 * with d_ij = l_j(c_i), a_ij = int_0^c_i l_j, beta_j = int_0^1 l_j. When the nodes are the points
 * this is the symplectic partitioned Runge-Kutta method with weights b (HLW VI.6.4). */
#ifndef DM_STAGE_H
#define DM_STAGE_H

#include "integ/method/stage_table.h"

/* Reads the basis of a row. Kicks and drifts step instead where the row has them and L separates
 * (split/splitting.h), with constraints the engine of constrained/constrained.h. */
extern const dm_engine dm_engine_stage;

/* What it is made of. */
unsigned dm_stage_wants(const dm_rule *rule, const dm_model *m);
size_t dm_stage_work(size_t s, size_t r, const dm_model *m);
dm_status dm_stage_open(dm_stepper *stepper, const dm_galerkin *g);
dm_status dm_stage_start(dm_stepper *stepper, double *state, double t, double h);
dm_status dm_stage_step(dm_stepper *stepper, double *state, double t, double h);
size_t dm_stage_memory(dm_stepper *stepper, double **place);

#endif
