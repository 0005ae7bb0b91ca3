/* trace.c - calling a Lua function with symbols, with numbers, and reading what it
 * returns. */
#include "bind/trace/trace.h"
#include "bind/core/missing_key.h"
#include "bind/core/scope.h"

#include "bind/trace/traced_call.h"
#include "bind/value/array.h"
#include "bind/value/trace_log.h"

#include <string.h>

/* The inputs of the graph, numbered through all arguments in their order. */
uint32_t dml_signature_inputs(const dml_signature *s) {
    uint32_t n = 0;
    for (int k = 0; k < s->arguments; k++)
        n += s->length[k] == DML_SCALAR_ARGUMENT ? 1u : (uint32_t)s->length[k];
    return n;
}

/* ---- results ---- */

static const char *type_name(lua_State *L, int arg) {
    if (luaL_getmetafield(L, arg, "__name") == LUA_TSTRING) return lua_tostring(L, -1);
    return luaL_typename(L, arg);
}

/* Raises with what was wanted, what came, and what may have been meant. */
static void wrong_result(lua_State *L, const dml_signature *s, int result) {
    const char *noted = lua_isnil(L, result) ? dml_noted(L) : NULL;
    const char *hint = noted                  ? lua_pushfstring(L, ": %s", noted)
                       : lua_isnil(L, result) ? ": is a return missing?"
                                              : "";
    if (s->outputs == DML_SCALAR_ARGUMENT)
        luaL_error(L, "%s must return a number, got %s%s", s->what, type_name(L, result), hint);
    if (s->outputs == 0)
        luaL_error(L, "%s must return a number, or a vector or table of numbers, got %s%s", s->what,
                   type_name(L, result), hint);
    luaL_error(L, "%s must return a vector or table of %d numbers, got %s%s", s->what, s->outputs,
               type_name(L, result), hint);
}

/* what a user's function gives is looked through, wherever its names stand */
static void refuse_surplus(lua_State *L, const dml_signature *s, int result) {
    const lua_Integer n = lua_type(L, result) == LUA_TTABLE ? luaL_len(L, result) : 0;
    const char *more = dml_surplus(L, result, n);
    if (more)
        dml_refuse_surplus(L, lua_pushfstring(L, "the list that %s returns", s->what), more, n);
}

/* The result is at `result`; it is looked at, not changed. */
uint32_t dml_result_length(lua_State *L, const dml_signature *s, int result) {
    refuse_surplus(L, s, result);
    dml_scalar x;
    const int bare = dml_toscalar(L, result, &x);
    const long n = bare ? 1 : dml_length(L, result);
    if (bare && s->outputs <= 0) return 1;
    if (n < 0 || s->outputs == DML_SCALAR_ARGUMENT || bare) wrong_result(L, s, result);
    if (s->outputs > 0 && n != s->outputs)
        luaL_error(L, "%s must return %d numbers, got %d", s->what, s->outputs, (int)n);
    if (n == 0)
        luaL_error(L, "%s must return a number, or a vector or table of numbers, got none",
                   s->what);
    return (uint32_t)n;
}

/* From 0; raises where an entry of a table is no number. */
dml_scalar dml_result_entry(lua_State *L, const dml_signature *s, int result, uint32_t i) {
    dml_scalar x;
    if (dml_toscalar(L, result, &x)) return x;
    if (dml_toarray(L, result, 1)) return dml_entry(L, result, i);
    lua_geti(L, result, (lua_Integer)i + 1);
    if (!dml_toscalar(L, -1, &x))
        luaL_error(L, "%s must return numbers, but entry %d of its result is %s", s->what,
                   (int)i + 1, type_name(L, -1));
    lua_pop(L, 1);
    return x;
}

/* ---- calls ---- */

/* x points to the first entry of argument k, not of all. */
void dml_pushargument(lua_State *L, const dml_signature *s, int k, const dml_scalar *x) {
    if (s->length[k] == DML_SCALAR_ARGUMENT)
        dml_pushscalar(L, x);
    else
        dml_pushscalars(L, x, (uint32_t)s->length[k]);
}

/* push the function and its arguments, numbers */
static void push_numbers(lua_State *L, int fn, const dml_signature *s, const double *in) {
    lua_pushvalue(L, fn);
    for (int k = 0; k < s->arguments; k++) {
        if (s->length[k] == DML_SCALAR_ARGUMENT) {
            lua_pushnumber(L, *in++);
            continue;
        }
        const uint32_t n = (uint32_t)s->length[k];
        double *v = dml_pushvector(L, n);
        if (n) memcpy(v, in, n * sizeof *v);
        in += n;
    }
}

/* The stack is left as it was. */
void dml_call_numbers(lua_State *L, int fn, const dml_signature *s, const double *in, double *out,
                      uint32_t outputs) {
    fn = lua_absindex(L, fn);
    luaL_checkstack(L, s->arguments + 10, NULL);
    push_numbers(L, fn, s, in);
    dml_callone(L, s->arguments, s->what);
    const int result = lua_gettop(L);
    const uint32_t n = dml_result_length(L, s, result);
    if (n != outputs)
        luaL_error(L, "%s returned %d numbers when it was traced, and %d now", s->what,
                   (int)outputs, (int)n);
    for (uint32_t i = 0; i < outputs; i++) {
        const dml_scalar x = dml_result_entry(L, s, result, i);
        if (x.kind != DML_NUMBER)
            luaL_error(L,
                       "%s returned a %s although its arguments were numbers: is one kept in a "
                       "global or an upvalue?",
                       s->what, x.kind == DML_SYMBOL ? "symbol" : "hyper-dual number");
        out[i] = x.as.number;
    }
    lua_settop(L, result - 1);
}

/* ---- traces ---- */

/* its symbols are dead from here on; its scope is its first member */
static void end_trace(dml_state *state, dml_scope *scope) {
    dml_frame *frame = (dml_frame *)scope;
    state->frames = frame->next;
    dml_leavesymbols(frame);
}

/* it is on top of the stack from here on, and keeps the arena; one that repeats another keeps
 * that one's too */
static dml_frame *begin_trace(lua_State *L, dm_arena *arena, const dml_signature *s,
                              const dml_traced *last) {
    dml_state *state = dml_getstate(L);
    dml_frame *frame = dml_pushscope(L, sizeof *frame, 2, end_trace);
    frame->arena = arena;
    frame->what = s->what;
    frame->keeps_sums = s->keeps_sums;
    frame->may_branch = s->may_branch;
    frame->capture = s->capture;
    frame->request = s->request;
    frame->serial = ++state->serial;
    frame->next = state->frames;
    state->frames = frame;
    dml_pushkeeper(L, arena);
    lua_setiuservalue(L, -2, 2);
    if (last) dml_pushkeeper(L, dm_graph_arena(last->graph));
    if (last) lua_setiuservalue(L, -2, 3);
    return frame;
}

/* the nodes of inputs first .. first + count - 1: the first ones of every trace */
static void make_inputs(const dml_frame *frame, dm_node *out, uint32_t first, uint32_t count) {
    if (frame->own) dm_inputs(frame->own, out, first, count);
    for (uint32_t i = 0; !frame->own && i < count; i++) out[i] = 1 + first + i;
}

/* The function and its arguments; nodes of inputs are the first of any graph. */
static void push_symbols(lua_State *L, int fn, const dml_signature *s, const dml_frame *frame) {
    dml_scalar x = {.kind = DML_SYMBOL, .serial = frame->serial};
    uint32_t input = 0;
    lua_pushvalue(L, fn);
    for (int k = 0; k < s->arguments; k++) {
        if (s->length[k] == DML_SCALAR_ARGUMENT) {
            make_inputs(frame, &x.as.node, input++, 1);
            dml_pushscalar(L, &x);
            continue;
        }
        const uint32_t n = (uint32_t)s->length[k];
        if (s->lazy) {
            lua_pushnil(L);
            input += n;
            continue;
        }
        const dml_array *v = dml_newarray(L, 1, n, 1, &x);
        make_inputs(frame, v->entries, input, n);
        input += n;
    }
    dml_checkgraph(L, frame);
}

/* The result on top becomes nodes in the arena of the frame. */
static void read_result(lua_State *L, const dml_signature *s, const dml_frame *frame,
                        dml_traced *out) {
    const int result = lua_gettop(L);
    const dml_scalar like = {.kind = DML_SYMBOL, .serial = frame->serial};
    const uint32_t n = dml_result_length(L, s, result);
    dm_node *nodes = dm_arena_take(frame->arena, n * sizeof *nodes);
    if (!nodes) luaL_error(L, "not enough memory");
    for (uint32_t i = 0; i < n; i++) {
        const dml_scalar x = dml_result_entry(L, s, result, i);
        if (x.kind == DML_HYPERDUAL)
            luaL_error(L, "%s returned a hyper-dual number while it was traced", s->what);
        if (x.kind == DML_SYMBOL && x.serial != frame->serial)
            luaL_error(L,
                       "%s returned a symbol of another trace: it was kept in a global or an "
                       "upvalue",
                       s->what);
        nodes[i] = dml_lift(L, &x, &like).as.node;
    }
    out->out = nodes;
    out->outputs = n;
    out->bare = dml_length(L, result) == 1 && !lua_istable(L, result) && !dml_toarray(L, result, 1);
}

/* the function ran on to its end although the graph had no more room */
static int is_too_large(lua_State *L, const dml_frame *frame, int may_grow) {
    if (dm_graph_status(frame->graph) == DM_OK) return 0;
    if (!may_grow)
        luaL_error(L,
                   "%s: %s (more than %d nodes): is there a loop with very many rounds? make it "
                   "shorter%s",
                   frame->what, dm_status_text(dm_graph_status(frame->graph)), DM_GRAPH_LIMIT,
                   frame->may_branch ? ", or use derivatives = \"hyperdual\"" : "");
    return 1;
}

typedef struct {
    const dml_signature *s;
    dml_frame *frame;
    dml_traced *out;
} tracing;

/* (function, arguments ..., what is traced): the call and its results */
static int call_traced(lua_State *L) {
    const tracing *t = lua_touserdata(L, -1);
    lua_pop(L, 1);
    dml_callone(L, t->s->arguments, t->s->what);
    read_result(L, t->s, t->frame, t->out);
    return 0;
}

/* The function on symbols. 0: it fails, on symbols that are those of the last time: it may have
 * kept some of what it made of them then, by a table that remembers results, say. */
static int call_with_symbols(lua_State *L, int fn, const tracing *t) {
    const int again = t->frame->symbols != NULL;
    if (again) lua_pushcfunction(L, call_traced);
    push_symbols(L, fn, t->s, t->frame);
    dml_forget(L);
    lua_pushlightuserdata(L, (void *)(uintptr_t)t);
    if (again) return dml_try(L, t->s->arguments + 2, 0);
    lua_pop(L, 1);
    dml_callone(L, t->s->arguments, t->s->what);
    read_result(L, t->s, t->frame, t->out);
    return 1;
}

/* the trace of `frame`, on top of the stack, from its symbols to its results; closes it. 0: it
 * wants new symbols */
static int trace(lua_State *L, int fn, const dml_signature *s, dml_frame *frame, dml_traced *out) {
    const int top = lua_gettop(L) - 1;
    if (!call_with_symbols(L, fn, &(tracing){s, frame, out})) {
        dml_dropsymbols(frame);
        dml_cut(L, top);
        return 0;
    }
    dml_checkgraph(L, frame);
    const dml_traced *last = dml_repeated(frame, out->out, out->outputs);
    if (last) {
        *out = *last;
    } else {
        dml_leavelast(L, frame);
        out->log = frame->log;
        out->graph = is_too_large(L, frame, s->may_grow) ? NULL : frame->own;
        out->inputs = dml_signature_inputs(s);
    }
    dml_cut(L, top);
    return 1;
}

/* Raises where there is none. */
static void need(lua_State *L, int memory) {
    if (!memory) luaL_error(L, "not enough memory");
}

/* The frame is closed on return, also by an error (it is a value to be closed). */
void dml_trace(lua_State *L, int fn, const dml_signature *s, dm_arena *arena, dml_traced *out) {
    fn = lua_absindex(L, fn);
    luaL_checkstack(L, s->arguments + 12, NULL);
    dml_frame *frame = begin_trace(L, arena, s, NULL);
    const uint32_t inputs = dml_signature_inputs(s);
    frame->graph = frame->own =
        s->lazy ? dm_graph_lazy(arena, inputs) : dm_graph_new(arena, inputs);
    need(L, frame->own != NULL);
    trace(L, fn, s, frame, out);
}

/* Where symbols of the last time cannot be used, it is traced again without them. */
void dml_retrace(lua_State *L, int fn, const dml_signature *s, dm_arena *arena,
                 const dml_traced *last, dml_traced *out) {
    if (s->lazy) {
        dml_trace(L, fn, s, arena, out);
        return;
    }
    fn = lua_absindex(L, fn);
    luaL_checkstack(L, s->arguments + 12, NULL);
    dml_frame *frame = begin_trace(L, arena, s, last);
    need(L, dml_beginlog(frame, last));
    if (!frame->last) frame->graph = frame->own = dm_graph_new(arena, dml_signature_inputs(s));
    need(L, frame->graph != NULL);
    if (!trace(L, fn, s, frame, out)) dml_retrace(L, fn, s, arena, NULL, out);
}

/* Constants by their bits: 0 and -0, and NaN, are told apart. */
static int same_node(const dm_expr *a, const dm_expr *b) {
    if (a->op != b->op) return 0;
    if (a->op == DM_OP_CONSTANT || a->op == DM_OP_IMPLICIT)
        return memcmp(&a->as.value, &b->as.value, sizeof a->as.value) == 0;
    if (a->op == DM_OP_INPUT) return a->as.input == b->as.input;
    return memcmp(a->as.arg, b->as.arg, sizeof a->as.arg) == 0; /* 0 where unused */
}

/* What was made later, derivatives for instance, is not looked at. */
int dml_samenodes(const dm_graph *a, const dm_graph *b, uint32_t size) {
    const dm_expr *x = dm_graph_at(a, 0), *y = dm_graph_at(b, 0);
    for (dm_node i = 0; i < size; i++)
        if (!same_node(x + i, y + i)) return 0;
    return 1;
}
