#include "expr/analyse.h"

#include "expr/nodes.h"

#include <string.h>

int dm_depends(dm_graph *g, const dm_node *roots, uint32_t m, uint32_t first,
               uint32_t n) {
    const uint32_t end = dm_mark(g, roots, m);
    for (dm_node i = 0; i < end; i++) {
        const dm_expr *e = dm_at(g, i);
        if (dm_is_marked(g, i) && e->op == DM_OP_INPUT && e->as.input - first < n)
            return 1;
    }
    return 0;
}

void dm_operation_counts(dm_graph *g, const dm_node *roots, uint32_t m,
                         uint32_t *counts) {
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
