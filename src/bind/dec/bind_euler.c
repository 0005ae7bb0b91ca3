/* bind_euler.c - `dm.euler_engine`: vorticity on a surface, stepped in C. lua/dm/dec/flow makes it
 * and is what a script sees. */
#include "bind/core/bind_failure.h"
#include "bind/dec/bind_mesh.h"
#include "bind/dec/bind_sparse.h"
#include "bind/value/array.h"
#include "field/flow/euler.h"

#include <math.h>
#include <string.h>

#define ENGINE "dm.euler_engine"

enum { KEPT_MESH = 1, KEPT_FACTOR, KEPT_ARENA, KEPT = KEPT_ARENA };

/* the flow, and how its last step ended */
typedef struct {
    dm_euler flow;
    dm_status status;
    uint32_t sweeps;
} engine;

static engine *check(lua_State *L) {
    return luaL_checkudata(L, 1, ENGINE);
}

/* memory that stays as long as the engine */
static void *take(lua_State *L, dm_arena *arena, size_t count, size_t size) {
    void *block = dm_arena_take(arena, (count + 1) * size);
    if (!block) luaL_error(L, "a flow: not enough memory");
    return block;
}

/* arguments of core.euler by their places */
enum { MESH = 1, FACTOR, SOLVED, COMPONENT, SIGN, VORTICITY, LOW, HOLES, INVERSE, ROUND, ETA, B };

/* Signs as small integers; corners are read where the mesh has them. */
static void read_triangles(lua_State *L, dm_euler *e, const dml_mesh *m, dm_arena *arena) {
    const double *sign = dml_numbersat(L, SIGN, "the signs", (int32_t)m->K.count[2]);
    int8_t *signs = take(L, arena, m->K.count[2], sizeof *signs);
    for (uint32_t i = 0; i < m->K.count[2]; i++) signs[i] = sign[i] < 0.0 ? -1 : 1;
    e->triangles = m->K.count[2];
    e->corner = m->K.vertex[2];
    e->sign = signs;
}

/* Components count from 1, and one that is free has a vertex that is not solved for. */
static void read_vertices(lua_State *L, dm_euler *e, const dml_mesh *m, dm_arena *arena) {
    const uint32_t n = m->K.count[0];
    const double *solved = dml_numbersat(L, SOLVED, "the marks of unknowns", (int32_t)n);
    const double *number = dml_numbersat(L, COMPONENT, "the components", (int32_t)n);
    uint32_t *freed = take(L, arena, n, sizeof *freed);
    uint32_t *component = take(L, arena, n, sizeof *component);
    for (uint32_t i = 0; i < n; i++) {
        if (!(number[i] >= 0.0 && number[i] <= n)) luaL_argerror(L, COMPONENT, "not a component");
        component[i] = (uint32_t)number[i];
        if (component[i] > e->components) e->components = component[i];
        if (solved[i] != 0.0) freed[e->unknowns++] = i;
    }
    e->vertices = n;
    e->component = component;
    e->free = freed;
    e->mass = m->metric.dual[0];
}

/* a copy of the numbers of the vector at idx */
static const double *copied(lua_State *L, dm_arena *arena, int idx, const char *what, size_t n) {
    const double *from = dml_numbersat(L, idx, what, (int32_t)n);
    double *to = take(L, arena, n, sizeof *to);
    memcpy(to, from, n * sizeof *to);
    return to;
}

/* as many as there are circulations round them */
static void read_holes(lua_State *L, dm_euler *e, dm_arena *arena) {
    const dml_array *round = dml_toarray(L, ROUND, 1);
    if (!round) luaL_argerror(L, ROUND, "a vector is needed");
    const size_t count = (size_t)round->rows;
    luaL_argcheck(L, count * (e->vertices + 1u) <= INT32_MAX, ROUND, "too many holes");
    e->holes.count = (uint32_t)count;
    e->holes.g = copied(L, arena, HOLES, "the functions of the holes", count * e->vertices);
    e->holes.inverse = copied(L, arena, INVERSE, "the matrix of the holes", count * count);
    e->holes.circulation = copied(L, arena, ROUND, "the circulations", count);
}

/* as many as there are numbers of the flow round them */
static void read_handles(lua_State *L, dm_euler *e, dm_arena *arena) {
    const dml_array *around = dml_toarray(L, B, 1);
    if (!around) luaL_argerror(L, B, "a vector is needed");
    const size_t count = (size_t)around->rows, numbers = 2 * (size_t)e->triangles;
    luaL_argcheck(L, count * (numbers + 1) <= INT32_MAX, B, "too many handles");
    e->handles.count = (uint32_t)count;
    e->handles.eta = copied(L, arena, ETA, "the forms of the handles", count * numbers);
}

/* vorticity, flow round handles and the low parts of both */
static void read_state(lua_State *L, dm_euler *e) {
    const double *w = dml_numbersat(L, VORTICITY, "the vorticity", (int32_t)e->vertices);
    memcpy(e->w, w, e->vertices * sizeof *w);
    if (e->handles.count) {
        const double *b = dml_numbersat(L, B, "flows", (int32_t)e->handles.count);
        memcpy(e->w + e->vertices, b, e->handles.count * sizeof *b);
    }
    if (lua_isnil(L, LOW)) return;
    const double *low = dml_numbersat(L, LOW, "the low parts", (int32_t)e->size);
    memcpy(e->low, low, e->size * sizeof *low);
}

/* core.euler(mesh, factor, solved, component, sign, w, low, holes, inverse, round, eta, b) */
static int core_euler(lua_State *L) {
    const dml_mesh *m = dml_checkmesh(L, MESH);
    luaL_argcheck(L, m->K.n == 2, MESH, "a surface is needed");
    dml_needmetric(L, m);
    lua_settop(L, B);
    void *factor = lua_isnil(L, FACTOR) ? NULL : luaL_checkudata(L, FACTOR, DML_FACTOR);
    engine *own = lua_newuserdatauv(L, sizeof *own, KEPT);
    *own = (engine){.flow.poisson = {dml_factorsolve, factor}};
    dm_euler *e = &own->flow;
    const int at = lua_gettop(L);
    dm_arena *arena = dml_pusharena(L);
    lua_setiuservalue(L, at, KEPT_ARENA);
    lua_pushvalue(L, MESH);
    lua_setiuservalue(L, at, KEPT_MESH);
    lua_pushvalue(L, FACTOR);
    lua_setiuservalue(L, at, KEPT_FACTOR);
    read_triangles(L, e, m, arena);
    read_vertices(L, e, m, arena);
    if (!lua_isnil(L, ROUND)) read_holes(L, e, arena);
    if (!lua_isnil(L, B)) read_handles(L, e, arena);
    luaL_argcheck(L, factor ? dml_factorunknowns(factor) == e->unknowns : !e->unknowns, FACTOR,
                  "as many unknowns as marks are needed");
    if (dm_euler_open(e, arena) != DM_OK) luaL_error(L, "a flow: not enough memory");
    read_state(L, e);
    lua_settop(L, at);
    luaL_setmetatable(L, ENGINE);
    return 1;
}

/* (h, steps) -> steps that were taken, rates that they needed; fewer steps: see engine_fail */
static int engine_advance(lua_State *L) {
    engine *e = check(L);
    const double h = dml_checknumber(L, 2);
    const lua_Integer steps = dml_checkinteger(L, 3);
    lua_Integer done = 0, sweeps = 0;
    e->status = DM_OK;
    while (done < steps && e->status == DM_OK) {
        e->status = dml_stop ? DM_STOPPED : dm_euler_step(&e->flow, h, &e->sweeps);
        sweeps += e->sweeps;
        done += e->status == DM_OK;
    }
    lua_pushinteger(L, done);
    lua_pushinteger(L, sweeps);
    return 2;
}

/* (steps taken, t, h, rule, run so far): raises what ended the last advance */
static int engine_fail(lua_State *L) {
    const engine *e = check(L);
    const dml_failure f = {.status = e->status,
                           .step = (long)dml_checkinteger(L, 2) + (e->status != DM_STOPPED),
                           .time = dml_checknumber(L, 3),
                           .h = dml_checknumber(L, 4),
                           .residual = e->flow.change,
                           .iterations = (int)e->sweeps,
                           .rule = luaL_checkstring(L, 5)};
    lua_settop(L, 6);
    if (e->status == DM_STOPPED) dml_stop = 0;
    if (e->status != DM_OK) dml_fail(L, &f, 6);
    return 0;
}

static int engine_vorticity(lua_State *L) {
    const dm_euler *e = &check(L)->flow;
    memcpy(dml_pushvector(L, e->vertices), e->w, e->vertices * sizeof *e->w);
    return 1;
}

static int engine_low(lua_State *L) {
    const dm_euler *e = &check(L)->flow;
    memcpy(dml_pushvector(L, e->size), e->low, e->size * sizeof *e->low);
    return 1;
}

static int engine_around(lua_State *L) {
    const dm_euler *e = &check(L)->flow;
    const uint32_t count = e->handles.count;
    memcpy(dml_pushvector(L, count), e->w + e->vertices, count * sizeof *e->w);
    return 1;
}

/* psi, energy, enstrophy, circulation */
static int engine_measure(lua_State *L) {
    dm_euler *e = &check(L)->flow;
    double out[3];
    const dm_status status = dm_euler_integrals(e, out);
    if (status == DM_STOPPED) dml_checkstop(L);
    if (status != DM_OK) luaL_error(L, "a stream function: %s", dm_status_text(status));
    memcpy(dml_pushvector(L, e->vertices), e->psi, e->vertices * sizeof *e->psi);
    for (int k = 0; k < 3; k++) lua_pushnumber(L, out[k]);
    return 4;
}

static const dml_row methods[] = {
    {"advance", engine_advance,
     "e:advance(h, steps) -> steps taken, rates\n"
     "Steps of the implicit midpoint rule, and how many rates they needed in all; fewer steps than "
     "asked for where one failed."},
    {"fail", engine_fail,
     "e:fail(steps, t, h, rule, run) -> nothing\n"
     "Raises a dm.failure that says why the last e:advance ended, with the run so far."},
    {"vorticity", engine_vorticity, "e:vorticity() -> dm.vector\nThe vorticity at the vertices."},
    {"low", engine_low,
     "e:low() -> dm.vector\n"
     "What compensated sums of the vorticity, and then of e:around(), have beside them."},
    {"around", engine_around,
     "e:around() -> dm.vector\nHow much the flow has of each form of the handles."},
    {"measure", engine_measure,
     "e:measure() -> dm.vector, energy, enstrophy, circulation\n"
     "The stream function at the vertices, the energy, |w|^2 / 2 and the sum of *v w."},
    {NULL, NULL, NULL}};

static const dml_row functions[] = {
    {"euler", core_euler,
     "core.euler(mesh, factor, solved, component, sign, w [, low, holes, inverse, round, eta, b])\n"
     "-> dm.euler_engine\n"
     "Flow by its vorticity w, with its low-order parts; factor: of -div grad on the vertices that "
     "are marked as solved (nil where there are none); component: of vertices whose component "
     "holds none, from 1, else 0; sign of every triangle; holes: harmonic functions, one after "
     "the other, the inverse of their products, round: the circulations; eta: forms of handles, "
     "one "
     "after the other, each with its values on the edges from the first corner of every triangle, "
     "b: how much of each. See mesh:euler."},
    {NULL, NULL, NULL}};

const dml_class dml_class_euler = {
    .name = ENGINE,
    .doc = "dm.euler_engine: vorticity on a surface, stepped by mesh:euler's solvers\n"
           "Between calls it holds the vorticity and its low-order parts; nothing else matters.",
    .methods = methods,
    .functions = functions,
};
