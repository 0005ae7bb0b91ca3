/* derive_rules.c - the local rules of derivatives: what operand k of a node gets of df/dn, or
 * gives to dn/dx. Results reuse the node itself where they can: d sqrt(u) = du / (2 sqrt(u)). A
 * branch that is not taken adds nothing, even where its derivative is not finite: 0 * NaN would
 * be NaN, so zeros under a condition stay under it (dm_derive_join, dm_derive_times). */
#include "algebra/derive_inside.h"
#include "graph/nodes.h"

#include <math.h>

/* small pieces of the rules below */
static dm_node one(dm_graph *g) {
    return dm_constant(g, 1.0);
}

static dm_node half(dm_graph *g, dm_node a) {
    const dm_node c = dm_constant(g, 0.5);
    return dm_mul(g, c, a);
}

static dm_node one_plus(dm_graph *g, dm_node a) {
    return dm_add(g, one(g), a);
}

static dm_node square(dm_graph *g, dm_node a) {
    return dm_mul(g, a, a);
}

static dm_node inverse(dm_graph *g, dm_node a) {
    return dm_div(g, one(g), a);
}

/* a + b for derivatives: what stands under the same condition stays together, so that the side
 * that is not taken stays zero */
dm_node dm_derive_join(dm_graph *g, dm_node a, dm_node b) {
    const dm_expr x = *dm_at(g, a), y = *dm_at(g, b);
    if (!a || !b) return a ? a : b;
    if (x.op != DM_OP_WHERE || y.op != DM_OP_WHERE || x.as.arg[0] != y.as.arg[0])
        return dm_add(g, a, b);
    const dm_node yes = dm_derive_join(g, x.as.arg[1], y.as.arg[1]);
    const dm_node no = dm_derive_join(g, x.as.arg[2], y.as.arg[2]);
    return dm_apply(g, DM_OP_WHERE, x.as.arg[0], yes, no);
}

enum { DEEPEST_BRANCH = 12 };

/* can branches make n zero, however deep they stand in it? */
static int vanishes(const dm_graph *g, dm_node n, int depth) {
    const dm_expr *e = dm_at(g, n);
    if (n == 0) return 1;
    if (depth == 0) return 0;
    if (e->op == DM_OP_WHERE)
        return vanishes(g, e->as.arg[1], depth - 1) || vanishes(g, e->as.arg[2], depth - 1);
    return e->op == DM_OP_ADD && vanishes(g, e->as.arg[0], depth - 1) &&
           vanishes(g, e->as.arg[1], depth - 1);
}

/* factor * slope; a factor that a branch makes zero stays zero whatever the slope is */
dm_node dm_derive_times(dm_graph *g, dm_node factor, dm_node slope) {
    const dm_expr e = *dm_at(g, factor);
    if (factor == 0) return 0;
    if (!vanishes(g, factor, DEEPEST_BRANCH)) return dm_mul(g, factor, slope);
    const int is_sum = e.op == DM_OP_ADD;
    const dm_node first = dm_derive_times(g, e.as.arg[is_sum ? 0 : 1], slope);
    const dm_node second = dm_derive_times(g, e.as.arg[is_sum ? 1 : 2], slope);
    return is_sum ? dm_derive_join(g, first, second)
                  : dm_apply(g, DM_OP_WHERE, e.as.arg[0], first, second);
}

/* 1 / sqrt(1 - a^2) */
static dm_node arcsine_slope(dm_graph *g, dm_node a) {
    const dm_node a2 = square(g, a), u = dm_sub(g, one(g), a2);
    return inverse(g, dm_apply(g, DM_OP_SQRT, u, 0, 0));
}

/* d a^b / da = b a^(b-1); d a^b / db = a^b log(a), which is 0 at a = 0 for b > 0 */
static dm_node power_slope(dm_graph *g, dm_node n, int k) {
    const dm_node a = dm_at(g, n)->as.arg[0], b = dm_at(g, n)->as.arg[1];
    if (k == 0) return dm_mul(g, b, dm_power(g, a, dm_sub(g, b, one(g))));
    const dm_node size = dm_apply(g, DM_OP_ABS, a, 0, 0);
    const dm_node safe = dm_apply(g, DM_OP_WHERE, size, a, one(g));
    return dm_mul(g, n, dm_apply(g, DM_OP_LOG, safe, 0, 0));
}

/* d log(a) = da / a where a is in the domain; outside it stays without a value, or Newton's
 * method would find roots there, and explicit steps go on behind the wall of log(a) */
static dm_node log_slope(dm_graph *g, dm_node a) {
    const dm_node w = inverse(g, a);
    return g->nonnegative[a] ? w : dm_apply(g, DM_OP_WHERE, a, w, dm_constant(g, NAN));
}

/* d atan2(y, x) = (x dy - y dx) / (x^2 + y^2) */
static dm_node angle_slope(dm_graph *g, dm_node y, dm_node x, int k) {
    const dm_node x2 = square(g, x), y2 = square(g, y);
    const dm_node w = inverse(g, dm_add(g, x2, y2));
    return k == 0 ? dm_mul(g, x, w) : dm_neg(g, dm_mul(g, y, w));
}

/* d (a/b) / da = 1/b, d (a/b) / db = -(a/b) / b */
static dm_node quotient_slope(dm_graph *g, dm_node n, int k) {
    const dm_node w = inverse(g, dm_at(g, n)->as.arg[1]);
    return k == 0 ? w : dm_neg(g, dm_mul(g, n, w));
}

/* dn / d(operand k) for operations of one operand */
static dm_node slope1(dm_graph *g, dm_node n) {
    const dm_expr e = *dm_at(g, n);
    const dm_node a = e.as.arg[0];
    switch (e.op) {
    case DM_OP_NEG:
        return dm_constant(g, -1.0);
    case DM_OP_ABS:
        return dm_apply(g, DM_OP_SIGN, a, 0, 0);
    case DM_OP_SQRT:
        return half(g, inverse(g, n));
    case DM_OP_RSQRT:
        return dm_neg(g, half(g, dm_mul(g, n, square(g, n))));
    case DM_OP_RSQRT3: /* -3/2 n / a */
        return dm_mul(g, dm_mul(g, dm_constant(g, -1.5), n),
                      square(g, dm_apply(g, DM_OP_RSQRT, a, 0, 0)));
    case DM_OP_EXP:
        return n;
    case DM_OP_LOG:
        return log_slope(g, a);
    case DM_OP_SIN:
        return dm_apply(g, DM_OP_COS, a, 0, 0);
    case DM_OP_COS:
        return dm_neg(g, dm_apply(g, DM_OP_SIN, a, 0, 0));
    case DM_OP_TAN:
        return one_plus(g, square(g, n));
    case DM_OP_ASIN:
        return arcsine_slope(g, a);
    case DM_OP_ACOS:
        return dm_neg(g, arcsine_slope(g, a));
    case DM_OP_ATAN:
        return inverse(g, one_plus(g, square(g, a)));
    case DM_OP_SINH:
        return dm_apply(g, DM_OP_COSH, a, 0, 0);
    case DM_OP_COSH:
        return dm_apply(g, DM_OP_SINH, a, 0, 0);
    case DM_OP_TANH:
        return one_plus(g, dm_neg(g, square(g, n)));
    default:
        return 0; /* sign: constant but for its jump */
    }
}

/* dn / d(operand k), for all operations but those that choose */
static dm_node slope(dm_graph *g, dm_node n, int k) {
    const dm_expr e = *dm_at(g, n);
    switch (e.op) {
    case DM_OP_ADD:
        return one(g);
    case DM_OP_SUB:
        return dm_constant(g, k == 0 ? 1.0 : -1.0);
    case DM_OP_MUL:
        return e.as.arg[1 - k];
    case DM_OP_FMA:
        return k == 2 ? one(g) : e.as.arg[1 - k];
    case DM_OP_FMS:
        return k == 2 ? dm_constant(g, -1.0) : e.as.arg[1 - k];
    case DM_OP_FNMA:
        return k == 2 ? one(g) : dm_neg(g, e.as.arg[1 - k]);
    case DM_OP_DIV:
        return quotient_slope(g, n, k);
    case DM_OP_POW:
        return power_slope(g, n, k);
    case DM_OP_ATAN2:
        return angle_slope(g, e.as.arg[0], e.as.arg[1], k);
    default:
        return slope1(g, n);
    }
}

/* which operand min, max and where give: where(condition, yes, no) */
typedef struct {
    dm_node condition;
    int yes, no; /* numbers of the operands */
} choice;

/* min(a, b) is b where a - b > 0; max(a, b) is b where b - a > 0 */
static int is_choice(dm_graph *g, dm_node n, choice *out) {
    const dm_expr e = *dm_at(g, n);
    const dm_node a = e.as.arg[0], b = e.as.arg[1];
    if (e.op == DM_OP_MIN)
        *out = (choice){dm_sub(g, a, b), 1, 0};
    else if (e.op == DM_OP_MAX)
        *out = (choice){dm_sub(g, b, a), 1, 0};
    else if (e.op == DM_OP_WHERE)
        *out = (choice){a, 1, 2};
    else
        return 0;
    return 1;
}

/* whose operands get the derivative as it is, or negated */
static int is_sum(dm_op op) {
    return op == DM_OP_ADD || op == DM_OP_SUB;
}

/* what a branch adds to the derivative of the other one: nothing, but no value where it is none */
static dm_node rest(dm_graph *g, dm_node n, int k) {
    const dm_expr *other = dm_at(g, dm_at(g, n)->as.arg[k]);
    return other->op == DM_OP_CONSTANT && isnan(other->as.value) ? dm_constant(g, NAN) : 0;
}

/* what operand k gets of, or gives to, a derivative `factor` at n */
dm_node dm_derive_share(dm_graph *g, dm_node n, int k, dm_node factor) {
    choice c;
    const dm_op op = dm_at(g, n)->op;
    if (factor == 0) return 0;
    if (is_sum(op) && !vanishes(g, factor, DEEPEST_BRANCH))
        return op == DM_OP_SUB && k == 1 ? dm_neg(g, factor) : factor;
    if (!is_choice(g, n, &c)) return dm_derive_times(g, factor, slope(g, n, k));
    if (k == c.yes) return dm_apply(g, DM_OP_WHERE, c.condition, factor, rest(g, n, c.no));
    return k == c.no ? dm_apply(g, DM_OP_WHERE, c.condition, rest(g, n, c.yes), factor) : 0;
}

/* what is taken away need not be negated first, nor a square looked at twice: all squares of a
 * sum share 2 factor */
dm_node dm_derive_pass(dm_graph *g, dm_node n, int k, dm_node factor, dm_node held) {
    const dm_expr e = *dm_at(g, n);
    const int square = e.op == DM_OP_MUL && e.as.arg[0] == e.as.arg[1];
    const int minus = e.op == DM_OP_SUB && k == 1 && held;
    if ((!square && !minus) || vanishes(g, factor, DEEPEST_BRANCH))
        return dm_derive_join(g, held, dm_derive_share(g, n, k, factor));
    if (minus) return dm_sub(g, held, factor);
    if (k == 1) return held;
    return dm_derive_join(g, held, dm_mul(g, dm_add(g, factor, factor), e.as.arg[0]));
}
