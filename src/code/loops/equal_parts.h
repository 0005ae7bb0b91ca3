/* equal_parts.h - a kernel whose outputs are the same few functions of one body after the other:
 * the functions of a body are made once and run for all bodies, side by side in lanes.
 *
 * Written out body by body a kernel of a chain of 80 links is more code than a cache holds. Parts
 * are functions of their own, so what two bodies share is computed by both. Which bodies are equal
 * is read off the graph; the bits depend on that alone, not on the lanes.
 * Speed: bodies, chain of 80 links by lie(1): 1.6x, against kernels written out. */
#ifndef DM_EQUAL_PARTS_H
#define DM_EQUAL_PARTS_H

#include "code/kernel.h"

/* an input that belongs to no body */
#define DM_NO_BODY UINT32_MAX

/* roots[m] of g as such a kernel; body[inputs of g] < bodies, or DM_NO_BODY. An output belongs to
 * the first body that it depends on. out->eval is NULL where few bodies are equal, or parts would
 * be too many operations or too large: the roots are then a kernel like others. */
dm_status dm_equal_parts_build(dm_kernel *out, dm_graph *g, const dm_node *roots, uint32_t m,
                               const uint32_t *body, uint32_t bodies, dm_compile *compile,
                               dm_arena *arena);

#endif
