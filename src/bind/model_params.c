/* model_params.c - L with some of its parameters as inputs behind t: one trace and one kernel for all their values. */
#include "bind/model_params.h"

#include "expr/analyse.h"
#include "expr/sum.h"

void dml_pushcopy(lua_State *L, int table) {
    table = lua_absindex(L, table);
    lua_newtable(L);
    for (lua_pushnil(L); lua_next(L, table);) {
        lua_pushvalue(L, -2);
        lua_insert(L, -2);
        lua_rawset(L, -4);
    }
}

/* L(q, v, t, values) with the values among the parameters; upvalues: L, params, names */
static int call_with(lua_State *L) {
    const lua_Integer count = luaL_len(L, lua_upvalueindex(3));
    lua_settop(L, 4);
    lua_pushvalue(L, lua_upvalueindex(1));
    lua_insert(L, 1);
    dml_pushcopy(L, lua_upvalueindex(2));
    for (lua_Integer k = 1; k <= count; k++) {
        lua_rawgeti(L, lua_upvalueindex(3), k);
        lua_geti(L, 5, k);
        lua_rawset(L, 6);
    }
    lua_remove(L, 5);
    lua_call(L, 4, 1);
    return 1;
}

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

/* L alone: nothing that ties it is traced with them */
static int is_bare(lua_State *L, int system, const dml_system *s) {
    static const char *const ties[] = {"constraint", "rolling",  "control",
                                       "force",      "reaction", NULL};
    int bare = !s->pair && !s->ruled && !s->hyperdual;
    for (int k = 0; ties[k]; k++) {
        bare = dml_systemfield(L, system, ties[k]) == LUA_TNIL && bare;
        lua_pop(L, 1);
    }
    return bare;
}

/* forces see the parameters, momenta do not */
static int is_split(const dml_model *m) {
    const unsigned simple = DM_SEPARABLE | DM_CONSTANT_MASS;
    return (m->model.structure & simple) == simple && m->model.inverse_mass &&
           !(m->model.structure & DM_LOOPS) &&
           !dm_depends(m->graph, m->model.source.gradient + m->n, m->n, 2 * m->n + 1,
                       m->params);
}

dml_model *dml_pushwithparams(lua_State *L, int system, int names) {
    system = lua_absindex(L, system);
    const dml_system *s = dml_checksystem(L, system);
    const uint32_t params = (uint32_t)luaL_len(L, names);
    const dml_signature sig = dml_withsignature(s->n, params);
    dml_traced traced;
    if (params > DML_MOST_PARAMS || !is_bare(L, system, s))
        luaL_error(L, "parameters cannot be inputs here");
    dml_pushwith(L, system, names);
    const int fn = lua_gettop(L);
    dml_model *m = lua_newuserdatauv(L, sizeof *m, 3); /* arena, function */
    *m = (dml_model){.n = s->n, .params = params};
    m->arena = dml_pusharena(L);
    lua_setiuservalue(L, -2, 1);
    lua_pushvalue(L, fn);
    lua_setiuservalue(L, -2, 2);
    dml_trace(L, fn, &sig, m->arena, &traced);
    m->graph = traced.graph;
    if (!m->graph) luaL_error(L, "too large");
    m->lagrangian = traced.out[0];
    const dm_status status =
        dm_model_build(&m->model, m->graph, m->lagrangian, m->n, 0, NULL, m->arena);
    if (status != DM_OK || !is_split(m))
        luaL_error(L, "parameters are more than a part of the potential");
    m->model.params = params;
    lua_remove(L, fn);
    return m;
}
