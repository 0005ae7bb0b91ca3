/* even.c - products by decimal numbers in two parts, which sums keep apart. */
#include "algebra/even.h"

#include "graph/nodes.h"
#include "numbers/weight.h"

#include <math.h>

/* numbers beyond have no float */
static const double LARGEST = 0x1p100, SMALLEST = 0x1p-100;

/* A node of the old graph in the new one: main + rest. rest 0: there is none. */
typedef struct {
    dm_node main, rest;
} even_parts;

/* c x */
static even_parts product(dm_graph *to, double c, dm_node x) {
    const double size = fabs(c);
    const dm_weight w = dm_weight_of(c);
    if (w.rest == 0.0 || !(size > SMALLEST && size < LARGEST))
        return (even_parts){dm_mul(to, dm_constant(to, c), x), 0};
    return (even_parts){dm_mul(to, dm_constant(to, w.top), x),
                        dm_mul(to, dm_constant(to, w.rest), x)};
}

/* x^(-3/2) */
static dm_node cube(dm_graph *to, dm_node x) {
    const dm_node root = dm_apply(to, DM_OP_RSQRT, x, 0, 0);
    return dm_mul(to, root, dm_mul(to, root, root));
}

/* op(a, b) of rests, where there are any */
static dm_node rest_of(dm_graph *to, dm_op op, dm_node a, dm_node b) {
    if (a && b) return dm_apply(to, op, a, b, 0);
    return a || op == DM_OP_ADD ? (a ? a : b) : b ? dm_neg(to, b) : 0;
}

/* both parts as one number */
static dm_node whole(dm_graph *to, even_parts *x) {
    if (x->rest) *x = (even_parts){dm_add(to, x->main, x->rest), 0};
    return x->main;
}

/* node n in the new graph, which has what it needs */
static even_parts copy_of(dm_graph *g, dm_graph *to, dm_node n, even_parts *copy) {
    const dm_expr e = *dm_at(g, n);
    const dm_node *arg = e.as.arg;
    double c;
    if (e.op == DM_OP_CONSTANT) return (even_parts){dm_constant(to, e.as.value), 0};
    if (e.op == DM_OP_INPUT) return (even_parts){dm_input(to, e.as.input), 0};
    if (e.op == DM_OP_IMPLICIT) return (even_parts){dm_node_make(to, &e), 0};
    if (e.op == DM_OP_ADD || e.op == DM_OP_SUB)
        return (even_parts){dm_apply(to, e.op, copy[arg[0]].main, copy[arg[1]].main, 0),
                            rest_of(to, e.op, copy[arg[0]].rest, copy[arg[1]].rest)};
    if (e.op == DM_OP_NEG && copy[arg[0]].rest)
        return (even_parts){dm_neg(to, copy[arg[0]].main), dm_neg(to, copy[arg[0]].rest)};
    const int operands = dm_arity(e.op);
    dm_node x[3] = {0};
    for (int k = 0; k < operands; k++) x[k] = whole(to, copy + arg[k]);
    for (int k = 0; e.op == DM_OP_MUL && k < 2; k++)
        if (dm_is_constant(g, arg[k], &c)) return product(to, c, x[1 - k]);
    if (e.op == DM_OP_RSQRT3) return (even_parts){cube(to, x[0]), 0};
    return (even_parts){dm_apply(to, e.op, x[0], x[1], x[2]), 0};
}

dm_graph *dm_even_graph(dm_graph *g, const dm_node *roots, uint32_t m, dm_node *out) {
    const uint32_t end = dm_mark(g, roots, m);
    dm_graph *to = dm_graph_new(g->arena, g->inputs);
    even_parts *copy = dm_arena_take(g->arena, (end + (size_t)1) * sizeof *copy);
    if (!to || !copy) return NULL;
    dm_graph_verbatim(to, 1);
    to->implicits = g->implicits;
    for (dm_node n = 0; n < end; n++)
        copy[n] = dm_is_marked(g, n) ? copy_of(g, to, n, copy) : (even_parts){0};
    for (uint32_t i = 0; i < m; i++) out[i] = whole(to, copy + roots[i]);
    return dm_graph_status(to) == DM_OK ? to : NULL;
}
