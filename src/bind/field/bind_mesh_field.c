/* bind_mesh_field.c - what K:field, which is written in Lua, asks of a system of cells. */
#include "bind/dec/bind_sparse.h"
#include "bind/model/bind_system.h"
#include "bind/model/model_sums.h"
#include "bind/trace/backend.h"
#include "bind/value/array.h"
#include "chain/curvature.h"
#include "code/tape/tape.h"
#include "graph/analyse.h"

#include <math.h>
#include <string.h>

/* core.field_system{...}: dm.system whose L reads q and v by sums over cells */
static int field_system(lua_State *L) {
    static const char *const known[] = {"Q", "L", "field", "params", "name", NULL};
    luaL_checktype(L, 1, LUA_TTABLE);
    dml_push_rn(L, (uint32_t)dml_count(L, 1, "Q", 1, 0));
    lua_setfield(L, 1, "Q");
    dml_newsystem(L, known, 0);
    return 1;
}

/* does a sum read t, input 2 n, in a column that its term depends on? */
static int reads_time(const dm_sum *s, uint32_t n) {
    for (uint32_t c = 0; c < s->columns; c++)
        if (!s->column[c].data && s->column[c].first == 2 * n &&
            dm_depends(s->term, &s->value, 1, c, 1))
            return 1;
    return 0;
}

/* core.field_is_timed(system): does L itself depend on t, whatever the forces beside it do? */
static int field_is_timed(lua_State *L) {
    const uint32_t n = dml_checksystem(L, 1)->n;
    const dml_model *m = dml_pushlast(L, 1, NULL);
    luaL_argcheck(L, m->graph != NULL, 1, "it is no field");
    int timed = dm_depends(m->graph, &m->lagrangian, 1, 2 * n, 1);
    for (const dm_sum *s = dm_sums(m->graph); s; s = s->next) timed |= !s->work && reads_time(s, n);
    lua_pushboolean(L, timed);
    return 1;
}

/* core.field_check(system, q, t) */
static int field_check(lua_State *L) {
    const dml_system *s = dml_checksystem(L, 1);
    const double t = dml_optnumber(L, 3, 0.0);
    dml_model *m = dml_pushlast(L, 1, NULL);
    double *x = lua_newuserdatauv(L, (2 * (size_t)s->n + 1) * sizeof *x, 0), value;
    memset(x, 0, (2 * (size_t)s->n + 1) * sizeof *x);
    dml_vectorarg(L, 2, "q", x, s->n);
    x[2 * (size_t)s->n] = t;
    dml_want(L, m, DM_WANT_VALUE, NULL);
    dm_kernel_prepare(&m->model.value, &value);
    dm_kernel_eval(&m->model.value, x, &value);
    if (isfinite(value)) dml_checkmodel(L, 1, m, x);
    return 0;
}

/* factors of the sums over cells in L: numbers at time t */
static void read_factors(lua_State *L, const dml_model *m, const dm_node *node, uint32_t count,
                         double t, double *out) {
    const uint32_t inputs = dm_sum_first(m->graph);
    dm_kernel k;
    double *x = lua_newuserdatauv(L, dm_graph_inputs(m->graph) * sizeof *x, 0);
    memset(x, 0, dm_graph_inputs(m->graph) * sizeof *x);
    x[inputs - 1] = t;
    if (!count) return;
    if (dm_tape_build(&k, m->graph, node, count, m->arena) != DM_OK)
        luaL_error(L, "not enough memory");
    dm_kernel_prepare(&k, out);
    dm_kernel_eval(&k, x, out);
    lua_pop(L, 1);
}

/* Second derivatives of a function of sums are a full matrix: every cell meets every other one. */
static void need_linear(lua_State *L, const dml_model *m, const dm_node *factor, uint32_t count) {
    const uint32_t first = dm_sum_first(m->graph);
    if (dm_depends(m->graph, factor, count, first, dm_graph_inputs(m->graph) - first))
        luaL_error(L, "L is a function of sums over cells that is not linear in them, as the "
                      "product of two sums is: its second derivatives couple all cells, and modes, "
                      "limits of stability and values without mass are not had of it");
}

/* core.field_hessian(system, q, t): d2L/dq2 at v = 0 */
static int field_hessian(lua_State *L) {
    const dml_system *s = dml_checksystem(L, 1);
    const double t = dml_optnumber(L, 3, 0.0);
    dml_model *m = dml_pushmodel(L, 1);
    luaL_argcheck(L, m->graph && dm_sum_over_cells(m->graph), 1, "it has no sums over cells");
    double *x = lua_newuserdatauv(L, (2 * (size_t)s->n + 1) * sizeof *x, 0);
    memset(x, 0, (2 * (size_t)s->n + 1) * sizeof *x);
    dml_vectorarg(L, 2, "q", x, s->n);
    x[2 * (size_t)s->n] = t;
    uint32_t count = 0;
    for (const dm_sum *k = dm_sums(m->graph); k; k = k->next) count++;
    dm_node *node = lua_newuserdatauv(L, (count + 1) * sizeof *node, 0);
    double *factor = lua_newuserdatauv(L, (count + 1) * sizeof *factor, 0);
    const dm_sum **sums = dm_cells_sums(m->graph, m->lagrangian, node, &count, m->arena);
    dm_curvature c;
    if (sums) need_linear(L, m, node, count);
    if (!sums || dm_curvature_open(&c, sums, count, s->n, dml_findbackend(L, NULL)->compile,
                                   m->arena) != DM_OK)
        return luaL_error(L, "not enough memory");
    read_factors(L, m, node, count, t, factor);
    dm_curvature_at(&c, factor, x);
    dm_arena *arena;
    dm_sparse *A = dml_newsparse(L, &arena);
    const int32_t entries = c.A.start[c.A.columns];
    const dm_status status = dm_sparse_room(A, arena, c.A.rows, c.A.columns, entries);
    if (status == DM_OK) {
        memcpy(A->start, c.A.start, ((size_t)c.A.columns + 1) * sizeof *A->start);
        memcpy(A->row, c.A.row, (size_t)entries * sizeof *A->row);
        memcpy(A->value, c.A.value, (size_t)entries * sizeof *A->value);
    }
    dml_sparsedone(L, status);
    return 1;
}

static const dml_row functions[] = {
    {"field_system", field_system,
     "core.field_system{Q=, L=, field=, params=, name=} -> dm.system\n"
     "A system on R^Q whose L(q, v, t, params) gets nil for q and v while it is traced: sums over "
     "cells "
     "read them."},
    {"field_is_timed", field_is_timed,
     "core.field_is_timed(system) -> boolean\n"
     "Does L itself depend on t, whatever the forces beside it do?"},
    {"field_check", field_check,
     "core.field_check(system, q [, t])\n"
     "Compare L, called with numbers, with its trace at q, v = 0, where it is finite; raises where "
     "they differ."},
    {"field_hessian", field_hessian,
     "core.field_hessian(system, q [, t]) -> dm.sparse\nThe second derivatives of L by q, v = 0."},
    {NULL, NULL, NULL}};

const dml_class dml_class_mesh_field = {
    .functions = functions,
};
