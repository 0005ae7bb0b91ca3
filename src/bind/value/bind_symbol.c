/* bind_symbol.c - `dm.symbol`: what a traced function gets instead of numbers.
 * Arithmetic records; what would need a value raises. */
#include "bind/core/state.h"
#include "bind/value/array.h"

#include <string.h>

#define TNAME "dm.symbol"

/* the trace of the symbol among the operands */
static uint32_t serial_of(lua_State *L) {
    dml_scalar x;
    for (int arg = 1; arg <= 2; arg++)
        if (dml_toscalar(L, arg, &x) && x.kind == DML_SYMBOL) return x.serial;
    return 0;
}

static const char *traced_function(lua_State *L) {
    const dml_frame *frame = dml_findframe(L, serial_of(L));
    return frame ? frame->what : "the function";
}

/* What needs a value cannot be recorded. */
static int refuse(lua_State *L, const char *how) {
    lua_settop(L, 2);
    return dml_refusesymbol(L, how, serial_of(L));
}

static int refuse_lt(lua_State *L) {
    if (dml_inmax(L)) return 0; /* nil: not less */
    return refuse(L, "the comparison < or >");
}
static int refuse_le(lua_State *L) {
    return refuse(L, "the comparison <= or >=");
}
static int refuse_eq(lua_State *L) {
    return refuse(L, "the comparison == or ~=");
}
static int refuse_mod(lua_State *L) {
    return refuse(L, "the operator %");
}
static int refuse_idiv(lua_State *L) {
    return refuse(L, "the operator //");
}
static int refuse_bits(lua_State *L) {
    return refuse(L, "a bit operator");
}
static int refuse_concat(lua_State *L) {
    return refuse(L, "the operator ..");
}
static int refuse_len(lua_State *L) {
    return refuse(L, "the operator #");
}
static int refuse_call(lua_State *L) {
    return refuse(L, "a call");
}

/* Is the key at 2 one that a vector has: a whole number, or the name of a method? */
static int is_of_vectors(lua_State *L) {
    if (lua_isinteger(L, 2)) return 1;
    luaL_getmetatable(L, "dm.vector");
    lua_getfield(L, -1, "methods");
    if (lua_istable(L, -1)) lua_pushvalue(L, 2), lua_rawget(L, -2);
    const int found = lua_isfunction(L, -1);
    lua_settop(L, 2);
    return found;
}

/* x.y of a symbol: the message guesses which function should have got another argument there. */
static int refuse_field(lua_State *L) {
    lua_settop(L, 2);
    const int vector = is_of_vectors(L);
    const char *key = luaL_tolstring(L, 2, NULL);
    const char *traced = traced_function(L);
    const char *hint =
        strcmp(traced, "the function") == 0
            ? "of a vector argument say how many it has, as in dm.derivative(f, n)"
        : strcmp(traced, "constraint") == 0
            ? "constraint gets (q, t, params); a condition on velocities is `rolling`"
        : vector ? "velocities and momenta of a product are one flat list of "
                   "numbers, factor after factor: xi:slice(1, 3)"
                 : "the params of a system are the fourth argument, after q, v, t";
    return luaL_error(L, "a symbol has no field '%s': it stands for one number of %s (%s)", key,
                      traced, hint);
}

static int symbol_tostring(lua_State *L) {
    dml_scalar x;
    char text[DML_TEXT];
    if (!dml_toscalar(L, 1, &x) || x.kind != DML_SYMBOL) return luaL_typeerror(L, 1, TNAME);
    dml_scalartext(L, text, &x);
    lua_pushstring(L, text);
    return 1;
}

static const dml_row meta[] = {DML_ARITHMETIC,
                               {"__lt", refuse_lt, NULL},
                               {"__le", refuse_le, NULL},
                               {"__eq", refuse_eq, NULL},
                               {"__mod", refuse_mod, NULL},
                               {"__idiv", refuse_idiv, NULL},
                               {"__band", refuse_bits, NULL},
                               {"__bor", refuse_bits, NULL},
                               {"__bxor", refuse_bits, NULL},
                               {"__bnot", refuse_bits, NULL},
                               {"__shl", refuse_bits, NULL},
                               {"__shr", refuse_bits, NULL},
                               {"__concat", refuse_concat, NULL},
                               {"__len", refuse_len, NULL},
                               {"__call", refuse_call, NULL},
                               {"__newindex", refuse_field, NULL},
                               {"__tostring", symbol_tostring, NULL},
                               {NULL, NULL, NULL}};

static void open_symbol(lua_State *L) {
    dml_setclass(L, DML_CLASS_SYMBOL, TNAME);
}

const dml_class dml_class_symbol = {
    .name = TNAME,
    .doc = "dm.symbol: an argument of a function while it is traced\n"
           "+ - * / ^ and math.* record an expression; comparisons, %, // and whatever else needs "
           "a value raise",
    .meta = meta,
    .field = refuse_field,
    .open = open_symbol,
};
