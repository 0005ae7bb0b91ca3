/* cc.h - kernels by the C compiler of the system: on request only, since it takes some 100 ms. */
#ifndef DML_CC_H
#define DML_CC_H

#include "code/kernel.h"
#include "graph/graph.h"

/* As dm_tape_build. The C text of the roots is compiled in a private folder that is gone again
 * afterwards, by the program that CC names (default cc), started without a shell. DM_NO_NATIVE:
 * no compiler, or it failed. */
dm_status dml_cc_build(dm_kernel *out, dm_graph *g, const dm_node *roots, uint32_t m,
                       dm_arena *arena);

/* The tape where there is no compiler. */
dm_status dml_cc_or_tape(dm_kernel *out, dm_graph *g, const dm_node *roots, uint32_t m,
                         dm_arena *arena);

#endif
