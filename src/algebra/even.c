/* even.c - products by decimal numbers in two parts. */
#include "algebra/even.h"

#include "graph/nodes.h"
#include "numbers/weight.h"

#include <math.h>

/* numbers beyond have no float */
static const double LARGEST = 0x1p100, SMALLEST = 0x1p-100;

/* c x */
static dm_node product(dm_graph *to, double c, dm_node x) {
    const double size = fabs(c);
    const dm_weight w = dm_weight_of(c);
    if (w.rest == 0.0 || !(size > SMALLEST && size < LARGEST))
        return dm_mul(to, dm_constant(to, c), x);
    const dm_node top = dm_mul(to, dm_constant(to, w.top), x);
    return dm_add(to, top, dm_mul(to, dm_constant(to, w.rest), x));
}

/* x^(-3/2) */
static dm_node cube(dm_graph *to, dm_node x) {
    const dm_node root = dm_apply(to, DM_OP_RSQRT, x, 0, 0);
    return dm_mul(to, root, dm_mul(to, root, root));
}

/* node n in the new graph, which has what it needs */
static dm_node copy_of(dm_graph *g, dm_graph *to, dm_node n, const dm_node *copy) {
    const dm_expr e = *dm_at(g, n);
    const dm_node *arg = e.as.arg;
    double c;
    if (e.op == DM_OP_CONSTANT) return dm_constant(to, e.as.value);
    if (e.op == DM_OP_INPUT) return dm_input(to, e.as.input);
    if (e.op == DM_OP_IMPLICIT) return dm_node_make(to, &e);
    if (e.op == DM_OP_MUL && dm_is_constant(g, arg[0], &c)) return product(to, c, copy[arg[1]]);
    if (e.op == DM_OP_MUL && dm_is_constant(g, arg[1], &c)) return product(to, c, copy[arg[0]]);
    if (e.op == DM_OP_RSQRT3) return cube(to, copy[arg[0]]);
    const int operands = dm_arity(e.op);
    return dm_apply(to, e.op, copy[arg[0]], operands > 1 ? copy[arg[1]] : 0,
                    operands > 2 ? copy[arg[2]] : 0);
}

dm_graph *dm_even_graph(dm_graph *g, const dm_node *roots, uint32_t m, dm_node *out) {
    const uint32_t end = dm_mark(g, roots, m);
    dm_graph *to = dm_graph_new(g->arena, g->inputs);
    dm_node *copy = dm_arena_take(g->arena, (end + (size_t)1) * sizeof *copy);
    if (!to || !copy) return NULL;
    dm_graph_verbatim(to, 1);
    to->implicits = g->implicits;
    for (dm_node n = 0; n < end; n++) copy[n] = dm_is_marked(g, n) ? copy_of(g, to, n, copy) : 0;
    for (uint32_t i = 0; i < m; i++) out[i] = copy[roots[i]];
    return dm_graph_status(to) == DM_OK ? to : NULL;
}
