/* open.c - `require "dm.core"`: every class of classes.def, docs, and the door for Lua
 * modules. */
#include "bind/core/bind.h"
#include "bind/core/missing_key.h"

/* method(tname, name, f, doc): also for classes whose methods are all in Lua */
static int add_method(lua_State *L) {
    const char *tname = luaL_checkstring(L, 1), *name = luaL_checkstring(L, 2);
    luaL_checktype(L, 3, LUA_TFUNCTION);
    luaL_checkstring(L, 4);
    if (luaL_getmetatable(L, tname) != LUA_TTABLE || lua_getfield(L, -1, "methods") != LUA_TTABLE)
        return luaL_error(L,
                          "unknown class '%s': give the name that tostring and help use, "
                          "for instance \"dm.path\"",
                          tname);
    lua_pushvalue(L, 3);
    lua_setfield(L, -2, name);
    luaL_getsubtable(L, LUA_REGISTRYINDEX, "dm_docs");
    lua_pushvalue(L, 3);
    lua_pushvalue(L, 4);
    lua_rawset(L, -3);
    return 0;
}

static int until_stop(lua_State *L) {
    luaL_checkany(L, 1);
    const int fine = lua_pcall(L, lua_gettop(L) - 1, LUA_MULTRET, 0) == LUA_OK;
    dml_raised = 0;
    lua_pushboolean(L, fine);
    lua_insert(L, 1);
    return lua_gettop(L);
}

static int make_result(lua_State *L) {
    luaL_checktype(L, 1, LUA_TTABLE);
    lua_settop(L, 1);
    dml_setresult(L);
    return 1;
}

static const dml_row functions[] =
    {{"result", make_result,
      "core.result(t) -> t\n"
      "The table t as what a method returns: print(t) and tostring(t) show its entries, "
      "in "
      "scripts as in a session."},
     {"method", add_method,
      "core.method(class, name, f, doc)\n"
      "Add the Lua function f as method `name` to a class (\"dm.path\"); doc: signature "
      "line, "
      "then shapes, units, errors. Raises on an unknown class."},
     {"until_stop", until_stop,
      "core.until_stop(f, ...) -> true, results   or   false, error\n"
      "pcall for what has something to show when Ctrl-C ends it: the only one of our "
      "modules that keeps this error."},
     {"miss", dml_core_miss,
      "core.miss(class, key [, names])\n"
      "Note that class has no such key, for the message of an error on the same line; "
      "called from the __index of a class in Lua; names: a table with the keys there are, "
      "where methods and docs do not say."},
     {"nearest", dml_core_nearest,
      "core.nearest(word, names) -> name or nil\n"
      "The name of the list that is spelt most like the word, nil when none is near."},
     {NULL, NULL, NULL}};

int luaopen_dm_core(lua_State *L) {
    lua_newtable(L);
    dml_setfunctions(L, functions);
    luaL_getsubtable(L, LUA_REGISTRYINDEX, "dm_docs");
    lua_setfield(L, -2, "docs");
#define X(name) dml_open_##name(L);
#include "bind/classes.def"
#undef X
    return 1;
}
