#include "expr/contract.h"

#include "expr/nodes.h"

#include <string.h>

typedef struct {
    dm_graph *from, *to;
    uint32_t *uses; /* of every node of `from` */
    dm_node *copy;  /* what stands for it in `to`, once it is made */
} pass;

static void count_uses(pass *p, const dm_node *roots, uint32_t m, uint32_t end) {
    memset(p->uses, 0, end * sizeof *p->uses);
    for (uint32_t i = 0; i < m; i++) p->uses[roots[i]]++;
    for (dm_node n = 0; n < end; n++) {
        const dm_expr *e = dm_at(p->from, n);
        for (int k = 0; dm_is_marked(p->from, n) && k < dm_arity(e->op); k++)
            p->uses[e->as.arg[k]]++;
    }
}

/* which operand of a sum is a product to be taken in: the second rather, -1: none */
static int product_of(const pass *p, const dm_expr *e) {
    for (int k = 1; k >= 0 && e->op == DM_OP_ADD; k--)
        if (dm_at(p->from, e->as.arg[k])->op == DM_OP_MUL && p->uses[e->as.arg[k]] == 1)
            return k;
    return -1;
}

static dm_node copy_of(pass *p, dm_node n) {
    const dm_expr e = *dm_at(p->from, n);
    const dm_node *arg = e.as.arg, *copy = p->copy;
    if (e.op == DM_OP_CONSTANT) return dm_constant(p->to, e.as.value);
    if (e.op == DM_OP_INPUT) return dm_input(p->to, e.as.input);
    if (e.op == DM_OP_IMPLICIT) return dm_node_make(p->to, &e);
    const int k = product_of(p, &e);
    if (k >= 0) {
        const dm_expr product = *dm_at(p->from, arg[k]);
        return dm_multiply_add(p->to, copy[product.as.arg[0]], copy[product.as.arg[1]],
                               copy[arg[1 - k]]);
    }
    const int operands = dm_arity(e.op);
    return dm_apply(p->to, e.op, copy[arg[0]], operands > 1 ? copy[arg[1]] : 0,
                    operands > 2 ? copy[arg[2]] : 0);
}

dm_graph *dm_contract_graph(dm_graph *g, const dm_node *roots, uint32_t m, dm_node *out) {
    const uint32_t end = dm_mark(g, roots, m);
    pass p = {.from = g, .to = dm_graph_new(g->arena, g->inputs)};
    p.uses = dm_arena_take(g->arena, (end + (size_t)1) * sizeof *p.uses);
    p.copy = dm_arena_take(g->arena, (end + (size_t)1) * sizeof *p.copy);
    if (!p.to || !p.uses || !p.copy) return NULL;
    dm_graph_verbatim(p.to, 1);
    p.to->implicits = g->implicits;
    count_uses(&p, roots, m, end);
    for (dm_node n = 0; n < end; n++) p.copy[n] = dm_is_marked(g, n) ? copy_of(&p, n) : 0;
    for (uint32_t i = 0; i < m; i++) out[i] = p.copy[roots[i]];
    return dm_graph_status(p.to) == DM_OK ? p.to : NULL;
}
