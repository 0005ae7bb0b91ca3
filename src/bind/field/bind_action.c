/* bind_action.c - a sum over the cells of a mesh as a function of the values of forms, with its
 * gradient and its sparse Hessian: what is made stationary. */
#include "algebra/derive.h"
#include "bind/core/state.h"
#include "bind/dec/bind_sparse.h"
#include "bind/model/model_sums.h"
#include "bind/trace/backend.h"
#include "bind/trace/trace.h"
#include "bind/value/array.h"
#include "chain/curvature.h"
#include "chain/loops.h"

#include <math.h>
#include <string.h>

#define ACTION "dm.cell_action"

/* user value 1 keeps the arena, 2 what the columns point to */
typedef struct {
    uint32_t n, sums;
    dm_kernel value, gradient, factors; /* factors: dS/dS_k of the sums, as numbers of x */
    dm_curvature curvature;
    double *factor; /* [sums] */
    int curved;     /* curvature is there */
    dm_graph *g;
    dm_node root;
    const dm_sum **sum;
    dm_arena *arena;
} action;

/* The action at stack index 1. */
static action *check(lua_State *L) {
    return luaL_checkudata(L, 1, ACTION);
}

/* Raises where something could not be made. */
static void need(lua_State *L, dm_status status) {
    if (status == DM_NO_MEMORY) luaL_error(L, "not enough memory");
    if (status != DM_OK) luaL_error(L, "%s", dm_status_text(status));
}

/* the sums that the value depends on; it must be linear in them */
static void read_sums(lua_State *L, action *a) {
    uint32_t count = 0;
    for (const dm_sum *s = dm_sums(a->g); s; s = s->next) count++;
    a->sum = dm_arena_take(a->arena, (count + 1) * sizeof(void *));
    a->factor = dm_arena_take(a->arena, (count + 1) * sizeof *a->factor);
    if (!a->sum || !a->factor) luaL_error(L, "not enough memory");
    for (const dm_sum *s = dm_sums(a->g); s; s = s->next) {
        dm_node factor;
        dm_gradient(a->g, a->root, s->input, 1, &factor);
        if (!factor) continue;
        if (!dm_is_constant(a->g, factor, a->factor + a->sums))
            luaL_error(L, "a function of a sum over cells: the action must be a sum of such sums, "
                          "times numbers");
        a->sum[a->sums++] = s;
    }
}

/* of the function f(x) */
static dml_signature signature(lua_Integer n) {
    return (dml_signature){.what = "the term",
                           .arguments = 1,
                           .length = {(int)n},
                           .outputs = DML_SCALAR_ARGUMENT,
                           .keeps_sums = 1,
                           .lazy = 1};
}

/* core.cell_action(n, f): f() is called with symbols */
static int action_new(lua_State *L) {
    const lua_Integer n = dml_checkinteger(L, 1);
    const dml_signature sig = signature(n);
    dml_traced traced;
    luaL_argcheck(L, n >= 1 && n < INT32_MAX / 4, 1, "a number of entries, 1 at least, is needed");
    luaL_checktype(L, 2, LUA_TFUNCTION);
    lua_settop(L, 2);
    action *a = lua_newuserdatauv(L, sizeof *a, 1);
    *a = (action){.n = (uint32_t)n};
    a->arena = dml_pusharena(L);
    lua_setiuservalue(L, 3, 1);
    luaL_setmetatable(L, ACTION);
    dml_trace(L, 2, &sig, a->arena, &traced);
    a->g = traced.graph;
    a->root = traced.out[0];
    read_sums(L, a);
    dm_compile *compile = dml_findbackend(L, NULL)->compile;
    need(L, dm_loops_value(&a->value, a->g, a->root, compile, a->arena));
    need(L, dm_loops_gradient(&a->gradient, a->g, a->root, NULL, a->n, compile, a->arena));
    return 1;
}

/* a:check(f, x): f is called with numbers, where the trace has symbols */
static int action_check(lua_State *L) {
    const action *a = check(L);
    const dml_signature sig = signature(a->n);
    const double *x = dml_numbersat(L, 3, "x", (int32_t)a->n), *with = x;
    double value = 0.0;
    luaL_checktype(L, 2, LUA_TFUNCTION);
    lua_settop(L, 3);
    dm_kernel_prepare(&a->value, &value);
    dm_kernel_eval(&a->value, x, &value);
    if (!isfinite(value)) return 0;
    const dm_kernel *outer = a->sums ? dm_loops_outer(&a->value, &with) : &a->value;
    dml_pushgiven(L, a->g, 0);
    dml_trace_check_start(L, 2, &sig, outer, with);
    dml_cut(L, 3);
    return 0;
}

/* a:value(x) */
static int action_value(lua_State *L) {
    const action *a = check(L);
    double value = 0.0;
    const double *x = dml_numbersat(L, 2, "x", (int32_t)a->n);
    dm_kernel_prepare(&a->value, &value);
    dm_kernel_eval(&a->value, x, &value);
    lua_pushnumber(L, value);
    return 1;
}

/* a:gradient(x) */
static int action_gradient(lua_State *L) {
    const action *a = check(L);
    const double *x = dml_numbersat(L, 2, "x", (int32_t)a->n);
    double *out = dml_pushvector(L, a->n);
    dm_kernel_eval(&a->gradient, x, out);
    return 1;
}

/* a:hessian(x): the pattern is found at the first call */
static int action_hessian(lua_State *L) {
    action *a = check(L);
    const double *x = dml_numbersat(L, 2, "x", (int32_t)a->n);
    dm_arena *arena;
    if (!a->curved)
        need(L, dm_curvature_open(&a->curvature, a->sum, a->sums, a->n,
                                  dml_findbackend(L, NULL)->compile, a->arena));
    a->curved = 1;
    dm_curvature_at(&a->curvature, a->factor, x);
    const dm_sparse *from = &a->curvature.A;
    const int32_t entries = from->start[from->columns];
    dm_sparse *A = dml_newsparse(L, &arena);
    const dm_status status = dm_sparse_room(A, arena, from->rows, from->columns, entries);
    if (status == DM_OK) {
        memcpy(A->start, from->start, ((size_t)from->columns + 1) * sizeof *A->start);
        memcpy(A->row, from->row, (size_t)entries * sizeof *A->row);
        memcpy(A->value, from->value, (size_t)entries * sizeof *A->value);
    }
    dml_sparsedone(L, status);
    return 1;
}

static const dml_row methods[] =
    {{"check", action_check,
      "action:check(f, x)\n"
      "Compare the function f(x) that the action is of, called with a vector of numbers, with what "
      "it was with symbols; raises where they differ."},
     {"value", action_value, "action:value(x) -> number\nThe sum at x, as many numbers as it has."},
     {"gradient", action_gradient,
      "action:gradient(x) -> dm.vector\nIts derivatives by x; 0 where x is held."},
     {"hessian", action_hessian,
      "action:hessian(x) -> dm.sparse\n"
      "Its second derivatives, symmetric to the last bit; all of the diagonal is stored."},
     {NULL, NULL, NULL}};

static const dml_row functions[] =
    {{"cell_action", action_new,
      "core.cell_action(n, f) -> dm.cell_action\n"
      "A sum of sums over cells (K:sum) of n numbers: f() is called once, with symbols."},
     {NULL, NULL, NULL}};

const dml_class dml_class_action = {
    .name = ACTION,
    .doc = "dm.cell_action: a sum over the cells of a mesh with gradient and Hessian\n"
           "made of the term of a stationary problem, a function of all values of a form",
    .methods = methods,
    .functions = functions,
};
