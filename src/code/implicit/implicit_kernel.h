/* implicit_kernel.h - kernels of graphs with implicit functions (algebra/implicit.h): the roots
 * first, then the straight line. */
#ifndef DM_IMPLICIT_KERNEL_H
#define DM_IMPLICIT_KERNEL_H

#include "algebra/implicit.h"
#include "code/kernel.h"

/* out[m] = roots of a graph with implicit functions, all parts made by `compile`, which never sees
 * one. The kernel is for one thread. Where a function has no value its outputs are NaN, and its
 * `trouble` says why, if `arena` is that of the graph. */
dm_status dm_root_kernel(dm_kernel *out, dm_graph *g, const dm_node *roots, uint32_t m,
                         dm_compile *compile, dm_arena *arena);

#endif
