/* mesh_euler.c - K.euler is Euler's number of a mesh, and K:euler{...} the flow of Euler's
 * equations: a number that can be called. All numbers share one metatable, so its __call says of
 * every other call what Lua would have said. It is put there when K.euler is first asked for. */
#include "bind/dec/bind_mesh.h"

/* "attempt to call a number value (local 'x')" at the line of the call */
static int refuse(lua_State *L) {
    lua_Debug about;
    const char *name = NULL;
    if (lua_getstack(L, 0, &about) && lua_getinfo(L, "n", &about)) name = about.name;
    luaL_where(L, 1);
    if (name)
        lua_pushfstring(L, "attempt to call a number value (%s '%s')",
                        *about.namewhat ? about.namewhat : "value", name);
    else
        lua_pushliteral(L, "attempt to call a number value");
    lua_concat(L, 2);
    return lua_error(L);
}

/* (number, mesh, options): the method that lua/dm/dec/flow gives to the class */
static int call_number(lua_State *L) {
    if (!luaL_testudata(L, 2, DML_MESH)) return refuse(L);
    luaL_getmetatable(L, DML_MESH);
    lua_getfield(L, -1, "methods");
    lua_getfield(L, -1, "euler");
    lua_replace(L, 1);
    lua_pop(L, 2);
    lua_call(L, lua_gettop(L) - 1, LUA_MULTRET);
    return lua_gettop(L);
}

int dml_mesh_pusheuler(lua_State *L, const dml_mesh *m) {
    lua_pushinteger(L, dm_complex_euler(&m->K));
    if (!lua_getmetatable(L, -1)) {
        lua_newtable(L);
        lua_pushvalue(L, -1);
        lua_setmetatable(L, -3);
    }
    if (lua_getfield(L, -1, "__call") == LUA_TNIL) {
        lua_pushcfunction(L, call_number);
        lua_setfield(L, -3, "__call");
    }
    lua_pop(L, 2);
    return 1;
}
