/* body_sum.c - sums as leaves: kept by the graph beside its nodes, newest first, each an input
 * behind those that there were before. A graph that has sums can be compared, copied and
 * written out; how they are evaluated as loops is chain/loops.c's business. */
#include "algebra/body_sum.h"

#include "algebra/derive.h"
#include "graph/nodes.h"

#include <string.h>

/* NULL: the graph is a plain one */
const dm_sum *dm_sums(const dm_graph *g) {
    return g->sums;
}

/* inputs that are no sums; those of sums come behind */
uint32_t dm_sum_first(const dm_graph *g) {
    uint32_t count = 0;
    for (const dm_sum *s = g->sums; s; s = s->next) count++;
    return g->inputs - count;
}

const dm_sum *dm_sum_over_near(const dm_graph *g) {
    const dm_sum *s = g->sums;
    while (s && !(s->within > 0.0)) s = s->next;
    return s;
}

const dm_sum *dm_sum_over_cells(const dm_graph *g) {
    const dm_sum *s = g->sums;
    while (s && !s->cells) s = s->next;
    return s;
}

/* as a double: pairs of 10^5 bodies overflow 32 bits */
double dm_sum_all_rounds(const dm_sum *s) {
    double rounds = 0;
    for (uint32_t shift = s->from; shift <= s->to; shift++) rounds += dm_sum_rounds(s, shift);
    return rounds;
}

/* the term and the columns stay where they are; the record is copied */
dm_node dm_sum_leaf(dm_graph *g, const dm_sum *s) {
    dm_sum *kept = dm_arena_take(g->arena, sizeof *kept);
    if (!kept) return dm_graph_fail(g, DM_NO_MEMORY);
    *kept = *s;
    kept->input = g->inputs++;
    kept->next = g->sums;
    g->sums = kept;
    return dm_input(g, kept->input);
}

/* derivatives of a term are terms of the same columns */
dm_node dm_sum_of(dm_graph *g, const dm_sum *like, dm_node value) {
    dm_sum s = *like;
    s.value = value;
    if (dm_graph_status(s.term) != DM_OK) return dm_graph_fail(g, dm_graph_status(s.term));
    return value ? dm_sum_leaf(g, &s) : 0;
}

/* as dm_op_value does, without simplification: what L itself would compute */
double dm_sum_term(const dm_sum *s, const double *in, double *work) {
    for (dm_node k = 0; k <= s->value; k++) {
        const dm_expr *e = dm_at(s->term, k);
        if (e->op == DM_OP_CONSTANT)
            work[k] = e->as.value;
        else if (e->op == DM_OP_INPUT)
            work[k] = in[e->as.input];
        else
            work[k] =
                dm_op_value(e->op, work[e->as.arg[0]], work[e->as.arg[1]], work[e->as.arg[2]]);
    }
    return work[s->value];
}

/* the bodies that a column reads are the same */
static int same_index(const dm_sum *s, const dm_column *a, const dm_column *b) {
    if (a->index == b->index) return 1;
    return a->index && b->index && memcmp(a->index, b->index, s->bodies * sizeof *a->index) == 0;
}

/* reads the same entries, or equal numbers */
static int same_column(const dm_sum *s, const dm_column *a, const dm_column *b) {
    if (a->first != b->first || a->step != b->step || a->partner != b->partner ||
        a->varied != b->varied || !a->data != !b->data || !same_index(s, a, b))
        return 0;
    if (!a->data || a->data == b->data) return 1;
    for (uint32_t i = 0; a->index && i < s->bodies; i++)
        if (memcmp(a->data + dm_sum_entry(s, a, i, 0), b->data + dm_sum_entry(s, b, i, 0),
                   sizeof *a->data) != 0)
            return 0;
    const size_t last = a->step * (size_t)(s->bodies - 1);
    return a->index ||
           memcmp(a->data + a->first, b->data + b->first, (last + 1) * sizeof *a->data) == 0;
}

int dm_sum_alike(const dm_sum *a, const dm_sum *b) {
    if (a->columns != b->columns || a->bodies != b->bodies || a->from != b->from ||
        a->to != b->to || a->periodic != b->periodic || a->call != b->call ||
        a->cells != b->cells || a->work != b->work || a->held != b->held ||
        a->within != b->within || a->margin != b->margin || a->axes != b->axes ||
        memcmp(a->box, b->box, sizeof a->box) != 0)
        return 0;
    for (uint32_t c = 0; c < b->columns; c++)
        if (!same_column(b, a->column + c, b->column + c)) return 0;
    return 1;
}

/* same pattern, same nodes in the term */
static int same_sum(const dm_sum *kept, const dm_sum *fresh) {
    if (kept->value != fresh->value || kept->input != fresh->input || !dm_sum_alike(kept, fresh))
        return 0;
    for (dm_node k = 0; k <= fresh->value; k++)
        if (!dm_same_expr(dm_at(kept->term, k), dm_at(fresh->term, k))) return 0;
    return 1;
}

/* those of `kept` that derivatives added are newer */
int dm_sums_same(const dm_graph *kept, const dm_graph *fresh) {
    const dm_sum *a = kept->sums, *b = fresh->sums;
    while (a && b && a->input > b->input) a = a->next;
    for (; a && b; a = a->next, b = b->next)
        if (!same_sum(a, b)) return 0;
    return !a && !b;
}

/* what the columns are in one round, as nodes of `to` */
static void fill_columns(dm_graph *to, const dm_sum *s, dm_node *with, uint32_t i, uint32_t shift) {
    for (uint32_t c = 0; c < s->columns; c++) {
        const dm_column *column = s->column + c;
        const size_t at = dm_sum_entry(s, column, i, shift);
        with[c] = column->data ? dm_constant(to, column->data[at]) : dm_input(to, (uint32_t)at);
    }
}

/* every round as nodes, added in their order; which pairs are near is not known to a graph */
static dm_node write_sum(dm_graph *to, const dm_sum *s) {
    dm_node sum = 0, term = 0;
    if (s->within > 0.0) return dm_graph_fail(to, DM_TOO_LARGE);
    dm_node *with = dm_arena_take(to->arena, (s->columns + 1) * sizeof *with);
    if (!with) return dm_graph_fail(to, DM_NO_MEMORY);
    for (uint32_t shift = s->from; shift <= s->to; shift++)
        for (uint32_t i = 0; i < dm_sum_rounds(s, shift) && to->status == DM_OK; i++) {
            fill_columns(to, s, with, i, shift);
            dm_transplant(to, s->term, &s->value, 1, with, &term);
            sum = dm_add(to, sum, term);
        }
    return sum;
}

/* what the leaves stand for takes their place */
dm_node dm_sum_write_out(dm_graph *to, dm_graph *g, dm_node root) {
    dm_node out = 0;
    dm_node *with = dm_arena_take(to->arena, (g->inputs + 1) * sizeof *with);
    if (!with) return dm_graph_fail(to, DM_NO_MEMORY);
    for (uint32_t i = 0; i < to->inputs; i++) with[i] = dm_input(to, i);
    for (const dm_sum *s = g->sums; s; s = s->next) with[s->input] = write_sum(to, s);
    dm_transplant(to, g, &root, 1, with, &out);
    return out;
}
