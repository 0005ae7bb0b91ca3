/* bind_math.c - math.* for numbers, symbols and hyper-dual numbers, and the same
 * functions in dm. Plain numbers, and whatever is wrong, go straight to Lua's own
 * function, so that results and messages are its own. */
#include "bind/core/state.h"
#include "bind/value/array.h"

#include <math.h>

/* one wrapped function; `call` gets 1 .. 3 arguments of which one is a symbol or
 * hyper-dual number */
typedef struct {
    const char *name;
    dm_op op;
    int (*call)(lua_State *L, const dml_scalar *x, int n, dm_op op);
    const char *doc;
} wrapper;

static int push(lua_State *L, const dml_scalar *x) {
    dml_pushscalar(L, x);
    return 1;
}

static int unary(lua_State *L, const dml_scalar *x, int n, dm_op op) {
    const dml_scalar y = dml_apply(L, op, x, NULL, NULL);
    (void)n;
    return push(L, &y);
}

static int arctangent(lua_State *L, const dml_scalar *x, int n, dm_op op) {
    if (n < 2) return unary(L, x, n, op);
    const dml_scalar y = dml_apply(L, DM_OP_ATAN2, x, x + 1, NULL);
    return push(L, &y);
}

static int power(lua_State *L, const dml_scalar *x, int n, dm_op op) {
    if (n < 2) return luaL_argerror(L, 2, "number expected, got no value");
    const dml_scalar y = dml_apply(L, op, x, x + 1, NULL);
    return push(L, &y);
}

/* log(x) or log(x, base) = log(x) / log(base) */
static int logarithm(lua_State *L, const dml_scalar *x, int n, dm_op op) {
    dml_scalar y = dml_apply(L, op, x, NULL, NULL);
    if (n > 1) {
        const dml_scalar base = dml_apply(L, op, x + 1, NULL, NULL);
        y = dml_apply(L, DM_OP_DIV, &y, &base, NULL);
    }
    return push(L, &y);
}

static int logarithm10(lua_State *L, const dml_scalar *x, int n, dm_op op) {
    const dml_scalar pair[2] = {*x, {.kind = DML_NUMBER, .as.number = 10}};
    (void)n;
    return logarithm(L, pair, 2, op);
}

static int extremum(lua_State *L, const dml_scalar *x, int n, dm_op op) {
    dml_scalar y = *x;
    for (int k = 2; k <= lua_gettop(L); k++) {
        dml_scalar z;
        if (!dml_toscalar(L, k, &z)) return luaL_typeerror(L, k, "number");
        y = dml_apply(L, op, &y, &z, NULL);
    }
    (void)n;
    return push(L, &y);
}

/* ---- functions that need a value: on hyper-dual numbers only ---- */

static void need_value(lua_State *L, const dml_scalar *x, int n, const char *name) {
    for (int k = 0; k < n; k++)
        if (x[k].kind == DML_SYMBOL)
            luaL_error(L,
                       "math.%s met a symbol while a function is traced, when its arguments have "
                       "no values: use dm.where(c, a, b) (a where c > 0, else b), dm.abs, dm.max "
                       "or dm.min, or derivatives = \"hyperdual\"",
                       name);
}

static double value_of(const dml_scalar *x) {
    return x->kind == DML_HYPERDUAL ? x->as.hyper.f : x->as.number;
}

/* call Lua's own function on the value */
static int on_value(lua_State *L, double x, int results) {
    lua_settop(L, 0);
    lua_pushvalue(L, lua_upvalueindex(1));
    lua_pushnumber(L, x);
    lua_call(L, 1, results);
    return results;
}

static int whole(lua_State *L, const dml_scalar *x, int n, dm_op op) {
    const wrapper *w = lua_touserdata(L, lua_upvalueindex(2));
    (void)op;
    need_value(L, x, n, w->name);
    return on_value(L, value_of(x), 1);
}

/* x - n y with the whole number n = x/y cut off towards zero */
static int remainder_of(lua_State *L, const dml_scalar *x, int n, dm_op op) {
    (void)op;
    need_value(L, x, n, "fmod");
    if (n < 2) return luaL_argerror(L, 2, "number expected, got no value");
    const double a = value_of(x), b = value_of(x + 1);
    const dml_scalar quotient = {.kind = DML_NUMBER, .as.number = trunc(a / b)};
    const dml_scalar part = dml_apply(L, DM_OP_MUL, &quotient, x + 1, NULL);
    const dml_scalar rest = dml_apply(L, DM_OP_SUB, x, &part, NULL);
    return push(L, &rest);
}

static int parts(lua_State *L, const dml_scalar *x, int n, dm_op op) {
    (void)op;
    need_value(L, x, n, "modf");
    on_value(L, value_of(x), 1);
    const dml_scalar integral = {.kind = DML_NUMBER, .as.number = lua_tonumber(L, -1)};
    const dml_scalar fraction = dml_apply(L, DM_OP_SUB, x, &integral, NULL);
    return 1 + push(L, &fraction);
}

/* ---- the table ---- */

static const wrapper wrappers[] = {
    {"sin", DM_OP_SIN, unary, "math.sin(x) -> number\nThe sine; x in radians."},
    {"cos", DM_OP_COS, unary, "math.cos(x) -> number\nThe cosine; x in radians."},
    {"tan", DM_OP_TAN, unary, "math.tan(x) -> number\nThe tangent; x in radians."},
    {"asin", DM_OP_ASIN, unary,
     "math.asin(x) -> number\nThe arc sine, in radians; NaN outside [-1, 1]."},
    {"acos", DM_OP_ACOS, unary,
     "math.acos(x) -> number\nThe arc cosine, in radians; NaN outside [-1, 1]."},
    {"atan", DM_OP_ATAN, arctangent,
     "math.atan(y [, x]) -> number\n"
     "The angle of the point (x, y), x = 1 when left out, in radians."},
    {"exp", DM_OP_EXP, unary, "math.exp(x) -> number\nThe exponential."},
    {"log", DM_OP_LOG, logarithm,
     "math.log(x [, base]) -> number\n"
     "The logarithm, natural when base is left out; NaN for x < 0."},
    {"sqrt", DM_OP_SQRT, unary, "math.sqrt(x) -> number\nThe square root; NaN for x < 0."},
    {"abs", DM_OP_ABS, unary, "math.abs(x) -> number\nThe absolute value."},
    {"max", DM_OP_MAX, extremum, "math.max(x, ...) -> number\nThe largest of its arguments."},
    {"min", DM_OP_MIN, extremum, "math.min(x, ...) -> number\nThe smallest of its arguments."},
    {"sinh", DM_OP_SINH, unary, "dm.sinh(x) -> number\nThe hyperbolic sine."},
    {"cosh", DM_OP_COSH, unary, "dm.cosh(x) -> number\nThe hyperbolic cosine."},
    {"tanh", DM_OP_TANH, unary, "dm.tanh(x) -> number\nThe hyperbolic tangent."},
    {"sign", DM_OP_SIGN, unary,
     "dm.sign(x) -> number\n1, 0 or -1: the sign of x; its derivative is taken as 0."},
    {"pow", DM_OP_POW, power, "dm.pow(x, y) -> number\nThe power x^y."},
    {"log10", DM_OP_LOG, logarithm10, "dm.log10(x) -> number\nThe logarithm to base 10."},
    {"floor", DM_OP_COUNT, whole,
     "math.floor(x) -> integer\n"
     "The largest integer <= x. Raises on a symbol: see dm.where."},
    {"ceil", DM_OP_COUNT, whole,
     "math.ceil(x) -> integer\n"
     "The smallest integer >= x. Raises on a symbol: see dm.where."},
    {"tointeger", DM_OP_COUNT, whole,
     "math.tointeger(x) -> integer\n"
     "x as an integer, or nil. Raises on a symbol: see dm.where."},
    {"fmod", DM_OP_COUNT, remainder_of,
     "math.fmod(x, y) -> number\n"
     "The remainder of x / y with the sign of x. Raises on a symbol."},
    {"modf", DM_OP_COUNT, parts,
     "math.modf(x) -> number, number\n"
     "Integral and fractional part of x. Raises on a symbol."},
    {NULL, DM_OP_COUNT, NULL, NULL},
};

static int is_special(lua_State *L, int arg) {
    if (lua_type(L, arg) != LUA_TUSERDATA) return 0;
    const int class = dml_classof(L, arg);
    return class == DML_CLASS_SYMBOL || class == DML_CLASS_HYPERDUAL;
}

/* numbers where Lua has no function of that name */
static int plain(lua_State *L, const wrapper *w) {
    dml_scalar x[2] = {{.kind = DML_NUMBER}, {.kind = DML_NUMBER}};
    const int n = lua_gettop(L) > 1 ? 2 : 1;
    for (int k = 0; k < n; k++) x[k].as.number = luaL_checknumber(L, k + 1);
    return w->call(L, x, n, w->op);
}

/* upvalue 1: Lua's own function or nil, 2: the row, 3: true when the former may be
 * entered directly */
static int wrapped(lua_State *L) {
    const wrapper *w = lua_touserdata(L, lua_upvalueindex(2));
    const int top = lua_gettop(L);
    int special = 0;
    for (int k = 1; k <= top && !special; k++) special = is_special(L, k);
    if (!special) {
        if (lua_toboolean(L, lua_upvalueindex(3)))
            return lua_tocfunction(L, lua_upvalueindex(1))(L);
        if (lua_isnil(L, lua_upvalueindex(1))) return plain(L, w);
        lua_pushvalue(L, lua_upvalueindex(1));
        lua_insert(L, 1);
        lua_call(L, top, LUA_MULTRET);
        return lua_gettop(L);
    }
    dml_scalar x[2];
    const int n = top > 1 ? 2 : 1;
    for (int k = 0; k < n; k++)
        if (!dml_toscalar(L, k + 1, x + k)) return luaL_typeerror(L, k + 1, "number");
    return w->call(L, x, n, w->op);
}

static const dml_scalar *check_scalar(lua_State *L, int arg, dml_scalar *x) {
    if (!dml_toscalar(L, arg, x)) luaL_typeerror(L, arg, "number");
    return x;
}

static int where(lua_State *L) {
    dml_scalar c, a, b;
    check_scalar(L, 1, &c);
    if (dml_toarray(L, 2, 1) || dml_toarray(L, 3, 1))
        return luaL_error(L, "dm.where takes numbers: choose a vector entry by entry");
    check_scalar(L, 2, &a);
    check_scalar(L, 3, &b);
    const dml_scalar y = dml_apply(L, DM_OP_WHERE, &c, &a, &b);
    return push(L, &y);
}

static const dml_row functions[] = {{"where", where,
                                     "dm.where(c, a, b) -> number\n"
                                     "a where c > 0, else b: the way to branch in a function that "
                                     "is traced. Both sides are computed; derivatives are those of "
                                     "the side that is taken."},
                                    {NULL, NULL, NULL}};

/* a C function without upvalues needs no call of its own */
static int is_light(lua_State *L, int arg) {
    return lua_iscfunction(L, arg) && !lua_getupvalue(L, arg, 1);
}

/* replace what is on top, Lua's own function or nil, by its wrapper */
static void wrap(lua_State *L, const wrapper *w) {
    lua_pushlightuserdata(L, (void *)(uintptr_t)w);
    lua_pushboolean(L, is_light(L, -2));
    lua_pushcclosure(L, wrapped, 3);
    dml_setdoc(L, -1, w->doc);
}

/* the wrapper on top takes every name in math of Lua's own function at index `own` (on
 * some systems math.atan2 is math.atan) */
static void rename_all(lua_State *L, int math, int own) {
    for (lua_pushnil(L); lua_next(L, math); lua_pop(L, 1)) {
        if (!lua_rawequal(L, -1, own)) continue;
        lua_pushvalue(L, -2);
        lua_pushvalue(L, -4);
        lua_rawset(L, math);
    }
}

/* math[name] becomes a wrapper, once: what is wrapped is remembered in dm_math */
static void wrap_in_place(lua_State *L, const wrapper *w, int math, int dm_math) {
    if (lua_getfield(L, dm_math, w->name) == LUA_TNIL &&
        lua_getfield(L, math, w->name) != LUA_TNIL) {
        lua_pushvalue(L, -1);
        lua_setfield(L, dm_math, w->name); /* Lua's own */
        const int own = lua_gettop(L);
        lua_pushvalue(L, own);
        wrap(L, w);
        rename_all(L, math, own);
    }
    lua_settop(L, dm_math);
}

/* core on top. core.sin is a function of its own, so that messages of math.sin say
 * math.sin */
static void open_math(lua_State *L) {
    const int core = lua_gettop(L), math = core + 1, dm_math = core + 2;
    if (lua_getglobal(L, "math") != LUA_TTABLE) { /* a state without the math library */
        lua_pop(L, 1);
        lua_newtable(L);
    }
    luaL_getsubtable(L, LUA_REGISTRYINDEX, "dm_math");
    for (const wrapper *w = wrappers; w->name; w++) {
        wrap_in_place(L, w, math, dm_math);
        lua_getfield(L, dm_math, w->name);
        wrap(L, w);
        lua_setfield(L, core, w->name);
    }
    lua_settop(L, core);
}

const dml_class dml_class_math = {
    .functions = functions,
    .open = open_math,
};
