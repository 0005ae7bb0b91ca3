/* bind_root.c - `dm.root`: functions that are only known by an equation, called on numbers,
 * symbols and hyper-dual numbers. */
#include "bind/trace/bind_root.h"
#include "bind/core/state.h"
#include "bind/trace/apart.h"
#include "bind/value/array.h"

#include <math.h>
#include <string.h>

enum { FIELDS = 1, SHAPES = 2 };

/* ---- calls ---- */

/* all entries of the arguments from index 2 on, and what kind they have in common */
static dml_scalar read_arguments(lua_State *L, const dml_root_shape *s, int top, dml_scalar *x) {
    dml_scalar kind = {.kind = DML_NUMBER};
    for (int arg = 2; arg <= top; arg++) {
        const int n = s->s.length[arg - 1] == DML_SCALAR_ARGUMENT ? 1 : s->s.length[arg - 1];
        for (int i = 0; i < n; i++) {
            *x = dml_entry(L, arg, (uint32_t)i);
            kind = dml_common(L, &kind, x++);
        }
    }
    return kind;
}

/* what the arguments are, if not all are numbers */
static dml_kind kind_of(lua_State *L, int top) {
    for (int arg = 2; arg <= top; arg++) {
        const long n = dml_length(L, arg);
        for (long i = 0; i < n; i++) {
            const dml_kind kind = dml_entry(L, arg, (uint32_t)i).kind;
            if (kind != DML_NUMBER) return kind;
        }
    }
    return DML_NUMBER;
}

/* real parts */
static void check_finite(lua_State *L, const dml_scalar *x, uint32_t n, double *out) {
    for (uint32_t i = 0; i < n; i++) {
        out[i] = x[i].kind == DML_NUMBER ? x[i].as.number : x[i].as.hyper.f;
        if (!isfinite(out[i]))
            luaL_error(L, "%s: entry %d of its arguments is %s, but must be finite",
                       dml_rootname(L, 1), (int)i + 1, isnan(out[i]) ? "NaN" : "infinite");
    }
}

/* the equations called with the root: not what was traced? */
static int has_changed(lua_State *L, const dml_root_shape *s) {
    const uint32_t m = s->equation.outputs, size = s->unknowns + s->inputs;
    const int top = lua_gettop(L);
    dml_pushapart(L);
    double *block = lua_newuserdatauv(L, (size + m) * sizeof *block, 0), *out = block + size;
    lua_getiuservalue(L, 1, FIELDS);
    const int stationary = lua_getfield(L, -1, "stationary") != LUA_TNIL;
    if (!stationary) lua_getfield(L, -2, "equations");
    memcpy(block, s->y, s->unknowns * sizeof *block);
    memcpy(block + s->unknowns, s->x, s->inputs * sizeof *block);
    dml_call_numbers(L, -1, &s->s, block, out, m);
    const int differs = dml_rootdiffers(s, out);
    dml_cut(L, top);
    return differs;
}

/* of all arguments those that the root depends on */
static void choose(const dml_root_shape *s, dml_scalar *x) {
    for (uint32_t i = 0; i < s->uses; i++) x[i] = x[s->used[i]];
}

/* A number where there is one unknown that was asked for as such, else a vector. */
static void push_root(lua_State *L, const dml_root_shape *s, const dml_scalar *y) {
    if (s->s.length[0] == DML_SCALAR_ARGUMENT)
        dml_pushscalar(L, y);
    else
        dml_pushscalars(L, y, s->unknowns);
}

/* on numbers; if `compared`, the functions are traced anew where a call of the equations shows that
 * they have changed, or where there is no root: those that are the same have none */
static dml_root_shape *solve(lua_State *L, int top, int compared) {
    const dml_root_shape *failed = NULL;
    for (int tries = 0;; tries++) {
        lua_settop(L, top);
        dml_root_shape *s = compared ? dml_rootchecked(L, tries > 0) : dml_rootshape(L, tries > 0);
        if (s == failed) dml_raiseroot(L, s->f);
        dml_scalar *x = lua_newuserdatauv(L, (s->inputs + 1) * sizeof *x, 0);
        read_arguments(L, s, top, x);
        check_finite(L, x, s->inputs, s->x);
        for (uint32_t i = 0; i < s->uses; i++) s->chosen[i] = s->x[s->used[i]];
        const dm_root_outcome outcome = dm_root_solve(&s->solver, s->chosen, s->y, s->inverse);
        if (outcome == DM_ROOT_FOUND && !(compared && has_changed(L, s))) return s;
        if (outcome != DM_ROOT_FOUND && (tries || !compared)) dml_raiseroot(L, s->f);
        failed = outcome == DM_ROOT_FOUND ? NULL : s;
        if (tries)
            luaL_error(L,
                       "%s is not what its trace says: it must not use random numbers or the time, "
                       "nor branch on its arguments by == or a truth test",
                       s->s.what);
    }
}

/* the trace that all others are nested in */
static uint32_t outermost(lua_State *L) {
    dml_state *state = dml_getstate(L);
    uint32_t serial = 0;
    dml_leavedead(state);
    for (const dml_frame *f = state->frames; f; f = f->next) serial = f->serial;
    return serial;
}

/* once in a trace its functions are traced too, to see whether they are what they were */
static dml_root_shape *shape_in_trace(lua_State *L, int top) {
    dml_root_shape *s = dml_rootchecked(L, 0);
    if (s->trace == outermost(L)) return s;
    lua_settop(L, top);
    s = dml_rootchecked(L, 1);
    s->trace = outermost(L);
    return s;
}

/* The root becomes a leaf of the graph; its equations stay a graph of their own. */
static int call_on_symbols(lua_State *L, int top, int value) {
    const dml_root_shape *s = shape_in_trace(L, top);
    const uint32_t r = s->unknowns, first = value ? r : 0;
    dml_scalar *x = lua_newuserdatauv(L, (s->inputs + r + 1) * sizeof *x, 0);
    dml_scalar *y = x + s->inputs + 1;
    read_arguments(L, s, top, x);
    choose(s, x);
    for (uint32_t k = 0; k < (value ? 1 : r); k++)
        y[k] = dml_rootentry(L, s->f, x, s->uses, first + k);
    if (value)
        dml_pushscalar(L, y);
    else
        push_root(L, s, y);
    return 1;
}

/* Derivatives of the root follow from those of its equations. */
static int call_on_hyperduals(lua_State *L, int top, int value) {
    dml_root_shape *s = solve(L, top, 1);
    dml_scalar *x = lua_newuserdatauv(L, (s->inputs + s->unknowns + 1) * sizeof *x, 0);
    dml_scalar *y = x + s->inputs + 1;
    read_arguments(L, s, top, x);
    choose(s, x);
    if (value) {
        *y = dml_rootentry(L, s->f, x, s->uses, s->unknowns);
        dml_pushscalar(L, y);
        return 1;
    }
    dml_roothyper(L, s->f, &s->solver, x, y);
    push_root(L, s, y);
    return 1;
}

/* Arguments stand at 2 .. top; value: S is asked for, not the root. */
static int call_special(lua_State *L, dml_kind kind, int top, int value) {
    return kind == DML_SYMBOL ? call_on_symbols(L, top, value) : call_on_hyperduals(L, top, value);
}

/* (root, x ...): plain numbers, unless one of the arguments is special. */
static int call(lua_State *L, int compared) {
    luaL_checkudata(L, 1, DML_ROOT);
    const int top = lua_gettop(L);
    const dml_kind kind = kind_of(L, top);
    if (kind != DML_NUMBER) return call_special(L, kind, top, 0);
    const dml_root_shape *s = solve(L, top, compared);
    if (s->s.length[0] == DML_SCALAR_ARGUMENT)
        lua_pushnumber(L, *s->y);
    else
        memcpy(dml_pushvector(L, s->unknowns), s->y, s->unknowns * sizeof *s->y);
    return 1;
}

static int root_call(lua_State *L) {
    return call(L, 1);
}

static int root_traced(lua_State *L) {
    return call(L, 0);
}

/* S at the root, of one that was given by `stationary`. */
static int root_value(lua_State *L) {
    luaL_checkudata(L, 1, DML_ROOT);
    const int top = lua_gettop(L);
    lua_getiuservalue(L, 1, FIELDS);
    if (lua_getfield(L, -1, "stationary") == LUA_TNIL)
        luaL_error(L, "%s is given by 'equations': only a root of 'stationary' has a value",
                   dml_rootname(L, 1));
    lua_settop(L, top);
    const dml_kind kind = kind_of(L, top);
    if (kind != DML_NUMBER) return call_special(L, kind, top, 1);
    const dml_root_shape *s = solve(L, top, 1);
    lua_pushnumber(L, dml_rootvalue(s));
    return 1;
}

/* f:condition(x...): Skeel's condition number is in the solver; the inverse is what a script may
 * look at */
static int root_inverse(lua_State *L) {
    luaL_checkudata(L, 1, DML_ROOT);
    const dml_root_shape *s = solve(L, lua_gettop(L), 1);
    const uint32_t r = s->unknowns;
    memcpy(dml_pushmatrix(L, r, r), s->inverse, r * (size_t)r * sizeof *s->inverse);
    return 1;
}

/* ---- making one ---- */

/* Field `key` of the options at 1; needed: nil raises, too. */
static void check_type(lua_State *L, const char *key, int needed) {
    const int type = lua_getfield(L, 1, key);
    if (type != LUA_TFUNCTION && (needed || type != LUA_TNIL))
        luaL_error(L, "field '%s' must be a function (got %s)", key, luaL_typename(L, -1));
    lua_pop(L, 1);
}

/* A list of strings or nil. */
static void check_list(lua_State *L, const char *key) {
    const int type = lua_getfield(L, 1, key);
    if (type != LUA_TTABLE && type != LUA_TNIL)
        luaL_error(L, "field '%s' must be a list (got %s)", key, luaL_typename(L, -1));
    lua_pop(L, 1);
}

/* All fields before anything is traced. */
static void check_options(lua_State *L) {
    static const char *const known[] = {"equations", "stationary", "unknowns", "start", "branch",
                                        "angles",    "name",       "failure",  NULL};
    luaL_checktype(L, 1, LUA_TTABLE);
    dml_options(L, 1, known);
    const int stationary = lua_getfield(L, 1, "stationary") != LUA_TNIL;
    const int equations = lua_getfield(L, 1, "equations") != LUA_TNIL;
    if (stationary == equations)
        luaL_error(L, "give one of 'equations', a function(y, x, ...) of as many numbers as "
                      "unknowns, and 'stationary', a function(y, x, ...) of one number");
    check_type(L, "equations", !stationary);
    check_type(L, "stationary", stationary);
    check_type(L, "branch", 0);
    dml_text(L, 1, "name");
    dml_text(L, 1, "failure");
    check_list(L, "angles");
    const int start = lua_getfield(L, 1, "start");
    dml_count(L, 1, "unknowns", 1, 1);
    if (start == LUA_TNIL && lua_getfield(L, 1, "unknowns") == LUA_TNIL)
        luaL_error(L, "give 'start' (a number, a list of numbers or a function of the arguments) "
                      "or the number of 'unknowns'");
    if (start != LUA_TNIL && start != LUA_TFUNCTION && dml_length(L, -1) < 1)
        luaL_error(L,
                   "field 'start' must be a number, a list of numbers, a list of such lists, or a "
                   "function of the arguments (got %s)",
                   luaL_typename(L, -1));
    lua_settop(L, 1);
}

/* (options) -> root; it is traced when its arguments are known. */
static int root_new(lua_State *L) {
    lua_settop(L, 1);
    check_options(L);
    lua_newuserdatauv(L, 1, 2);
    lua_newtable(L);
    for (lua_pushnil(L); lua_next(L, 1);) {
        lua_pushvalue(L, -2);
        lua_insert(L, -2);
        lua_rawset(L, -4);
    }
    if (lua_getfield(L, -1, "name") == LUA_TNIL) {
        lua_pushliteral(L, "dm.root");
        lua_setfield(L, -3, "name");
    }
    lua_pop(L, 1);
    lua_setiuservalue(L, 2, FIELDS);
    lua_newtable(L);
    lua_setiuservalue(L, 2, SHAPES);
    luaL_setmetatable(L, DML_ROOT);
    return 1;
}

/* Its name and unknowns. */
static int root_tostring(lua_State *L) {
    luaL_checkudata(L, 1, DML_ROOT);
    const char *name = dml_rootname(L, 1);
    if (strcmp(name, DML_ROOT) == 0)
        lua_pushliteral(L, "implicit function");
    else
        lua_pushfstring(L, "implicit function '%s'", name);
    return 1;
}

static const dml_row meta[] = {{"__call", root_call, NULL},
                               {"__tostring", root_tostring, NULL},
                               {NULL, NULL, NULL}};
static const dml_row methods[] =
    {{"traced", root_traced,
      "f:traced(x, ...) -> number or dm.vector\n"
      "f(x, ...) of the equations as they were traced: they are not called to see whether the "
      "trace says what they do, nor whether what they read has changed since. For many calls of "
      "one root, of which each costs less, where the result is looked at anyway."},
     {"value", root_value,
      "f:value(x, ...) -> number\n"
      "S(y, x, ...) at the point y where it is stationary. Its first derivatives are those of S at "
      "fixed y, so a Lagrangian that is such a value costs no derivative of y."},
     {"inverse", root_inverse,
      "f:inverse(x, ...) -> dm.matrix\n"
      "The inverse of dF/dy at the root: entry (i, k) is how much unknown i moves where equation k "
      "is off by one. On numbers."},
     {NULL, NULL, NULL}};
static const dml_row functions[] =
    {{"root", root_new,
      "dm.root{equations= | stationary=, start= | unknowns=, branch=, angles=, name=, failure=} -> "
      "dm.root\n"
      "The function y = f(x, ...) with equations(y, x, ...) = 0: as many numbers as unknowns; or "
      "for which stationary(y, x, ...), one number, is stationary in y. Arguments are numbers, "
      "vectors or tables of numbers. start: where Newton's method begins, a list (or a number: "
      "then y is one), a list of lists to be tried in turn, or a function of the arguments; "
      "unknowns = r without a start: r zeros. branch(y, x, ...) > 0 tells the root that is meant "
      "from others. angles = {i, ...}: these unknowns are angles in rad, of which the equations "
      "are periodic: whole turns are taken off them, so that they keep their digits. y depends on "
      "the arguments alone, not on earlier calls. In a function that is "
      "traced f has exact derivatives of any order, so Lagrangians, discrete Lagrangians, "
      "constraints, forces and events may use it; it may call other roots. Raises, or ends a run, "
      "where there is no root, dF/dy is singular or the branch is left: the message has the name, "
      "where, the residual or condition number, and the text of failure."},
     {NULL, NULL, NULL}};

const dml_class dml_class_root = {
    .name = DML_ROOT,
    .doc = "dm.root: a function that is only known by an equation, made by dm.root{equations=, "
           "start=}\n"
           "called on numbers, vectors or tables; also inside of traced functions and of other "
           "roots",
    .meta = meta,
    .methods = methods,
    .functions = functions,
};
