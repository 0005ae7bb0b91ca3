/* model_bound.c - functions of a system with its params, and the step of a pair, as their last
 * arguments. */
#include "bind/core/missing_key.h"
#include "bind/model/bind_system.h"

#include <string.h>

/* L(q, v, t, params) and Ld(q0, q1, h, params) with the last arguments bound */
static int bound_call(lua_State *L) {
    const int given = lua_gettop(L);
    lua_pushvalue(L, lua_upvalueindex(1));
    lua_insert(L, 1);
    int extra = 0;
    for (int i = 2; i <= 3; i++) {
        if (lua_isnone(L, lua_upvalueindex(i))) break;
        dml_pushparams(L, lua_upvalueindex(i));
        extra++;
    }
    lua_call(L, given + extra, LUA_MULTRET);
    return lua_gettop(L);
}

void dml_pushbound(lua_State *L, int arg, const char *key) {
    arg = lua_absindex(L, arg);
    dml_systemfield(L, arg, key);
    if (dml_systemfield(L, arg, "params") != LUA_TNIL)
        lua_pushcclosure(L, bound_call, 2);
    else
        lua_pop(L, 1);
}

void dml_pushboundpair(lua_State *L, int arg, const char *key) {
    arg = lua_absindex(L, arg);
    dml_systemfield(L, arg, key);
    lua_pushnumber(L, dml_checksystem(L, arg)->h);
    dml_systemfield(L, arg, "params");
    lua_pushcclosure(L, bound_call, 3);
}

/* ---- params as a script has them ---- */

/* field `params` of the system at 1, or nil: of a plain table what stands for it */
int dml_shownparams(lua_State *L) {
    if (dml_systemfield(L, 1, "params") != LUA_TTABLE || lua_getmetatable(L, -1)) {
        lua_settop(L, 3);
        return 1;
    }
    /* the core alone knows of none */
    if (lua_getfield(L, LUA_REGISTRYINDEX, "dm_params") != LUA_TFUNCTION) return lua_pop(L, 1), 1;
    lua_pushvalue(L, 1);
    lua_pushvalue(L, -3);
    lua_call(L, 2, 1);
    return 1;
}

/* The options at 1 are copied where their params stand for those of another system. */
void dml_plainparams(lua_State *L) {
    lua_getfield(L, 1, "params");
    if (lua_istable(L, -1) && luaL_getmetafield(L, -1, "__name") == LUA_TSTRING &&
        strcmp(lua_tostring(L, -1), "dm.params") == 0) {
        dml_pushcopy(L, 1);
        luaL_getmetafield(L, -3, "__params");
        lua_setfield(L, -2, "params");
        lua_replace(L, 1);
    }
    lua_settop(L, 1);
}

void *dml_pushtwin(lua_State *L, int of, int user_values) {
    const size_t size = lua_rawlen(L, of);
    void *twin = lua_newuserdatauv(L, size, user_values);
    memcpy(twin, lua_touserdata(L, of), size);
    lua_getmetatable(L, of);
    lua_setmetatable(L, -2);
    return twin;
}

int dml_core_trace_with(lua_State *L) {
    dml_checksystem(L, 1);
    luaL_checktype(L, 2, LUA_TTABLE);
    lua_settop(L, 2);
    if (lua_getfield(L, 2, "__index") != LUA_TFUNCTION)
        luaL_error(L, "the metatable needs a function __index");
    lua_settop(L, 2);
    dml_pushtwin(L, 1, 1);
    lua_getiuservalue(L, 1, 1);
    dml_pushcopy(L, -1);
    lua_newuserdatauv(L, 0, 0);
    lua_pushvalue(L, 2);
    lua_setmetatable(L, -2);
    lua_setfield(L, -2, "params");
    lua_setiuservalue(L, 3, 1);
    lua_settop(L, 3);
    const dml_model *m = dml_pushmodel(L, 3);
    if (m->callback) return luaL_error(L, "it runs on hyper-dual numbers");
    return 0;
}
