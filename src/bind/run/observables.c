#include "bind/run/observables.h"
#include "bind/model/space_group.h"
#include "bind/trace/backend.h"
#include "graph/analyse.h"

#include <string.h>

/* whose energy it is: that of the model that is stepped */
static dml_model *model_of(const dml_stepping *r) {
    return r->inputs ? r->inputs : r->model;
}

/* Their inputs are (q, v, t, p), v being found from p where one of them asks for it. */
void dml_observables_start(dml_observables *o, const dml_stepping *r) {
    const dml_model *m = model_of(r);
    o->observer = (dm_observer){.model = &m->model, .list = o->list, .params = r->stepper.params};
}

/* Room for one more; raises where a run has DML_OBSERVABLES already. */
static dm_observable *next(lua_State *L, dml_observables *o) {
    if (o->observer.count == DML_OBSERVABLES)
        luaL_error(L, "a run observes at most %d functions and columns", DML_OBSERVABLES);
    dm_observable *out = o->list + o->observer.count++;
    return *out = (dm_observable){0}, out;
}

/* the backend that the model uses, or the default */
static dm_compile *compiler(lua_State *L, const dml_stepping *r) {
    const char *name = r->model->callback ? NULL : r->model->backend;
    return dml_findbackend(L, name)->compile;
}

/* The kernel lives as long as the arena that is left on the stack. */
void dml_observables_add(lua_State *L, dml_observables *o, const dml_stepping *r, const char *what,
                         int any) {
    const int n = (int)r->solver->n, fn = lua_gettop(L);
    const dml_signature s = {.what = what,
                             .arguments = 4,
                             .length = {n, n, DML_SCALAR_ARGUMENT, n},
                             .outputs = any ? 0 : DML_SCALAR_ARGUMENT};
    dml_traced traced;
    if (!lua_isfunction(L, fn))
        luaL_error(L, "%s must be a function of (q, v, t, p) (got %s)", what, luaL_typename(L, fn));
    dml_place_function(L, r->system, "observable");
    if (r->solver->alone)
        luaL_error(L,
                   "%s: a discrete Lagrangian knows no velocity: only columns of the path can be "
                   "watched",
                   what);
    dm_observable *out = next(L, o);
    dm_kernel *kernel = o->kernel + (out - o->list);
    dm_arena *arena = dml_pusharena(L);
    dml_trace(L, fn, &s, arena, &traced);
    if (model_of(r)->model.structure & DM_LINEAR_IN_V &&
        dm_depends(traced.graph, traced.out, traced.outputs, (uint32_t)n, (uint32_t)n))
        luaL_error(L,
                   "%s reads v, which a run of an L linear in v does not have: no momentum "
                   "determines it; write it in q, t and p",
                   what);
    const dm_status status =
        compiler(L, r)(kernel, traced.graph, traced.out, traced.outputs, arena);
    if (status != DM_OK) luaL_error(L, "%s: %s", what, dm_status_text(status));
    dml_trace_check(L, fn, &s, kernel, NULL);
    *out = (dm_observable){.kernel = kernel};
    o->observer.work = r->work; /* only that it is needed */
}

/* E = p . v - L, which needs no trace of its own. */
void dml_observables_energy(lua_State *L, dml_observables *o, const dml_stepping *r) {
    if (r->solver->alone) luaL_error(L, "a discrete Lagrangian alone has no energy to watch");
    dml_model *m = model_of(r);
    dml_want(L, m, DM_WANT_ENERGY | dml_legendre_wants(m, 0), NULL);
    *next(L, o) = (dm_observable){.kernel = &m->model.energy, .of_model = 1};
    o->observer.work = r->work;
}

/* Entries are counted through q, then p. */
void dml_observables_entry(lua_State *L, dml_observables *o, uint32_t entry) {
    *next(L, o) = (dm_observable){.entry = entry};
}

/* The stepper of the run is where it will be opened. */
void dml_observables_parts(lua_State *L, dml_observables *o, const dml_stepping *r, uint32_t first,
                           uint32_t count) {
    *next(L, o) = (dm_observable){.parts = &r->stepper, .entry = first, .count = count};
}

/* Called once, when all are known: the room depends on how many there are. */
void dml_observables_end(lua_State *L, dml_observables *o) {
    const dm_model *m = o->observer.model;
    const size_t own =
        m->params || m->structure & DM_HAMILTONIAN ? 2 * (size_t)m->n + 1 + m->params : 0;
    const size_t inputs = 3 * (size_t)m->n + 1 + own;
    const size_t size = inputs + dm_legendre_work(m);
    o->observer.x = lua_newuserdatauv(L, size * sizeof(double), 0);
    memset(o->observer.x, 0, size * sizeof(double));
    if (o->observer.work) o->observer.work = o->observer.x + inputs;
}

/* insertion sort of the names in the list at `keys` from entry `first` on */
static void insert_name(lua_State *L, int keys, lua_Integer first, lua_Integer count) {
    lua_Integer i = count;
    for (; i > first; i--) {
        lua_rawgeti(L, keys, i - 1);
        const int sorted = !lua_compare(L, -2, -1, LUA_OPLT);
        if (!sorted) lua_rawseti(L, keys, i);
        if (sorted) {
            lua_pop(L, 1);
            break;
        }
    }
    lua_rawseti(L, keys, i);
}

/* The order of columns must not depend on that of a table of Lua. */
void dml_pushkeys(lua_State *L, int table, const char *field) {
    const lua_Integer listed = (lua_Integer)lua_rawlen(L, table);
    lua_Integer count = listed;
    lua_newtable(L);
    const int keys = lua_gettop(L);
    for (lua_Integer i = 1; i <= listed; i++) lua_pushinteger(L, i), lua_rawseti(L, keys, i);
    for (lua_pushnil(L); lua_next(L, table);) {
        lua_pop(L, 1);
        if (lua_isinteger(L, -1) && lua_tointeger(L, -1) >= 1 && lua_tointeger(L, -1) <= listed)
            continue;
        if (lua_type(L, -1) != LUA_TSTRING)
            luaL_error(L, "field '%s': its keys are names (got a %s)", field, luaL_typename(L, -1));
        lua_pushvalue(L, -1);
        insert_name(L, keys, listed + 1, ++count);
    }
}
