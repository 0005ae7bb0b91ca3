/* simplify.c - the rules by which dm_apply makes a node. Values are kept up to rounding, for
 * operands whose products and reciprocals neither overflow nor underflow; the sign of a zero is
 * not kept. A NaN stays a NaN, with three exceptions: 0*x = 0, 0/x = 0 and x - x = 0 for any x.
 *
 * Canonical forms: constants first and folded together; a term is c*x with x free of constant
 * factors; sums hold positive coefficients (x - 2*y, not x + (-2)*y); commutative operands in
 * order of number; a/b is a * (1/b), so that reciprocals are shared. A rule looks at its
 * operands and their operands only, so that making a node costs a bounded number of look-ups;
 * what needs a wider view (like terms of long sums, common factors) is left to
 * algebra/compact.c.
 *
 * Long because it is one set of rules, whose canonical forms have to agree. */
#include "graph/nodes.h"

#include <math.h>

/* the node for an operation of a, b, c; operands that it does not have are 0 */
typedef dm_node rule(dm_graph *g, dm_node a, dm_node b, dm_node c);

enum { LARGEST_POWER = 64 }; /* whole powers up to here are multiplications */

/* a number */
static int is_constant(const dm_graph *g, dm_node n) {
    return dm_is_op(g, n, DM_OP_CONSTANT);
}

/* which one */
static double value(const dm_graph *g, dm_node n) {
    return g->nodes[n].as.value;
}

/* a commutative operation with its operands in order of number */
static dm_node ordered(dm_graph *g, dm_op op, dm_node a, dm_node b) {
    return a < b ? dm_node_plain(g, op, a, b, 0) : dm_node_plain(g, op, b, a, 0);
}

/* n = c * rest, with rest free of constant factors; c = 1 when there is none */
static double split(const dm_graph *g, dm_node n, dm_node *rest) {
    const dm_expr *e = dm_at(g, n);
    *rest = n;
    if (e->op == DM_OP_NEG) return *rest = e->as.arg[0], -1.0;
    if (e->op != DM_OP_MUL || !is_constant(g, e->as.arg[0])) return 1.0;
    *rest = e->as.arg[1];
    return value(g, e->as.arg[0]);
}

/* -(a - b) is b - a where that is there already */
static dm_node negated(dm_graph *g, dm_node x) {
    const dm_expr *e = dm_at(g, x);
    if (e->op == DM_OP_SUB) {
        const dm_expr opposite = {.op = DM_OP_SUB, .as.arg = {e->as.arg[1], e->as.arg[0]}};
        const dm_node found = dm_node_find(g, &opposite);
        if (found) return found;
    }
    return dm_node_plain(g, DM_OP_NEG, x, 0, 0);
}

/* c * n; a factor that would leave the normal range stays apart */
static dm_node scaled(dm_graph *g, double c, dm_node n) {
    dm_node rest;
    if (c == 1.0) return n;
    if (c == 0.0) return 0;
    if (is_constant(g, n)) return dm_constant(g, c * value(g, n));
    const double k = split(g, n, &rest);
    if (isnormal(c * k) || fabs(c) == 1.0 || fabs(k) == 1.0)
        c *= k;
    else
        rest = n;
    if (c == 1.0) return rest;
    if (c == -1.0) return negated(g, rest);
    return dm_node_plain(g, DM_OP_MUL, dm_constant(g, c), rest, 0);
}

/* (c1 + x) or (c1 - x) with a further constant c: c + sign * n, or 0 when n has no constant */
static dm_node shifted(dm_graph *g, double c, dm_node n, double sign) {
    const dm_expr e = *dm_at(g, n);
    if ((e.op != DM_OP_ADD && e.op != DM_OP_SUB) || !is_constant(g, e.as.arg[0])) return 0;
    const dm_node sum = dm_constant(g, c + sign * value(g, e.as.arg[0]));
    const int minus = (e.op == DM_OP_SUB) != (sign < 0.0);
    return minus ? dm_sub(g, sum, e.as.arg[1]) : dm_add(g, sum, e.as.arg[1]);
}

/* c + n */
static dm_node add_constant(dm_graph *g, double c, dm_node n) {
    dm_node rest;
    if (c == 0.0) return n;
    if (is_constant(g, n)) return dm_constant(g, c + value(g, n));
    const dm_node both = shifted(g, c, n, 1.0);
    if (both) return both;
    if (split(g, n, &rest) < 0.0) {
        const dm_node positive = scaled(g, -1.0, n);
        return dm_sub(g, dm_constant(g, c), positive);
    }
    return dm_node_plain(g, DM_OP_ADD, dm_constant(g, c), n, 0);
}

/* both are sums with a constant: (c1 + x) + sign * (c2 + y) = (c1 + sign c2) + (x + sign y) */
static int both_shifted(const dm_graph *g, dm_node a, dm_node b) {
    const dm_expr *x = dm_at(g, a), *y = dm_at(g, b);
    return x->op == DM_OP_ADD && y->op == DM_OP_ADD && is_constant(g, x->as.arg[0]) &&
           is_constant(g, y->as.arg[0]);
}

/* where(c, a, 0) + where(c, 0, b) = where(c, a, b): derivatives of branches come in such halves */
static int are_halves(const dm_graph *g, dm_node a, dm_node b) {
    const dm_expr *p = dm_at(g, a), *q = dm_at(g, b);
    if (p->op != DM_OP_WHERE || q->op != DM_OP_WHERE || p->as.arg[0] != q->as.arg[0]) return 0;
    return (!p->as.arg[1] || !q->as.arg[1]) && (!p->as.arg[2] || !q->as.arg[2]);
}

/* constants go to the front, signs out of the terms, equal terms together */
static dm_node add(dm_graph *g, dm_node a, dm_node b, dm_node c) {
    (void)c;
    dm_node x, y;
    if (is_constant(g, a)) return add_constant(g, value(g, a), b);
    if (is_constant(g, b)) return add_constant(g, value(g, b), a);
    const double ca = split(g, a, &x), cb = split(g, b, &y);
    if (x == y) return scaled(g, ca + cb, x);
    if (cb < 0.0) return dm_sub(g, a, scaled(g, -1.0, b));
    if (ca < 0.0) return dm_sub(g, b, scaled(g, -1.0, a));
    if (ca == cb && ca != 1.0) return scaled(g, ca, dm_add(g, x, y));
    if (both_shifted(g, a, b)) {
        const dm_expr p = *dm_at(g, a), q = *dm_at(g, b);
        return add_constant(g, value(g, p.as.arg[0]) + value(g, q.as.arg[0]),
                            dm_add(g, p.as.arg[1], q.as.arg[1]));
    }
    if (are_halves(g, a, b)) {
        const dm_expr p = *dm_at(g, a), q = *dm_at(g, b);
        return dm_apply(g, DM_OP_WHERE, p.as.arg[0], p.as.arg[1] ? p.as.arg[1] : q.as.arg[1],
                        p.as.arg[2] ? p.as.arg[2] : q.as.arg[2]);
    }
    return ordered(g, DM_OP_ADD, a, b);
}

/* c - n */
static dm_node subtract_from(dm_graph *g, double c, dm_node n) {
    dm_node rest;
    if (c == 0.0) return scaled(g, -1.0, n);
    if (is_constant(g, n)) return dm_constant(g, c - value(g, n));
    const dm_node both = shifted(g, c, n, -1.0);
    if (both) return both;
    if (split(g, n, &rest) < 0.0) return add_constant(g, c, scaled(g, -1.0, n));
    return dm_node_plain(g, DM_OP_SUB, dm_constant(g, c), n, 0);
}

/* as a sum; -(b - a) where b - a is there already, so that x - y and y - x are one subtraction */
static dm_node sub(dm_graph *g, dm_node a, dm_node b, dm_node c) {
    (void)c;
    dm_node x, y;
    if (a == b) return 0;
    if (is_constant(g, a)) return subtract_from(g, value(g, a), b);
    if (is_constant(g, b)) return add_constant(g, -value(g, b), a);
    const double ca = split(g, a, &x), cb = split(g, b, &y);
    if (x == y) return scaled(g, ca - cb, x);
    if (cb < 0.0) return dm_add(g, a, scaled(g, -1.0, b));
    if (ca < 0.0) return scaled(g, -1.0, dm_add(g, scaled(g, -1.0, a), b));
    if (ca == cb && ca != 1.0) return scaled(g, ca, dm_sub(g, x, y));
    if (both_shifted(g, a, b)) {
        const dm_expr p = *dm_at(g, a), q = *dm_at(g, b);
        return add_constant(g, value(g, p.as.arg[0]) - value(g, q.as.arg[0]),
                            dm_sub(g, p.as.arg[1], q.as.arg[1]));
    }
    const dm_expr opposite = {.op = DM_OP_SUB, .as.arg = {b, a}};
    const dm_node found = dm_node_find(g, &opposite);
    return found ? dm_node_plain(g, DM_OP_NEG, found, 0, 0) : dm_node_plain(g, DM_OP_SUB, a, b, 0);
}

/* x * y without constant factors: sqrt(u)^2 = u where u >= 0, |x|^2 = x^2 */
static dm_node product(dm_graph *g, dm_node x, dm_node y) {
    const dm_expr e = *dm_at(g, x);
    if (x == y && e.op == DM_OP_SQRT && g->nonnegative[e.as.arg[0]]) return e.as.arg[0];
    if (x == y && e.op == DM_OP_ABS) return dm_mul(g, e.as.arg[0], e.as.arg[0]);
    return ordered(g, DM_OP_MUL, x, y);
}

/* constants go to the front, if their product is in the normal range */
static dm_node mul(dm_graph *g, dm_node a, dm_node b, dm_node c) {
    (void)c;
    dm_node x, y;
    if (is_constant(g, a)) return scaled(g, value(g, a), b);
    if (is_constant(g, b)) return scaled(g, value(g, b), a);
    const double ca = split(g, a, &x), cb = split(g, b, &y);
    if (!isnormal(ca * cb)) return ordered(g, DM_OP_MUL, a, b);
    return scaled(g, ca * cb, product(g, x, y));
}

static dm_node whole_power(dm_graph *g, dm_node x, unsigned n);

/* 1 / x for x without constant factors */
static dm_node reciprocal(dm_graph *g, dm_node x) {
    const dm_expr e = *dm_at(g, x);
    double one;
    if (e.op == DM_OP_DIV && dm_is_constant(g, e.as.arg[0], &one) && one == 1.0) return e.as.arg[1];
    if (e.op == DM_OP_SQRT) return dm_node_plain(g, DM_OP_RSQRT, e.as.arg[0], 0, 0);
    if (e.op == DM_OP_RSQRT) return dm_node_plain(g, DM_OP_SQRT, e.as.arg[0], 0, 0);
    if (e.op != DM_OP_MUL) return dm_node_plain(g, DM_OP_DIV, dm_constant(g, 1.0), x, 0);
    const dm_expr y = *dm_at(g, e.as.arg[1]); /* a root stands behind what it is of */
    if (y.op == DM_OP_SQRT && y.as.arg[0] == e.as.arg[0])
        return whole_power(g, reciprocal(g, e.as.arg[1]), 3);
    return dm_node_plain(g, DM_OP_DIV, dm_constant(g, 1.0), x, 0);
}

/* by a constant: times its reciprocal; else times a node 1/b that others can share */
static dm_node divide(dm_graph *g, dm_node a, dm_node b, dm_node c) {
    (void)c;
    dm_node x, y;
    double numerator;
    if (a == 0) return 0;
    if (is_constant(g, b)) {
        const double inverse = 1.0 / value(g, b);
        return isnormal(inverse) ? scaled(g, inverse, a) : dm_node_plain(g, DM_OP_DIV, a, b, 0);
    }
    const double cb = split(g, b, &y);
    if (dm_is_constant(g, a, &numerator)) {
        if (!isnormal(numerator / cb)) return dm_node_plain(g, DM_OP_DIV, a, b, 0);
        return scaled(g, numerator / cb, reciprocal(g, y));
    }
    const double ca = split(g, a, &x);
    if (!isnormal(ca / cb)) return dm_node_plain(g, DM_OP_DIV, a, b, 0);
    return scaled(g, ca / cb, dm_mul(g, x, reciprocal(g, y)));
}

/* x^n by squaring; equal powers of one base are equal nodes */
static dm_node whole_power(dm_graph *g, dm_node x, unsigned n) {
    if (n == 1) return x;
    if (n % 2) return dm_mul(g, x, whole_power(g, x, n - 1));
    const dm_node root = whole_power(g, x, n / 2);
    return dm_mul(g, root, root);
}

/* x^(twice/2): a half power through sqrt, a negative one through the reciprocal */
static dm_node half_power(dm_graph *g, dm_node x, int twice) {
    if (twice == 0) return dm_constant(g, 1.0);
    const unsigned size = (unsigned)(twice < 0 ? -twice : twice);
    const dm_node root = size % 2 ? dm_apply(g, DM_OP_SQRT, x, 0, 0) : 0;
    if (twice < 0) {
        const dm_node w = dm_div(g, dm_constant(g, 1.0), root ? root : x);
        return whole_power(g, w, root ? size : size / 2);
    }
    if (size == 1) return root;
    const dm_node whole = whole_power(g, x, size / 2);
    return root ? dm_mul(g, whole, root) : whole;
}

/* whole and half exponents become products and roots, others stay */
static dm_node power(dm_graph *g, dm_node a, dm_node b, dm_node c) {
    (void)c;
    double exponent;
    if (dm_is_constant(g, b, &exponent) && fabs(exponent) <= LARGEST_POWER &&
        2.0 * exponent == floor(2.0 * exponent))
        return half_power(g, a, (int)(2.0 * exponent));
    return dm_node_plain(g, DM_OP_POW, a, b, 0);
}

/* f(-x) = -f(x), f(-x) = f(x): the sign goes out of the argument */
static dm_node with_sign(dm_graph *g, dm_op op, dm_node a, double parity) {
    dm_node rest;
    if (split(g, a, &rest) >= 0.0) return dm_node_plain(g, op, a, 0, 0);
    return scaled(g, parity, dm_node_plain(g, op, scaled(g, -1.0, a), 0, 0));
}

#define ODD(name, op)                                                                              \
    static dm_node name(dm_graph *g, dm_node a, dm_node b, dm_node c) {                            \
        (void)b, (void)c;                                                                          \
        return with_sign(g, op, a, -1.0);                                                          \
    }
#define EVEN(name, op)                                                                             \
    static dm_node name(dm_graph *g, dm_node a, dm_node b, dm_node c) {                            \
        (void)b, (void)c;                                                                          \
        return with_sign(g, op, a, 1.0);                                                           \
    }
ODD(sine, DM_OP_SIN)
EVEN(cosine, DM_OP_COS)
ODD(tangent, DM_OP_TAN)
ODD(arcsine, DM_OP_ASIN)
ODD(arctangent, DM_OP_ATAN)
ODD(sineh, DM_OP_SINH)
EVEN(cosineh, DM_OP_COSH)
ODD(tangenth, DM_OP_TANH)
ODD(sign, DM_OP_SIGN)
#undef ODD
#undef EVEN

/* the sign joins the constant factor */
static dm_node negate(dm_graph *g, dm_node a, dm_node b, dm_node c) {
    (void)b, (void)c;
    return scaled(g, -1.0, a);
}

/* |c x| = |c| |x|, and |x| = x where x >= 0 */
static dm_node absolute(dm_graph *g, dm_node a, dm_node b, dm_node c) {
    (void)b, (void)c;
    dm_node x;
    const double k = fabs(split(g, a, &x));
    const dm_node inside = g->nonnegative[x] ? x : dm_node_plain(g, DM_OP_ABS, x, 0, 0);
    return scaled(g, k, inside);
}

/* sqrt(x x) = |x| */
static dm_node root(dm_graph *g, dm_node a, dm_node b, dm_node c) {
    (void)b, (void)c;
    const dm_expr e = *dm_at(g, a);
    if (e.op == DM_OP_MUL && e.as.arg[0] == e.as.arg[1])
        return dm_apply(g, DM_OP_ABS, e.as.arg[0], 0, 0);
    return dm_node_plain(g, DM_OP_SQRT, a, 0, 0);
}

/* 1/sqrt(x x) = 1/|x| */
static dm_node reciprocal_root(dm_graph *g, dm_node a, dm_node b, dm_node c) {
    (void)b, (void)c;
    const dm_expr e = *dm_at(g, a);
    if (e.op != DM_OP_MUL || e.as.arg[0] != e.as.arg[1])
        return dm_node_plain(g, DM_OP_RSQRT, a, 0, 0);
    return reciprocal(g, dm_apply(g, DM_OP_ABS, e.as.arg[0], 0, 0));
}

/* not commutative where one operand is NaN, so the order stays */
static dm_node smaller(dm_graph *g, dm_node a, dm_node b, dm_node c) {
    (void)c;
    return a == b ? a : dm_node_plain(g, DM_OP_MIN, a, b, 0);
}

/* the same */
static dm_node larger(dm_graph *g, dm_node a, dm_node b, dm_node c) {
    (void)c;
    return a == b ? a : dm_node_plain(g, DM_OP_MAX, a, b, 0);
}

/* a branch that does not matter, or is known, is taken */
static dm_node where(dm_graph *g, dm_node a, dm_node b, dm_node c) {
    double condition;
    if (b == c) return b;
    if (dm_is_constant(g, a, &condition)) return condition > 0.0 ? b : c;
    return dm_node_plain(g, DM_OP_WHERE, a, b, c);
}

/* operations without a row are made as they stand */
static rule *const rules[DM_OP_COUNT] = {
    [DM_OP_NEG] = negate,
    [DM_OP_ABS] = absolute,
    [DM_OP_SIGN] = sign,
    [DM_OP_SQRT] = root,
    [DM_OP_SIN] = sine,
    [DM_OP_COS] = cosine,
    [DM_OP_TAN] = tangent,
    [DM_OP_ASIN] = arcsine,
    [DM_OP_ATAN] = arctangent,
    [DM_OP_SINH] = sineh,
    [DM_OP_COSH] = cosineh,
    [DM_OP_TANH] = tangenth,
    [DM_OP_ADD] = add,
    [DM_OP_SUB] = sub,
    [DM_OP_MUL] = mul,
    [DM_OP_DIV] = divide,
    [DM_OP_POW] = power,
    [DM_OP_MIN] = smaller,
    [DM_OP_RSQRT] = reciprocal_root,
    [DM_OP_MAX] = larger,
    [DM_OP_WHERE] = where,
};

/* all operands constant: the value itself */
static int fold(dm_graph *g, dm_op op, const dm_node arg[3], double *result) {
    double x[3] = {0.0, 0.0, 0.0};
    if (!is_constant(g, arg[0])) return 0;
    for (int k = 0; k < dm_arity(op); k++)
        if (!dm_is_constant(g, arg[k], x + k)) return 0;
    *result = dm_op_value(op, x[0], x[1], x[2]);
    return 1;
}

/* verbatim first: then nothing is folded, ordered or shared but equal nodes */
dm_node dm_apply(dm_graph *g, dm_op op, dm_node a, dm_node b, dm_node c) {
    double folded;
    const int count = dm_arity(op);
    const dm_node arg[3] = {a, count > 1 ? b : 0, count > 2 ? c : 0};
    if (g->status != DM_OK) return 0;
    if (g->verbatim) return dm_node_plain(g, op, arg[0], arg[1], arg[2]);
    if (fold(g, op, arg, &folded)) return dm_constant(g, folded);
    if (rules[op]) return rules[op](g, arg[0], arg[1], arg[2]);
    return dm_node_plain(g, op, arg[0], arg[1], arg[2]);
}

dm_node dm_neg(dm_graph *g, dm_node a) {
    return dm_apply(g, DM_OP_NEG, a, 0, 0);
}

dm_node dm_add(dm_graph *g, dm_node a, dm_node b) {
    return dm_apply(g, DM_OP_ADD, a, b, 0);
}

dm_node dm_sub(dm_graph *g, dm_node a, dm_node b) {
    return dm_apply(g, DM_OP_SUB, a, b, 0);
}

dm_node dm_mul(dm_graph *g, dm_node a, dm_node b) {
    return dm_apply(g, DM_OP_MUL, a, b, 0);
}

dm_node dm_div(dm_graph *g, dm_node a, dm_node b) {
    return dm_apply(g, DM_OP_DIV, a, b, 0);
}

dm_node dm_multiply_add(dm_graph *g, dm_node a, dm_node b, dm_node c) {
    return dm_apply(g, DM_OP_FMA, a, b, c);
}

dm_node dm_power(dm_graph *g, dm_node a, dm_node b) {
    return dm_apply(g, DM_OP_POW, a, b, 0);
}
