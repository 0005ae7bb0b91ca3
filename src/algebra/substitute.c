/* substitute.c - the same expressions of other inputs, in the same graph or another one. */
#include "algebra/derive.h"
#include "algebra/implicit.h"
#include "graph/nodes.h"

#include <string.h>

/* Every node is made anew by dm_apply, which simplifies it for its new operands. */
void dm_transplant(dm_graph *to, dm_graph *from, const dm_node *roots, uint32_t m,
                   const dm_node *with, dm_node *out) {
    memset(out, 0, m * sizeof *out);
    const uint32_t end = dm_mark(from, roots, m);
    dm_node *now = dm_arena_take(to->arena, (end + 1) * sizeof *now);
    if (!now) dm_graph_fail(to, DM_NO_MEMORY);
    if (from->status != DM_OK) dm_graph_fail(to, from->status);
    if (to->status != DM_OK) return;
    for (dm_node n = 0; n < end; n++) {
        const dm_expr e = *dm_at(from, n);
        dm_node arg[3] = {0, 0, 0};
        if (!dm_is_marked(from, n)) continue;
        for (int k = 0; k < dm_arity(e.op); k++) arg[k] = now[e.as.arg[k]];
        if (e.op == DM_OP_INPUT)
            now[n] = with[e.as.input];
        else if (e.op == DM_OP_CONSTANT)
            now[n] = dm_constant(to, e.as.value);
        else if (e.op == DM_OP_IMPLICIT)
            now[n] = dm_implicit_leaf(to, dm_implicit_find(from, e.as.value));
        else
            now[n] = dm_apply(to, e.op, arg[0], arg[1], arg[2]);
    }
    for (uint32_t i = 0; i < m; i++) out[i] = now[roots[i]];
}

/* within one graph */
void dm_substitute(dm_graph *g, const dm_node *roots, uint32_t m, const dm_node *with,
                   dm_node *out) {
    dm_transplant(g, g, roots, m, with, out);
}
