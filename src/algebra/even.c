/* even.c - products by decimal numbers in two parts. */
#include "algebra/even.h"

#include "graph/nodes.h"
#include "numbers/weight.h"

#include <math.h>

/* numbers beyond have no float */
static const double LARGEST = 0x1p100, SMALLEST = 0x1p-100;

/* c x = top x + rest x; 0: n is no such product */
static int take_apart(dm_graph *g, dm_graph *to, dm_node n, const dm_node *copy, dm_node part[2]) {
    const dm_expr e = *dm_at(g, n);
    double c;
    for (int k = 0; e.op == DM_OP_MUL && k < 2; k++) {
        if (!dm_is_constant(g, e.as.arg[k], &c)) continue;
        const dm_weight w = dm_weight_of(c);
        const dm_node x = copy[e.as.arg[1 - k]];
        if (w.rest == 0.0 || !(fabs(c) > SMALLEST && fabs(c) < LARGEST)) return 0;
        part[0] = dm_mul(to, dm_constant(to, w.top), x);
        part[1] = dm_mul(to, dm_constant(to, w.rest), x);
        return 1;
    }
    return 0;
}

/* a + (top x + rest x) as (a + top x) + rest x: the sum of both products is as near to few places
 * as c x is; 0: no operand is such a product */
static dm_node sum(dm_graph *g, dm_graph *to, const dm_expr *e, const dm_node *copy) {
    const int minus = e->op == DM_OP_SUB;
    dm_node part[2];
    for (int k = 1; (e->op == DM_OP_ADD || minus) && k >= 0; k--) {
        const dm_node other = copy[e->as.arg[1 - k]];
        if (!take_apart(g, to, e->as.arg[k], copy, part)) continue;
        const dm_node first = k ? other : part[0], second = k ? part[0] : other;
        const dm_node top = dm_apply(to, e->op, first, second, 0);
        return k && minus ? dm_sub(to, top, part[1]) : dm_add(to, top, part[1]);
    }
    return 0;
}

/* x^(-3/2) */
static dm_node cube(dm_graph *to, dm_node x) {
    const dm_node root = dm_apply(to, DM_OP_RSQRT, x, 0, 0);
    return dm_mul(to, root, dm_mul(to, root, root));
}

/* node n in the new graph, which has what it needs */
static dm_node copy_of(dm_graph *g, dm_graph *to, dm_node n, const dm_node *copy) {
    const dm_expr e = *dm_at(g, n);
    const dm_node *arg = e.as.arg, added = sum(g, to, &e, copy);
    dm_node part[2];
    if (added) return added;
    if (e.op == DM_OP_CONSTANT) return dm_constant(to, e.as.value);
    if (e.op == DM_OP_INPUT) return dm_input(to, e.as.input);
    if (e.op == DM_OP_IMPLICIT) return dm_node_make(to, &e);
    if (take_apart(g, to, n, copy, part)) return dm_add(to, part[0], part[1]);
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
