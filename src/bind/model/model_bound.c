/* model_bound.c - functions of a system with its params, and the step of a pair, as their last
 * arguments. */
#include "bind/core/missing_key.h"
#include "bind/model/bind_system.h"

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
