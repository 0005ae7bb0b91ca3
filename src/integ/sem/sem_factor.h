/* sem_factor.h - a matrix of nodes A[size*size], written out, and its inverse times a vector. */
#ifndef DM_SEM_FACTOR_H
#define DM_SEM_FACTOR_H

#include "graph/graph.h"

/* A = l D u by blocks of two without pivots: inverses of the blocks, l below and u above them, as
 * A leaves them; 0: it is singular everywhere. */
int dm_sem_factor(dm_graph *g, dm_node *A, uint32_t size);

/* y = A^-1 y of the factors */
void dm_sem_solve_factored(dm_graph *g, const dm_node *A, uint32_t size, dm_node *y);

#endif
