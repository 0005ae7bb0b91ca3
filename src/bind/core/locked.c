/* locked.c - lists and tables that tell what an object holds: they are read as tables are, and
 * cannot be set, since what is written there would change nothing, or the object behind its back.
 * They are no tables, so that next and the raw functions raise where they would see none. */
#include "bind/core/bind.h"

#define LIST "dm.list"

enum { ENTRIES = 1, WHAT = 2 }; /* user values */

static void push_entries(lua_State *L) {
    luaL_checkudata(L, 1, LIST);
    lua_getiuservalue(L, 1, ENTRIES);
}

static int get(lua_State *L) {
    lua_settop(L, 2);
    push_entries(L);
    lua_insert(L, 2);
    lua_rawget(L, 2);
    return 1;
}

static int refuse(lua_State *L) {
    push_entries(L);
    const int is_list = lua_rawlen(L, -1) > 0;
    lua_getiuservalue(L, 1, WHAT);
    return luaL_error(L, "%s cannot be set, since it is a copy: %s", lua_tostring(L, -1),
                      is_list ? "change a list of your own, table.move(list, 1, #list, 1, {})"
                              : "change a table of your own, for key, value in pairs(it) do "
                                "own[key] = value end");
}

static int length(lua_State *L) {
    push_entries(L);
    lua_pushinteger(L, (lua_Integer)lua_rawlen(L, -1));
    return 1;
}

/* (list, key) -> next key, value */
static int step(lua_State *L) {
    lua_settop(L, 2);
    push_entries(L);
    lua_insert(L, 2);
    return lua_next(L, 2) ? 2 : 0;
}

/* the entries themselves stay in here: who has them can set them */
static int all(lua_State *L) {
    lua_settop(L, 1);
    lua_pushcfunction(L, step);
    lua_insert(L, 1);
    return 2;
}

static int text(lua_State *L) {
    push_entries(L);
    luaL_tolstring(L, -1, NULL);
    return 1;
}

static void push_class(lua_State *L) {
    static const luaL_Reg events[] = {{"__index", get}, {"__newindex", refuse}, {"__len", length},
                                      {"__pairs", all}, {"__tostring", text},   {NULL, NULL}};
    if (!luaL_newmetatable(L, LIST)) return;
    luaL_setfuncs(L, events, 0);
    lua_pushboolean(L, 1);
    lua_setfield(L, -2, "__list"); /* dml_islist */
    lua_pushboolean(L, 0);
    lua_setfield(L, -2, "__metatable");
}

void dml_lock(lua_State *L, const char *what) {
    dml_setresult(L);
    lua_newuserdatauv(L, 0, WHAT);
    lua_insert(L, -2);
    lua_setiuservalue(L, -2, ENTRIES);
    lua_pushstring(L, what);
    lua_setiuservalue(L, -2, WHAT);
    push_class(L);
    lua_setmetatable(L, -2);
}

void dml_unlock(lua_State *L, int at) {
    if (!luaL_testudata(L, at, LIST)) return;
    at = lua_absindex(L, at);
    lua_getiuservalue(L, at, ENTRIES);
    dml_pushcopy(L, lua_gettop(L));
    lua_replace(L, at);
    lua_pop(L, 1);
}
