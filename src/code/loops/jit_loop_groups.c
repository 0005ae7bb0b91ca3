/* jit_loop_groups.c - groups of lanes whose operations take turns: two groups side by side in
 * one part, since the latency of one stage is more than a processor looks ahead.
 * Speed: steps, leapfrog ensemble of Kepler orbits: 1.09x. */
#include "code/loops/jit_loop.h"

#include "algebra/implicit.h"
#include "graph/nodes.h"

#include <string.h>

/* which group of so many */
typedef struct {
    uint32_t k, times;
} group;

/* where an input of the part is in the repeated one */
static uint32_t place_of(const dm_loop_part *in, const dm_expr *e, uint32_t size, group g) {
    const uint32_t i = e->as.input;
    if (e->op != DM_OP_INPUT) return 0;
    if (i < size) return i + g.k * size;
    return g.times * size + (in->own ? (i - size) * g.times + g.k : i - size);
}

/* The latencies of one group are more than a processor looks ahead: so the operations of some
 * groups take turns. A node becomes one for each of them; constants and coefficients are the
 * same. */
static int repeat_part(dm_loop_part *out, const dm_loop_part *in, uint32_t size, uint32_t times,
                       dm_arena *arena) {
    const uint32_t end = dm_mark(in->graph, in->roots, size);
    dm_node *now = dm_arena_take(arena, (size_t)end * times * sizeof *now);
    dm_node *roots = dm_arena_take(arena, (size_t)size * times * sizeof *roots);
    const uint32_t coefficients = in->coefficients * (in->own ? times : 1);
    dm_graph *g = dm_graph_sized(arena, size * times + coefficients, end * times);
    if (!now || !roots || !g || dm_graph_status(in->graph) != DM_OK) return 0;
    memset(now, 0, (size_t)end * times * sizeof *now);
    for (dm_node n = 1; n < end; n++) {
        const dm_expr e = *dm_at(in->graph, n);
        for (uint32_t k = 0; k < times && dm_is_marked(in->graph, n); k++) {
            dm_node arg[3] = {0, 0, 0};
            const uint32_t input = place_of(in, &e, size, (group){k, times});
            for (int a = 0; a < dm_arity(e.op); a++) arg[a] = now[e.as.arg[a] * times + k];
            now[n * times + k] = e.op == DM_OP_INPUT ? dm_input(g, input)
                                 : e.op == DM_OP_CONSTANT
                                     ? dm_constant(g, e.as.value)
                                     : dm_node_plain(g, e.op, arg[0], arg[1], arg[2]);
        }
    }
    for (uint32_t k = 0; k < times; k++)
        for (uint32_t i = 0; i < size; i++) roots[k * size + i] = now[in->roots[i] * times + k];
    *out = (dm_loop_part){g, roots, coefficients, in->own};
    return dm_graph_status(g) == DM_OK;
}

/* with more carried values two groups want more registers than there are */
static uint32_t choose_together(uint32_t size, uint32_t lanes) {
    return lanes > 1 && size <= 12 ? 2 : 1;
}

/* parts are repeated for the groups that take turns; one group alone goes as it is */
dm_status dm_loop_native(dm_loop *out, const dm_loop_part part[DM_LOOP_PARTS], uint32_t size,
                         uint32_t lanes, dm_arena *arena) {
    for (int k = 0; k < DM_LOOP_PARTS; k++)
        if (part[k].graph && dm_has_roots(part[k].graph, part[k].roots, size)) return DM_NO_NATIVE;
    const uint32_t together = choose_together(size, lanes);
    dm_loop_part more[DM_LOOP_PARTS] = {{0}};
    if (together == 1) return dm_loop_code(out, part, size, lanes, arena);
    for (int k = 0; k < DM_LOOP_PARTS; k++)
        if (part[k].graph && !repeat_part(more + k, part + k, size, together, arena))
            return DM_NO_MEMORY;
    const dm_status status = dm_loop_code(out, more, size * together, lanes, arena);
    if (status != DM_OK) return status;
    out->size = size;
    out->together = together;
    return DM_OK;
}
