/* jit_loop.h - machine code of a loop as it stands: dm_loop_native with one group after the
 * other. */
#ifndef DM_JIT_LOOP_H
#define DM_JIT_LOOP_H

#include "code/tape/loop.h"

/* The arguments of dm_loop_native; `together` of the loop is 1. */
dm_status dm_loop_code(dm_loop *out, const dm_loop_part part[DM_LOOP_PARTS], uint32_t size,
                       uint32_t lanes, dm_arena *arena);

#endif
