/* hyperdual.c - g(x) = g + g' a e1 + g' b e2 + (g' ab + g'' a b) e1 e2, and for two
 * arguments g_x a + g_y a', g_x ab + g_y ab' + g_xx a b + g_xy (a b' + a' b) + g_yy a' b'
 * (Fike & Alonso 2011). */
#include "bind/value/hyperdual.h"

#include <math.h>

/* value, slope and curvature of a function of one number */
typedef struct {
    double g, g1, g2;
} jet1;

/* the same of two numbers */
typedef struct {
    double g, gx, gy, gxx, gxy, gyy;
} jet2;

/* a direction in which nothing moves contributes nothing, even where the slope is
 * infinite */
static double times(double slope, double move) {
    return move == 0 ? 0.0 : slope * move;
}

/* f(x) by f, f', f'': the second derivative has the product of the slopes. */
static dml_hyperdual chain1(const jet1 *j, const dml_hyperdual *x) {
    return (dml_hyperdual){
        .f = j->g,
        .a = times(j->g1, x->a),
        .b = times(j->g1, x->b),
        .ab = times(j->g1, x->ab) + times(j->g2, x->a * x->b),
    };
}

/* f(x, y) by its first and second partial derivatives. */
static dml_hyperdual chain2(const jet2 *j, const dml_hyperdual *x, const dml_hyperdual *y) {
    return (dml_hyperdual){
        .f = j->g,
        .a = times(j->gx, x->a) + times(j->gy, y->a),
        .b = times(j->gx, x->b) + times(j->gy, y->b),
        .ab = times(j->gx, x->ab) + times(j->gy, y->ab) + times(j->gxx, x->a * x->b) +
              times(j->gxy, x->a * y->b + y->a * x->b) + times(j->gyy, y->a * y->b),
    };
}

static jet1 tangent(double x) {
    const double t = tan(x), slope = 1 + t * t;
    return (jet1){t, slope, 2 * t * slope};
}

/* (1 - x^2)^(-1/2) and its slope: of asin, and with the sign turned of acos */
static jet1 arcsine(double x) {
    const double w = 1 / sqrt((1 - x) * (1 + x));
    return (jet1){asin(x), w, x * w * w * w};
}

static jet1 arctangent(double x) {
    const double w = 1 / (1 + x * x);
    return (jet1){atan(x), w, -2 * x * w * w};
}

static jet1 tanh_jet(double x) {
    const double t = tanh(x), slope = 1 - t * t;
    return (jet1){t, slope, -2 * t * slope};
}

static jet1 reciprocal_root(double x) {
    const double w = 1 / sqrt(x);
    return (jet1){w, -0.5 * w / x, 0.75 * w / (x * x)};
}

/* f, f', f'' of every function of one argument. */
static jet1 jet_of_one(dm_op op, double x) {
    const double g = dm_op_value(op, x, 0, 0);
    const jet1 w = arcsine(x);
    switch (op) {
    case DM_OP_NEG:
        return (jet1){g, -1, 0};
    case DM_OP_ABS:
        return (jet1){g, (double)((x > 0) - (x < 0)), 0};
    case DM_OP_RSQRT:
        return reciprocal_root(x);
    case DM_OP_RSQRT3:
        return (jet1){g, -1.5 * g / x, 3.75 * g / (x * x)};
    case DM_OP_EXP:
        return (jet1){g, g, g};
    case DM_OP_LOG:
        return x < 0 ? (jet1){NAN, NAN, NAN} : (jet1){g, 1 / x, -1 / (x * x)};
    case DM_OP_SIN:
        return (jet1){g, cos(x), -g};
    case DM_OP_COS:
        return (jet1){g, -sin(x), -g};
    case DM_OP_TAN:
        return tangent(x);
    case DM_OP_ASIN:
        return w;
    case DM_OP_ACOS:
        return (jet1){g, -w.g1, -w.g2};
    case DM_OP_ATAN:
        return arctangent(x);
    case DM_OP_SINH:
        return (jet1){g, cosh(x), g};
    case DM_OP_COSH:
        return (jet1){g, sinh(x), g};
    case DM_OP_TANH:
        return tanh_jet(x);
    default:
        return (jet1){g, 0, 0}; /* sign */
    }
}

/* x^y; where a coefficient such as y (y - 1) vanishes the power beside it does not
 * matter */
static jet2 power(double x, double y) {
    const double g = pow(x, y), l = log(x);
    return (jet2){
        .g = g,
        .gx = times(pow(x, y - 1), y),
        .gy = times(l, g),
        .gxx = times(pow(x, y - 2), y * (y - 1)),
        .gxy = pow(x, y - 1) * (1 + y * l),
        .gyy = times(l * l, g),
    };
}

/* angle of (x, y) = (second, first argument); r2 = x^2 + y^2 */
static jet2 angle(double y, double x) {
    const double r2 = x * x + y * y, gy = x / r2, gx = -y / r2;
    return (jet2){atan2(y, x), gy, gx, 2 * gx * gy, gx * gx - gy * gy, -2 * gx * gy};
}

/* Powers, quotients, arctangents of two arguments. */
static jet2 jet_of_two(dm_op op, double x, double y) {
    const double g = dm_op_value(op, x, y, 0);
    switch (op) {
    case DM_OP_ADD:
        return (jet2){g, 1, 1, 0, 0, 0};
    case DM_OP_SUB:
        return (jet2){g, 1, -1, 0, 0, 0};
    case DM_OP_MUL:
        return (jet2){g, y, x, 0, 1, 0};
    case DM_OP_POW:
        return power(x, y);
    default:
        return angle(x, y); /* atan2 */
    }
}

/* q y = x, derived: no y^2, which may leave the range of doubles before q does */
static dml_hyperdual quotient(const dml_hyperdual *x, const dml_hyperdual *y) {
    dml_hyperdual q = {.f = x->f / y->f};
    q.a = (x->a - q.f * y->a) / y->f;
    q.b = (x->b - q.f * y->b) / y->f;
    q.ab = (x->ab - q.a * y->b - q.b * y->a - q.f * y->ab) / y->f;
    return q;
}

/* s^2 = x, derived; 0 along a direction in which x does not change, even at x = 0 */
static dml_hyperdual square_root(const dml_hyperdual *x) {
    dml_hyperdual s = {.f = sqrt(x->f)};
    s.a = x->a == 0.0 ? 0.0 : 0.5 * x->a / s.f;
    s.b = x->b == 0.0 ? 0.0 : 0.5 * x->b / s.f;
    const double rest = x->ab - 2.0 * s.a * s.b;
    s.ab = rest == 0.0 ? 0.0 : 0.5 * rest / s.f;
    return s;
}

dml_hyperdual dml_hyper_apply(dm_op op, const dml_hyperdual *x, const dml_hyperdual *y,
                              const dml_hyperdual *z) {
    if (op == DM_OP_WHERE) return x->f > 0 ? *y : *z;
    if (op == DM_OP_DIV) return quotient(x, y);
    if (op == DM_OP_SQRT) return square_root(x);
    if (op == DM_OP_MIN) return y->f < x->f ? *y : *x;
    if (op == DM_OP_MAX) return x->f < y->f ? *y : *x;
    if (dm_op_operands(op) == 2) {
        const jet2 j = jet_of_two(op, x->f, y->f);
        return chain2(&j, x, y);
    }
    const jet1 j = jet_of_one(op, x->f);
    return chain1(&j, x);
}
