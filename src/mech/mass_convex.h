/* mass_convex.h - is L convex in v, as it is written? */
#ifndef DM_MASS_CONVEX_H
#define DM_MASS_CONVEX_H

#include "graph/graph.h"

/* DM_DEFINITE: and no value of d2L/dv2 comes near to zero, whatever q, t and the parameters are,
 * and no weight of a square grows without bound, beside which others are lost in rounding. */
typedef enum { DM_NOT_CONVEX, DM_CONVEX, DM_DEFINITE } dm_convexity;

/* Is L(q, v, t), where it is of second degree in v, sum_ij c_ij w_i w_j + what is linear in v, with
 * w_i linear in v and bounds of the c_ij(q, t) that leave no value of (c_ij) negative anywhere? So
 * for sums of squares, and with products beside them: then no value of d2L/dv2 is negative. None is
 * zero where none of (c_ij) is, the c_ij have bounds, and some w_i are sums of velocities with
 * numbers, which vanish for v = 0 alone. DM_NOT_CONVEX also where L is not written so. An extremum
 * f(q, v, y) (algebra/extremum.h), as a Routhian is one, is convex where f is so in (v, y).
 * Speed: double pendulum in a chart (P4), gauss(4, 3): 1.07x. */
dm_convexity dm_mass_convexity(dm_graph *g, dm_node L, uint32_t n, dm_arena *arena);

#endif
