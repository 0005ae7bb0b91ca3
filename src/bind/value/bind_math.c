/* bind_math.c - math.* for numbers, symbols and hyper-dual numbers, and the same functions in dm.
 * They are plain C functions, as Lua's own: numbers take the way that they take there, with its
 * results and messages; only what is no number is looked at. */
#include "bind/core/missing_key.h"
#include "bind/core/state.h"
#include "bind/value/array.h"
#include "bind/value/math_special.h"

#include <math.h>

/* ---- what is no number ---- */

enum { MAX, MIN }; /* the first of the table */
static const dml_math functions[];

/* A symbol or a hyper-dual number: what plain math does not know. */
static int is_special(lua_State *L, int arg) {
    if (lua_type(L, arg) != LUA_TUSERDATA) return 0;
    const int class = dml_classof(L, arg);
    return class == DML_CLASS_SYMBOL || class == DML_CLASS_HYPERDUAL;
}

static const dml_math *find(lua_CFunction enter) {
    const dml_math *f = functions;
    while (f->row.call != enter) f++;
    return f;
}

/* Is one of the arguments a symbol or hyper-dual number? Then *results were pushed. The function
 * takes so many arguments and, as Lua's own, does not look at more. */
static int is_done(lua_State *L, lua_CFunction enter, int takes, int *results) {
    const int top = lua_gettop(L);
    int special = 0;
    for (int k = 1; k <= top && !special; k++) special = is_special(L, k);
    if (!special) return 0;
    dml_scalar x[2];
    const int n = top < takes ? top : takes;
    for (int k = 0; k < n; k++)
        if (!dml_toscalar(L, k + 1, x + k)) return dml_typeerror(L, k + 1, "number");
    const dml_math *f = find(enter);
    *results = f->call(L, x, n, f);
    return 1;
}

/* ---- numbers, as in Lua's lmathlib.c ---- */

/* with the name of what is nil */
static inline void refuse_nil(lua_State *L, int arg) {
    if (lua_isnil(L, arg)) dml_typeerror(L, arg, "number");
}

static double number_at(lua_State *L, int arg) {
    refuse_nil(L, arg);
    return luaL_checknumber(L, arg);
}

/* y = f(x) of one number */
#define OF_ONE(name, f)                                                                            \
    static int math_##name(lua_State *L) {                                                         \
        int is_number, results;                                                                    \
        const double x = lua_tonumberx(L, 1, &is_number);                                          \
        if (!is_number && is_done(L, math_##name, 1, &results)) return results;                    \
        lua_pushnumber(L, f(is_number ? x : number_at(L, 1)));                                     \
        return 1;                                                                                  \
    }
static double sign_of(double x) {
    return dm_op_value(DM_OP_SIGN, x, 0, 0);
}
OF_ONE(sin, sin)
OF_ONE(cos, cos)
OF_ONE(tan, tan)
OF_ONE(asin, asin)
OF_ONE(acos, acos)
OF_ONE(exp, exp)
OF_ONE(sqrt, sqrt)
OF_ONE(sinh, sinh)
OF_ONE(cosh, cosh)
OF_ONE(tanh, tanh)
OF_ONE(log10, log10)
OF_ONE(sign, sign_of)

/* numbers at 1 and 2: 2; at 1 alone, where one is enough: 1; 0: the results were pushed */
static int read_two(lua_State *L, lua_CFunction enter, int least, double x[2], int *results) {
    int first, second;
    x[0] = lua_tonumberx(L, 1, &first);
    x[1] = lua_tonumberx(L, 2, &second);
    if (!second && least < 2 && lua_isnil(L, 2)) lua_settop(L, 1); /* as Lua's own */
    if ((!first || !second) && is_done(L, enter, 2, results)) return 0;
    if (!first) number_at(L, 1);
    if (!second && !lua_isnoneornil(L, 2)) number_at(L, 2);
    return second ? 2 : 1;
}

/* Of two arguments too, as Lua's. */
static int math_atan(lua_State *L) {
    double x[2];
    int results = 0;
    const int n = read_two(L, math_atan, 1, x, &results);
    if (!n) return results;
    lua_pushnumber(L, atan2(x[0], n > 1 ? x[1] : 1.0));
    return 1;
}

/* Any base; 2 and 10 have functions of their own in C, and keep them. */
static int math_log(lua_State *L) {
    double x[2];
    int results = 0;
    const int n = read_two(L, math_log, 1, x, &results);
    if (!n) return results;
    const double y = n == 1         ? log(x[0])
                     : x[1] == 2.0  ? log2(x[0])
                     : x[1] == 10.0 ? log10(x[0])
                                    : log(x[0]) / log(x[1]);
    lua_pushnumber(L, y);
    return 1;
}

static int math_pow(lua_State *L) {
    double x[2];
    int results = 0;
    const int n = read_two(L, math_pow, 2, x, &results);
    if (!n) return results;
    if (n < 2) number_at(L, 2);
    lua_pushnumber(L, pow(x[0], x[1]));
    return 1;
}

/* Integers stay integers, and the least one is its own modulus, as in Lua. */
static int math_abs(lua_State *L) {
    int results = 0;
    if (lua_isinteger(L, 1)) {
        const lua_Integer n = lua_tointeger(L, 1);
        lua_pushinteger(L, n < 0 ? (lua_Integer)(0u - (lua_Unsigned)n) : n);
        return 1;
    }
    if (lua_type(L, 1) != LUA_TNUMBER && is_done(L, math_abs, 1, &results)) return results;
    lua_pushnumber(L, fabs(number_at(L, 1)));
    return 1;
}

/* an integer where it fits, else the number */
static int push_whole(lua_State *L, double x) {
    lua_Integer n;
    if (lua_numbertointeger(x, &n))
        lua_pushinteger(L, n);
    else
        lua_pushnumber(L, x);
    return 1;
}

/* a number with a fraction is none of Lua's integers, which stay as they are */
#define TO_WHOLE(name)                                                                             \
    static int math_##name(lua_State *L) {                                                         \
        int is_number, results;                                                                    \
        double x = lua_tonumberx(L, 1, &is_number);                                                \
        if (!is_number && is_done(L, math_##name, 1, &results)) return results;                    \
        if (!is_number) x = number_at(L, 1);                                                       \
        const double y = name(x);                                                                  \
        if (x == y && lua_isinteger(L, 1)) return lua_settop(L, 1), 1;                             \
        return push_whole(L, y);                                                                   \
    }
TO_WHOLE(floor)
TO_WHOLE(ceil)

/* Lua compares the arguments, and asks symbols and hyper-dual numbers only where there are some:
 * these say so here. */
static _Thread_local int compared;

/* the C function that runs at that level, behind a row with a doc too */
static lua_CFunction running(lua_State *L, int level) {
    lua_Debug ar;
    if (!lua_getstack(L, level, &ar) || !lua_getinfo(L, "f", &ar)) return NULL;
    const lua_CFunction f = dml_rowof(L, -1);
    lua_pop(L, 1);
    return f;
}

int dml_inmax(lua_State *L) {
    const lua_CFunction caller = running(L, 1);
    if (caller != functions[MAX].row.call && caller != functions[MIN].row.call) return 0;
    return compared = 1;
}

/* The argument itself is the result, an integer or not. Two numbers ask nobody and have no nil.
 * Speed: people, math.max. */
static inline int farthest(lua_State *L, lua_CFunction enter, int largest) {
    const int n = lua_gettop(L);
    int best = 1, results;
    if (n == 2 && lua_type(L, 1) == LUA_TNUMBER && lua_type(L, 2) == LUA_TNUMBER) {
        if (!lua_compare(L, largest ? 1 : 2, largest ? 2 : 1, LUA_OPLT)) lua_pushvalue(L, 1);
        return 1; /* what is on top */
    }
    luaL_argcheck(L, n >= 1, 1, "value expected");
    for (int k = 1; k <= n && n > 1; k++) refuse_nil(L, k); /* Lua raises too, without a name */
    for (int k = 2; k <= n; k++)
        if (lua_compare(L, largest ? best : k, largest ? k : best, LUA_OPLT)) best = k;
    if (compared) {
        compared = 0;
        if (is_done(L, enter, 2, &results)) return results;
    }
    lua_pushvalue(L, best);
    return 1;
}

static int math_max(lua_State *L) {
    return farthest(L, math_max, 1);
}

static int math_min(lua_State *L) {
    return farthest(L, math_min, 0);
}

/* Lua's own function of that name, which is kept in the registry: those that few loops call */
static int call_own(lua_State *L, lua_CFunction enter, int takes) {
    int results = 0;
    if (is_done(L, enter, takes, &results)) return results;
    const int top = lua_gettop(L);
    luaL_getsubtable(L, LUA_REGISTRYINDEX, "dm_math");
    lua_getfield(L, -1, find(enter)->row.name);
    lua_insert(L, 1);
    lua_settop(L, top + 1);
    if (lua_tocfunction(L, 1)) { /* entered directly, so that messages name this one */
        const lua_CFunction own = lua_tocfunction(L, 1);
        lua_remove(L, 1);
        return own(L);
    }
    lua_call(L, top, LUA_MULTRET);
    return lua_gettop(L);
}

static int math_tointeger(lua_State *L) {
    return call_own(L, math_tointeger, 1);
}

static int math_fmod(lua_State *L) {
    refuse_nil(L, 1), refuse_nil(L, 2);
    return call_own(L, math_fmod, 2);
}

static int math_modf(lua_State *L) {
    refuse_nil(L, 1);
    return call_own(L, math_modf, 1);
}

/* ---- the table ---- */

static const dml_math functions[] = {
    {{"max", math_max, "math.max(x, ...) -> number\nThe largest of its arguments."},
     DM_OP_MAX,
     dml_math_extremum},
    {{"min", math_min, "math.min(x, ...) -> number\nThe smallest of its arguments."},
     DM_OP_MIN,
     dml_math_extremum},
    {{"sin", math_sin, "math.sin(x) -> number\nThe sine; x in radians."},
     DM_OP_SIN,
     dml_math_unary},
    {{"cos", math_cos, "math.cos(x) -> number\nThe cosine; x in radians."},
     DM_OP_COS,
     dml_math_unary},
    {{"tan", math_tan, "math.tan(x) -> number\nThe tangent; x in radians."},
     DM_OP_TAN,
     dml_math_unary},
    {{"asin", math_asin, "math.asin(x) -> number\nThe arc sine, in radians; NaN outside [-1, 1]."},
     DM_OP_ASIN,
     dml_math_unary},
    {{"acos", math_acos,
      "math.acos(x) -> number\nThe arc cosine, in radians; NaN outside [-1, 1]."},
     DM_OP_ACOS,
     dml_math_unary},
    {{"atan", math_atan,
      "math.atan(y [, x]) -> number\n"
      "The angle of the point (x, y), x = 1 when left out, in radians."},
     DM_OP_ATAN,
     dml_math_arctangent},
    {{"exp", math_exp, "math.exp(x) -> number\nThe exponential."}, DM_OP_EXP, dml_math_unary},
    {{"log", math_log,
      "math.log(x [, base]) -> number\n"
      "The logarithm, natural when base is left out; NaN for x < 0."},
     DM_OP_LOG,
     dml_math_logarithm},
    {{"sqrt", math_sqrt, "math.sqrt(x) -> number\nThe square root; NaN for x < 0."},
     DM_OP_SQRT,
     dml_math_unary},
    {{"abs", math_abs, "math.abs(x) -> number\nThe absolute value."}, DM_OP_ABS, dml_math_unary},
    {{"sinh", math_sinh, "dm.sinh(x) -> number\nThe hyperbolic sine."}, DM_OP_SINH, dml_math_unary},
    {{"cosh", math_cosh, "dm.cosh(x) -> number\nThe hyperbolic cosine."},
     DM_OP_COSH,
     dml_math_unary},
    {{"tanh", math_tanh, "dm.tanh(x) -> number\nThe hyperbolic tangent."},
     DM_OP_TANH,
     dml_math_unary},
    {{"sign", math_sign,
      "dm.sign(x) -> number\n1, 0 or -1: the sign of x; its derivative is taken as 0."},
     DM_OP_SIGN,
     dml_math_unary},
    {{"pow", math_pow, "dm.pow(x, y) -> number\nThe power x^y."}, DM_OP_POW, dml_math_power},
    {{"log10", math_log10, "dm.log10(x) -> number\nThe logarithm to base 10."},
     DM_OP_LOG,
     dml_math_logarithm10},
    {{"floor", math_floor,
      "math.floor(x) -> integer\n"
      "The largest integer <= x. Raises on a symbol: see dm.where."},
     DM_OP_COUNT,
     dml_math_whole},
    {{"ceil", math_ceil,
      "math.ceil(x) -> integer\n"
      "The smallest integer >= x. Raises on a symbol: see dm.where."},
     DM_OP_COUNT,
     dml_math_whole},
    {{"tointeger", math_tointeger,
      "math.tointeger(x) -> integer\n"
      "x as an integer, or nil. Raises on a symbol: see dm.where."},
     DM_OP_COUNT,
     dml_math_whole},
    {{"fmod", math_fmod,
      "math.fmod(x, y) -> number\n"
      "The remainder of x / y with the sign of x. Raises on a symbol."},
     DM_OP_COUNT,
     dml_math_remainder},
    {{"modf", math_modf,
      "math.modf(x) -> number, number\n"
      "Integral and fractional part of x. Raises on a symbol."},
     DM_OP_COUNT,
     dml_math_parts},
    {{NULL, NULL, NULL}, DM_OP_COUNT, NULL},
};

static const dml_scalar *check_scalar(lua_State *L, int arg, dml_scalar *x) {
    if (!dml_toscalar(L, arg, x)) dml_typeerror(L, arg, "number");
    return x;
}

/* dm.where(condition, a, b): both sides are computed, the one that is not taken has slope zero. */
static int where(lua_State *L) {
    dml_scalar c, a, b;
    check_scalar(L, 1, &c);
    if (dml_toarray(L, 2, 1) || dml_toarray(L, 3, 1))
        return luaL_error(L, "dm.where takes numbers: choose a vector entry by entry");
    check_scalar(L, 2, &a);
    check_scalar(L, 3, &b);
    const dml_scalar y = dml_apply(L, DM_OP_WHERE, &c, &a, &b);
    dml_pushscalar(L, &y);
    return 1;
}

static const dml_row rows[] = {{"where", where,
                                "dm.where(c, a, b) -> number\n"
                                "a where c > 0, else b: the way to branch in a function that is "
                                "traced. Both sides are computed; derivatives are those of the "
                                "side that is taken."},
                               {NULL, NULL, NULL}};

/* what is in math of Lua's own function takes every name that it has there: on some systems
 * math.atan2 is math.atan */
static void replace(lua_State *L, int math, const dml_math *f) {
    if (lua_getfield(L, math, f->row.name) == LUA_TNIL || lua_tocfunction(L, -1) == f->row.call)
        return;
    const int own = lua_gettop(L);
    for (lua_pushnil(L); lua_next(L, math); lua_pop(L, 1)) {
        if (!lua_rawequal(L, -1, own)) continue;
        lua_pushvalue(L, -2);
        lua_pushcfunction(L, f->row.call);
        lua_rawset(L, math);
    }
    luaL_getsubtable(L, LUA_REGISTRYINDEX, "dm_math");
    lua_pushvalue(L, own);
    lua_setfield(L, -2, f->row.name);
}

/* core on top. core.sin is a function of its own, so that messages of math.sin say math.sin. */
static void open_math(lua_State *L) {
    const int core = lua_gettop(L), math = core + 1;
    if (lua_getglobal(L, "math") != LUA_TTABLE) { /* a state without the math library */
        lua_pop(L, 1);
        lua_newtable(L);
    }
    for (const dml_math *f = functions; f->row.name; f++) {
        lua_pushcfunction(L, f->row.call);
        dml_setdoc(L, -1, f->row.doc);
        replace(L, math, f);
        lua_pushvalue(L, core);
        dml_setfunction(L, &f->row);
        lua_settop(L, math);
    }
    lua_settop(L, core);
}

const dml_class dml_class_math = {
    .functions = rows,
    .open = open_math,
};
