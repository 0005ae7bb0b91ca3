/* prefix.h - the beginning of a graph as a graph of its own, which grows in another direction. */
#ifndef DM_PREFIX_H
#define DM_PREFIX_H

#include "algebra/body_sum.h"

/* The first `size` nodes of g, under the same numbers, in a new graph of `arena`, with the sums
 * among them; they must hold no implicit functions. NULL: no memory. */
dm_graph *dm_graph_prefix(dm_arena *arena, const dm_graph *g, uint32_t size);

#endif
