/* constrained.h - the step equation of stage.h for models with constraints and forces
 * (mech/constraints.h): holonomic constraints, rolling and f(q, v, t). K + 1 constraint points t_k
 * of a Lobatto rule carry impulses I_k = (G^T lambda + E^T mu)(k): sum_i b_i [h (a_ij - beta_j)
 * (L_q + f)(i) + d_ij L_v(i)] + sum_{k<K} (a~_kj - beta_j) I_k = beta_j p0, g = 0 at t_1 .. t_K,
 * phi = 0 at the K Gauss points of the curve, p1 = p0 + h sum_i b_i (L_q + f)(i) + sum_{k<K} I_k +
 * I_K, with I_K for G v1 + g_t = 0 and phi(q1, v1) = 0 (Jay 1996, 2007, 2009; discrete
 * Lagrange-d'Alembert: Marsden-West 2001 sec. 3.2, Cuell-Patrick). */
#ifndef DM_CONSTRAINED_H
#define DM_CONSTRAINED_H

#include "integ/method/stage_table.h"

/* Steps rules of stages where the model has constraints. */
extern const dm_engine dm_engine_constrained;

/* Constraint points of a step, both ends too. */
uint32_t dm_constrained_nodes(const dm_galerkin *g);

#endif
