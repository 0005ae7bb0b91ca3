/* constrained.h - the step equation of stage.h for models with constraints and forces (mech/constraints.h): holonomic
 * constraints, rolling and f(q, v, t). K + 1 constraint points t_k of a Lobatto rule carry impulses I_k
 * = (G^T lambda + E^T mu)(k): sum_i b_i [h (a_ij - beta_j) (L_q + f)(i) + d_ij L_v(i)] +
 * sum_{k<K} (a~_kj - beta_j) I_k = beta_j p0, g = 0 at t_1 .. t_K, phi = 0 at the K Gauss points
 * of the curve, p1 = p0 + h sum_i b_i (L_q + f)(i) + sum_{k<K} I_k + I_K, with I_K for G v1 +
 * g_t = 0 and phi(q1, v1) = 0 (Jay 1996, 2007, 2009; discrete Lagrange-d'Alembert: Marsden-West
 * 2001 sec. 3.2, Cuell-Patrick). */
#ifndef DM_CONSTRAINED_H
#define DM_CONSTRAINED_H

#include "integ/method/method.h"
#include "integ/method/stage_table.h"

/* What the stage rules call where the model has constraints; as the functions of stage.h. */
unsigned dm_constrained_wants(const dm_model *m);
size_t dm_constrained_work(size_t s, size_t r, const dm_model *m);
dm_status dm_constrained_open(dm_stepper *stepper, const dm_galerkin *g);
dm_status dm_constrained_start(dm_stepper *stepper, double *state, double t, double h);
dm_status dm_constrained_step(dm_stepper *stepper, double *state, double t, double h);
size_t dm_constrained_memory(dm_stepper *stepper, double **place);
void dm_constrained_impulses(const dm_stepper *stepper, double *out);

/* Tie points of a step, both ends too. */
uint32_t dm_constrained_nodes(const dm_galerkin *g);

#endif
