/* lie_joints.h - lie(s) with constraints, and of many bodies. In the chart of lie.h, K + 1
 * constraint points t_k of a Lobatto rule carry impulses I_k = G^T lambda + E^T mu, body covectors:
 *   sum_i b_i [h a_ij L_xi(i) + d_ij L_xi'(i)] + sum_{k<K} a~_kj dtau(xi_k)^T I_k
 *     = beta_j dtau_R(xi1)^T w,   w = p0 + h sum_i b_i L_e(i) + sum_{k<K} Ad*_{1/tau(xi_k)} I_k,
 *   g = 0 at t_1 .. t_K,  phi = 0 at the K Gauss points of the curve,
 *   p1 = Ad*_tau(xi1) w + I_K,  I_K for G v1 + g_t = 0 and phi(g1, v1) = 0,
 * the discrete Lagrange-d'Alembert principle with g0 varied, the chart fixed (Marsden-West 2001
 * sec. 3.2; on R^n it is constrained/constrained.h; s = 1 is RATTLE on the group). The matrix of a
 * chain of bodies is a band: dtau_R keeps what belongs to one factor of a product together. */
#ifndef DM_LIE_JOINTS_H
#define DM_LIE_JOINTS_H

#include "integ/lie/lie.h"

extern const dm_engine dm_engine_lie_joints;

/* Is a model stepped by this engine? */
int dm_lie_is_jointed(const dm_model *m);

#endif
