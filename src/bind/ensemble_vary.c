/* ensemble_vary.c - `vary = { name = ... }`: members of one ensemble with parameters of their own. */
#include "bind/ensemble.h"
#include "bind/model_params.h"
#include "bind/system.h"

#include <math.h>
#include <string.h>

/* the system of the solver at 1 must have a number of that name among its params */
static void check_parameter(lua_State *L, const char *name) {
    lua_getiuservalue(L, 1, DML_SOLVER_SYSTEM);
    if (dml_systemfield(L, lua_gettop(L), "params") != LUA_TTABLE)
        luaL_error(L,
                   "field 'vary': the system has no parameters; give them as "
                   "dm.system{params = {...}} and take them as the fourth argument of L");
    if (lua_getfield(L, -1, name) != LUA_TNUMBER)
        luaL_error(L,
                   "field 'vary': '%s' is not a number among the params of the system "
                   "(it is %s)",
                   name, lua_isnil(L, -1) ? "not there" : luaL_typename(L, -1));
    lua_pop(L, 3);
}

/* the names in alphabetical order, whatever the order of the table */
static void push_names(lua_State *L, int vary) {
    lua_newtable(L);
    for (lua_pushnil(L); lua_next(L, vary); lua_pop(L, 1)) {
        if (lua_type(L, -2) != LUA_TSTRING)
            luaL_error(L,
                       "field 'vary' must be a table { name = function or table }, for "
                       "instance vary = { k = function(i) return i / 10 end }");
        check_parameter(L, lua_tostring(L, -2));
        lua_pushvalue(L, -2);
        lua_rawseti(L, -4, luaL_len(L, -4) + 1);
    }
    lua_getglobal(L, "table");
    lua_getfield(L, -1, "sort");
    lua_pushvalue(L, -3);
    lua_call(L, 1, 0);
    lua_pop(L, 1);
}

static double read_value(lua_State *L, int vary, const char *name, long i) {
    dml_push_source(L, vary, name, i);
    if (lua_type(L, -1) != LUA_TNUMBER || !isfinite(lua_tonumber(L, -1)))
        luaL_error(L, "field 'vary': '%s' of member %d must be a finite number (got %s)",
                   name, (int)i + 1, luaL_tolstring(L, -1, NULL));
    const double x = lua_tonumber(L, -1);
    lua_pop(L, 1);
    return x;
}

const double *dml_read_vary(lua_State *L, long members, uint32_t *count) {
    const int type = lua_getfield(L, 2, "vary"), vary = lua_gettop(L);
    if (type == LUA_TNIL) return lua_pop(L, 1), NULL;
    if (type != LUA_TTABLE)
        luaL_error(L,
                   "field 'vary' must be a table { name = function or table } (got %s)",
                   luaL_typename(L, -1));
    push_names(L, vary);
    *count = (uint32_t)luaL_len(L, -1);
    double *values =
        lua_newuserdatauv(L, ((size_t)members * *count + 1) * sizeof *values, 0);
    for (uint32_t k = 0; k < *count; k++) {
        lua_rawgeti(L, vary + 1, k + 1);
        const char *name = lua_tostring(L, -1);
        dml_check_source(L, vary, name, members);
        for (long i = 0; i < members; i++)
            values[(size_t)i * *count + k] = read_value(L, vary, name, i);
        lua_pop(L, 1);
    }
    lua_insert(L, -2);
    lua_remove(L, vary);
    return values;
}

long dml_vary_alike(const double *values, uint32_t count, long first, long members) {
    const size_t bytes = count * sizeof *values;
    const double *row = values + (size_t)first * count;
    long last = first + 1;
    while (last < members && memcmp(row, values + (size_t)last * count, bytes) == 0)
        last++;
    return last - first;
}

/* fields of the system, with these numbers among its params */
static void push_fields(lua_State *L, int system, const double *values, int names) {
    lua_getiuservalue(L, system, 1);
    dml_pushcopy(L, -1);
    lua_getfield(L, -1, "params");
    dml_pushcopy(L, -1);
    for (lua_Integer k = 1; k <= luaL_len(L, names); k++) {
        lua_rawgeti(L, names, k);
        lua_pushnumber(L, values[k - 1]);
        lua_rawset(L, -3);
    }
    lua_setfield(L, -3, "params");
    lua_pop(L, 1);
    lua_remove(L, -2);
}

/* another userdata with the same bytes and metatable */
static void *push_twin(lua_State *L, int of, int user_values) {
    const size_t size = lua_rawlen(L, of);
    void *twin = lua_newuserdatauv(L, size, user_values);
    memcpy(twin, lua_touserdata(L, of), size);
    lua_getmetatable(L, of);
    lua_setmetatable(L, -2);
    return twin;
}

dml_solver *dml_vary_solver(lua_State *L, const double *values, int names) {
    dml_solver *solver = push_twin(L, 1, DML_SOLVER_VALUES);
    const int twin = lua_gettop(L);
    for (int k = 1; k <= DML_SOLVER_VALUES; k++) {
        lua_getiuservalue(L, 1, k);
        lua_setiuservalue(L, twin, k);
    }
    lua_getiuservalue(L, 1, DML_SOLVER_SYSTEM);
    push_twin(L, twin + 1, 1);
    push_fields(L, twin + 1, values, names);
    lua_setiuservalue(L, -2, 1);
    lua_setiuservalue(L, twin, DML_SOLVER_SYSTEM);
    lua_settop(L, twin);
    lua_replace(L, 1);
    return solver;
}

/* ---- parameters as inputs of one kernel ---- */

/* what may fail: (solver, options, names) */
static int try_inputs(lua_State *L) {
    dml_stepping r = {.solver = lua_touserdata(L, 1), .apart = 1, .names = 3};
    const dm_method *m = r.solver->method;
    dml_stepping_prepare(L, &r, 0.0);
    const dm_model *model = &r.model->model;
    lua_pushboolean(L, m->widen && !(m->traits & DM_OWN_TIME) &&
                           m->wants(r.solver->nodes, model) == DM_WANT_FORCE);
    return 1;
}

int dml_vary_is_input(lua_State *L, int names) {
    lua_pushcfunction(L, try_inputs);
    lua_pushvalue(L, 1);
    lua_pushvalue(L, 2);
    lua_pushvalue(L, names);
    const int fits = lua_pcall(L, 3, 1, 0) == LUA_OK && lua_toboolean(L, -1);
    lua_pop(L, 1);
    return fits;
}

/* (what is compared): raises where trace and function differ at r->x, with the values behind it */
static int compare(lua_State *L) {
    const dml_stepping *r = lua_touserdata(L, 1);
    const dml_signature sig = dml_withsignature(r->model->n, r->model->params);
    dml_trace_check_start(L, 2, &sig, &r->model->model.value, lua_touserdata(L, 3));
    return 0;
}

int dml_vary_is_traced(lua_State *L, const dml_part *p, dml_stepping *r) {
    const uint32_t n = p->e->n, many = r->model->params;
    const dm_model *model = &r->model->model;
    const int top = lua_gettop(L);
    double *x = lua_newuserdatauv(L, (2 * n + 1 + many) * sizeof *x, 0);
    int same = 1;
    dml_pushwith(L, r->system, r->names);
    for (long i = 0; same && i < p->count; i++) {
        const double *state = p->e->state + (size_t)i * dm_state_size(n);
        memcpy(x, state, 2 * n * sizeof *x);
        x[2 * n] = r->t0;
        memcpy(x + 2 * n + 1, p->values + (size_t)i * many, many * sizeof *x);
        if (dm_legendre_inverse(model, x + n, state, state + n, r->t0, r->work) != DM_OK)
            continue;
        lua_pushcfunction(L, compare);
        lua_pushlightuserdata(L, r);
        lua_pushvalue(L, top + 2);
        lua_pushlightuserdata(L, x);
        same = lua_pcall(L, 3, 0, 0) == LUA_OK;
    }
    lua_settop(L, top);
    return same;
}
