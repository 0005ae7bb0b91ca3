#include "code/loops/array_loop.h"

#include "algebra/compact.h"
#include "algebra/derive.h"
#include "code/native/jit.h"
#include "graph/nodes.h"

#include <string.h>

int dm_strip_begin(dm_strip_draft *d, dm_arena *arena) {
    d->g = dm_graph_new(arena, DM_STRIP_MOST);
    d->inputs = d->outputs = d->carried = 0;
    d->full = d->stands = 0;
    return d->g != NULL;
}

/* a strand read twice is one input */
dm_node dm_strip_read(dm_strip_draft *d, dm_strand from) {
    uint32_t k = 0;
    while (k < d->inputs && (d->in[k].base != from.base || d->in[k].at != from.at)) k++;
    if (k == DM_STRIP_MOST) {
        d->full = 1;
        return 0;
    }
    if (k == d->inputs) d->in[d->inputs++] = from;
    return dm_input(d->g, k);
}

void dm_strip_write(dm_strip_draft *d, dm_strand to, dm_node value) {
    if (d->outputs == DM_STRIP_MOST) {
        d->full = 1;
        return;
    }
    d->out[d->outputs] = to;
    d->root[d->outputs++] = value;
}

dm_strand dm_strip_carry(dm_strip_draft *d, dm_strand start, int keep) {
    if (d->carried == DM_STRIP_CARRIED) {
        d->full = 1;
        return start;
    }
    d->start[d->carried] = start;
    d->kept[d->carried] = keep;
    return (dm_strand){DM_STRAND_CARRIED, d->carried++};
}

void dm_strip_repeat(dm_strip_draft *d, const dm_strip *s, const dm_node *with, dm_node *out) {
    dm_transplant(d->g, s->g, s->root, s->one.outputs, with, out);
}

static int keep_strands(dm_strip *s, const dm_strip_draft *d, dm_arena *arena) {
    const size_t bytes = DM_STRIP_MOST * sizeof *d->in;
    dm_strand *both = dm_arena_take(arena, 2 * bytes);
    if (!both) return 0;
    memcpy(both, d->in, d->inputs * sizeof *both);
    memcpy(both + DM_STRIP_MOST, d->out, d->outputs * sizeof *both);
    s->in = both;
    s->out = both + DM_STRIP_MOST;
    return 1;
}

/* ---- products that a sum takes along ---- */

typedef struct {
    const dm_graph *from;
    dm_graph *to;
    uint8_t *uses;
    dm_node *now;
} contraction;

/* a product used once */
static int is_product(const contraction *c, dm_node n) {
    return dm_is_op(c->from, n, DM_OP_MUL) && c->uses[n] == 1;
}

static dm_node contract(const contraction *c, dm_node n) {
    const dm_expr *e = dm_at(c->from, n);
    dm_node arg[3] = {0, 0, 0};
    if (dm_arity(e->op) == 0) return dm_node_make(c->to, e);
    for (int k = 0; e->op == DM_OP_ADD && k < 2; k++) {
        if (!is_product(c, e->as.arg[k])) continue;
        const dm_expr *product = dm_at(c->from, e->as.arg[k]);
        return dm_node_plain(c->to, DM_OP_FMA, c->now[product->as.arg[0]],
                             c->now[product->as.arg[1]], c->now[e->as.arg[1 - k]]);
    }
    for (int k = 0; k < dm_arity(e->op); k++) arg[k] = c->now[e->as.arg[k]];
    return dm_node_plain(c->to, e->op, arg[0], arg[1], arg[2]);
}

/* the roots of g with sums of products as fused ones, in a graph of its own; NULL without memory */
static dm_graph *contract_all(dm_graph *g, dm_node *roots, uint32_t m) {
    dm_arena *arena = dm_graph_arena(g);
    const uint32_t end = dm_mark(g, roots, m);
    contraction c = {.from = g, .to = dm_graph_sized(arena, g->inputs, end + 1)};
    c.uses = dm_arena_take(arena, end + 1);
    c.now = dm_arena_take(arena, (end + 1) * sizeof *c.now);
    if (!c.to || !c.uses || !c.now) return NULL;
    c.to->implicits = g->implicits;
    memset(c.uses, 0, end + 1);
    for (dm_node n = 0; n < end; n++)
        for (int k = 0; dm_is_marked(g, n) && k < dm_arity(dm_at(g, n)->op); k++)
            c.uses[dm_at(g, n)->as.arg[k]] |= (uint8_t)(c.uses[dm_at(g, n)->as.arg[k]] + 1);
    for (uint32_t i = 0; i < m; i++) c.uses[roots[i]] = 2;
    for (dm_node n = 0; n < end; n++)
        if (dm_is_marked(g, n)) c.now[n] = contract(&c, n);
    for (uint32_t i = 0; i < m; i++) roots[i] = c.now[roots[i]];
    return c.to->status == DM_OK ? c.to : NULL;
}

dm_status dm_strip_end(dm_strip *out, dm_strip_draft *d, dm_compile *compile, dm_arena *arena) {
    dm_strip s = {.lanes = 0};
    dm_node *compact = dm_arena_take(arena, (d->outputs + 1) * sizeof *compact);
    if (!compact) return DM_NO_MEMORY;
    if (d->full) return DM_TOO_LARGE;
    if (!keep_strands(&s, d, arena)) return DM_NO_MEMORY;
    dm_graph *small = dm_compact_graph(d->g, d->root, d->outputs, compact);
    if (dm_graph_status(d->g) != DM_OK) return dm_graph_status(d->g);
    if (small && !d->stands) small = contract_all(small, compact, d->outputs);
    if (!small) return DM_NO_MEMORY;
    dm_graph_verbatim(small, 1);
    dm_status status = DM_NO_NATIVE;
    s.one = (dm_kernel){.inputs = d->inputs, .outputs = d->outputs, .backend = "jit"};
    s.g = small;
    s.root = compact;
    if (compile == dm_native_build) status = dm_jit_build_strip(&s, d, arena);
    if (status == DM_NO_NATIVE && !d->carried) {
        status = compile(&s.one, small, compact, d->outputs, arena);
        s.one.inputs = d->inputs;
    }
    if (status == DM_OK) *out = s;
    return status;
}

static double *place(const dm_strip_bases *at, dm_strand s, uint32_t i) {
    return (s.base == DM_STRAND_MAIN ? at->main : at->side) + s.at + i;
}

static void run_one_by_one(const dm_strip *s, const dm_strip_bases *at, uint32_t count) {
    double in[DM_STRIP_MOST] = {0}, y[DM_STRIP_MOST];
    dm_kernel_prepare(&s->one, y);
    for (uint32_t i = 0; i < count; i++) {
        for (uint32_t k = 0; k < s->one.inputs; k++)
            in[k] = s->in[k].base == DM_STRAND_FIXED ? at->fixed[s->in[k].at * DM_STRIP_GROUP]
                                                     : *place(at, s->in[k], i);
        dm_kernel_eval(&s->one, in, y);
        for (uint32_t k = 0; k < s->one.outputs; k++) *place(at, s->out[k], i) = y[k];
    }
}

void dm_strip_run(const dm_strip *s, dm_strip_bases at, uint32_t count) {
    const uint32_t whole = (count + DM_STRIP_GROUP - 1) & ~(uint32_t)(DM_STRIP_GROUP - 1);
    if (!count) return;
    if (s->lanes)
        s->eval(s->pool, at.main, at.fixed, at.main + whole, at.side);
    else
        run_one_by_one(s, &at, whole);
}
