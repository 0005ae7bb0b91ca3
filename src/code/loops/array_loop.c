/* array_loop.c - drafts of loops along arrays become kernels: compacted, products taken into
 * sums, and compiled, as a loop in lanes where there is native code and entry by entry
 * elsewhere.
 * Speed: P8-fpu-1024: 57x, machine code against the tape. */
#include "code/loops/array_loop.h"

#include "algebra/compact.h"
#include "algebra/derive.h"
#include "code/native/jit.h"
#include "graph/nodes.h"

#include <string.h>

/* a graph with as many inputs as there may be references */
int dm_array_loop_begin(dm_array_loop_draft *d, dm_arena *arena) {
    d->g = dm_graph_new(arena, DM_ARRAY_LOOP_MOST);
    d->inputs = d->outputs = d->carried = 0;
    d->full = d->verbatim = 0;
    return d->g != NULL;
}

/* a reference read twice is one input */
dm_node dm_array_loop_read(dm_array_loop_draft *d, dm_array_ref from) {
    uint32_t k = 0;
    while (k < d->inputs && (d->in[k].base != from.base || d->in[k].at != from.at)) k++;
    if (k == DM_ARRAY_LOOP_MOST) {
        d->full = 1;
        return 0;
    }
    if (k == d->inputs) d->in[d->inputs++] = from;
    return dm_input(d->g, k);
}

/* Outputs in the order in which they are written. */
void dm_array_loop_write(dm_array_loop_draft *d, dm_array_ref to, dm_node value) {
    if (d->outputs == DM_ARRAY_LOOP_MOST) {
        d->full = 1;
        return;
    }
    d->out[d->outputs] = to;
    d->root[d->outputs++] = value;
}

/* The number of the carried value is its register, counted from the last. */
dm_array_ref dm_array_loop_carry(dm_array_loop_draft *d, dm_array_ref start, int keep) {
    if (d->carried == DM_ARRAY_LOOP_CARRIED) {
        d->full = 1;
        return start;
    }
    d->start[d->carried] = start;
    d->stored[d->carried] = keep;
    return (dm_array_ref){DM_ARRAY_CARRIED, d->carried++};
}

/* Node by node: the draft then computes what the loop would have left in its outputs. */
void dm_array_loop_inline(dm_array_loop_draft *d, const dm_array_loop *s, const dm_node *with,
                          dm_node *out) {
    dm_transplant(d->g, s->g, s->root, s->one.outputs, with, out);
}

/* where inputs and outputs are, beside the kernel; 0 without memory */
static int copy_refs(dm_array_loop *s, const dm_array_loop_draft *d, dm_arena *arena) {
    const size_t bytes = DM_ARRAY_LOOP_MOST * sizeof *d->in;
    dm_array_ref *both = dm_arena_take(arena, 2 * bytes);
    if (!both) return 0;
    memcpy(both, d->in, d->inputs * sizeof *both);
    memcpy(both + DM_ARRAY_LOOP_MOST, d->out, d->outputs * sizeof *both);
    s->in = both;
    s->out = both + DM_ARRAY_LOOP_MOST;
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

/* a sum takes its first operand in that is a product, each product once */
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

/* Carried values need registers: without native code such a loop is refused. */
dm_status dm_array_loop_end(dm_array_loop *out, dm_array_loop_draft *d, dm_compile *compile,
                            dm_arena *arena) {
    dm_array_loop s = {.lanes = 0};
    dm_node *compact = dm_arena_take(arena, (d->outputs + 1) * sizeof *compact);
    if (!compact) return DM_NO_MEMORY;
    if (d->full) return DM_TOO_LARGE;
    if (!copy_refs(&s, d, arena)) return DM_NO_MEMORY;
    dm_graph *small = dm_compact_graph(d->g, d->root, d->outputs, compact);
    if (dm_graph_status(d->g) != DM_OK) return dm_graph_status(d->g);
    if (small && !d->verbatim) small = contract_all(small, compact, d->outputs);
    if (!small) return DM_NO_MEMORY;
    dm_graph_verbatim(small, 1);
    dm_status status = DM_NO_NATIVE;
    s.one = (dm_kernel){.inputs = d->inputs, .outputs = d->outputs, .backend = "jit"};
    s.g = small;
    s.root = compact;
    if (compile == dm_native_build) status = dm_jit_build_array_loop(&s, d, arena);
    if (status == DM_NO_NATIVE && !d->carried) {
        status = compile(&s.one, small, compact, d->outputs, arena);
        s.one.inputs = d->inputs;
    }
    if (status == DM_OK) *out = s;
    return status;
}

/* entry i of an array or of the buffer */
static double *place(const dm_array_bases *at, dm_array_ref s, uint32_t i) {
    return (s.base == DM_ARRAY_MAIN ? at->main : at->buffer) + s.at + i;
}

/* by the kernel of one entry; the order of entries makes no difference */
static void run_one_by_one(const dm_array_loop *s, const dm_array_bases *at, uint32_t count) {
    double in[DM_ARRAY_LOOP_MOST] = {0}, y[DM_ARRAY_LOOP_MOST];
    dm_kernel_prepare(&s->one, y);
    for (uint32_t i = 0; i < count; i++) {
        for (uint32_t k = 0; k < s->one.inputs; k++)
            in[k] = s->in[k].base == DM_ARRAY_SCALAR ? at->scalars[s->in[k].at * DM_ARRAY_GROUP]
                                                     : *place(at, s->in[k], i);
        dm_kernel_eval(&s->one, in, y);
        for (uint32_t k = 0; k < s->one.outputs; k++) *place(at, s->out[k], i) = y[k];
    }
}

/* whole groups of lanes, also behind the last entry */
void dm_array_loop_run(const dm_array_loop *s, dm_array_bases at, uint32_t count) {
    const uint32_t whole = (count + DM_ARRAY_GROUP - 1) & ~(uint32_t)(DM_ARRAY_GROUP - 1);
    if (!count) return;
    if (s->lanes)
        s->eval(s->pool, at.main, at.scalars, at.main + whole, at.buffer);
    else
        run_one_by_one(s, &at, whole);
}
