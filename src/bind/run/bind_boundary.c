/* bind_boundary.c - `dm.stationary`: a sequence that makes a sum over its windows stationary. */
#include "algebra/derive.h"
#include "bind/core/bind_failure.h"
#include "bind/trace/backend.h"
#include "bind/trace/trace.h"
#include "bind/value/array.h"
#include "run/boundary.h"

#include <string.h>

enum { OPTIONS = 1, TERM };

static void check_status(lua_State *L, dm_status status) {
    if (status != DM_OK) luaL_error(L, "'term': %s", dm_status_text(status));
}

static void *take(lua_State *L, dm_arena *arena, size_t size) {
    void *block = dm_arena_take(arena, size);
    if (!block) luaL_error(L, "not enough memory");
    return block;
}

/* first and second derivatives of the term, a function of window * block numbers */
static void build(lua_State *L, dm_boundary *p) {
    const uint32_t w = p->window * p->block;
    const dml_signature s = {.what = "term",
                             .arguments = 1,
                             .length = {(int)w},
                             .outputs = DML_SCALAR_ARGUMENT};
    dm_arena *arena = dml_pusharena(L);
    dm_compile *compile = dml_findbackend(L, NULL)->compile;
    dml_traced t;
    dml_trace(L, TERM, &s, arena, &t);
    dm_node *nodes = take(L, arena, (w + (size_t)w * w) * sizeof *nodes);
    dm_hessian(t.graph, *t.out, 0, w, nodes, nodes + w);
    check_status(L, dm_graph_status(t.graph));
    check_status(L, compile(&p->slope, t.graph, nodes, w, arena));
    check_status(L, compile(&p->hessian, t.graph, nodes, w + w * w, arena));
}

static uint32_t count_of(lua_State *L, const char *key, long most) {
    const long n = dml_count(L, OPTIONS, key, 1, 0);
    if (n > most) luaL_error(L, "field '%s' must be at most %d", key, (int)most);
    return (uint32_t)n;
}

/* 1 for every number that is not free */
static uint8_t *read_given(lua_State *L, uint32_t n) {
    uint8_t *given = lua_newuserdatauv(L, n, 0);
    lua_getfield(L, OPTIONS, "given");
    luaL_argcheck(L, lua_istable(L, -1) && lua_rawlen(L, -1) == n, OPTIONS,
                  "field 'given' must be a list of booleans, one for each number of x");
    for (uint32_t i = 0; i < n; i++) {
        lua_rawgeti(L, -1, (lua_Integer)i + 1);
        given[i] = (uint8_t)lua_toboolean(L, -1);
        lua_pop(L, 1);
    }
    lua_pop(L, 1);
    return given;
}

static void push_report(lua_State *L, const dm_boundary_report *report, dm_status status) {
    lua_createtable(L, 0, 4);
    lua_pushstring(L, dm_status_code(status)), lua_setfield(L, -2, "code");
    lua_pushstring(L, dm_status_text(status)), lua_setfield(L, -2, "text");
    lua_pushinteger(L, report->iterations), lua_setfield(L, -2, "iterations");
    lua_pushnumber(L, report->residual), lua_setfield(L, -2, "residual");
}

static int stationary(lua_State *L) {
    static const char *const known[] = {"term", "sites", "block", "window", "x", "given", NULL};
    luaL_checktype(L, OPTIONS, LUA_TTABLE);
    lua_settop(L, OPTIONS);
    dml_options(L, OPTIONS, known);
    if (lua_getfield(L, OPTIONS, "term") != LUA_TFUNCTION)
        luaL_error(L, "field 'term' must be a function (got %s)", luaL_typename(L, -1));
    dm_boundary p = {.sites = count_of(L, "sites", 10000000),
                     .block = count_of(L, "block", 64),
                     .window = count_of(L, "window", 16),
                     .tolerance = 4e-15,
                     .max_iterations = 60,
                     .stop = &dml_stop};
    if (p.window > p.sites) luaL_error(L, "'window' has more sites than there are");
    const uint32_t n = p.sites * p.block;
    p.given = read_given(L, n);
    build(L, &p);
    double *work = lua_newuserdatauv(L, dm_boundary_work(&p) * sizeof *work, 0);
    double *x = dml_pushvector(L, n);
    dml_numbers(L, OPTIONS, "x", x, n);
    dm_boundary_report report;
    const dm_status status = dm_boundary_solve(x, &p, work, &report);
    if (status == DM_STOPPED) dml_stopped(L, "dm.stationary", report.iterations);
    push_report(L, &report, status);
    return 2;
}

static const dml_row functions[] =
    {{"stationary", stationary,
      "dm.stationary{term=, sites=, block=, window=, x=, given=} -> dm.vector, report\n"
      "The sequence x of `sites` blocks of `block` numbers for which the sum of term(w) over all "
      "windows w of `window` neighbouring blocks (a vector) is stationary, from the guess x by "
      "Newton's method on the whole (a band). given: a list of booleans, true for the numbers that "
      "stay. report: code (\"ok\", \"no_convergence\", \"singular\", \"not_finite\"), text, "
      "iterations, residual (the largest derivative left). Look at report.code: x is no solution "
      "when it is not \"ok\". Ctrl-C raises a dm.failure, whose path is x so far."},
     {NULL, NULL, NULL}};

const dml_class dml_class_boundary = {
    .functions = functions,
};
