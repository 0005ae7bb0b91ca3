/* value.c - scalars of the three kinds: in and out of Lua, and every operation on
 * them. */
#include "bind/value/array.h"
#include "bind/value/hyperdual.h"
#include "bind/value/trace_log.h"

#include <math.h>
#include <string.h>

/* Numbers first: nearly all arguments are. */
int dml_toscalar(lua_State *L, int arg, dml_scalar *out) {
    *out = (dml_scalar){.kind = DML_NUMBER};
    if (lua_type(L, arg) == LUA_TNUMBER) {
        out->as.number = lua_tonumber(L, arg);
        return 1;
    }
    const int class = dml_classof(L, arg);
    if (class == DML_CLASS_SYMBOL) {
        const dml_symbol *s = lua_touserdata(L, arg);
        *out = (dml_scalar){.kind = DML_SYMBOL, .serial = s->serial, .as.node = s->node};
    } else if (class == DML_CLASS_HYPERDUAL) {
        out->kind = DML_HYPERDUAL;
        out->as.hyper = *(const dml_hyperdual *)lua_touserdata(L, arg);
    }
    return class == DML_CLASS_SYMBOL || class == DML_CLASS_HYPERDUAL;
}

/* the kept symbol of that node, made when it is missing; 0: none is kept. Nodes of a trace that
 * has become another one have new symbols: theirs mean something else. */
static int push_kept(lua_State *L, const dml_frame *frame, dm_node node) {
    dml_symbols *kept = frame->symbols;
    if (!kept || !frame->last || node >= kept->count) return 0;
    dml_symbol *s = kept->of[node];
    if (!s) {
        if (!lua_checkstack(kept->keeper, 2)) return 0;
        s = dml_newvalue(L, DML_CLASS_SYMBOL, sizeof *s, 0);
        lua_pushvalue(L, -1);
        lua_xmove(L, kept->keeper, 1);
        *s = (dml_symbol){node, frame->serial, lua_gettop(kept->keeper)};
        kept->of[node] = s;
        return 1;
    }
    s->serial = frame->serial;
    lua_pushvalue(kept->keeper, s->slot);
    lua_xmove(kept->keeper, L, 1);
    return 1;
}

/* A new userdata with the number of its trace, so that one which outlives it is told. */
static void push_symbol(lua_State *L, dm_node node, uint32_t serial) {
    const dml_frame *frame = dml_getstate(L)->frames;
    if (frame && frame->serial == serial && push_kept(L, frame, node)) return;
    dml_symbol *s = dml_newvalue(L, DML_CLASS_SYMBOL, sizeof *s, 0);
    *s = (dml_symbol){.node = node, .serial = serial};
}

/* The inverse of dml_toscalar. */
void dml_pushscalar(lua_State *L, const dml_scalar *x) {
    if (x->kind == DML_NUMBER) {
        lua_pushnumber(L, x->as.number);
    } else if (x->kind == DML_SYMBOL) {
        push_symbol(L, x->as.node, x->serial);
    } else {
        dml_hyperdual *h = dml_newvalue(L, DML_CLASS_HYPERDUAL, sizeof *h, 0);
        *h = x->as.hyper;
    }
}

/* ---- kinds ---- */

/* The trace that a symbol belongs to, or an error: it has ended. */
static dml_frame *live_frame(lua_State *L, uint32_t serial) {
    dml_frame *frame = dml_findframe(L, serial);
    if (!frame)
        luaL_error(L, "a symbol was used after its trace had ended: it was kept in a global or an "
                      "upvalue of the traced function; keep numbers there instead");
    return frame;
}

/* The kind that both fit: number < symbol, number < hyper-dual number; symbols of two traces,
 * and symbols with hyper-dual numbers, have none. */
dml_scalar dml_common(lua_State *L, const dml_scalar *a, const dml_scalar *b) {
    if (a->kind == DML_NUMBER) return *b;
    if (b->kind == DML_NUMBER) return *a;
    if (a->kind != b->kind)
        luaL_error(L, "a symbol and a hyper-dual number cannot be combined: one function is being "
                      "traced while another is differentiated by hyper-dual numbers");
    if (a->kind == DML_SYMBOL && a->serial != b->serial) {
        const dml_frame *frame = dml_getstate(L)->frames;
        live_frame(L, a->serial);
        live_frame(L, b->serial);
        if (frame->capture && a->serial == frame->serial) return *a;
        if (frame->capture && b->serial == frame->serial) return *b;
        luaL_error(L, "symbols of two traces meet: a function that is traced inside another must "
                      "not use the outer one's arguments; pass them as arguments");
    }
    return *a;
}

/* x as a scalar of the kind of `like`: a number becomes a constant node, or has slopes zero. */
dml_scalar dml_lift(lua_State *L, const dml_scalar *x, const dml_scalar *like) {
    if (x->kind == DML_SYMBOL && like->kind == DML_SYMBOL && x->serial != like->serial) {
        dml_frame *frame = live_frame(L, like->serial);
        dml_scalar inside = *like;
        if (frame->capture)
            return inside.as.node = frame->capture(L, frame, x->serial, x->as.node), inside;
    }
    if (x->kind == like->kind) return *x;
    if (x->kind != DML_NUMBER || like->kind == DML_NUMBER)
        luaL_error(L, "a symbol or hyper-dual number cannot become a plain number");
    dml_scalar lifted = *like;
    if (like->kind == DML_SYMBOL) {
        dml_frame *frame = live_frame(L, like->serial);
        lifted.as.node = dml_constant(L, frame, x->as.number);
        dml_checkgraph(L, frame);
    } else {
        lifted.as.hyper = (dml_hyperdual){.f = x->as.number};
    }
    return lifted;
}

/* ---- operations ---- */

static dml_scalar symbolic(lua_State *L, dm_op op, const dml_scalar *x, int n) {
    dml_frame *frame = live_frame(L, x[0].serial);
    dm_node node[3] = {0, 0, 0};
    for (int k = 0; k < n; k++) node[k] = x[k].as.node;
    dml_scalar y = x[0];
    y.as.node = dml_operation(L, frame, op, node[0], node[1], node[2]);
    dml_checkgraph(L, frame);
    return y;
}

static dml_scalar numeric(dm_op op, const dml_scalar *const x[3], int n) {
    const double b = n > 1 ? x[1]->as.number : 0.0, c = n > 2 ? x[2]->as.number : 0.0;
    return (dml_scalar){.kind = DML_NUMBER, .as.number = dm_op_value(op, x[0]->as.number, b, c)};
}

/* One operation of the table, whatever the kind: the place where all arithmetic of a script
 * ends. */
dml_scalar dml_apply(lua_State *L, dm_op op, const dml_scalar *a, const dml_scalar *b,
                     const dml_scalar *c) {
    const dml_scalar *const x[3] = {a, b, c};
    const int n = dm_op_operands(op);
    dml_scalar kind = *a, lifted[3];
    if (op == DM_OP_WHERE && a->kind == DML_NUMBER) return a->as.number > 0 ? *b : *c;
    for (int k = 1; k < n; k++) kind = dml_common(L, &kind, x[k]);
    if (kind.kind == DML_NUMBER) return numeric(op, x, n);
    for (int k = 0; k < n; k++) lifted[k] = dml_lift(L, x[k], &kind);
    if (kind.kind == DML_SYMBOL) return symbolic(L, op, lifted, n);
    kind.as.hyper =
        dml_hyper_apply(op, &lifted[0].as.hyper, &lifted[1].as.hyper, &lifted[2].as.hyper);
    return kind;
}

/* Node of the symbol at arg; 0: it is none, or not of the newest trace. A kept one is known by
 * where it is: at that place nothing else can be. */
static int symbol_node(lua_State *L, int arg, const dml_state *state, dm_node *node) {
    const dml_symbol *s = lua_touserdata(L, arg);
    if (!s || lua_rawlen(L, arg) != sizeof *s) return 0;
    *node = s->node;
    const dml_symbols *kept = state->frames->symbols;
    const int is_kept = kept && s->node < kept->count && kept->of[s->node] == s;
    if (!is_kept && dml_classof(L, arg) != DML_CLASS_SYMBOL) return 0;
    return s->serial == state->frames->serial;
}

int dml_symbolic(lua_State *L, dm_op op) {
    const dml_state *state = dml_getstate(L);
    dml_frame *frame = state->frames;
    dm_node node[2] = {0, 0};
    int symbol[2];
    if (!frame || frame->scope.thread != L) return 0; /* which may be dead */
    for (int k = 0; k < 2; k++) {
        symbol[k] = symbol_node(L, k + 1, state, node + k);
        if (!symbol[k] && lua_type(L, k + 1) != LUA_TNUMBER) return 0;
    }
    if (!symbol[0] && !symbol[1]) return 0;
    for (int k = 0; k < 2; k++)
        if (!symbol[k]) node[k] = dml_constant(L, frame, lua_tonumber(L, k + 1));
    const dm_node made = dml_operation(L, frame, op, node[0], node[1], 0);
    dml_checkgraph(L, frame);
    if (!push_kept(L, frame, made)) push_symbol(L, made, frame->serial);
    return 1;
}

/* ---- anything that can stand for a vector ---- */

enum { CHUNK = 16 }; /* entries of a table on the stack at once */

/* -1 is no error: callers say what they expected. */
int dml_islist(lua_State *L, int arg) {
    if (lua_istable(L, arg)) return 1;
    if (!lua_isuserdata(L, arg) || luaL_getmetafield(L, arg, "__list") == LUA_TNIL) return 0;
    lua_pop(L, 1);
    return 1;
}

/* is the key on top of the stack but one that of an entry 1 to n, or the count of table.pack? */
static int is_of_list(lua_State *L, lua_Integer n) {
    if (lua_isinteger(L, -2)) return lua_tointeger(L, -2) >= 1 && lua_tointeger(L, -2) <= n;
    return lua_type(L, -2) == LUA_TSTRING && strcmp(lua_tostring(L, -2), "n") == 0 &&
           lua_isinteger(L, -1) && lua_tointeger(L, -1) == n;
}

/* the first key behind the one on top, which is popped, that is none of a list; NULL: none is */
static const char *stranger(lua_State *L, int arg, lua_Integer n) {
    for (; lua_next(L, arg); lua_pop(L, 1)) {
        if (is_of_list(L, n)) continue;
        lua_pop(L, 1);
        return luaL_tolstring(L, -1, NULL);
    }
    return NULL;
}

/* does a plain table stand there, and not an object, whose owner knows what it holds? */
static int is_plain_table(lua_State *L, int arg) {
    if (lua_type(L, arg) != LUA_TTABLE) return 0;
    if (!lua_getmetatable(L, arg)) return 1;
    lua_pop(L, 1);
    return 0;
}

const char *dml_surplus(lua_State *L, int arg, lua_Integer n) {
    if (n <= 0 || !is_plain_table(L, arg)) return NULL;
    arg = lua_absindex(L, arg);
    luaL_checkstack(L, 4, NULL);
    lua_pushnil(L);
    return stranger(L, arg, n);
}

/* Entries are ahead of names where the table was written as a list, { 1, 2, x = 3 }: one look
 * behind the last of them, not one at each. */
static void check_behind(lua_State *L, int arg, lua_Integer n, const char *what) {
    if (n <= 0 || !is_plain_table(L, arg)) return;
    arg = lua_absindex(L, arg);
    luaL_checkstack(L, 4, NULL);
    lua_pushinteger(L, n);
    const char *more = stranger(L, arg, n);
    if (more) dml_refuse_surplus(L, what, more, n);
}

void dml_refuse_surplus(lua_State *L, const char *what, const char *more, lua_Integer n) {
    luaL_error(L,
               "%s has '%s' beside its entries 1 to %d, which would be lost: entries have no "
               "names, and none is left out",
               what, more, (int)n);
}

long dml_bare_length(lua_State *L, int arg) {
    dml_scalar x;
    const dml_array *a = dml_toarray(L, arg, 1);
    if (a) return (long)a->rows;
    if (dml_islist(L, arg)) {
        const lua_Integer n = luaL_len(L, arg);
        return n < 0 || n > UINT32_MAX ? -1 : (long)n;
    }
    return dml_toscalar(L, arg, &x) ? 1 : -1;
}

long dml_length(lua_State *L, int arg) {
    const long n = dml_bare_length(L, arg);
    check_behind(L, arg, n, "a list");
    return n;
}

const char *dml_kindname(lua_State *L, int arg) {
    if (luaL_getmetafield(L, arg, "__name") == LUA_TNIL) return luaL_typename(L, arg);
    const char *name = lua_tostring(L, -1); /* lives on in the metatable */
    lua_pop(L, 1);
    return name ? name : luaL_typename(L, arg);
}

int dml_tryentry(lua_State *L, int arg, uint32_t i, dml_scalar *x, const char **type) {
    const dml_array *a = dml_toarray(L, arg, 1);
    if (a && i < a->rows) return *x = dml_get(a, i), 1;
    if (a || !dml_islist(L, arg)) {
        *type = luaL_typename(L, arg);
        return dml_toscalar(L, arg, x);
    }
    luaL_checkstack(L, 4, NULL);
    lua_geti(L, arg, (lua_Integer)i + 1);
    const int there = dml_toscalar(L, -1, x);
    if (!there) *type = *dml_text_hint(L, -1) ? "string" DML_TEXT_HINT : dml_kindname(L, -1);
    lua_pop(L, 1);
    return there;
}

dml_scalar dml_entry(lua_State *L, int arg, uint32_t i) {
    dml_scalar x;
    const char *type = "";
    if (!dml_tryentry(L, arg, i, &x, &type))
        luaL_error(L, "entry %d must be a number, got %s%s", (int)i + 1, type,
                   i == 0 && strcmp(type, "table") == 0 ? ": rows make a dm.matrix {{1, 2}, {3, 4}}"
                                                        : "");
    return x;
}

/* what stands at arg instead of a vector */
static const char *found(lua_State *L, int arg) {
    return lua_type(L, arg) == LUA_TNUMBER ? "a number" : dml_kindname(L, arg);
}

/* entries i .. i + CHUNK - 1 of a plain table, if all are finite numbers: the stack is cleared
 * once for all */
static int read_chunk(lua_State *L, int arg, double *out, uint32_t i) {
    const int top = lua_gettop(L);
    int fine = 1;
    for (int k = 1; k <= CHUNK; k++) fine &= lua_rawgeti(L, arg, (lua_Integer)i + k) == LUA_TNUMBER;
    for (int k = 1; fine && k <= CHUNK; k++) {
        out[i + (uint32_t)k - 1] = lua_tonumberx(L, top + k, NULL);
        fine = isfinite(out[i + (uint32_t)k - 1]);
    }
    lua_settop(L, top);
    return fine;
}

uint32_t dml_readplain(lua_State *L, int arg, double *out, uint32_t n) {
    const dml_array *a = dml_toarray(L, arg, 1);
    const double *entries = a ? dml_numbersof(a) : NULL;
    uint32_t i = 0;
    int number = 1;
    if (entries) {
        for (; i < n && isfinite(entries[i]); i++) out[i] = entries[i];
        return i;
    }
    if (a || !lua_istable(L, arg)) return 0;
    luaL_checkstack(L, CHUNK, NULL);
    if (luaL_getmetafield(L, arg, "__index") != LUA_TNIL) return lua_pop(L, 1), 0;
    while (n - i >= CHUNK && read_chunk(L, arg, out, i)) i += CHUNK;
    for (; i < n; i++) {
        number = lua_rawgeti(L, arg, (lua_Integer)i + 1) == LUA_TNUMBER;
        if (number) out[i] = lua_tonumberx(L, -1, NULL);
        lua_settop(L, -2);
        if (!number || !isfinite(out[i])) break;
    }
    return i;
}

/* Vectors are read in their block, tables in pieces of raw entries, all else entry by entry,
 * with the first bad one named. */
void dml_vectorarg(lua_State *L, int arg, const char *name, double *out, uint32_t n) {
    arg = lua_absindex(L, arg);
    const long length = dml_bare_length(L, arg);
    check_behind(L, arg, length, name);
    if (length < 0 || (lua_type(L, arg) == LUA_TNUMBER && n != 1))
        luaL_error(L, "%s must be a vector or table of %d numbers (got %s)", name, (int)n,
                   found(L, arg));
    if (length != (long)n)
        luaL_error(L, "%s must have %d entries (got %d)", name, (int)n, (int)length);
    luaL_checkstack(L, 4, NULL);
    for (uint32_t i = dml_readplain(L, arg, out, n); i < n; i++) {
        dml_scalar x;
        const char *type = "";
        if (!dml_tryentry(L, arg, i, &x, &type))
            luaL_error(L, "%s: entry %d must be a number, got %s", name, (int)i + 1, type);
        if (x.kind != DML_NUMBER)
            luaL_error(L, "%s: entry %d is a %s, but a plain number is needed here", name,
                       (int)i + 1,
                       x.kind == DML_SYMBOL ? "symbol of a trace" : "hyper-dual number");
        if (!isfinite(x.as.number))
            luaL_error(L, "%s: entry %d is %s, but must be finite", name, (int)i + 1,
                       isnan(x.as.number) ? "NaN" : "infinite");
        out[i] = x.as.number;
    }
}

void dml_numbers(lua_State *L, int arg, const char *key, double *out, uint32_t n) {
    if (!dml_field(L, arg, key)) {
        const char *expected = lua_pushfstring(L, "a vector or table of %d numbers", (int)n);
        lua_pushvalue(L, -2);
        dml_wrongfield(L, key, expected);
    }
    const char *name = lua_pushfstring(L, "field '%s'", key);
    dml_vectorarg(L, -2, name, out, n);
    lua_pop(L, 2);
}
