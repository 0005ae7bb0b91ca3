/* analyse.c - questions to a graph, all by one sweep over the nodes that the roots need. */
#include "graph/analyse.h"

#include "graph/nodes.h"

#include <math.h>
#include <string.h>

/* an input without a node is in nothing */
int dm_depends(dm_graph *g, const dm_node *roots, uint32_t m, uint32_t first, uint32_t n) {
    const uint32_t all = g->pages * DM_LEAVES, end = first + n < all ? first + n : all;
    dm_mark(g, roots, m);
    for (uint32_t i = first; i < end; i++) {
        const dm_node *page = g->leaf[i / DM_LEAVES];
        if (!page)
            i |= DM_LEAVES - 1; /* the last of the page */
        else if (page[i % DM_LEAVES] && dm_is_marked(g, page[i % DM_LEAVES]))
            return 1;
    }
    return 0;
}

/* one sweep for all inputs */
void dm_independent(uint8_t *out, dm_graph *g, const dm_node *roots, uint32_t m, uint32_t first,
                    uint32_t n) {
    dm_mark(g, roots, m);
    for (uint32_t i = 0; i < n; i++) {
        const dm_node leaf = dm_leaf_of(g, first + i);
        out[i] = !leaf || !dm_is_marked(g, leaf);
    }
}

/* leaves are no operations */
void dm_operation_counts(dm_graph *g, const dm_node *roots, uint32_t m, uint32_t *counts) {
    const uint32_t end = dm_mark(g, roots, m);
    memset(counts, 0, DM_OP_COUNT * sizeof *counts);
    for (dm_node i = 0; i < end; i++)
        if (dm_is_marked(g, i) && dm_at(g, i)->op >= DM_OP_NEG) counts[dm_at(g, i)->op]++;
}

/* the sum of these */
uint32_t dm_operations(dm_graph *g, const dm_node *roots, uint32_t m) {
    uint32_t counts[DM_OP_COUNT], sum = 0;
    dm_operation_counts(g, roots, m, counts);
    for (int op = 0; op < DM_OP_COUNT; op++) sum += counts[op];
    return sum;
}

dm_node dm_break_of(dm_graph *g, const dm_expr *e) {
    switch (e->op) {
    case DM_OP_ABS:
    case DM_OP_SIGN:
    case DM_OP_WHERE:
        return e->as.arg[0];
    case DM_OP_MIN:
    case DM_OP_MAX:
        return dm_sub(g, e->as.arg[0], e->as.arg[1]);
    default:
        return 0;
    }
}

dm_node dm_edge_of(const dm_graph *g, const dm_expr *e) {
    double power;
    switch (e->op) {
    case DM_OP_SQRT:
    case DM_OP_RSQRT:
    case DM_OP_RSQRT3:
    case DM_OP_LOG:
        return e->as.arg[0];
    case DM_OP_POW:
        return dm_is_constant(g, e->as.arg[1], &power) && power == floor(power) ? 0 : e->as.arg[0];
    default:
        return 0;
    }
}
