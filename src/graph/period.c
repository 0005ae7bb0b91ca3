#include "graph/period.h"

#include <math.h>

/* How a node depends on an input: not at all, with its period, as a whole multiple of it beside
 * what does not depend on it, or in another way. */
enum { CONSTANT, PERIODIC, MULTIPLE, OTHER };

static int is_whole(const dm_expr *e) {
    return e->op == DM_OP_CONSTANT && e->as.value == floor(e->as.value);
}

/* Of a sum: a multiple and something periodic make neither. */
static unsigned char of_sum(unsigned char a, unsigned char b) {
    const unsigned char most = a > b ? a : b, least = a > b ? b : a;
    return most == MULTIPLE && least == PERIODIC ? OTHER : most;
}

static unsigned char of_product(const dm_graph *g, const dm_expr *e, const unsigned char *kind) {
    const dm_node a = e->as.arg[0], b = e->as.arg[1];
    const unsigned char most = kind[a] > kind[b] ? kind[a] : kind[b];
    if (most != MULTIPLE) return most;
    const dm_node other = kind[a] == MULTIPLE ? b : a;
    return is_whole(dm_graph_at(g, other)) ? MULTIPLE : OTHER;
}

static unsigned char of_operation(const dm_graph *g, const dm_expr *e, const unsigned char *kind) {
    unsigned char most = CONSTANT;
    for (int i = 0; i < dm_op_operands(e->op); i++)
        if (kind[e->as.arg[i]] > most) most = kind[e->as.arg[i]];
    if (most != MULTIPLE) return most;
    switch (e->op) {
    case DM_OP_NEG:
        return MULTIPLE;
    case DM_OP_ADD:
    case DM_OP_SUB:
        return of_sum(kind[e->as.arg[0]], kind[e->as.arg[1]]);
    case DM_OP_MUL:
        return of_product(g, e, kind);
    case DM_OP_SIN:
    case DM_OP_COS:
    case DM_OP_TAN:
        return PERIODIC;
    default:
        return OTHER;
    }
}

int dm_has_period(const dm_graph *g, const unsigned char *roots, uint32_t input,
                  unsigned char *scratch) {
    const uint32_t size = dm_graph_size(g);
    int depends = 0;
    for (dm_node n = 0; n < size; n++) {
        const dm_expr *e = dm_graph_at(g, n);
        if (e->op == DM_OP_INPUT)
            scratch[n] = e->as.input == input ? MULTIPLE : CONSTANT;
        else
            scratch[n] = dm_op_operands(e->op) ? of_operation(g, e, scratch) : CONSTANT;
        if (!roots[n]) continue;
        if (scratch[n] > PERIODIC) return 0;
        depends |= scratch[n] == PERIODIC;
    }
    return depends;
}
