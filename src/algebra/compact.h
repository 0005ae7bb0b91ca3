/* compact.h - the same functions with fewer operations. */
#ifndef DM_COMPACT_H
#define DM_COMPACT_H

#include "graph/graph.h"

/* out[m] = roots, rewritten together as sums of products of powers: like terms and like powers
 * gathered, common factors pulled out, common parts of sums and products made once, one
 * division per shared denominator. Values are kept up to rounding, as dm_apply keeps them.
 * The roots themselves come back when nothing is gained, and from very large graphs. */
void dm_compact(dm_graph *g, const dm_node *roots, uint32_t m, dm_node *out);

/* The form of f to differentiate: a sum of products where that is not much longer, as then like
 * terms of the derivatives meet. */
dm_node dm_compact_source(dm_graph *g, dm_node f);

/* The roots alone in a graph of their own, their nodes in the order of a walk from the roots.
 * NULL without memory. */
dm_graph *dm_graph_copy(dm_graph *g, const dm_node *roots, uint32_t m, dm_node *out);

/* Compacted as a graph of its own, in the arena of g, with nothing else in it and its nodes in
 * the order of a walk from the roots: what else g holds makes no difference, so that all
 * kernels of the same roots round alike. NULL without memory. */
dm_graph *dm_compact_graph(dm_graph *g, const dm_node *roots, uint32_t m, dm_node *out);

#endif
