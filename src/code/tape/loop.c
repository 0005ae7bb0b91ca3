/* loop.c - loops by kernels: a part is one call, between two buffers. */
#include "code/tape/loop.h"

#include <string.h>

/* Two buffers hold carried values and coefficients by turns: a part reads one and writes the
 * other. */
dm_status dm_loop_by_kernels(dm_loop *out, const dm_loop_part part[DM_LOOP_PARTS], uint32_t size,
                             dm_compile *compile, dm_arena *arena) {
    dm_loop l = {.size = size, .lanes = 1, .together = 1};
    uint32_t most = 0;
    for (int k = 0; k < DM_LOOP_PARTS; k++) {
        if (!part[k].graph) continue;
        const dm_status status = compile(l.kernel + k, part[k].graph, part[k].roots, size, arena);
        if (status != DM_OK) return status;
        l.coefficients[k] = part[k].coefficients;
        l.operations += l.kernel[k].operations;
        if (most < l.kernel[k].inputs) most = l.kernel[k].inputs;
    }
    for (int i = 0; i < 2; i++) {
        l.buffer[i] = dm_arena_take(arena, (size + (size_t)most) * sizeof(double));
        if (!l.buffer[i]) return DM_NO_MEMORY;
        memset(l.buffer[i], 0, (size + (size_t)most) * sizeof(double));
    }
    *out = l;
    return DM_OK;
}

/* where the carried values are, and the coefficients of the next part */
typedef struct {
    double *now, *next;
    const double *coefficients;
} cursor;

/* one part; its coefficients are copied behind the carried values */
static void do_part(const dm_loop *l, dm_loop_kind kind, cursor *at) {
    const dm_kernel *k = l->kernel + kind;
    const uint32_t count = l->coefficients[kind];
    if (!k->eval) return;
    memcpy(at->now + l->size, at->coefficients, count * sizeof(double));
    dm_kernel_prepare(k, at->next);
    dm_kernel_eval(k, at->now, at->next);
    double *swap = at->now;
    at->now = at->next;
    at->next = swap;
    at->coefficients += count;
}

/* start once, then head, body as often as it is repeated, and tail of every step */
static void run_kernels(const dm_loop *l, const dm_loop_call *c) {
    cursor at = {l->buffer[0], l->buffer[1], c->coefficients};
    memcpy(at.now, c->state, l->size * sizeof(double));
    do_part(l, DM_LOOP_START, &at);
    const double *first = at.coefficients;
    for (int64_t step = 0; step < c->steps; step++) {
        at.coefficients = first + step * (c->stride / (int64_t)sizeof(double));
        do_part(l, DM_LOOP_HEAD, &at);
        for (int64_t i = 0; i < c->repeats && l->kernel[DM_LOOP_BODY].eval; i++)
            do_part(l, DM_LOOP_BODY, &at);
        do_part(l, DM_LOOP_TAIL, &at);
    }
    memcpy(c->state, at.now, l->size * sizeof(double));
}

/* Native code counts groups by as many as it takes at once. */
void dm_loop_run(const dm_loop *l, dm_loop_call *call) {
    if (!l->native) {
        run_kernels(l, call);
        return;
    }
    call->groups /= l->together;
    memcpy(call->pool, l->pool, sizeof call->pool);
    l->native(call);
}
