/* prefix.c - the beginning of a graph as a graph of its own, when a trace that repeated an old
 * one takes another turn: the same nodes under the same numbers, so that what follows is what
 * it would have become without the old trace. */
#include "algebra/prefix.h"

#include "graph/nodes.h"

#include <string.h>

/* the entries of a column that are read, up to the last body's */
static const double *copy_data(dm_arena *arena, const dm_sum *s, const dm_column *c) {
    const size_t count = c->first + (size_t)c->step * (s->bodies - 1) + 1;
    double *data = dm_arena_take(arena, count * sizeof *data);
    if (data) memcpy(data, c->data, count * sizeof *data);
    return data;
}

/* a sum with a term and columns of its own; 0: no memory */
static int copy_sum(dm_arena *arena, const dm_sum *s, dm_sum *out) {
    dm_column *column = dm_arena_take(arena, (s->columns + 1) * sizeof *column);
    *out = *s;
    out->term = dm_graph_prefix(arena, s->term, s->value + 1);
    out->column = column;
    if (!out->term || !column) return 0;
    memcpy(column, s->column, s->columns * sizeof *column);
    for (uint32_t c = 0; c < s->columns; c++) {
        if (!column[c].data) continue;
        column[c].data = copy_data(arena, s, column + c);
        if (!column[c].data) return 0;
    }
    return 1;
}

/* the leaf of a sum */
static void add_leaf(dm_graph *to, const dm_graph *g, uint32_t input) {
    const dm_sum *s = g->sums;
    dm_sum own;
    while (s->input != input) s = s->next;
    if (copy_sum(to->arena, s, &own))
        dm_sum_leaf(to, &own);
    else
        dm_graph_fail(to, DM_NO_MEMORY);
}

/* node by node: their contents are new to the new graph, in this order */
dm_graph *dm_graph_prefix(dm_arena *arena, const dm_graph *g, uint32_t size) {
    const uint32_t inputs = dm_sum_first(g);
    dm_graph *to = dm_graph_sized(arena, inputs, size);
    if (!to) return NULL;
    for (dm_node k = 1; k < size; k++) {
        const dm_expr *e = dm_at(g, k);
        if (e->op == DM_OP_INPUT && e->as.input >= inputs)
            add_leaf(to, g, e->as.input);
        else
            dm_node_make(to, e);
    }
    return to->status == DM_OK && to->size == size ? to : NULL;
}
