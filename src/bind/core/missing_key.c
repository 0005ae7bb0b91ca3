/* missing_key.c - what was asked for last and is not there. */
#include "bind/core/missing_key.h"

#include <string.h>

/* registry.dm_missed: of, key, source, line and a table of names */
static void push_note(lua_State *L) {
    luaL_checkstack(L, 6, NULL);
    luaL_getsubtable(L, LUA_REGISTRYINDEX, "dm_missed");
}

/* The function at a level of the stack that asks; a metamethod in Lua that asks for another one is
 * passed over. */
static int find_asker(lua_State *L, int level, lua_Debug *ar) {
    if (!lua_getstack(L, level, ar) || !lua_getinfo(L, "nSl", ar)) return 0;
    const int is_index = strcmp(ar->namewhat, "metamethod") == 0 && strcmp(ar->name, "index") == 0;
    return (!is_index || (lua_getstack(L, level + 1, ar) && lua_getinfo(L, "Sl", ar))) &&
           ar->currentline >= 0;
}

void dml_miss(lua_State *L, int level, const char *of, int key) {
    lua_Debug ar;
    key = lua_absindex(L, key);
    if (!find_asker(L, level, &ar)) return;
    push_note(L);
    lua_pushstring(L, of);
    lua_setfield(L, -2, "of");
    lua_pushvalue(L, key);
    lua_setfield(L, -2, "key");
    lua_pushstring(L, ar.short_src);
    lua_setfield(L, -2, "source");
    lua_pushinteger(L, ar.currentline);
    lua_setfield(L, -2, "line");
    lua_pushnil(L);
    lua_setfield(L, -2, "names");
    lua_pop(L, 1);
}

/* the names that there are, where no class lists them: keys of the table at `names` */
static void note_names(lua_State *L, int names) {
    push_note(L);
    lua_pushvalue(L, names);
    lua_setfield(L, -2, "names");
    lua_pop(L, 1);
}

void dml_explain(lua_State *L) {
    const int text = lua_gettop(L);
    luaL_checkstack(L, 4, NULL);
    if (lua_getfield(L, LUA_REGISTRYINDEX, "dm_explain") == LUA_TFUNCTION) {
        lua_pushvalue(L, text);
        if (dml_try(L, 1, 1) && lua_type(L, -1) == LUA_TSTRING) lua_copy(L, -1, text);
    }
    lua_settop(L, text);
}

const char *dml_noted(lua_State *L) {
    luaL_checkstack(L, 4, NULL);
    if (lua_getfield(L, LUA_REGISTRYINDEX, "dm_noted") != LUA_TFUNCTION) return NULL;
    return dml_try(L, 0, 1) ? lua_tostring(L, -1) : NULL;
}

int dml_typeerror(lua_State *L, int arg, const char *wanted) {
    if (!lua_isnil(L, arg)) return luaL_typeerror(L, arg, wanted);
    luaL_checkstack(L, 4, NULL);
    const char *name = NULL;
    if (lua_getfield(L, LUA_REGISTRYINDEX, "dm_argument") == LUA_TFUNCTION) {
        lua_pushinteger(L, arg);
        if (dml_try(L, 1, 1)) name = lua_tostring(L, -1);
    }
    return luaL_argerror(L, arg,
                         lua_pushfstring(L, "%s expected, got nil%s", wanted, name ? name : ""));
}

void dml_forget(lua_State *L) {
    push_note(L);
    lua_pushnil(L);
    lua_setfield(L, -2, "of");
    lua_pop(L, 1);
}

/* ---- parameters ---- */

/* the __index of a copy; upvalue: the table itself */
static int missing_parameter(lua_State *L) {
    lua_settop(L, 2);
    dml_miss(L, 1, "params", 2);
    note_names(L, lua_upvalueindex(1));
    return 0;
}

void dml_copyparams(lua_State *L, int table) {
    table = lua_absindex(L, table);
    dml_pushcopy(L, table);
    if (lua_getmetatable(L, table)) lua_setmetatable(L, -2);
}

void dml_pushparams(lua_State *L, int table) {
    table = lua_absindex(L, table);
    luaL_checkstack(L, 6, NULL);
    const int has_own = lua_getmetatable(L, table);
    if (has_own) lua_pop(L, 1);
    if (has_own || !lua_istable(L, table)) {
        lua_pushvalue(L, table);
        return;
    }
    dml_pushcopy(L, table);
    lua_createtable(L, 0, 1);
    lua_pushvalue(L, table);
    lua_pushcclosure(L, missing_parameter, 1);
    lua_setfield(L, -2, "__index");
    lua_setmetatable(L, -2);
}

/* ---- for modules in Lua ---- */

int dml_core_miss(lua_State *L) {
    const char *of = luaL_checkstring(L, 1);
    lua_settop(L, 3);
    dml_miss(L, 2, of, 2); /* who asked the module's own __index */
    if (!lua_isnil(L, 3)) note_names(L, 3);
    return 0;
}
