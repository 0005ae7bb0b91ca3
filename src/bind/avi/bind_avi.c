/* bind_avi.c - asynchronous steps of a field: the cells of its potential, their limits, runs. */
#include "bind/avi/field_rows.h"
#include "bind/core/state.h"
#include "bind/run/bind_path.h"
#include "bind/trace/backend.h"
#include "bind/value/array.h"
#include "code/tape/tape.h"
#include "field/avi/avi.h"
#include "graph/analyse.h"

#include <math.h>
#include <string.h>
#include <time.h>

#define CELLS "dm.avi_cells"

/* user value 1: the system, 2: its model, 3: the arena */
typedef struct {
    dm_avi a;
    dm_arena *arena;
    const dm_sum **sums;
    dm_avi_factors factors;
    dm_kernel of_t;
    uint32_t count;
    double *limit, *alone; /* [cells], once asked for: dm_avi_limits */
} avi;

/* The cells at stack index 1. */
static avi *check(lua_State *L) {
    return luaL_checkudata(L, 1, CELLS);
}

/* Raises where something could not be made. */
static void need(lua_State *L, dm_status status) {
    if (status == DM_NO_MEMORY) luaL_error(L, "not enough memory");
    if (status == DM_STOPPED) dml_checkstop(L);
    if (status != DM_OK) luaL_error(L, "rule 'avi': %s", dm_status_text(status));
}

/* factors of the sums, of which some are functions of t */
static void make_factors(lua_State *L, avi *k, const dml_model *m, const dm_node *node, double t) {
    dm_avi_factors *f = &k->factors;
    const uint32_t inputs = dm_graph_inputs(m->graph), n = 2 * m->n;
    if (dm_depends(m->graph, node, k->count, 0, n) ||
        dm_depends(m->graph, node, k->count, n + 1, inputs - n - 1))
        luaL_error(L, "rule 'avi': a sum over cells is multiplied by what is no number and no "
                      "function of t alone: cells have no action of their own then");
    f->in = dm_arena_take(k->arena, inputs * sizeof *f->in);
    if (!f->in || dm_tape_build(&k->of_t, m->graph, node, k->count, k->arena) != DM_OK)
        luaL_error(L, "not enough memory");
    memset(f->in, 0, inputs * sizeof *f->in);
    f->at = n;
    f->in[n] = t;
    f->of_t = &k->of_t;
    dm_kernel_prepare(&k->of_t, f->out);
    dm_kernel_eval(&k->of_t, f->in, f->out);
}

/* the sums of the potential with their factors, as they are at time t */
static void read_sums(lua_State *L, avi *k, const dml_model *m, double t) {
    uint32_t count = 0;
    for (const dm_sum *s = dm_sums(m->graph); s; s = s->next) count++;
    dm_node *node = dm_arena_take(k->arena, (count + 1) * sizeof *node);
    double *factor = dm_arena_take(k->arena, (count + 1) * sizeof *factor);
    k->sums = node ? dm_cells_sums(m->graph, m->lagrangian, node, &k->count, k->arena) : NULL;
    if (!k->sums || !factor) luaL_error(L, "not enough memory");
    k->factors = (dm_avi_factors){.value = factor, .out = factor};
    uint32_t numbers = 0;
    for (uint32_t i = 0; i < k->count; i++)
        numbers += (uint32_t)dm_is_constant(m->graph, node[i], factor + i);
    if (numbers < k->count) make_factors(L, k, m, node, t);
}

/* core.avi(system, q, t): its cells */
static int avi_new(lua_State *L) {
    const dml_system *s = dml_checksystem(L, 1);
    const double t = dml_optnumber(L, 3, 0.0);
    lua_settop(L, 2);
    avi *k = lua_newuserdatauv(L, sizeof *k, 3);
    memset(k, 0, sizeof *k);
    luaL_setmetatable(L, CELLS);
    lua_pushvalue(L, 1);
    lua_setiuservalue(L, 3, 1);
    const dml_model *m = dml_pushmodel(L, 1);
    if (!m->model.inverse_mass || !(m->model.structure & DM_CELLS))
        return luaL_error(L, "rule 'avi' is for fields on meshes (K:field)");
    if (m->model.unfit)
        return luaL_error(L, "rule 'avi' cannot step this system: %s", m->model.unfit);
    if (m->model.massless)
        return luaL_error(L, "rule 'avi' cannot eliminate values without mass; take verlet");
    if (m->model.sphere)
        return luaL_error(L, "rule 'avi' cannot step values on a sphere; take rattle");
    if (m->model.worked)
        return luaL_error(L, "rule 'avi': the field has forces beside L (force, absorbing), and no "
                             "cell says when they act; take verlet or midpoint");
    lua_setiuservalue(L, 3, 2);
    k->arena = dml_pusharena(L);
    lua_setiuservalue(L, 3, 3);
    read_sums(L, k, m, t);
    need(L, dm_avi_open(&k->a, k->sums, &k->factors, k->count, s->n,
                        dml_findbackend(L, NULL)->compile, k->arena));
    k->a.w = m->model.inverse_mass;
    dml_vectorarg(L, 2, "q", k->a.x, s->n);
    k->a.x[2 * (size_t)s->n] = t;
    lua_settop(L, 3);
    return 1;
}

/* cells:sums(): pairs of the call of a sum in L, from 1, and how many cells it has */
static int avi_sums(lua_State *L) {
    const avi *k = check(L);
    lua_newtable(L);
    for (uint32_t i = 0; i < k->a.sums; i++) {
        const dm_sum *s = k->a.sum[i].sum;
        lua_createtable(L, 2, 0);
        lua_pushinteger(L, (lua_Integer)s->call + 1);
        lua_rawseti(L, -2, 1);
        lua_pushinteger(L, s->bodies);
        lua_rawseti(L, -2, 2);
        lua_rawseti(L, -2, (lua_Integer)i + 1);
    }
    return 1;
}

/* cells:limits() */
static int avi_limits(lua_State *L) {
    avi *k = check(L);
    dm_curvature c;
    if (!k->limit) {
        const size_t cells = k->a.cells;
        double *limit = dm_arena_take(k->arena, (2 * cells + 1) * sizeof *limit);
        if (!limit) return luaL_error(L, "not enough memory");
        need(L, dm_curvature_open(&c, k->sums, k->count, k->a.n, dml_findbackend(L, NULL)->compile,
                                  k->arena));
        need(L, dm_avi_limits(&k->a, &c, limit, limit + cells, k->arena));
        k->alone = limit + cells;
        k->limit = limit;
    }
    memcpy(dml_pushvector(L, k->a.cells), k->limit, k->a.cells * sizeof *k->limit);
    return 1;
}

/* cells:resonances(margin), once the steps are known */
static int avi_resonances(lua_State *L) {
    const avi *k = check(L);
    if (!k->limit || !k->a.near) return luaL_error(L, "limits and a run first");
    lua_pushinteger(L, (lua_Integer)dm_avi_resonances(&k->a, k->alone, dml_checknumber(L, 2)));
    return 1;
}

/* what a run is asked for: at stack indices 2 (options), 3 (steps), 4 (times) */
typedef struct {
    dml_field_rows rows;
    double *times, *state; /* [count], of the last row that is kept as an ending */
    uint32_t count;
    int goes_on, half;
    uint32_t taken; /* the row that `state` is of */
    clock_t looked; /* when it was taken */
} asked;

/* a path of rows at these times */
static dml_path *push_path(lua_State *L, const avi *k, asked *run) {
    lua_getiuservalue(L, 1, 1);
    dml_path *path = dml_field_rows_open(L, &run->rows, lua_gettop(L), k->a.n, run->count,
                                         run->goes_on ? run->times[0] : NAN);
    lua_getiuservalue(L, 1, 2);
    lua_setiuservalue(L, -2, DML_PATH_MODEL);
    path->rule = "avi";
    path->t0 = path->t = run->times[0];
    return path;
}

/* the start, from option p, or from an ending { state =, t0 = } in option `from` */
static dm_status begin(lua_State *L, avi *k, const asked *run) {
    const size_t size = dm_avi_state_size(&k->a);
    dml_vectorarg(L, 3, "h", k->a.h, k->a.cells);
    if (!run->goes_on) {
        lua_getfield(L, 2, "p");
        dml_vectorarg(L, lua_gettop(L), "p", k->a.p, k->a.n);
        lua_pop(L, 1);
        return dm_avi_start(&k->a, run->times[0], run->half, k->arena);
    }
    lua_getfield(L, 2, "from");
    dml_vectorarg(L, lua_gettop(L), "from", run->state, (uint32_t)size);
    lua_pop(L, 1);
    const double t0 = dml_number(L, 2, "t0", 0.0);
    const dm_status status =
        dm_avi_resume(&k->a, t0, run->half, run->state, run->times[0], k->arena);
    if (status == DM_NOT_FINITE)
        luaL_error(L,
                   "the checkpoint is no state of these cells at t = %f: times of entries or "
                   "numbers of kicks do not fit",
                   run->times[0]);
    return status;
}

/* Now and then a state is kept, for what goes on from a run that is stopped between two rows. */
static void keep(const avi *k, asked *run, uint32_t row, int now) {
    enum { OFTEN = 5 }; /* times a second */
    if (!now && clock() - run->looked < CLOCKS_PER_SEC / OFTEN) return;
    dm_avi_state(&k->a, run->state);
    run->taken = row;
    run->looked = clock();
}

/* row i, where the run has come to its time */
static dm_status add_row(lua_State *L, avi *k, asked *run, uint32_t i) {
    const uint32_t n = k->a.n;
    double *row;
    const dm_status status = dml_field_rows_next(&run->rows, &row);
    row[0] = run->rows.path->t = run->times[i];
    dm_avi_row(&k->a, run->times[i], row + 1, row + 1 + n);
    if (i || run->goes_on || !run->half) return status;
    lua_getfield(L, 2, "p"); /* half a kick that was given at t0 has not happened yet */
    dml_vectorarg(L, lua_gettop(L), "p", row + 1 + n, n);
    lua_pop(L, 1);
    return status;
}

/* a row at every time */
static dm_status go(lua_State *L, avi *k, asked *run) {
    dm_status status = DM_OK;
    for (uint32_t i = 0; i < run->count && status == DM_OK; i++) {
        if (i) status = dm_avi_run(&k->a, run->times[i], &dml_stop);
        if (status == DM_OK) status = add_row(L, k, run, i);
        if (status == DM_OK) keep(k, run, i, i == 0 || i + 1 == run->count);
    }
    return status;
}

/* cells:run(options, h, times) -> path, status, events, row of the ending, why */
static int avi_run(lua_State *L) {
    avi *k = check(L);
    asked run = {.count = (uint32_t)dml_length(L, 4)};
    lua_settop(L, 4);
    run.times = lua_newuserdatauv(L, (run.count + 1) * sizeof *run.times, 0);
    dml_vectorarg(L, 4, "times", run.times, run.count);
    run.half = (lua_getfield(L, 2, "half"), lua_toboolean(L, -1));
    run.goes_on = lua_getfield(L, 2, "from") != LUA_TNIL;
    run.state = dml_pushvector(L, (uint32_t)dm_avi_state_size(&k->a));
    lua_setfield(L, 2, "ending");
    lua_pop(L, 2);
    need(L, begin(L, k, &run));
    dml_path *path = push_path(L, k, &run);
    const int at = lua_gettop(L);
    dm_status status = dml_field_rows_close(L, &run.rows, go(L, k, &run));
    path->steps = (long)k->a.events;
    for (uint32_t i = 0; i < k->a.cells; i++) path->h = fmax(path->h, k->a.h[i]);
    if (status == DM_STOPPED) dml_stop = 0;
    lua_settop(L, at);
    lua_pushinteger(L, status);
    lua_pushinteger(L, (lua_Integer)k->a.events);
    lua_pushinteger(L, (lua_Integer)run.taken + 1);
    if (status != DM_NOT_WRITTEN) return 4;
    dml_field_rows_why(L, &run.rows);
    return 5;
}

static const dml_row methods[] =
    {{"sums", avi_sums,
      "cells:sums() -> list of { call, cells }\n"
      "The sums of the potential in the order of their cells: number of the sum in L, and cells."},
     {"limits", avi_limits,
      "cells:limits() -> dm.vector\n"
      "2 / omega of every cell alone at q, with its share of the masses of its entries."},
     {"resonances", avi_resonances,
      "cells:resonances(margin) -> number\n"
      "Pairs of cells with a common entry of which one kicks the other near a multiple of its half "
      "period, as steps turn it, by so many half periods."},
     {"run", avi_run,
      "cells:run({p=, half=, file=, from=, t0=}, h, times) -> dm.path, status, events, row, why\n"
      "Steps h of every cell from q and p at times[1]; a row at every time. Sets `ending` of the "
      "options, the state at a row, the last one unless the run was stopped; a run that goes on "
      "from there is given it as `from`, and the time t0 of its start."},
     {NULL, NULL, NULL}};

static const dml_row functions[] =
    {{"avi", avi_new,
      "core.avi(system, q [, t]) -> dm.avi_cells\n"
      "The cells of the potential of a field, for asynchronous steps from q at time t."},
     {NULL, NULL, NULL}};

const dml_class dml_class_avi = {
    .name = CELLS,
    .doc = "dm.avi_cells: the cells of the potential of a field, each with a step of its own\n"
           "what field:solver{ rule = \"avi\" } runs",
    .methods = methods,
    .functions = functions,
};
