#include "graph/bounds.h"

#include <math.h>

static const dm_interval ALL = DM_ANYWHERE;

/* a b; operands that are the same node are one number */
static dm_interval product_of(const dm_expr *e, const dm_interval *value) {
    const dm_node a = e->as.arg[0], b = e->as.arg[1];
    return a == b ? dm_interval_square(value[a]) : dm_interval_multiply(value[a], value[b]);
}

/* An operation with two or three operands. */
static dm_interval of_more(const dm_expr *e, const dm_interval *value) {
    const dm_interval a = value[e->as.arg[0]], b = value[e->as.arg[1]], c = value[e->as.arg[2]];
    switch (e->op) {
    case DM_OP_ADD:
        return dm_interval_add(a, b);
    case DM_OP_SUB:
        return dm_interval_add(a, dm_interval_negative(b));
    case DM_OP_MUL:
        return product_of(e, value);
    case DM_OP_DIV:
        return dm_interval_divide(a, b);
    case DM_OP_POW:
        return dm_interval_power(a, b);
    case DM_OP_ATAN2:
        return dm_interval_angle(a, b);
    case DM_OP_MIN:
        return (dm_interval){fmin(a.lo, b.lo), fmin(a.hi, b.hi)};
    case DM_OP_MAX:
        return (dm_interval){fmax(a.lo, b.lo), fmax(a.hi, b.hi)};
    case DM_OP_WHERE:
        return dm_interval_either(a, b, c);
    case DM_OP_FMA:
        return dm_interval_add(product_of(e, value), c);
    case DM_OP_FMS:
        return dm_interval_add(product_of(e, value), dm_interval_negative(c));
    case DM_OP_FNMA:
        return dm_interval_add(dm_interval_negative(product_of(e, value)), c);
    default:
        return ALL; /* roots of equations */
    }
}

void dm_bounds(const dm_graph *g, const dm_interval *in, dm_interval *value) {
    const uint32_t size = dm_graph_size(g);
    for (dm_node n = 0; n < size; n++) {
        const dm_expr *e = dm_graph_at(g, n);
        const int operands = dm_op_operands(e->op);
        if (e->op == DM_OP_CONSTANT)
            value[n] = isnan(e->as.value) ? ALL : (dm_interval){e->as.value, e->as.value};
        else if (e->op == DM_OP_INPUT)
            value[n] = in[e->as.input];
        else if (!operands)
            value[n] = ALL; /* the number of a function that only an equation defines */
        else
            value[n] =
                operands == 1 ? dm_interval_of(e->op, value[e->as.arg[0]]) : of_more(e, value);
    }
}

/* ---- rates ---- */

/* k a */
static dm_interval scaled(double k, dm_interval a) {
    return dm_interval_multiply((dm_interval){k, k}, a);
}

/* 1 + a */
static dm_interval plus_one(dm_interval a) {
    return dm_interval_add((dm_interval){1.0, 1.0}, a);
}

dm_interval dm_bounds_slope(dm_op op, dm_interval a, dm_interval y) {
    switch (op) {
    case DM_OP_NEG:
        return (dm_interval){-1.0, -1.0};
    case DM_OP_ABS:
        return (dm_interval){a.lo >= 0.0 ? 1.0 : -1.0, a.hi <= 0.0 ? -1.0 : 1.0};
    case DM_OP_SQRT:
        return dm_interval_divide((dm_interval){0.5, 0.5}, y);
    case DM_OP_RSQRT:
        return scaled(-0.5, dm_interval_divide(y, a));
    case DM_OP_RSQRT3:
        return scaled(-1.5, dm_interval_divide(y, a));
    case DM_OP_EXP:
        return y;
    case DM_OP_LOG:
        return dm_interval_reciprocal(a);
    case DM_OP_SIN:
        return dm_interval_of(DM_OP_COS, a);
    case DM_OP_COS:
        return dm_interval_negative(dm_interval_of(DM_OP_SIN, a));
    case DM_OP_TAN:
        return plus_one(dm_interval_square(y));
    case DM_OP_ATAN:
        return dm_interval_reciprocal(plus_one(dm_interval_square(a)));
    case DM_OP_SINH:
        return dm_interval_of(DM_OP_COSH, a);
    case DM_OP_COSH:
        return dm_interval_of(DM_OP_SINH, a);
    case DM_OP_TANH:
        return plus_one(dm_interval_negative(dm_interval_square(y)));
    default:
        return ALL; /* arcs, jumps, roots of equations */
    }
}

/* a' b + a b' */
static dm_interval of_product(const dm_interval *value, const dm_interval *rate, dm_node a,
                              dm_node b) {
    return dm_interval_add(dm_interval_multiply(rate[a], value[b]),
                           dm_interval_multiply(value[a], rate[b]));
}

/* (a^k)' = k a^(k-1) a', of a k that does not move */
static dm_interval of_power(dm_interval a, dm_interval k, dm_interval rate_a, dm_interval rate_k) {
    if (k.lo != k.hi || rate_k.lo != 0.0 || rate_k.hi != 0.0) return ALL;
    const dm_interval less = {k.lo - 1.0, k.lo - 1.0};
    return dm_interval_multiply(scaled(k.lo, dm_interval_power(a, less)), rate_a);
}

/* the hull of two */
static dm_interval both(dm_interval a, dm_interval b) {
    return (dm_interval){fmin(a.lo, b.lo), fmax(a.hi, b.hi)};
}

/* of the smaller, or, with -1, of the larger one */
static dm_interval of_extreme(double sign_of, dm_interval a, dm_interval b, dm_interval rate_a,
                              dm_interval rate_b) {
    const dm_interval d = scaled(sign_of, dm_interval_add(a, dm_interval_negative(b)));
    return d.hi < 0.0 ? rate_a : d.lo > 0.0 ? rate_b : both(rate_a, rate_b);
}

/* The chain rule for two or three operands; y is the value. */
static dm_interval rate_of_more(const dm_expr *e, dm_interval y, const dm_interval *value,
                                const dm_interval *rate) {
    const dm_node a = e->as.arg[0], b = e->as.arg[1], c = e->as.arg[2];
    const dm_interval condition = value[a];
    switch (e->op) {
    case DM_OP_ADD:
        return dm_interval_add(rate[a], rate[b]);
    case DM_OP_SUB:
        return dm_interval_add(rate[a], dm_interval_negative(rate[b]));
    case DM_OP_MUL:
        return of_product(value, rate, a, b);
    case DM_OP_DIV:
        return dm_interval_divide(dm_interval_add(rate[a], dm_interval_negative(
                                                               dm_interval_multiply(y, rate[b]))),
                                  value[b]);
    case DM_OP_POW:
        return of_power(value[a], value[b], rate[a], rate[b]);
    case DM_OP_MIN:
        return of_extreme(1.0, value[a], value[b], rate[a], rate[b]);
    case DM_OP_MAX:
        return of_extreme(-1.0, value[a], value[b], rate[a], rate[b]);
    case DM_OP_WHERE:
        return condition.lo > 0.0 ? rate[b] : condition.hi <= 0.0 ? rate[c] : ALL;
    case DM_OP_FMA:
        return dm_interval_add(of_product(value, rate, a, b), rate[c]);
    case DM_OP_FMS:
        return dm_interval_add(of_product(value, rate, a, b), dm_interval_negative(rate[c]));
    case DM_OP_FNMA:
        return dm_interval_add(dm_interval_negative(of_product(value, rate, a, b)), rate[c]);
    default:
        return ALL; /* angles, roots of equations */
    }
}

void dm_bounds_rate(const dm_graph *g, const dm_interval *rate_in, const dm_interval *value,
                    dm_interval *rate) {
    const uint32_t size = dm_graph_size(g);
    for (dm_node n = 0; n < size; n++) {
        const dm_expr *e = dm_graph_at(g, n);
        const int operands = dm_op_operands(e->op);
        if (e->op == DM_OP_INPUT)
            rate[n] = rate_in[e->as.input];
        else if (!operands)
            rate[n] = (dm_interval){0.0, 0.0};
        else if (operands == 1)
            rate[n] = dm_interval_multiply(dm_bounds_slope(e->op, value[e->as.arg[0]], value[n]),
                                           rate[e->as.arg[0]]);
        else
            rate[n] = rate_of_more(e, value[n], value, rate);
    }
}

/* ---- weights ---- */

static double largest_of(dm_interval a) {
    return fmax(fabs(a.lo), fabs(a.hi));
}

/* how far an interval stays away from 0 */
static double least_of(dm_interval a) {
    return a.lo > 0.0 ? a.lo : a.hi < 0.0 ? -a.hi : 0.0;
}

/* what is weighed by nothing counts for nothing, however large */
static double weighed(double w, double k) {
    return w == 0.0 || k == 0.0 ? 0.0 : w * k;
}

static double weight_of_power(dm_interval a, dm_interval k) {
    if (k.lo != k.hi) return INFINITY;
    return fabs(k.lo) * largest_of(dm_interval_power(a, (dm_interval){k.lo - 1.0, k.lo - 1.0}));
}

/* slopes[3]: the largest |de/d operand| of an operation with two or three operands, its value y */
static void largest_slopes(const dm_expr *e, dm_interval y, const dm_interval *value,
                           double slopes[3]) {
    const dm_interval a = value[e->as.arg[0]], b = value[e->as.arg[1]];
    slopes[0] = slopes[1] = slopes[2] = 1.0;
    switch (e->op) {
    case DM_OP_ADD:
    case DM_OP_SUB:
    case DM_OP_MIN:
    case DM_OP_MAX:
        return;
    case DM_OP_MUL:
    case DM_OP_FMA:
    case DM_OP_FMS:
    case DM_OP_FNMA:
        slopes[0] = largest_of(b), slopes[1] = largest_of(a);
        return;
    case DM_OP_DIV:
        slopes[0] = 1.0 / least_of(b), slopes[1] = weighed(largest_of(y), slopes[0]);
        return;
    case DM_OP_POW:
        slopes[0] = weight_of_power(a, b), slopes[1] = INFINITY;
        return;
    case DM_OP_ATAN2:
        slopes[0] = slopes[1] = 1.0 / hypot(least_of(a), least_of(b));
        return;
    case DM_OP_WHERE:
        slopes[0] = a.lo > 0.0 || a.hi <= 0.0 ? 0.0 : INFINITY;
        slopes[1] = a.hi > 0.0, slopes[2] = a.lo <= 0.0;
        return;
    default: /* roots of equations */
        slopes[0] = slopes[1] = slopes[2] = INFINITY;
    }
}

void dm_bounds_weight(const dm_graph *g, const dm_interval *value, double *weight) {
    for (dm_node n = dm_graph_size(g); n-- > 0;) {
        const dm_expr *e = dm_graph_at(g, n);
        const int operands = dm_op_operands(e->op);
        if (!operands || weight[n] == 0.0) continue;
        double slopes[3];
        if (operands == 1)
            slopes[0] = largest_of(dm_bounds_slope(e->op, value[e->as.arg[0]], value[n]));
        else
            largest_slopes(e, value[n], value, slopes);
        for (int i = 0; i < operands; i++) weight[e->as.arg[i]] += weighed(weight[n], slopes[i]);
    }
}
