#include "graph/analyse.h"

#include "graph/nodes.h"

#include <string.h>

int dm_depends(dm_graph *g, const dm_node *roots, uint32_t m, uint32_t first, uint32_t n) {
    const uint32_t end = first + n < g->leaves ? first + n : g->leaves;
    dm_mark(g, roots, m);
    for (uint32_t i = first; i < end; i++)
        if (g->leaf[i] && dm_is_marked(g, g->leaf[i])) return 1;
    return 0;
}

void dm_independent(uint8_t *out, dm_graph *g, const dm_node *roots, uint32_t m, uint32_t first,
                    uint32_t n) {
    dm_mark(g, roots, m);
    for (uint32_t i = 0; i < n; i++) {
        const dm_node leaf = first + i < g->leaves ? g->leaf[first + i] : 0;
        out[i] = !leaf || !dm_is_marked(g, leaf);
    }
}

void dm_operation_counts(dm_graph *g, const dm_node *roots, uint32_t m, uint32_t *counts) {
    const uint32_t end = dm_mark(g, roots, m);
    memset(counts, 0, DM_OP_COUNT * sizeof *counts);
    for (dm_node i = 0; i < end; i++)
        if (dm_is_marked(g, i) && dm_at(g, i)->op >= DM_OP_NEG) counts[dm_at(g, i)->op]++;
}

uint32_t dm_operations(dm_graph *g, const dm_node *roots, uint32_t m) {
    uint32_t counts[DM_OP_COUNT], sum = 0;
    dm_operation_counts(g, roots, m, counts);
    for (int op = 0; op < DM_OP_COUNT; op++) sum += counts[op];
    return sum;
}

static uint32_t latency(dm_op op) {
    static const uint8_t cycles[DM_OP_COUNT] =
        {[DM_OP_CONSTANT] = 0, [DM_OP_INPUT] = 0,  [DM_OP_NEG] = 1,     [DM_OP_ABS] = 1,
         [DM_OP_SQRT] = 18,    [DM_OP_RSQRT] = 28, [DM_OP_RSQRT3] = 28, [DM_OP_ADD] = 3,
         [DM_OP_SUB] = 3,      [DM_OP_MUL] = 4,    [DM_OP_DIV] = 14,    [DM_OP_MIN] = 4,
         [DM_OP_MAX] = 4,      [DM_OP_WHERE] = 6,  [DM_OP_SIGN] = 8,    [DM_OP_FMA] = 4,
         [DM_OP_FMS] = 4,      [DM_OP_FNMA] = 4};
    const int leaf = op == DM_OP_CONSTANT || op == DM_OP_INPUT || op == DM_OP_IMPLICIT;
    return cycles[op] || leaf ? cycles[op] : 50;
}

void dm_depths(uint32_t *out, dm_graph *g, const dm_node *roots, uint32_t m) {
    const uint32_t end = dm_mark(g, roots, m);
    uint32_t *at = dm_arena_take(g->arena, (end + (size_t)1) * sizeof *at);
    memset(out, 0, m * sizeof *out);
    if (!at) return;
    for (dm_node n = 0; n < end; n++) {
        const dm_expr *e = dm_at(g, n);
        at[n] = 0;
        for (int k = 0; dm_is_marked(g, n) && k < dm_arity(e->op); k++)
            if (at[e->as.arg[k]] > at[n]) at[n] = at[e->as.arg[k]];
        at[n] += latency(e->op);
    }
    for (uint32_t i = 0; i < m; i++) out[i] = at[roots[i]];
}
