/* jit_pool.h - what machine code reads besides its inputs: the library, masks, constants. */
#ifndef DM_JIT_POOL_H
#define DM_JIT_POOL_H

#include "code/native/jit_emit.h"

enum { /* masks and numbers that every kernel has, broadcast */
       DM_POOL_ONE,
       DM_POOL_ZERO,
       DM_POOL_SIGN_BIT,
       DM_POOL_ALL_BUT_SIGN,
       DM_POOL_INFINITY,
       DM_POOL_ROOT1, /* coefficients of 1/sqrt, functions.h */
       DM_POOL_ROOT2,
       DM_POOL_ROOT3,
       DM_POOL_CUBE1,
       DM_POOL_CUBE2,
       DM_POOL_CUBE3,
       DM_POOL_CUBE4,
       DM_POOL_NUMBERS_PASS, /* for dm_x86_fix: what is no number stays behind */
       DM_POOL_MASKS
};

/* In the pool, or in the register that a loop keeps it in. */
dm_operand dm_pool_mask(const dm_emitter *e, int mask);

/* What a call of the operation jumps to (dm_function_for); DM_OP_CONSTANT stands for sincos. */
dm_operand dm_pool_pointer(const dm_emitter *e, int op);

/* The pool in `arena`, and the homes of the constants in it; NULL without memory. */
void *dm_pool_make(dm_emitter *e, const dm_graph *g, dm_arena *arena);

#endif
