/* saddle.h - Lagrangians whose mass M = d2L/dv2 is singular by itself and regular on the velocities
 * that the constraints leave: the saddle-point matrix (M, A^T; A, 0), A = (G; dphi/dv), is regular
 * (a massless slider, a body by its quaternion). They are stepped with
 *   L + kappa/2 sum_c w_c^2,  w = (G v + g_t, phi),  kappa = |M| / |A_c|^2,
 * which has the equations of L, its momenta and its energy wherever w = 0: the new term is
 * quadratic in what vanishes along every motion. Its mass M + kappa A^T A is regular, so that every
 * rule knows what to do with it. */
#ifndef DM_SADDLE_H
#define DM_SADDLE_H

#include "mech/constraints.h"

/* *needed = 1 where M is singular and the saddle-point matrix regular at all points of the
 * constraints that were found from a few given ones; 0 without such points. What is made for the
 * question is in `scratch`, the graphs of L and t stay as they are. Needs k + l > 0. */
dm_status dm_saddle_needed(int *needed, dm_graph *g, dm_node L, const dm_constraints *t,
                           dm_arena *scratch);

/* That Lagrangian, in the graph g of L, whose inputs are q[n], v[n], t. */
dm_status dm_saddle_lagrangian(dm_node *out, dm_graph *g, dm_node L, const dm_constraints *t,
                               dm_arena *scratch);

#endif
