/* bind_hyperdual.c - `dm.hyperdual`: a number that carries its derivatives along two
 * directions. */
#include "bind/core/state.h"
#include "bind/value/array.h"

#include <math.h>
#include <string.h>

#define TNAME "dm.hyperdual"

/* the operands at 1 and 2 by value; the first one in full */
static void read_pair(lua_State *L, dml_scalar *x, double *a, double *b) {
    dml_scalar y;
    if (!dml_toscalar(L, 1, x) || !dml_toscalar(L, 2, &y) || x->kind == DML_SYMBOL ||
        y.kind == DML_SYMBOL)
        luaL_error(L, "a hyper-dual number can be compared with numbers only (got %s and %s)",
                   luaL_typename(L, 1), luaL_typename(L, 2));
    *a = x->kind ? x->as.hyper.f : x->as.number;
    *b = y.kind ? y.as.hyper.f : y.as.number;
}

/* Comparisons look at the value alone: the branch of a function is that of its value. */
static int hyper_lt(lua_State *L) {
    dml_scalar x;
    double a, b;
    read_pair(L, &x, &a, &b);
    (void)dml_inmax(L); /* which has derivatives, too */
    lua_pushboolean(L, a < b);
    return 1;
}

static int hyper_le(lua_State *L) {
    dml_scalar x;
    double a, b;
    read_pair(L, &x, &a, &b);
    lua_pushboolean(L, a <= b);
    return 1;
}

static int hyper_eq(lua_State *L) {
    dml_scalar x, y;
    const int both = dml_toscalar(L, 1, &x) && dml_toscalar(L, 2, &y);
    lua_pushboolean(L, both && x.kind == DML_HYPERDUAL && y.kind == DML_HYPERDUAL &&
                           x.as.hyper.f == y.as.hyper.f);
    return 1;
}

/* x - floor(x / y) y: the quotient is whole and has no derivatives */
static int hyper_mod(lua_State *L) {
    dml_scalar x, y;
    double a, b;
    read_pair(L, &x, &a, &b);
    dml_toscalar(L, 2, &y);
    const dml_scalar quotient = {.kind = DML_NUMBER, .as.number = floor(a / b)};
    const dml_scalar whole = dml_apply(L, DM_OP_MUL, &quotient, &y, NULL);
    const dml_scalar rest = dml_apply(L, DM_OP_SUB, &x, &whole, NULL);
    dml_pushscalar(L, &rest);
    return 1;
}

static int hyper_idiv(lua_State *L) {
    dml_scalar x;
    double a, b;
    read_pair(L, &x, &a, &b);
    lua_pushnumber(L, floor(a / b));
    return 1;
}

static const dml_hyperdual *check(lua_State *L) {
    if (dml_classof(L, 1) != DML_CLASS_HYPERDUAL) luaL_typeerror(L, 1, TNAME);
    return lua_touserdata(L, 1);
}

/* x.f, x.a, x.b, x.ab: value, both slopes and the mixed second derivative. */
static int hyper_field(lua_State *L) {
    static const char *const names[] = {"f", "a", "b", "ab"};
    const dml_hyperdual *h = check(L);
    const double parts[] = {h->f, h->a, h->b, h->ab};
    const char *key = lua_type(L, 2) == LUA_TSTRING ? lua_tostring(L, 2) : "";
    for (int i = 0; i < 4; i++)
        if (strcmp(key, names[i]) == 0) return lua_pushnumber(L, parts[i]), 1;
    return 0;
}

static int hyper_tostring(lua_State *L) {
    const dml_scalar x = {.kind = DML_HYPERDUAL, .as.hyper = *check(L)};
    char text[DML_TEXT];
    dml_scalartext(L, text, &x);
    lua_pushstring(L, text);
    return 1;
}

/* Parts that are left out are zero: a constant. */
static int hyper_new(lua_State *L) {
    const dml_scalar x = {.kind = DML_HYPERDUAL,
                          .as.hyper = {.f = dml_checknumber(L, 1),
                                       .a = dml_optnumber(L, 2, 0),
                                       .b = dml_optnumber(L, 3, 0),
                                       .ab = dml_optnumber(L, 4, 0)}};
    dml_pushscalar(L, &x);
    return 1;
}

static const dml_row meta[] = {DML_ARITHMETIC,
                               {"__lt", hyper_lt, NULL},
                               {"__le", hyper_le, NULL},
                               {"__eq", hyper_eq, NULL},
                               {"__mod", hyper_mod, NULL},
                               {"__idiv", hyper_idiv, NULL},
                               {"__tostring", hyper_tostring, NULL},
                               {NULL, NULL, NULL}};
static const dml_row functions[] = {{"hyperdual", hyper_new,
                                     "dm.hyperdual(f [, a, b, ab]) -> dm.hyperdual\n"
                                     "The number f with the derivatives a, b along two directions "
                                     "and ab along both (0 when left out): functions of "
                                     "hyperdual(x, 1, 1, 0) have f, f', f' and f'' in the fields "
                                     "f, a, b, ab (Fike & Alonso 2011)."},
                                    {NULL, NULL, NULL}};

static void open_hyperdual(lua_State *L) {
    dml_setclass(L, DML_CLASS_HYPERDUAL, TNAME);
}

const dml_class dml_class_hyperdual = {
    .name = TNAME,
    .doc = "dm.hyperdual: a number with exact derivatives along two directions\n"
           "fields: f (value), a, b (first derivatives), ab (second); comparisons work on the "
           "value",
    .meta = meta,
    .field = hyper_field,
    .functions = functions,
    .open = open_hyperdual,
};
