/* jit.h - native kernels: straight-line x86-64 code with the bits of the tape.
 *
 * A kernel is made in three passes: the order of its operations (jit_plan.h), machine code with
 * values in registers (jit_emit.h, one function per kind of operation in jit_x86.c), and pages
 * that can be executed (code_memory.h). All roads round as dm_op_value does, so the tape can
 * stand in wherever native code is refused, and tests compare both on random graphs. Kernels
 * for 4 and 8 members side by side do the same operations lane by lane; a lane has the bits of
 * a single call. */
#ifndef DM_JIT_H
#define DM_JIT_H

#include "code/kernel.h"
#include "graph/graph.h"

/* Lanes that one native kernel can work on here: 8, 4 or 1; 0 where there is none. */
uint32_t dm_jit_lanes(void);

/* Use at most `lanes` from now on, in the whole process (0: no native code; tests, options). */
void dm_jit_limit(uint32_t lanes);

/* out[m] = roots, compacted, as machine code in `arena`. The kernel may be called from several
 * threads. in and out must not overlap. DM_NO_NATIVE where the processor or the system refuses,
 * DM_NO_MEMORY: *out is left alone, the tape will do. */
dm_status dm_jit_build(dm_kernel *out, dm_graph *g, const dm_node *roots, uint32_t m,
                       dm_arena *arena);

/* The same for 4 or 8 members at once: in[input][lane], out[output][lane]. */
dm_status dm_jit_build_lanes(dm_kernel *out, dm_graph *g, const dm_node *roots, uint32_t m,
                             uint32_t lanes, dm_arena *arena);

/* The nodes as they stand, lanes 1, 4 or 8: bit for bit what dm_op_value gives. */
dm_status dm_jit_build_exact(dm_kernel *out, dm_graph *g, const dm_node *roots, uint32_t m,
                             uint32_t lanes, dm_arena *arena);

/* Native code, or the tape where there is none: what a model is built with. */
dm_status dm_native_build(dm_kernel *out, dm_graph *g, const dm_node *roots, uint32_t m,
                          dm_arena *arena);

/* The constant outputs of out[output][lane]. */
void dm_kernel_prepare_lanes(const dm_kernel *k, uint32_t lanes, double *out);

#endif
