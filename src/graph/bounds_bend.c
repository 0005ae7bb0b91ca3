/* bounds_bend.c - bounds of second derivatives along a line or curve, by the chain rule. */
#include "graph/bounds.h"

#include <math.h>

static const dm_interval ALL = DM_ANYWHERE;

/* k a */
static dm_interval scaled(double k, dm_interval a) {
    return dm_interval_multiply((dm_interval){k, k}, a);
}

static dm_interval less(dm_interval a, dm_interval b) {
    return dm_interval_add(a, dm_interval_negative(b));
}

/* the second derivative of an operation with one operand a, where the value is y and the slope k */
static dm_interval curvature(dm_op op, dm_interval a, dm_interval y, dm_interval k) {
    switch (op) {
    case DM_OP_NEG:
        return (dm_interval){0.0, 0.0};
    case DM_OP_ABS:
        return a.lo > 0.0 || a.hi < 0.0 ? (dm_interval){0.0, 0.0} : ALL;
    case DM_OP_SQRT:
        return scaled(-0.5, dm_interval_divide(k, a));
    case DM_OP_RSQRT:
        return scaled(-1.5, dm_interval_divide(k, a));
    case DM_OP_RSQRT3:
        return scaled(-2.5, dm_interval_divide(k, a));
    case DM_OP_EXP:
    case DM_OP_SINH:
    case DM_OP_COSH:
        return y;
    case DM_OP_LOG:
        return dm_interval_negative(dm_interval_square(k));
    case DM_OP_SIN:
    case DM_OP_COS:
        return dm_interval_negative(y);
    case DM_OP_TAN:
        return scaled(2.0, dm_interval_multiply(y, k));
    case DM_OP_ATAN:
        return scaled(-2.0, dm_interval_multiply(a, dm_interval_square(k)));
    case DM_OP_TANH:
        return scaled(-2.0, dm_interval_multiply(y, k));
    default:
        return ALL; /* arcs, jumps, roots of equations */
    }
}

/* What an operation with two or three operands needs: of every operand and of the result. */
typedef struct {
    const dm_interval *value, *rate, *bend;
    dm_interval y, slope; /* of the result */
} line;

/* a'' b + 2 a' b' + a b'' */
static dm_interval of_product(const line *x, dm_node a, dm_node b) {
    const dm_interval mixed =
        a == b ? dm_interval_square(x->rate[a]) : dm_interval_multiply(x->rate[a], x->rate[b]);
    return dm_interval_add(dm_interval_add(dm_interval_multiply(x->bend[a], x->value[b]),
                                           dm_interval_multiply(x->value[a], x->bend[b])),
                           scaled(2.0, mixed));
}

/* y = a/b: (a'' - 2 y' b' - y b'')/b */
static dm_interval of_quotient(const line *x, dm_node a, dm_node b) {
    const dm_interval twice = scaled(2.0, dm_interval_multiply(x->slope, x->rate[b]));
    const dm_interval rest = dm_interval_multiply(x->y, x->bend[b]);
    return dm_interval_divide(less(less(x->bend[a], twice), rest), x->value[b]);
}

static int is_zero(dm_interval a) {
    return a.lo == 0.0 && a.hi == 0.0;
}

/* (a^k)'' = k a^(k-1) a'' + k (k - 1) a^(k-2) a'^2, of a k that does not move */
static dm_interval of_power(const line *x, dm_node a, dm_node b) {
    const dm_interval k = x->value[b];
    if (k.lo != k.hi || !is_zero(x->rate[b])) return ALL;
    const dm_interval first = dm_interval_power(x->value[a], (dm_interval){k.lo - 1, k.lo - 1});
    const dm_interval second = dm_interval_power(x->value[a], (dm_interval){k.lo - 2, k.lo - 2});
    const dm_interval bent = dm_interval_multiply(scaled(k.lo, first), x->bend[a]);
    const dm_interval moved = dm_interval_square(x->rate[a]);
    return dm_interval_add(bent, dm_interval_multiply(scaled(k.lo * (k.lo - 1.0), second), moved));
}

/* of the smaller, or, with -1, of the larger one; where they meet there is a corner */
static dm_interval of_extreme(const line *x, double sign_of, dm_node a, dm_node b) {
    const dm_interval d = scaled(sign_of, less(x->value[a], x->value[b]));
    return d.hi < 0.0 ? x->bend[a] : d.lo > 0.0 ? x->bend[b] : ALL;
}

static dm_interval of_more(const dm_expr *e, const line *x) {
    const dm_node a = e->as.arg[0], b = e->as.arg[1], c = e->as.arg[2];
    const dm_interval condition = x->value[a];
    switch (e->op) {
    case DM_OP_ADD:
        return dm_interval_add(x->bend[a], x->bend[b]);
    case DM_OP_SUB:
        return less(x->bend[a], x->bend[b]);
    case DM_OP_MUL:
        return of_product(x, a, b);
    case DM_OP_DIV:
        return of_quotient(x, a, b);
    case DM_OP_POW:
        return of_power(x, a, b);
    case DM_OP_MIN:
        return of_extreme(x, 1.0, a, b);
    case DM_OP_MAX:
        return of_extreme(x, -1.0, a, b);
    case DM_OP_WHERE:
        return condition.lo > 0.0 ? x->bend[b] : condition.hi <= 0.0 ? x->bend[c] : ALL;
    case DM_OP_FMA:
        return dm_interval_add(of_product(x, a, b), x->bend[c]);
    case DM_OP_FMS:
        return less(of_product(x, a, b), x->bend[c]);
    case DM_OP_FNMA:
        return less(x->bend[c], of_product(x, a, b));
    default:
        return ALL; /* angles, roots of equations */
    }
}

/* f(a)'' = f'(a) a'' + f''(a) a'^2 */
static dm_interval of_one(dm_op op, const line *x, dm_node a) {
    const dm_interval k = dm_bounds_slope(op, x->value[a], x->y);
    const dm_interval c = curvature(op, x->value[a], x->y, k);
    return dm_interval_add(dm_interval_multiply(k, x->bend[a]),
                           dm_interval_multiply(c, dm_interval_square(x->rate[a])));
}

void dm_bounds_bend(const dm_graph *g, const dm_interval *bend_in, const dm_interval *value,
                    const dm_interval *rate, dm_interval *bend) {
    const uint32_t size = dm_graph_size(g);
    for (dm_node n = 0; n < size; n++) {
        const dm_expr *e = dm_graph_at(g, n);
        const line x = {value, rate, bend, value[n], rate[n]};
        const int operands = dm_op_operands(e->op);
        if (e->op == DM_OP_INPUT && bend_in)
            bend[n] = bend_in[e->as.input];
        else if (!operands)
            bend[n] = (dm_interval){0.0, 0.0};
        else if (operands == 1)
            bend[n] = of_one(e->op, &x, e->as.arg[0]);
        else
            bend[n] = of_more(e, &x);
    }
}
