/* locked.c - lists that tell what an object holds: they are read as tables are, and cannot be set,
 * since what is written there would change nothing, or the object behind its back. */
#include "bind/core/bind.h"

static int refuse(lua_State *L) {
    return luaL_error(L,
                      "%s cannot be set: change a list of your own, table.move(list, 1, #list, "
                      "1, {})",
                      lua_tostring(L, lua_upvalueindex(1)));
}

static int length(lua_State *L) {
    lua_pushinteger(L, (lua_Integer)lua_rawlen(L, lua_upvalueindex(1)));
    return 1;
}

/* (locked, key) -> next key, value */
static int step(lua_State *L) {
    lua_settop(L, 2);
    lua_pushvalue(L, lua_upvalueindex(1));
    lua_insert(L, 2);
    return lua_next(L, 2) ? 2 : 0;
}

/* the list itself stays in here: who has it can set it */
static int all(lua_State *L) {
    lua_settop(L, 1);
    lua_pushvalue(L, lua_upvalueindex(1));
    lua_pushcclosure(L, step, 1);
    lua_insert(L, 1);
    return 2;
}

static int text(lua_State *L) {
    luaL_tolstring(L, lua_upvalueindex(1), NULL);
    return 1;
}

static void set(lua_State *L, int of, lua_CFunction f, const char *name) {
    lua_pushvalue(L, of);
    lua_pushcclosure(L, f, 1);
    lua_setfield(L, -2, name);
}

void dml_lock(lua_State *L, const char *what) {
    dml_setresult(L);
    const int list = lua_gettop(L);
    lua_newtable(L);
    lua_createtable(L, 0, 6);
    set(L, list, length, "__len");
    set(L, list, all, "__pairs");
    set(L, list, text, "__tostring");
    lua_pushvalue(L, list);
    lua_setfield(L, -2, "__index");
    lua_pushstring(L, what);
    lua_pushcclosure(L, refuse, 1);
    lua_setfield(L, -2, "__newindex");
    lua_pushboolean(L, 0);
    lua_setfield(L, -2, "__metatable");
    lua_setmetatable(L, -2);
    lua_replace(L, list);
}
