#include "graph/interval.h"

#include <float.h>
#include <math.h>

static const double PI = 3.14159265358979323846;
static const dm_interval ALL = DM_ANYWHERE;
enum { ROUNDED = 1, COMPUTED = 4 }; /* errors of an operation in its last place, at most */

/* x less some units of the last place */
static double below(double x, int units) {
    return isinf(x) ? (x > 0.0 ? DBL_MAX : x) : x - (units * DBL_EPSILON * fabs(x) + 5e-324);
}

/* x and some units of the last place */
static double above(double x, int units) {
    return -below(-x, units);
}

/* outwards by so many units; what is no number is anywhere */
static dm_interval widened(double lo, double hi, int units) {
    if (isnan(lo) || isnan(hi)) return ALL;
    return (dm_interval){below(lo, units), above(hi, units)};
}

/* of the ends of products and the like; an end that is no number is anything */
static double least(const double *x, int count) {
    double out = x[0];
    for (int i = 1; i < count; i++) out = isnan(x[i]) ? -INFINITY : fmin(out, x[i]);
    return out;
}

/* the same upwards */
static double largest(const double *x, int count) {
    double out = x[0];
    for (int i = 1; i < count; i++) out = isnan(x[i]) ? INFINITY : fmax(out, x[i]);
    return out;
}

/* the hull of some numbers, rounded outwards */
static dm_interval hull(const double *x, int count, int units) {
    return widened(least(x, count), largest(x, count), units);
}

/* Is it one number? */
static int is_point(dm_interval a) {
    return a.lo == a.hi;
}

/* ---- arithmetic ---- */

/* [a.lo + b.lo, a.hi + b.hi] */
dm_interval dm_interval_add(dm_interval a, dm_interval b) {
    return widened(a.lo + b.lo, a.hi + b.hi, ROUNDED);
}

/* exact: no rounding */
dm_interval dm_interval_negative(dm_interval a) {
    return (dm_interval){-a.hi, -a.lo};
}

/* an end that is zero stays zero, however large the other factor */
static double product(double x, double y) {
    return x == 0.0 || y == 0.0 ? 0.0 : x * y;
}

/* extreme at corners; where one factor does not change its sign these are known: a >= 0 */
static dm_interval multiply_by_sign(dm_interval a, dm_interval b) {
    const double lo = product(b.lo >= 0.0 ? a.lo : a.hi, b.lo);
    const double hi = product(b.hi <= 0.0 ? a.lo : a.hi, b.hi);
    dm_interval out = widened(lo, hi, ROUNDED);
    /* a product of numbers that are not negative is none */
    if (lo >= 0.0 && out.lo < 0.0) out.lo = 0.0;
    if (hi <= 0.0 && out.hi > 0.0) out.hi = 0.0;
    return out;
}

/* any signs: the extreme corners of all four */
static dm_interval multiply_any(dm_interval a, dm_interval b) {
    const double x[4] = {product(a.lo, b.lo), product(a.lo, b.hi), product(a.hi, b.lo),
                         product(a.hi, b.hi)};
    dm_interval out = hull(x, 4, ROUNDED);
    if (least(x, 4) >= 0.0) out.lo = fmax(out.lo, 0.0);
    if (largest(x, 4) <= 0.0) out.hi = fmin(out.hi, 0.0);
    return out;
}

dm_interval dm_interval_multiply(dm_interval a, dm_interval b) {
    const dm_interval minus_a = {-a.hi, -a.lo}, minus_b = {-b.hi, -b.lo};
    if (!(a.lo <= a.hi && b.lo <= b.hi)) return multiply_any(a, b); /* no numbers */
    if (a.lo >= 0.0) return multiply_by_sign(a, b);
    if (b.lo >= 0.0) return multiply_by_sign(b, a);
    if (a.hi <= 0.0) return multiply_by_sign(minus_a, minus_b);
    if (b.hi <= 0.0) return multiply_by_sign(minus_b, minus_a);
    return multiply_any(a, b);
}

/* |a|; 0 is in it where a changes its sign */
static dm_interval absolute(dm_interval a) {
    if (a.lo >= 0.0) return a;
    if (a.hi <= 0.0) return dm_interval_negative(a);
    return (dm_interval){0.0, fmax(-a.lo, a.hi)};
}

/* a a is not negative, which a product of unrelated numbers may be */
dm_interval dm_interval_square(dm_interval a) {
    const dm_interval b = absolute(a);
    return dm_interval_multiply(b, b);
}

/* 1/a has a pole at 0, which may be an end of a: then it goes one way only */
dm_interval dm_interval_reciprocal(dm_interval a) {
    if (a.lo < 0.0 && a.hi > 0.0) return ALL;
    if (a.lo == 0.0 && a.hi == 0.0) return ALL;
    if (a.lo == 0.0) return (dm_interval){below(1.0 / a.hi, ROUNDED), INFINITY};
    if (a.hi == 0.0) return (dm_interval){-INFINITY, above(1.0 / a.lo, ROUNDED)};
    return widened(1.0 / a.hi, 1.0 / a.lo, ROUNDED);
}

/* a/b extreme at corners, unless b meets 0 */
dm_interval dm_interval_divide(dm_interval a, dm_interval b) {
    const double x[4] = {a.lo / b.lo, a.lo / b.hi, a.hi / b.lo, a.hi / b.hi};
    if (b.lo <= 0.0 && b.hi >= 0.0) return dm_interval_multiply(a, dm_interval_reciprocal(b));
    return hull(x, 4, ROUNDED);
}

/* ---- functions ---- */

typedef double function(double);

/* of a function that rises */
static dm_interval rising(function *f, dm_interval a) {
    return widened(f(a.lo), f(a.hi), COMPUTED);
}

/* of a function that falls */
static dm_interval falling(function *f, dm_interval a) {
    return widened(f(a.hi), f(a.lo), COMPUTED);
}

/* between `lo` and `hi`, which the function never leaves */
static dm_interval cut(dm_interval a, double lo, double hi) {
    return (dm_interval){fmax(a.lo, lo), fmin(a.hi, hi)};
}

/* x^(-3/2) */
static double cube_of_root(double x) {
    return 1.0 / (x * sqrt(x));
}

/* x^(-1/2) */
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

/* tan has poles at pi/2 + pi k, and rises between them */
static dm_interval tangent(dm_interval a) {
    if (!(a.hi - a.lo < PI) || meets(a, 0.5 * PI, PI)) return ALL;
    return rising(tan, a);
}

/* cosh(a) = cosh(|a|) >= 1 */
static dm_interval hyperbolic_cosine(dm_interval a) {
    return cut(rising(cosh, absolute(a)), 1.0, INFINITY);
}

/* log(a), from -infinity where a begins at 0 */
static dm_interval logarithm(dm_interval a) {
    if (a.lo < 0.0 || a.hi == 0.0) return ALL;
    return rising(log, a);
}

/* asin(a) or acos(a), of -1 <= a <= 1 only */
static dm_interval arc(dm_interval a, int cosine) {
    if (a.lo < -1.0 || a.hi > 1.0) return ALL;
    return cosine ? cut(falling(acos, a), 0.0, 2.0 * PI) : rising(asin, a);
}

/* the angle of (x, y): extreme at corners, but across the cut */
dm_interval dm_interval_angle(dm_interval y, dm_interval x) {
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
    if (k == 1.0) return a;
    if (k == 2.0) return dm_interval_square(a);
    if (k < 0.0) return dm_interval_reciprocal(whole_power(a, -k));
    const dm_interval b = even ? absolute(a) : a;
    dm_interval out = widened(pow(b.lo, k), pow(b.hi, k), COMPUTED);
    if (b.lo >= 0.0) out.lo = fmax(out.lo, 0.0);
    return out;
}

/* of a > 0 extreme at corners, as it is monotonic in each */
dm_interval dm_interval_power(dm_interval a, dm_interval k) {
    if (is_point(k) && k.lo == floor(k.lo)) return whole_power(a, k.lo);
    if (a.lo < 0.0 || (a.lo == 0.0 && k.lo <= 0.0)) return ALL;
    const double c[4] = {pow(a.lo, k.lo), pow(a.lo, k.hi), pow(a.hi, k.lo), pow(a.hi, k.hi)};
    return cut(hull(c, 4, COMPUTED), 0.0, INFINITY);
}

dm_interval dm_interval_either(dm_interval condition, dm_interval yes, dm_interval no) {
    if (condition.lo > 0.0) return yes;
    if (condition.hi <= 0.0) return no;
    return (dm_interval){fmin(yes.lo, no.lo), fmax(yes.hi, no.hi)};
}

/* -1, 0, 1 */
static dm_interval sign(dm_interval a) {
    return (dm_interval){(double)((a.lo > 0.0) - (a.lo < 0.0)),
                         (double)((a.hi > 0.0) - (a.hi < 0.0))};
}

/* ---- nodes ---- */

dm_interval dm_interval_of(dm_op op, dm_interval a) {
    switch (op) {
    case DM_OP_NEG:
        return dm_interval_negative(a);
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

dm_interval dm_interval_common(dm_interval a, dm_interval b) {
    return cut(a, b.lo, b.hi);
}
