/* contract.c - sums take products in, as fused multiply-adds. A product that all its users would
 * take in disappears; with `differences` there may be several of them, and each computes it by
 * itself: an operation more, but nothing waits for it. One that somebody needs as it is stays, and
 * nobody takes it in.
 * Speed: routh, 6 rotors by gauss(2): 1.18x, and 1.06x on P4 and P6. */
#include "algebra/contract.h"

#include "graph/nodes.h"

#include <string.h>

/* a graph and its copy in the making */
typedef struct {
    dm_graph *from, *to;
    uint32_t *
        /* of every node of `from`: by others, and of a product by sums that would take it in */
        uses;
    uint32_t *taken;
    int differences; /* take products into these, too, and products of several sums into each */
    dm_node *copy;   /* what stands for it in `to`, once it is made */
} pass;

/* a multiplication */
static int is_product(const pass *p, dm_node n) {
    return dm_at(p->from, n)->op == DM_OP_MUL;
}

/* sums, and differences where those are wanted */
static int may_take(const pass *p, const dm_expr *e) {
    return e->op == DM_OP_ADD || (p->differences && e->op == DM_OP_SUB);
}

/* which operand of a sum is a product to be taken in, one that is used once, or else the second
 * rather; -1: none */
static int product_of(const pass *p, const dm_expr *e) {
    int found = -1;
    for (int k = 0; k < 2 && may_take(p, e); k++) {
        const dm_node x = e->as.arg[k];
        if (!is_product(p, x) || (!p->differences && p->uses[x] > 1)) continue;
        if (found < 0 || p->uses[x] <= p->uses[e->as.arg[found]]) found = k;
    }
    return found;
}

/* users of every node, and how many of them would take it in */
static void count_uses(pass *p, const dm_node *roots, uint32_t m, uint32_t end) {
    memset(p->uses, 0, end * sizeof *p->uses);
    memset(p->taken, 0, end * sizeof *p->taken);
    for (uint32_t i = 0; i < m; i++) p->uses[roots[i]]++;
    for (dm_node n = 0; n < end; n++) {
        const dm_expr *e = dm_at(p->from, n);
        for (int k = 0; dm_is_marked(p->from, n) && k < dm_arity(e->op); k++)
            p->uses[e->as.arg[k]]++;
    }
    for (dm_node n = 0; n < end; n++) {
        const dm_expr *e = dm_at(p->from, n);
        const int k = dm_is_marked(p->from, n) ? product_of(p, e) : -1;
        if (k >= 0) p->taken[e->as.arg[k]]++;
    }
}

/* the sum or difference with its product at operand k, which no one else needs */
static dm_node take_in(pass *p, const dm_expr *e, int k) {
    const dm_expr product = *dm_at(p->from, e->as.arg[k]);
    const dm_op op = e->op == DM_OP_ADD ? DM_OP_FMA : k == 0 ? DM_OP_FMS : DM_OP_FNMA;
    return dm_apply(p->to, op, p->copy[product.as.arg[0]], p->copy[product.as.arg[1]],
                    p->copy[e->as.arg[1 - k]]);
}

/* node n in the new graph */
static dm_node copy_of(pass *p, dm_node n) {
    const dm_expr e = *dm_at(p->from, n);
    const dm_node *arg = e.as.arg, *copy = p->copy;
    if (e.op == DM_OP_CONSTANT) return dm_constant(p->to, e.as.value);
    if (e.op == DM_OP_INPUT) return dm_input(p->to, e.as.input);
    if (e.op == DM_OP_IMPLICIT) return dm_node_make(p->to, &e);
    const int k = product_of(p, &e);
    if (k >= 0 && p->taken[arg[k]] == p->uses[arg[k]]) return take_in(p, &e, k);
    const int operands = dm_arity(e.op);
    return dm_apply(p->to, e.op, copy[arg[0]], operands > 1 ? copy[arg[1]] : 0,
                    operands > 2 ? copy[arg[2]] : 0);
}

/* the marked nodes in their order, each copied or taken in; NULL without memory */
static dm_graph *contract(dm_graph *g, const dm_node *roots, uint32_t m, dm_node *out,
                          int differences) {
    const uint32_t end = dm_mark(g, roots, m);
    pass p = {.from = g, .to = dm_graph_new(g->arena, g->inputs), .differences = differences};
    p.uses = dm_arena_take(g->arena, 2 * (end + (size_t)1) * sizeof *p.uses);
    p.taken = p.uses + end + 1;
    p.copy = dm_arena_take(g->arena, (end + (size_t)1) * sizeof *p.copy);
    if (!p.to || !p.uses || !p.copy) return NULL;
    dm_graph_verbatim(p.to, 1);
    p.to->implicits = g->implicits;
    count_uses(&p, roots, m, end);
    for (dm_node n = 0; n < end; n++) p.copy[n] = dm_is_marked(g, n) ? copy_of(&p, n) : 0;
    for (uint32_t i = 0; i < m; i++) out[i] = p.copy[roots[i]];
    return dm_graph_status(p.to) == DM_OK ? p.to : NULL;
}

dm_graph *dm_contract_graph(dm_graph *g, const dm_node *roots, uint32_t m, dm_node *out) {
    return contract(g, roots, m, out, 0);
}

dm_graph *dm_contract_all(dm_graph *g, const dm_node *roots, uint32_t m, dm_node *out) {
    return contract(g, roots, m, out, 1);
}
