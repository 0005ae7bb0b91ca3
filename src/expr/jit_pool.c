#define _GNU_SOURCE /* sincos */
#include "expr/jit_pool.h"

#include "expr/functions.h"
#include "expr/nodes.h"

#include <math.h>
#include <string.h>

enum { POINTERS = 32, START = POINTERS * 8 + 64 * DM_POOL_MASKS };

typedef void function(void); /* any of the library, in the pool */

/* the library by operation */
#define CALLS(X)                                                                         \
    X(EXP, exp)                                                                          \
    X(LOG, log)                                                                          \
    X(SIN, sin)                                                                          \
    X(COS, cos)                                                                          \
    X(TAN, tan)                                                                          \
    X(ASIN, asin) X(ACOS, acos) X(ATAN, atan) X(SINH, sinh) X(COSH, cosh) X(TANH, tanh)

/* f for 4 and 8 lanes, one after the other: the bits of the scalar function */
#define LANES(name, value)                                                               \
    static void name##4(double *d, double *d2, const double *a, const double *b) {       \
        (void)d2, (void)b;                                                               \
        for (int i = 0; i < 4; i++) d[i] = value;                                        \
    }                                                                                    \
    static void name##8(double *d, double *d2, const double *a, const double *b) {       \
        (void)d2, (void)b;                                                               \
        for (int i = 0; i < 8; i++) d[i] = value;                                        \
    }
#define X(name, f) LANES(lanes_##f, f(a[i]))
CALLS(X)
#undef X
LANES(lanes_pow, pow(a[i], b[i]))
LANES(lanes_atan2, atan2(a[i], b[i]))

static void lanes_sincos4(double *s, double *c, const double *a) {
    for (int i = 0; i < 4; i++) sincos(a[i], s + i, c + i);
}

static void lanes_sincos8(double *s, double *c, const double *a) {
    for (int i = 0; i < 8; i++) sincos(a[i], s + i, c + i);
}

dm_operand dm_pool_mask(const dm_emitter *e, int mask) {
    return dm_in_memory(e->pool, POINTERS * 8 + 64 * mask);
}

dm_operand dm_pool_pointer(const dm_emitter *e, int op) {
    return dm_in_memory(e->pool, 8 * op);
}

static function *choose(dm_width w, function *one, function *four, function *eight) {
    return w == DM_SCALAR ? one : w == DM_LANES4 ? four : eight;
}

static void fill_pointers(unsigned char *bytes, dm_width w) {
#define F(f) choose(w, (function *)f, (function *)lanes_##f##4, (function *)lanes_##f##8)
#define X(name, f) [DM_OP_##name] = F(f),
    function *const pointers[POINTERS] = {[DM_OP_CONSTANT] = F(sincos),
                                          [DM_OP_POW] = F(pow),
                                          [DM_OP_ATAN2] = F(atan2),
                                          CALLS(X)};
#undef X
#undef F
    memcpy(bytes, pointers, sizeof pointers);
}

static void fill_masks(unsigned char *bytes) {
    static const double root[3] = DM_ROOT_SERIES;
    uint64_t masks[DM_POOL_MASKS] = {
        [DM_POOL_ONE] = 0x3FF0000000000000u,
        [DM_POOL_SIGN_BIT] = 0x8000000000000000u,
        [DM_POOL_ALL_BUT_SIGN] = 0x7FFFFFFFFFFFFFFFu,
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
        if (dm_is_marked(g, n) && dm_is_op(g, n, DM_OP_CONSTANT))
            size += (size_t)e->bytes;
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
