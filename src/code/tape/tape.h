/* tape.h - the portable evaluator of a graph, and the oracle of every other backend. */
#ifndef DM_TAPE_H
#define DM_TAPE_H

#include "code/kernel.h"
#include "graph/graph.h"

/* out[m] = roots as functions of the graph's inputs, built in `arena` (which may outlive
 * the graph's). The roots are compacted first (compact.h). One tape is for one thread: its
 * registers are in its pool. DM_NO_MEMORY leaves *out alone. */
dm_status dm_tape_build(dm_kernel *out, dm_graph *g, const dm_node *roots, uint32_t m,
                        dm_arena *arena);

/* The same for the nodes as they stand: bit for bit what dm_op_value gives node by node. */
dm_status dm_tape_build_exact(dm_kernel *out, dm_graph *g, const dm_node *roots, uint32_t m,
                              dm_arena *arena);

#endif
