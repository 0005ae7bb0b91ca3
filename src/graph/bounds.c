#include "graph/bounds.h"

#include <float.h>
#include <math.h>

static const double PI = 3.14159265358979323846;
static const dm_interval ALL = {-INFINITY, INFINITY};
enum { ROUNDED = 1, COMPUTED = 4 }; /* errors of an operation in its last place, at most */

/* x less some units of the last place */
static double below(double x, int units) {
    return isinf(x) ? (x > 0.0 ? DBL_MAX : x) : x - (units * DBL_EPSILON * fabs(x) + 5e-324);
}

static double above(double x, int units) {
    return -below(-x, units);
}

/* outwards by so many units; what is no number is anywhere */
static dm_interval widened(double lo, double hi, int units) {
    if (isnan(lo) || isnan(hi)) return ALL;
    return (dm_interval){below(lo, units), above(hi, units)};
}

static double least(const double *x, int count) {
    double out = x[0];
    for (int i = 1; i < count; i++) out = isnan(x[i]) ? -INFINITY : fmin(out, x[i]);
    return out;
}

static double largest(const double *x, int count) {
    double out = x[0];
    for (int i = 1; i < count; i++) out = isnan(x[i]) ? INFINITY : fmax(out, x[i]);
    return out;
}

/* the hull of some numbers, rounded outwards */
static dm_interval hull(const double *x, int count, int units) {
    return widened(least(x, count), largest(x, count), units);
}

static int is_point(dm_interval a) {
    return a.lo == a.hi;
}

/* ---- arithmetic ---- */

static dm_interval add(dm_interval a, dm_interval b) {
    return widened(a.lo + b.lo, a.hi + b.hi, ROUNDED);
}

static dm_interval negative(dm_interval a) {
    return (dm_interval){-a.hi, -a.lo};
}

/* an end that is zero stays zero, however large the other factor */
static double product(double x, double y) {
    return x == 0.0 || y == 0.0 ? 0.0 : x * y;
}

static dm_interval multiply(dm_interval a, dm_interval b) {
    const double x[4] = {product(a.lo, b.lo), product(a.lo, b.hi), product(a.hi, b.lo),
                         product(a.hi, b.hi)};
    dm_interval out = hull(x, 4, ROUNDED);
    /* a product of numbers that are not negative is none */
    if (least(x, 4) >= 0.0) out.lo = fmax(out.lo, 0.0);
    if (largest(x, 4) <= 0.0) out.hi = fmin(out.hi, 0.0);
    return out;
}

static dm_interval absolute(dm_interval a) {
    if (a.lo >= 0.0) return a;
    if (a.hi <= 0.0) return negative(a);
    return (dm_interval){0.0, fmax(-a.lo, a.hi)};
}

static dm_interval square(dm_interval a) {
    const dm_interval b = absolute(a);
    return multiply(b, b);
}

static dm_interval reciprocal(dm_interval a) {
    if (a.lo < 0.0 && a.hi > 0.0) return ALL;
    if (a.lo == 0.0 && a.hi == 0.0) return ALL;
    if (a.lo == 0.0) return (dm_interval){below(1.0 / a.hi, ROUNDED), INFINITY};
    if (a.hi == 0.0) return (dm_interval){-INFINITY, above(1.0 / a.lo, ROUNDED)};
    return widened(1.0 / a.hi, 1.0 / a.lo, ROUNDED);
}

static dm_interval divide(dm_interval a, dm_interval b) {
    const double x[4] = {a.lo / b.lo, a.lo / b.hi, a.hi / b.lo, a.hi / b.hi};
    if (b.lo <= 0.0 && b.hi >= 0.0) return multiply(a, reciprocal(b));
    return hull(x, 4, ROUNDED);
}

/* ---- functions ---- */

typedef double function(double);

static dm_interval rising(function *f, dm_interval a) {
    return widened(f(a.lo), f(a.hi), COMPUTED);
}

static dm_interval falling(function *f, dm_interval a) {
    return widened(f(a.hi), f(a.lo), COMPUTED);
}

/* between `lo` and `hi`, which the function never leaves */
static dm_interval cut(dm_interval a, double lo, double hi) {
    return (dm_interval){fmax(a.lo, lo), fmin(a.hi, hi)};
}

static double cube_of_root(double x) {
    return 1.0 / (x * sqrt(x));
}

static double root_of_inverse(double x) {
    return 1.0 / sqrt(x);
}

/* x^(-1/2), x^(-3/2): falling where x > 0 */
static dm_interval inverse_root(function *f, dm_interval a) {
    if (a.lo < 0.0 || a.hi == 0.0) return ALL;
    if (a.lo > 0.0) return cut(falling(f, a), 0.0, INFINITY);
    return (dm_interval){fmax(0.0, below(f(a.hi), COMPUTED)), INFINITY};
}

/* is offset + period k in a, for some whole k? A little more is taken for it */
static int meets(dm_interval a, double offset, double period) {
    const double slack = 4.0 * DBL_EPSILON * (fabs(a.lo) + fabs(a.hi) + 1.0);
    return floor((a.hi + slack - offset) / period) >= ceil((a.lo - slack - offset) / period);
}

/* cos(x - shift) of a: extremes are at shift + pi k */
static dm_interval wave(function *f, dm_interval a, double shift) {
    const double x[2] = {f(a.lo), f(a.hi)};
    enum { FAR = 1 << 30 };
    if (!(a.hi - a.lo < 2.0 * PI) || fabs(a.lo) > FAR || fabs(a.hi) > FAR)
        return is_point(a) && isfinite(a.lo) ? hull(x, 1, COMPUTED) : (dm_interval){-1.0, 1.0};
    dm_interval out = hull(x, 2, COMPUTED);
    if (meets(a, shift, 2.0 * PI)) out.hi = 1.0;
    if (meets(a, shift + PI, 2.0 * PI)) out.lo = -1.0;
    return cut(out, -1.0, 1.0);
}

static dm_interval tangent(dm_interval a) {
    if (!(a.hi - a.lo < PI) || meets(a, 0.5 * PI, PI)) return ALL;
    return rising(tan, a);
}

static dm_interval hyperbolic_cosine(dm_interval a) {
    return cut(rising(cosh, absolute(a)), 1.0, INFINITY);
}

static dm_interval logarithm(dm_interval a) {
    if (a.lo < 0.0 || a.hi == 0.0) return ALL;
    return rising(log, a);
}

static dm_interval arc(dm_interval a, int cosine) {
    if (a.lo < -1.0 || a.hi > 1.0) return ALL;
    return cosine ? cut(falling(acos, a), 0.0, 2.0 * PI) : rising(asin, a);
}

/* the angle of (x, y): extreme at corners, but across the cut */
static dm_interval angle(dm_interval y, dm_interval x) {
    const double c[4] = {atan2(y.lo, x.lo), atan2(y.lo, x.hi), atan2(y.hi, x.lo),
                         atan2(y.hi, x.hi)};
    if (x.lo <= 0.0 && y.lo <= 0.0 && y.hi >= 0.0)
        return (dm_interval){-above(PI, COMPUTED), above(PI, COMPUTED)};
    return hull(c, 4, COMPUTED);
}

/* a^k of whole k */
static dm_interval whole_power(dm_interval a, double k) {
    const int even = fmod(k, 2.0) == 0.0;
    if (k == 0.0) return (dm_interval){1.0, 1.0};
    if (k < 0.0) return reciprocal(whole_power(a, -k));
    const dm_interval b = even ? absolute(a) : a;
    dm_interval out = widened(pow(b.lo, k), pow(b.hi, k), COMPUTED);
    if (b.lo >= 0.0) out.lo = fmax(out.lo, 0.0);
    return out;
}

/* of a > 0 extreme at corners, as it is monotonic in each */
static dm_interval power(dm_interval a, dm_interval k) {
    const double c[4] = {pow(a.lo, k.lo), pow(a.lo, k.hi), pow(a.hi, k.lo), pow(a.hi, k.hi)};
    if (is_point(k) && k.lo == floor(k.lo)) return whole_power(a, k.lo);
    if (a.lo < 0.0 || (a.lo == 0.0 && k.lo <= 0.0)) return ALL;
    return cut(hull(c, 4, COMPUTED), 0.0, INFINITY);
}

static dm_interval either(dm_interval condition, dm_interval yes, dm_interval no) {
    if (condition.lo > 0.0) return yes;
    if (condition.hi <= 0.0) return no;
    return (dm_interval){fmin(yes.lo, no.lo), fmax(yes.hi, no.hi)};
}

static dm_interval sign(dm_interval a) {
    return (dm_interval){(double)((a.lo > 0.0) - (a.lo < 0.0)),
                         (double)((a.hi > 0.0) - (a.hi < 0.0))};
}

/* ---- nodes ---- */

static dm_interval of_one(dm_op op, dm_interval a) {
    switch (op) {
    case DM_OP_NEG:
        return negative(a);
    case DM_OP_ABS:
        return absolute(a);
    case DM_OP_SIGN:
        return sign(a);
    case DM_OP_SQRT:
        return a.lo < 0.0 ? ALL : cut(rising(sqrt, a), 0.0, INFINITY);
    case DM_OP_RSQRT:
        return inverse_root(root_of_inverse, a);
    case DM_OP_RSQRT3:
        return inverse_root(cube_of_root, a);
    case DM_OP_EXP:
        return cut(rising(exp, a), 0.0, INFINITY);
    case DM_OP_LOG:
        return logarithm(a);
    case DM_OP_SIN:
        return wave(sin, a, 0.5 * PI);
    case DM_OP_COS:
        return wave(cos, a, 0.0);
    case DM_OP_TAN:
        return tangent(a);
    case DM_OP_ASIN:
        return arc(a, 0);
    case DM_OP_ACOS:
        return arc(a, 1);
    case DM_OP_ATAN:
        return rising(atan, a);
    case DM_OP_SINH:
        return rising(sinh, a);
    case DM_OP_COSH:
        return hyperbolic_cosine(a);
    case DM_OP_TANH:
        return cut(rising(tanh, a), -1.0, 1.0);
    default:
        return ALL; /* roots of equations */
    }
}

static dm_interval of_more(const dm_expr *e, const dm_interval *value) {
    const dm_interval a = value[e->as.arg[0]], b = value[e->as.arg[1]], c = value[e->as.arg[2]];
    const int same = e->as.arg[0] == e->as.arg[1];
    const dm_interval ab = same ? square(a) : multiply(a, b);
    switch (e->op) {
    case DM_OP_ADD:
        return add(a, b);
    case DM_OP_SUB:
        return add(a, negative(b));
    case DM_OP_MUL:
        return ab;
    case DM_OP_DIV:
        return divide(a, b);
    case DM_OP_POW:
        return power(a, b);
    case DM_OP_ATAN2:
        return angle(a, b);
    case DM_OP_MIN:
        return (dm_interval){fmin(a.lo, b.lo), fmin(a.hi, b.hi)};
    case DM_OP_MAX:
        return (dm_interval){fmax(a.lo, b.lo), fmax(a.hi, b.hi)};
    case DM_OP_WHERE:
        return either(a, b, c);
    case DM_OP_FMA:
        return add(ab, c);
    case DM_OP_FMS:
        return add(ab, negative(c));
    case DM_OP_FNMA:
        return add(negative(ab), c);
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
        else
            value[n] = operands == 1 ? of_one(e->op, value[e->as.arg[0]]) : of_more(e, value);
    }
}

/* ---- rates ---- */

static dm_interval scaled(double k, dm_interval a) {
    return multiply((dm_interval){k, k}, a);
}

static dm_interval plus_one(dm_interval a) {
    return add((dm_interval){1.0, 1.0}, a);
}

/* the derivative of a function of one operand, where that is a and the value y */
static dm_interval slope(dm_op op, dm_interval a, dm_interval y) {
    switch (op) {
    case DM_OP_NEG:
        return (dm_interval){-1.0, -1.0};
    case DM_OP_ABS:
        return (dm_interval){a.lo >= 0.0 ? 1.0 : -1.0, a.hi <= 0.0 ? -1.0 : 1.0};
    case DM_OP_SQRT:
        return divide((dm_interval){0.5, 0.5}, y);
    case DM_OP_RSQRT:
        return scaled(-0.5, divide(y, a));
    case DM_OP_RSQRT3:
        return scaled(-1.5, divide(y, a));
    case DM_OP_EXP:
        return y;
    case DM_OP_LOG:
        return reciprocal(a);
    case DM_OP_SIN:
        return wave(cos, a, 0.0);
    case DM_OP_COS:
        return negative(wave(sin, a, 0.5 * PI));
    case DM_OP_TAN:
        return plus_one(square(y));
    case DM_OP_ATAN:
        return reciprocal(plus_one(square(a)));
    case DM_OP_SINH:
        return hyperbolic_cosine(a);
    case DM_OP_COSH:
        return rising(sinh, a);
    case DM_OP_TANH:
        return plus_one(negative(square(y)));
    default:
        return ALL; /* arcs, jumps, roots of equations */
    }
}

/* a' b + a b' */
static dm_interval of_product(const dm_interval *value, const dm_interval *rate, dm_node a,
                              dm_node b) {
    return add(multiply(rate[a], value[b]), multiply(value[a], rate[b]));
}

static dm_interval of_power(dm_interval a, dm_interval k, dm_interval rate_a, dm_interval rate_k) {
    if (!is_point(k) || rate_k.lo != 0.0 || rate_k.hi != 0.0) return ALL;
    const dm_interval less = {k.lo - 1.0, k.lo - 1.0};
    return multiply(scaled(k.lo, power(a, less)), rate_a);
}

static dm_interval both(dm_interval a, dm_interval b) {
    return (dm_interval){fmin(a.lo, b.lo), fmax(a.hi, b.hi)};
}

/* of the smaller, or, with -1, of the larger one */
static dm_interval of_extreme(double sign_of, dm_interval a, dm_interval b, dm_interval rate_a,
                              dm_interval rate_b) {
    const dm_interval d = scaled(sign_of, add(a, negative(b)));
    return d.hi < 0.0 ? rate_a : d.lo > 0.0 ? rate_b : both(rate_a, rate_b);
}

static dm_interval rate_of_more(const dm_expr *e, dm_interval y, const dm_interval *value,
                                const dm_interval *rate) {
    const dm_node a = e->as.arg[0], b = e->as.arg[1], c = e->as.arg[2];
    const dm_interval condition = value[a];
    switch (e->op) {
    case DM_OP_ADD:
        return add(rate[a], rate[b]);
    case DM_OP_SUB:
        return add(rate[a], negative(rate[b]));
    case DM_OP_MUL:
        return of_product(value, rate, a, b);
    case DM_OP_DIV:
        return divide(add(rate[a], negative(multiply(y, rate[b]))), value[b]);
    case DM_OP_POW:
        return of_power(value[a], value[b], rate[a], rate[b]);
    case DM_OP_MIN:
        return of_extreme(1.0, value[a], value[b], rate[a], rate[b]);
    case DM_OP_MAX:
        return of_extreme(-1.0, value[a], value[b], rate[a], rate[b]);
    case DM_OP_WHERE:
        return condition.lo > 0.0 ? rate[b] : condition.hi <= 0.0 ? rate[c] : ALL;
    case DM_OP_FMA:
        return add(of_product(value, rate, a, b), rate[c]);
    case DM_OP_FMS:
        return add(of_product(value, rate, a, b), negative(rate[c]));
    case DM_OP_FNMA:
        return add(negative(of_product(value, rate, a, b)), rate[c]);
    default:
        return ALL; /* angles, roots of equations */
    }
}

void dm_bounds_rate(const dm_graph *g, const dm_interval *rate_in, const dm_interval *value,
                    dm_interval *rate) {
    const uint32_t size = dm_graph_size(g);
    for (dm_node n = 0; n < size; n++) {
        const dm_expr *e = dm_graph_at(g, n);
        if (e->op == DM_OP_CONSTANT)
            rate[n] = (dm_interval){0.0, 0.0};
        else if (e->op == DM_OP_INPUT)
            rate[n] = rate_in[e->as.input];
        else if (dm_op_operands(e->op) == 1)
            rate[n] = multiply(slope(e->op, value[e->as.arg[0]], value[n]), rate[e->as.arg[0]]);
        else
            rate[n] = rate_of_more(e, value[n], value, rate);
    }
}

dm_interval dm_interval_add(dm_interval a, dm_interval b) {
    return add(a, b);
}

dm_interval dm_interval_multiply(dm_interval a, dm_interval b) {
    return multiply(a, b);
}

dm_interval dm_interval_common(dm_interval a, dm_interval b) {
    return cut(a, b.lo, b.hi);
}
