/* math_special.c - functions of math where an argument is no plain number. */
#include "bind/value/math_special.h"
#include "bind/core/missing_key.h"
#include "bind/core/state.h"

#include <math.h>

/* One result. */
static int push(lua_State *L, const dml_scalar *x) {
    dml_pushscalar(L, x);
    return 1;
}

/* The operation of the row itself. */
int dml_math_unary(lua_State *L, const dml_scalar *x, int n, const dml_math *f) {
    const dml_scalar y = dml_apply(L, f->op, x, NULL, NULL);
    (void)n;
    return push(L, &y);
}

/* The operation of the row is that of one argument. */
int dml_math_arctangent(lua_State *L, const dml_scalar *x, int n, const dml_math *f) {
    if (n < 2) return dml_math_unary(L, x, n, f);
    const dml_scalar y = dml_apply(L, DM_OP_ATAN2, x, x + 1, NULL);
    return push(L, &y);
}

/* Symbolic powers are simplified where the graph is made. */
int dml_math_power(lua_State *L, const dml_scalar *x, int n, const dml_math *f) {
    if (n < 2) return luaL_argerror(L, 2, "number expected, got no value");
    const dml_scalar y = dml_apply(L, f->op, x, x + 1, NULL);
    return push(L, &y);
}

/* log(x) or log(x, base) = log(x) / log(base) */
int dml_math_logarithm(lua_State *L, const dml_scalar *x, int n, const dml_math *f) {
    dml_scalar y = dml_apply(L, f->op, x, NULL, NULL);
    if (n > 1) {
        const dml_scalar base = dml_apply(L, f->op, x + 1, NULL, NULL);
        y = dml_apply(L, DM_OP_DIV, &y, &base, NULL);
    }
    return push(L, &y);
}

/* There is no operation of its own for it. */
int dml_math_logarithm10(lua_State *L, const dml_scalar *x, int n, const dml_math *f) {
    const dml_scalar pair[2] = {*x, {.kind = DML_NUMBER, .as.number = 10}};
    (void)n;
    return dml_math_logarithm(L, pair, 2, f);
}

/* From left to right, pair by pair: arguments behind the second are still on the stack. */
int dml_math_extremum(lua_State *L, const dml_scalar *x, int n, const dml_math *f) {
    dml_scalar y = *x;
    for (int k = 2; k <= lua_gettop(L); k++) {
        dml_scalar z;
        if (!dml_toscalar(L, k, &z)) return dml_typeerror(L, k, "number");
        y = dml_apply(L, f->op, &y, &z, NULL);
    }
    (void)n;
    return push(L, &y);
}

/* ---- functions that need a value: on hyper-dual numbers only ---- */

/* Raises where x is a symbol: what the function does would be fixed at a value that there is not.
 * */
static void need_value(lua_State *L, const dml_scalar *x, int n, const char *name) {
    for (int k = 0; k < n; k++)
        if (x[k].kind == DML_SYMBOL)
            dml_refusesymbol(L, lua_pushfstring(L, "math.%s", name), x[k].serial);
}

/* Of a hyper-dual number without its derivatives. */
static double value_of(const dml_scalar *x) {
    return x->kind == DML_HYPERDUAL ? x->as.hyper.f : x->as.number;
}

/* the function on the value alone */
static int on_value(lua_State *L, double x, const dml_math *f) {
    lua_settop(L, 0);
    lua_pushnumber(L, x);
    return f->row.call(L);
}

/* The result is a plain number. */
int dml_math_whole(lua_State *L, const dml_scalar *x, int n, const dml_math *f) {
    need_value(L, x, n, f->row.name);
    return on_value(L, value_of(x), f);
}

/* x - n y with the whole number n = x/y cut off towards zero */
int dml_math_remainder(lua_State *L, const dml_scalar *x, int n, const dml_math *f) {
    need_value(L, x, n, f->row.name);
    if (n < 2) return luaL_argerror(L, 2, "number expected, got no value");
    const double a = value_of(x), b = value_of(x + 1);
    const dml_scalar quotient = {.kind = DML_NUMBER, .as.number = trunc(a / b)};
    const dml_scalar part = dml_apply(L, DM_OP_MUL, &quotient, x + 1, NULL);
    const dml_scalar rest = dml_apply(L, DM_OP_SUB, x, &part, NULL);
    return push(L, &rest);
}

/* The integral part is a plain number, the fraction has the derivatives of x. */
int dml_math_parts(lua_State *L, const dml_scalar *x, int n, const dml_math *f) {
    need_value(L, x, n, f->row.name);
    const dml_scalar integral = {.kind = DML_NUMBER, .as.number = trunc(value_of(x))};
    const dml_scalar fraction = dml_apply(L, DM_OP_SUB, x, &integral, NULL);
    lua_pushnumber(L, integral.as.number);
    return 1 + push(L, &fraction);
}
