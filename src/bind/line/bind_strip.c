/* bind_strip.c - `core.strip`: levels of fields on a line, for the Lua modules that make fields of
 * them (dm.line). */
#include "bind/line/bind_strip.h"

#include "bind/core/bind_failure.h"
#include "bind/dec/bind_sparse.h"
#include "bind/value/array.h"

#include <math.h>
#include <stddef.h>
#include <string.h>

/* a vector of all nodes, an option of the table at 2; NULL: not given */
static const double *level_of(lua_State *L, const dml_strip *d, const char *key) {
    if (lua_getfield(L, 2, key) == LUA_TNIL) return NULL; /* the value stays on the stack */
    return dml_numbersat(L, lua_gettop(L), key, (int32_t)dm_strip_unknowns(&d->strip));
}

/* rows of a block that is larger than what a matrix holds, or what the machine does */
static void check_rows(lua_State *L, long rows, uint32_t n) {
    if ((double)rows * n > 1e9)
        luaL_error(L, "%I rows of %d numbers are too many: raise 'every'", (LUAI_UACINT)rows,
                   (int)n);
}

/* Numbers in memory of the collector. */
static double *block(lua_State *L, size_t count) {
    return lua_newuserdatauv(L, (count + 1) * sizeof(double), 0);
}

/* t[key] = the first rows of a block, t being on top. */
static void set_matrix(lua_State *L, const char *key, const double *from, long rows, uint32_t n) {
    memcpy(dml_pushmatrix(L, (uint32_t)rows, n), from, (size_t)rows * n * sizeof *from);
    lua_setfield(L, -2, key);
}

/* and of a column */
static void set_vector(lua_State *L, const char *key, const double *from, long rows) {
    memcpy(dml_pushvector(L, (uint32_t)rows), from, (size_t)rows * sizeof *from);
    lua_setfield(L, -2, key);
}

/* fields of an ending, as Lua has them */
static const struct {
    const char *key;
    size_t offset;
} ending_fields[] = {{"t", offsetof(dm_strip_ending, t)},
                     {"before", offsetof(dm_strip_ending, before)},
                     {"h", offsetof(dm_strip_ending, h)},
                     {"energy", offsetof(dm_strip_ending, energy)},
                     {"target", offsetof(dm_strip_ending, target)},
                     {"scale", offsetof(dm_strip_ending, scale)},
                     {"most", offsetof(dm_strip_ending, most)}};
enum { ENDING_FIELDS = sizeof ending_fields / sizeof *ending_fields };

/* Push the table of an ending, with the two levels before as the rows of `old`. */
static void push_ending(lua_State *L, const dml_strip *d, const dm_strip_ending *at) {
    const uint32_t n = dm_strip_unknowns(&d->strip);
    lua_createtable(L, 0, ENDING_FIELDS + 2);
    for (int k = 0; k < ENDING_FIELDS; k++) {
        const char *place = (const char *)at + ending_fields[k].offset;
        lua_pushnumber(L, *(const double *)(const void *)place);
        lua_setfield(L, -2, ending_fields[k].key);
    }
    lua_pushinteger(L, at->done), lua_setfield(L, -2, "done");
    double *old = dml_pushmatrix(L, 2, n);
    for (int k = 0; k < 2; k++) dm_strip_get_old(&d->room, k, old + (size_t)k * n);
    lua_setfield(L, -2, "old");
}

/* Option "from" of the table at 2: an ending; its levels before, or NULL without one. The matrix
 * stays on the stack. */
static const double *read_ending(lua_State *L, const dml_strip *d, dm_strip_ending *at) {
    if (lua_getfield(L, 2, "from") == LUA_TNIL) return NULL;
    luaL_checktype(L, -1, LUA_TTABLE);
    const int table = lua_gettop(L);
    for (int k = 0; k < ENDING_FIELDS; k++) {
        char *place = (char *)at + ending_fields[k].offset;
        lua_getfield(L, table, ending_fields[k].key);
        *(double *)(void *)place = dml_checknumber(L, -1);
        lua_pop(L, 1);
    }
    at->done = (lua_getfield(L, table, "done"), dml_checkinteger(L, -1));
    lua_pop(L, 1);
    lua_getfield(L, table, "old");
    const dml_array *a = dml_checkarray(L, lua_gettop(L), 2);
    if (a->rows != 2 || a->columns != dm_strip_unknowns(&d->strip) || !dml_numbersof(a))
        luaL_error(L, "'old' must have two rows, a column for every number of a level");
    return dml_numbersof(a);
}

/* The table that a run gives: matrices of the rows that there are, and how it ended. */
static void push_outcome(lua_State *L, const dml_strip *d, const dm_strip_record *rows,
                         const dm_strip_outcome *o, dm_status status) {
    const uint32_t n = dm_strip_unknowns(&d->strip);
    lua_createtable(L, 0, 13);
    dml_setresult(L);
    set_matrix(L, "u", rows->u, o->rows, n);
    set_vector(L, "t", rows->t, o->rows);
    if (rows->p) set_matrix(L, "p", rows->p, o->rows, n);
    if (rows->energy) set_vector(L, "energy", rows->energy, o->rows);
    lua_pushinteger(L, status), lua_setfield(L, -2, "status");
    lua_pushstring(L, dm_status_code(status)), lua_setfield(L, -2, "code");
    lua_pushinteger(L, o->done), lua_setfield(L, -2, "done");
    lua_pushinteger(L, o->solve.iterations), lua_setfield(L, -2, "iterations");
    lua_pushnumber(L, o->solve.residual), lua_setfield(L, -2, "residual");
    lua_pushnumber(L, o->h), lua_setfield(L, -2, "h");
    lua_pushinteger(L, o->tangled), lua_setfield(L, -2, "tangled");
    push_ending(L, d, &o->ending), lua_setfield(L, -2, "ending");
}

/* Rows in memory of the collector: nothing is left to free where a step fails. */
static int strip_run(lua_State *L) {
    static const char *const known[] = {"u",     "p",     "guess", "t0",   "h",
                                        "steps", "every", "free",  "from", NULL};
    dml_strip *d = dml_checkstrip(L);
    lua_settop(L, 2);
    dml_options(L, 2, known);
    const uint32_t n = dm_strip_unknowns(&d->strip);
    dm_strip_plan plan = {.t0 = dml_number(L, 2, "t0", 0.0),
                          .h = dml_positive(L, 2, "h", 0.0),
                          .steps = dml_count(L, 2, "steps", 0, -1),
                          .every = dml_count(L, 2, "every", 1, 1),
                          .is_free = dml_flag(L, 2, "free", 0),
                          .stop = &dml_stop};
    dml_refuse_late(L, plan.t0, plan.h);
    plan.guess = level_of(L, d, "guess");
    dm_strip_ending from = {0};
    plan.old = read_ending(L, d, &from);
    if (plan.old) plan.from = &from;
    const long most = dm_strip_plan_rows(&plan);
    check_rows(L, most, n);
    const double *u = level_of(L, d, "u"), *p = level_of(L, d, "p");
    dml_strip_wantstep(L, d);
    dm_strip_record rows = {.u = block(L, (size_t)most * n), .t = block(L, (size_t)most)};
    memcpy(rows.u, u, n * sizeof *u);
    if (p) {
        rows.p = block(L, (size_t)most * n), rows.energy = block(L, (size_t)most);
        memcpy(rows.p, p, n * sizeof *p);
        dml_strip_wantafter(L, d), dml_strip_wantenergy(L, d);
        if (plan.is_free) dml_strip_wantclock(L, d);
        if (plan.is_free && !dm_strip_open_heights(&d->room, d->large))
            luaL_error(L, "not enough memory");
    }
    dm_strip_outcome outcome;
    const dm_status status = dm_strip_go(&d->room, &plan, &rows, &outcome);
    if (status == DM_STOPPED) dml_stop = 0;
    push_outcome(L, d, &rows, &outcome, status);
    return 1;
}

/* put the levels at stack index 2 and 3, the scalars t and h at 4 and 5 */
static void put_slab(lua_State *L, dml_strip *d) {
    const int32_t n = (int32_t)dm_strip_unknowns(&d->strip);
    const double t = dml_optnumber(L, 4, 0.0), h = dml_optnumber(L, 5, 1.0);
    lua_settop(L, 5);
    dm_strip_put(&d->room, 0, dml_numbersat(L, 2, "the lower level", n));
    dm_strip_put(&d->room, dm_cell_upper(&d->strip.layout, 0),
                 dml_numbersat(L, 3, "the upper level", n));
    dm_strip_set(&d->room, DM_STRIP_TIME, t);
    dm_strip_set(&d->room, DM_STRIP_HEIGHT, h);
}

/* stack: strip, lower, upper, t, h */
static int strip_momenta(lua_State *L) {
    dml_strip *d = dml_checkstrip(L);
    put_slab(L, d);
    dml_strip_wantafter(L, d);
    dm_strip_momenta(&d->room, dml_pushvector(L, dm_strip_unknowns(&d->strip)));
    return 1;
}

/* the outputs of a map, a row for every cell */
static int strip_cells(lua_State *L) {
    static const char *const whats[] = {"value", "slopes", "hessian", NULL};
    dml_strip *d = dml_checkstrip(L);
    const int what = luaL_checkoption(L, 6, NULL, whats);
    const uint32_t n = d->strip.layout.values;
    put_slab(L, d);
    if (what == 0) dml_stripmap(L, d, &d->value, d->out, d->strip.boxes ? n : 1);
    if (what == 1) dml_stripmap(L, d, &d->strip.slopes, d->slopes, d->strip.boxes ? n : 4 * n);
    if (what == 2) dml_strip_wanthessian(L, d);
    const dm_cell_map *const maps[] = {&d->value, &d->strip.slopes, &d->strip.hessian};
    const dm_cell_map *map = maps[what];
    double *out = dml_pushmatrix(L, d->strip.cells, map->outputs);
    for (uint32_t c = 0; c < d->strip.cells; c += DM_CELL_BLOCK) {
        const uint32_t left = d->strip.cells - c;
        const uint32_t count = left < DM_CELL_BLOCK ? left : DM_CELL_BLOCK;
        dm_cell_map_run(map, d->room.memory, d->room.scalars, d->room.buffer, c, count);
        for (uint32_t i = 0; i < count; i++)
            for (uint32_t k = 0; k < map->outputs; k++)
                out[(size_t)(c + i) * map->outputs + k] =
                    d->room.buffer[(size_t)k * DM_CELL_BLOCK + i];
    }
    return 1;
}

/* a matrix of levels, an option of the table at 2 */
static const double *levels_of(lua_State *L, const dml_strip *d, const char *key, long *levels) {
    if (lua_getfield(L, 2, key) == LUA_TNIL) return NULL;
    const dml_array *a = dml_checkarray(L, lua_gettop(L), 2);
    if (a->columns != dm_strip_unknowns(&d->strip) || !dml_numbersof(a))
        luaL_error(L, "option '%s' must have a column for every number of a level", key);
    if (*levels && a->rows != *levels) luaL_error(L, "option '%s' has other levels", key);
    *levels = a->rows;
    return dml_numbersof(a);
}

/* u and t of the options, a row a level. */
static dm_strip_levels read_levels(lua_State *L, const dml_strip *d) {
    dm_strip_levels along = {0};
    lua_settop(L, 2);
    along.u = levels_of(L, d, "u", &along.levels);
    if (!along.u) luaL_error(L, "option 'u' is missing");
    lua_getfield(L, 2, "t");
    along.t = dml_numbersat(L, lua_gettop(L), "t", (int32_t)along.levels);
    return along;
}

/* what a law needs of every slab, one after the other: vary and residual poll Ctrl-C between
 * calls, which Lua makes in pieces */
static int strip_vary(lua_State *L) {
    dml_strip *d = dml_checkstrip(L);
    const uint32_t n = dm_strip_unknowns(&d->strip);
    const dm_strip_levels along = read_levels(L, d);
    const double *v = level_of(L, d, "v"), *dp = level_of(L, d, "dp");
    double *moving = dp ? dml_pushvector(L, n) : NULL;
    const int at = lua_gettop(L);
    if (dp) memcpy(moving, dp, n * sizeof *dp);
    dml_strip_wanthessian(L, d);
    double *out = dml_pushmatrix(L, (uint32_t)along.levels, n);
    memcpy(out, v, n * sizeof *v);
    const dm_status status = dm_strip_vary(&d->room, &along, out, moving);
    if (status != DM_OK)
        return luaL_error(L, "the linearized equation of a slab: %s", dm_status_text(status));
    if (!dp) return 1;
    lua_pushvalue(L, at);
    return 2;
}

/* stack: strip, options; one of xi and v, w is there */
static int strip_residual(lua_State *L) {
    dml_strip *d = dml_checkstrip(L);
    dm_strip_levels along = read_levels(L, d);
    dm_strip_law law = {.xi = levels_of(L, d, "xi", &along.levels),
                        .v = levels_of(L, d, "v", &along.levels),
                        .w = levels_of(L, d, "w", &along.levels)};
    lua_getfield(L, 2, "leave");
    const double *leave = dml_numbersat(L, lua_gettop(L), "leave", (int32_t)d->strip.nodes);
    uint8_t *marks = lua_newuserdatauv(L, d->strip.nodes, 0);
    for (uint32_t i = 0; i < d->strip.nodes; i++) marks[i] = leave[i] != 0.0;
    law.leave = marks;
    if (!dm_strip_open_laws(&d->room, d->large)) luaL_error(L, "not enough memory");
    if (law.xi)
        dml_stripmap(L, d, &d->strip.slopes, d->slopes, 4 * d->strip.layout.values);
    else
        dml_strip_wanthessian(L, d);
    double size;
    const double area = dml_positive(L, 2, "area", 1.0);
    lua_pushnumber(L, dm_strip_residual(&d->room, &along, &law, area, &size));
    lua_pushnumber(L, size);
    return 2;
}

/* -S_h and S_t of every slab */
static int strip_energies(lua_State *L) {
    dml_strip *d = dml_checkstrip(L);
    const dm_strip_levels along = read_levels(L, d);
    const uint32_t slabs = along.levels > 0 ? (uint32_t)along.levels - 1 : 0;
    const size_t n = dm_strip_unknowns(&d->strip);
    dml_strip_wantenergy(L, d);
    double *energy = dml_pushvector(L, slabs), *power = dml_pushvector(L, slabs), sums[2];
    for (uint32_t k = 0; k < slabs; k++) {
        dm_strip_put(&d->room, 0, along.u + k * n);
        dm_strip_put(&d->room, dm_cell_upper(&d->strip.layout, 0), along.u + (k + 1) * n);
        dm_strip_set(&d->room, DM_STRIP_TIME, along.t[k]);
        dm_strip_set(&d->room, DM_STRIP_HEIGHT, along.t[k + 1] - along.t[k]);
        dm_strip_sum(&d->room, &d->strip.energy, 2, sums);
        energy[k] = sums[0], power[k] = sums[1];
    }
    return 2;
}

/* stack: strip, level, unit */
static int strip_limit(lua_State *L) {
    dml_strip *d = dml_checkstrip(L);
    lua_settop(L, 3);
    const double *u = dml_numbersat(L, 2, "the level", (int32_t)dm_strip_unknowns(&d->strip));
    const double unit = dml_checknumber(L, 3);
    dml_strip_wanthessian(L, d);
    lua_pushnumber(L, dm_strip_limit(&d->room, u, unit));
    return 1;
}

/* strip:follows(f) */
static int strip_follows(lua_State *L) {
    const dml_strip *d = dml_checkstrip(L);
    lua_settop(L, 2);
    lua_pushboolean(L, dml_strip_follows(L, d));
    return 1;
}

/* how an outcome, the table at 1, ended: its status, a number, or else its code */
static dm_status status_of(lua_State *L) {
    dm_status status = DM_OK;
    if (lua_getfield(L, 1, "status") != LUA_TNIL) {
        const lua_Integer number = dml_checkinteger(L, -1);
        luaL_argcheck(L, number >= 0 && number < DM_STATUSES, 1, "it has no such status");
        status = (dm_status)number;
    } else if (lua_getfield(L, 1, "code") != LUA_TSTRING ||
               !dm_status_find(&status, lua_tostring(L, -1))) {
        luaL_error(L, "no run ends with the code '%s'", luaL_tolstring(L, -1, NULL));
    }
    lua_settop(L, 4);
    return status;
}

/* core.strip_fail(outcome, rule, run, why): a dm.failure with the run so far */
static int strip_fail(lua_State *L) {
    luaL_checktype(L, 1, LUA_TTABLE);
    lua_settop(L, 4);
    lua_pushinteger(L, status_of(L));
    lua_getfield(L, 1, "done");
    lua_getfield(L, 1, "time");
    dml_failure f = {.status = (dm_status)lua_tointeger(L, 5),
                     .step = lua_tointeger(L, 6),
                     .time = lua_tonumber(L, 7),
                     .rule = luaL_checkstring(L, 2),
                     .root = lua_tostring(L, 4)};
    f.step += f.status != DM_STOPPED && f.status != DM_BLOW_UP;
    lua_getfield(L, 1, "h"), f.h = lua_tonumber(L, -1);
    lua_getfield(L, 1, "residual"), f.residual = lua_tonumber(L, -1);
    lua_getfield(L, 1, "iterations"), f.iterations = (int)lua_tointeger(L, -1);
    dml_fail(L, &f, 3);
    return 0;
}

static const dml_row methods[] =
    {{"run", strip_run,
      "strip:run{u=, p=, guess=, t0=, h=, steps=, every=, free=, from=} -> table\n"
      "Levels from u (and p, of an action) on: u, p (matrices, a row a level), t, energy, code, "
      "status, done, iterations, residual, h, tangled, ending. from: the ending of a run, whose "
      "last u and p are given; then this one has the bits of one that never stopped."},
     {"momenta", strip_momenta,
      "strip:momenta(lower, upper, t, h) -> dm.vector\nThe momenta of the upper level."},
     {"cells", strip_cells,
      "strip:cells(lower, upper, t, h, \"value\" | \"slopes\" | \"hessian\") -> dm.matrix\n"
      "A row for every cell: the action or the equations, and their derivatives."},
     {"vary", strip_vary,
      "strip:vary{u=, t=, v=, dp=} -> dm.matrix, dp\n"
      "First variations along known levels from v, and dp of an action, at the first."},
     {"residual", strip_residual,
      "strip:residual{u=, t=, xi= | v=, w=, leave=, area=} -> number, number\n"
      "The largest boundary sum of a law around a node, and of the terms of a corner, over area."},
     {"energies", strip_energies,
      "strip:energies{u=, t=} -> dm.vector, dm.vector\n-dS/dh and dS/dt of every slab."},
     {"limit", strip_limit,
      "strip:limit(u, unit) -> number\n"
      "The height at which the fastest oscillation about u begins to grow, looked for around "
      "unit.\n-1: none is seen, and the kinetic energy is of both signs."},
     {"follows", strip_follows,
      "strip:follows(f) -> boolean\n"
      "Does f, traced again, do what the function did that the strip was made of?"},
     {NULL, NULL, NULL}};

static const dml_row functions[] =
    {{"strip", dml_strip_new,
      "core.strip(f, {values=, cells=, ring=, boxes=, held=, absorbs=, place=, moving=, width=}) "
      "-> dm.strip\n"
      "The levels of a line of cells: f(lower, upper, place, clock) is the action of a cell, or "
      "with boxes = true its equations, a number for each value. held, place: vectors of marks "
      "and of left ends; absorbs: c of the force -c u_t at either end. moving: the value that is a "
      "displacement of "
      "nodes, in cells of that width."},
     {"strip_fail", strip_fail,
      "core.strip_fail(outcome, rule, run, why)\nRaises the dm.failure of a run that ended so: "
      "outcome has status or code, done, time, h, residual, iterations."},
     {NULL, NULL, NULL}};

const dml_class dml_class_strip = {
    .name = DML_STRIP,
    .doc = "dm.strip: levels of a field on a line, as Lua modules see them\n"
           "Two levels with a row of cells between them; made by core.strip. Fields and boxes on "
           "lines are made of it.",
    .methods = methods,
    .functions = functions,
};
