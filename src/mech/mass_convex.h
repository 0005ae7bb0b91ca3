/* mass_convex.h - is L convex in v, as it is written? */
#ifndef DM_MASS_CONVEX_H
#define DM_MASS_CONVEX_H

#include "graph/graph.h"

/* Is L(q, v, t), where it is of second degree in v, sum_ij c_ij w_i w_j + what is linear in v, with
 * w_i linear in v and bounds of the c_ij(q, t) that leave no value of (c_ij) negative anywhere? So
 * for sums of squares, and with products beside them: then no value of d2L/dv2 is negative. 0 also
 * where L is not written so. An extremum f(q, v, y) (algebra/extremum.h), as a Routhian is one, is
 * convex where f is so in (v, y). */
int dm_mass_is_convex(dm_graph *g, dm_node L, uint32_t n, dm_arena *arena);

#endif
