/* jit_root.h - machine code of the reciprocal root. */
#ifndef DM_JIT_ROOT_H
#define DM_JIT_ROOT_H

#include "expr/jit_emit.h"

void dm_emit_reciprocal_root(dm_emitter *e, const dm_step *s);

#endif
