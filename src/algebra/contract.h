/* contract.h - products that are added at once. */
#ifndef DM_CONTRACT_H
#define DM_CONTRACT_H

#include "graph/graph.h"

/* out[m] = roots of g in a graph of its own, in the same arena, where a product that is used
 * once, in a sum, is a fused multiply-add (numbers/fma.h): fewer operations, less to wait for, one
 * rounding less. The graph is verbatim, as g should be. Not for sums whose rounding errors are
 * meant, unless no product is a term of them. NULL without memory. */
dm_graph *dm_contract_graph(dm_graph *g, const dm_node *roots, uint32_t m, dm_node *out);

/* The same for differences, and for products that are used by sums and differences only: each
 * takes them in by itself. */
dm_graph *dm_contract_all(dm_graph *g, const dm_node *roots, uint32_t m, dm_node *out);

#endif
