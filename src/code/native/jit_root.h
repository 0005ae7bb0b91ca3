/* jit_root.h - machine code of reciprocal roots, the same operations as
 * numbers/reciprocal_root.c. */
#ifndef DM_JIT_ROOT_H
#define DM_JIT_ROOT_H

#include "code/native/jit_emit.h"

/* DM_OP_RSQRT and DM_OP_RSQRT3 */
void dm_emit_reciprocal_root(dm_emitter *e, const dm_step *s);

#endif
