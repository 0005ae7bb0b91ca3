/* derive.h - exact derivatives of a graph, as new nodes of the same graph. */
#ifndef DM_DERIVE_H
#define DM_DERIVE_H

#include "graph/graph.h"

/* out[n] = df/dx_i by one reverse sweep; x are the input numbers first .. first+n-1. */
void dm_gradient(dm_graph *g, dm_node f, uint32_t first, uint32_t n, dm_node *out);

/* out[m*n] = df_i/dx_j, forward or reverse, whichever makes the smaller graph. */
void dm_jacobian(dm_graph *g, const dm_node *f, uint32_t m, uint32_t first, uint32_t n,
                 dm_node *out);

/* gradient[n] and hessian[n*n] (symmetric, same node at (i,j) and (j,i)) of f in the inputs
 * first .. first+n-1; both orders of differentiation are tried, the smaller kept. */
void dm_hessian(dm_graph *g, dm_node f, uint32_t first, uint32_t n, dm_node *gradient,
                dm_node *hessian);

/* out[m] = roots with input i replaced by node with[i] for every i < inputs of the graph. */
void dm_substitute(dm_graph *g, const dm_node *roots, uint32_t m, const dm_node *with,
                   dm_node *out);

/* out[m] in graph `to` = roots of graph `from` with input i replaced by node with[i] of `to`. */
void dm_transplant(dm_graph *to, dm_graph *from, const dm_node *roots, uint32_t m,
                   const dm_node *with, dm_node *out);

#endif
