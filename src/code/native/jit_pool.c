/* jit_pool.c - the numbers that machine code reads: pointers of functions, one for each
 * operation, then masks and coefficients of 64 bytes each, then the constants of the kernel,
 * one copy a lane. The code has the pool's address in a register and everything at a fixed
 * displacement from it.
 * Speed: P4: 24x, native code against the tape. */
#include "code/native/jit_pool.h"

#include "graph/nodes.h"
#include "numbers/functions.h"

#include <string.h>

enum { POINTERS = 40, START = POINTERS * 8 + 64 * DM_POOL_MASKS };
_Static_assert((int)DM_OP_COUNT <= (int)POINTERS, "a pointer for every operation");

dm_operand dm_pool_mask(const dm_emitter *e, int mask) {
    for (int k = 0; k < e->masks; k++)
        if (e->mask[k] == mask) return dm_in_register(e->mask_register[k]);
    return dm_in_memory(e->pool, POINTERS * 8 + 64 * mask);
}

dm_operand dm_pool_pointer(const dm_emitter *e, int op) {
    return dm_in_memory(e->pool, 8 * op);
}

/* for operations that are arithmetic the pointer is NULL and never called */
static void fill_pointers(unsigned char *bytes, dm_width w) {
    for (int op = 0; op < DM_OP_COUNT; op++) {
        dm_function *const f = dm_function_for(dm_op_function((dm_op)op), (uint32_t)w);
        memcpy(bytes + 8 * op, &f, sizeof f);
    }
}

/* each for 8 lanes, whatever the width: an instruction reads as many as it works on */
static void fill_masks(unsigned char *bytes) {
    static const double root[] = DM_ROOT_SERIES;
    uint64_t masks[DM_POOL_MASKS] = {
        [DM_POOL_ONE] = 0x3FF0000000000000u,          [DM_POOL_SIGN_BIT] = 0x8000000000000000u,
        [DM_POOL_ALL_BUT_SIGN] = 0x7FFFFFFFFFFFFFFFu, [DM_POOL_INFINITY] = 0x7FF0000000000000u,
        [DM_POOL_NUMBERS_PASS] = 0x11111100u,
    };
    memcpy(masks + DM_POOL_ROOT1, root, sizeof root);
    for (int k = 0; k < DM_POOL_MASKS; k++)
        for (int lane = 0; lane < 8; lane++)
            memcpy(bytes + 64 * k + 8 * lane, masks + k, sizeof masks[k]);
}

/* constants behind pointers and masks, one copy per lane; their homes are set */
void *dm_pool_make(dm_emitter *e, const dm_graph *g, dm_arena *arena) {
    size_t size = START;
    for (dm_node n = 0; n < e->plan->end; n++)
        if (dm_is_marked(g, n) && dm_is_op(g, n, DM_OP_CONSTANT)) size += (size_t)e->bytes;
    unsigned char *bytes = dm_arena_take(arena, size);
    if (!bytes) return NULL;
    fill_pointers(bytes, e->width);
    fill_masks(bytes + POINTERS * 8);
    int32_t offset = START;
    for (dm_node n = 0; n < e->plan->end; n++) {
        if (!dm_is_marked(g, n) || !dm_is_op(g, n, DM_OP_CONSTANT)) continue;
        e->at[n].home = dm_in_memory(e->pool, offset);
        for (int lane = 0; lane < (int)e->width; lane++, offset += 8)
            memcpy(bytes + offset, &dm_at(g, n)->as.value, sizeof(double));
    }
    return bytes;
}
