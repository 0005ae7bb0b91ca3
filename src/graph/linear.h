/* linear.h - linear systems written out in a graph; an entry that is zero everywhere is node 0,
 * and left out. */
#ifndef DM_LINEAR_H
#define DM_LINEAR_H

#include "graph/graph.h"

/* sum + x y and sum - x y, with dm_multiply_add. */
dm_node dm_add_product(dm_graph *g, dm_node sum, dm_node x, dm_node y);
dm_node dm_subtract_product(dm_graph *g, dm_node sum, dm_node x, dm_node y);

/* x[m] = A^-1 x, where A[m*m] can be eliminated along its diagonal (it is near to a positive
 * definite matrix), in an order that fills in little; where a diagonal entry is zero everywhere,
 * by rows. Operations grow with what fills in: like m for a band or a tree. A is used up;
 * symmetric: only entries i <= j are read. Two unknowns by Cramer's rule, with one division.
 * Returns the product of pivots, each times its entry of units[m]; where that is node 0 a pivot is
 * left out, if there are more than two unknowns. NULL: it is not asked for. */
dm_node dm_graph_solve(dm_graph *g, dm_node *A, dm_node *x, uint32_t m, int symmetric,
                       const dm_node *units);

#endif
