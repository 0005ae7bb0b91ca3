/* model_params.c - L with some of its parameters as inputs behind t: one trace and one kernel
 * for all their values. */
#include "bind/model/model_params.h"

#include "bind/core/missing_key.h"
#include "bind/core/state.h"
#include "graph/analyse.h"

#include <string.h>

/* L(q, v, t, values) with the values among the parameters; upvalues: L, params, names */
static int call_with(lua_State *L) {
    const lua_Integer count = luaL_len(L, lua_upvalueindex(3));
    lua_settop(L, 4);
    lua_pushvalue(L, lua_upvalueindex(1));
    lua_insert(L, 1);
    dml_copyparams(L, lua_upvalueindex(2));
    for (lua_Integer k = 1; k <= count; k++) {
        lua_rawgeti(L, lua_upvalueindex(3), k);
        lua_geti(L, 5, k);
        lua_rawset(L, 6);
    }
    lua_remove(L, 5);
    lua_call(L, 4, LUA_MULTRET);
    return lua_gettop(L);
}

/* A closure over L, its params and the names. */
void dml_pushwith(lua_State *L, int system, int names) {
    system = lua_absindex(L, system), names = lua_absindex(L, names);
    dml_systemfield(L, system, "L");
    dml_systemfield(L, system, "params");
    lua_pushvalue(L, names);
    lua_pushcclosure(L, call_with, 3);
}

dml_signature dml_withsignature(uint32_t n, uint32_t params) {
    return (dml_signature){.what = "L",
                           .arguments = 4,
                           .length = {(int)n, (int)n, DML_SCALAR_ARGUMENT, (int)params},
                           .outputs = DML_SCALAR_ARGUMENT,
                           .may_grow = 1};
}

/* ---- which of them ---- */

/* L alone: nothing that constraints it is traced with them */
static int is_bare(lua_State *L, int system, const dml_system *s) {
    static const char *const constraints[] = {"constraint", "rolling",  "control",
                                              "force",      "reaction", NULL};
    int bare = !s->pair && !s->ruled && !s->hyperdual && !s->hamiltonian && !s->field;
    for (int k = 0; constraints[k]; k++) {
        bare = dml_systemfield(L, system, constraints[k]) == LUA_TNIL && bare;
        lua_pop(L, 1);
    }
    return bare;
}

/* push the names of the parameters that are numbers, in alphabetical order */
static void push_numbers(lua_State *L, int system) {
    lua_newtable(L);
    const int names = lua_gettop(L);
    if (dml_systemfield(L, system, "params") != LUA_TTABLE) return lua_settop(L, names);
    for (lua_pushnil(L); lua_next(L, names + 1); lua_pop(L, 1)) {
        if (lua_type(L, -2) != LUA_TSTRING || lua_type(L, -1) != LUA_TNUMBER) continue;
        lua_pushvalue(L, -2);
        lua_rawseti(L, names, luaL_len(L, names) + 1);
    }
    lua_getglobal(L, "table");
    lua_getfield(L, -1, "sort");
    lua_pushvalue(L, names);
    lua_call(L, 1, 0);
    lua_settop(L, names);
}

/* a list of those of the names that momenta do not depend on */
static void push_of_forces(lua_State *L, int names, const dml_model *m) {
    const dm_node *momenta = m->model.source.gradient + m->n;
    lua_Integer kept = 0;
    lua_newtable(L);
    for (uint32_t j = 0; j < m->params; j++) {
        if (dm_depends(m->graph, momenta, m->n, 2 * m->n + 1 + j, 1)) continue;
        lua_rawgeti(L, names, j + 1);
        lua_rawseti(L, -2, ++kept);
    }
}

/* kicks and drifts can step it */
int dml_issplit(const dm_model *m) {
    const unsigned simple = DM_SEPARABLE | DM_CONSTANT_MASS;
    return (m->structure & simple) == simple && m->inverse_mass && !(m->structure & DM_LOOPS);
}

/* values of the parameters in the list on top of the stack, which is dropped */
void dml_readparams(lua_State *L, int system, double *out) {
    const int names = lua_gettop(L);
    dml_systemfield(L, system, "params");
    for (lua_Integer k = 1; k <= luaL_len(L, names); k++) {
        lua_rawgeti(L, names, k);
        lua_gettable(L, names + 1);
        *out++ = lua_tonumber(L, -1);
        lua_pop(L, 1);
    }
    lua_settop(L, names - 1);
}

/* push the model of L traced with these names as inputs */
static dml_model *push_traced(lua_State *L, int system, int names) {
    const dml_system *s = dml_checksystem(L, system);
    const uint32_t params = (uint32_t)luaL_len(L, names);
    const dml_signature sig = dml_withsignature(s->n, params);
    dml_pushwith(L, system, names);
    const int fn = lua_gettop(L);
    dml_model *m = lua_newuserdatauv(L, sizeof *m, 4); /* arena, function, -, names */
    *m = (dml_model){.n = s->n, .params = params};
    m->arena = dml_pusharena(L);
    lua_setiuservalue(L, -2, 1);
    lua_pushvalue(L, fn);
    lua_setiuservalue(L, -2, 2);
    lua_pushvalue(L, names);
    lua_setiuservalue(L, -2, 4);
    dml_retrace(L, fn, &sig, m->arena, NULL, &m->trace);
    m->graph = m->trace.graph;
    if (!m->graph) luaL_error(L, "too large a graph");
    m->lagrangian = m->stepped = m->trace.out[0];
    m->values = dm_arena_take(m->arena, params * sizeof *m->values);
    if (!m->values) luaL_error(L, "not enough memory");
    lua_pushvalue(L, names);
    dml_readparams(L, system, m->values);
    if (dm_model_build(&m->model, m->graph, m->lagrangian, m->n, 0, NULL, m->arena) != DM_OK)
        m->model.structure = 0;
    m->model.params = params;
    lua_remove(L, fn);
    return m;
}

/* (system) -> the model with as many inputs as there can be, or nothing; raises what tracing
 * raises */
static int find_inputs(lua_State *L) {
    push_numbers(L, 1);
    for (int tries = 0; tries < 2; tries++) {
        const lua_Integer count = luaL_len(L, -1);
        const int names = lua_gettop(L);
        if (count == 0 || count > DML_MOST_PARAMS) return 0;
        const dml_model *m = push_traced(L, 1, names);
        push_of_forces(L, names, m);
        if (luaL_len(L, -1) == count) return lua_pop(L, 1), dml_issplit(&m->model);
    }
    return 0;
}

/* The model or nil is left on the stack in any case. */
dml_model *dml_pushinputs(lua_State *L, int system) {
    system = lua_absindex(L, system);
    lua_pushcfunction(L, find_inputs);
    lua_pushvalue(L, system);
    if (!is_bare(L, system, dml_checksystem(L, system)) || !dml_try(L, 1, 1)) {
        lua_settop(L, lua_gettop(L) - 1);
        lua_pushnil(L);
    }
    return lua_touserdata(L, -1);
}
