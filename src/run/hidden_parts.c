/* hidden_parts.c - which nodes of a graph may have narrow features of their own. */
#include "run/hidden.h"

#include <math.h>

/* a power of low degree */
static int is_low_power(const dm_graph *g, const dm_expr *e) {
    const dm_expr *k = dm_graph_at(g, e->as.arg[1]);
    return k->op == DM_OP_CONSTANT && k->as.value >= 0.0 && k->as.value <= 6.0 &&
           k->as.value == floor(k->as.value);
}

/* of how many unlike operands is it known that they are no polynomials? */
static int rough_operands(const dm_expr *e, const unsigned char *rough) {
    const int operands = dm_op_operands(e->op);
    int out = 0;
    for (int i = 0; i < operands; i++) {
        int again = 0;
        for (int k = 0; k < i; k++) again |= e->as.arg[k] == e->as.arg[i];
        out += rough[e->as.arg[i]] && !again;
    }
    return out;
}

uint32_t dm_hidden_parts(const dm_graph *g, dm_node *list, unsigned char *rough) {
    uint32_t count = 0;
    for (dm_node n = 0; n < dm_graph_size(g); n++) {
        const dm_expr *e = dm_graph_at(g, n);
        const int operands = rough_operands(e, rough);
        switch (e->op) {
        case DM_OP_CONSTANT:
        case DM_OP_INPUT:
            rough[n] = 0;
            continue;
        case DM_OP_NEG:
        case DM_OP_ADD:
        case DM_OP_SUB:
        case DM_OP_MUL:
        case DM_OP_FMA:
        case DM_OP_FMS:
        case DM_OP_FNMA:
            rough[n] = operands > 0;
            break;
        default:
            rough[n] = 1;
            if (e->op == DM_OP_POW && is_low_power(g, e))
                rough[n] = operands > 0;
            else
                list[count++] = n;
            continue;
        }
        if (operands > 1) list[count++] = n;
    }
    return count;
}
