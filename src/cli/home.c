/* home.c - finding lua/dm: beside the build tree, or under PREFIX/share/dmlua. */
#include "cli/home.h"

#include "bind/core/bind.h"
#include "cli/compiled.h"
#include "cli/options.h"

#include <lualib.h>

#include <stdio.h>
#include <string.h>
#include <unistd.h>

enum { LONGEST_PATH = 4096 };

/* folder of the executable, without the slash; 0 when it is not known */
static int own_folder(char *out, size_t size) {
    const ssize_t n = readlink("/proc/self/exe", out, size - 1);
    if (n <= 0 || (size_t)n >= size - 1) return 0;
    out[n] = '\0';
    char *slash = strrchr(out, '/');
    if (slash) *slash = '\0';
    return slash != NULL;
}

/* push "<home>/?.lua;<home>/?/init.lua" of the first folder that has dm/init.lua, or nil */
static void push_path(lua_State *L) {
    static const char *const places[] = {"../lua", "../../lua", "../share/dmlua/lua"};
    char folder[LONGEST_PATH];
    if (own_folder(folder, sizeof folder)) {
        for (size_t i = 0; i < sizeof places / sizeof *places; i++) {
            const char *home = lua_pushfstring(L, "%s/%s", folder, places[i]);
            const char *first = lua_pushfstring(L, "%s/dm/init.lua", home);
            const int found = access(first, R_OK) == 0;
            lua_pop(L, 1);
            if (found) {
                lua_pushfstring(L, "%s/?.lua;%s/?/init.lua", home, home);
                lua_remove(L, -2);
                return;
            }
            lua_pop(L, 1);
        }
    }
    lua_pushnil(L);
}

/* chunk, name, file -> the module, which is among those that are loaded now */
static int read_module(lua_State *L) {
    luaL_getsubtable(L, LUA_REGISTRYINDEX, LUA_LOADED_TABLE);
    lua_insert(L, 1);
    lua_pushvalue(L, 3);
    lua_insert(L, 2);
    lua_call(L, 2, 1); /* loaded, name, module */
    if (lua_isnil(L, 3)) return 1;
    lua_pushvalue(L, 3);
    lua_insert(L, 1);
    lua_settable(L, 2);
    lua_settop(L, 1);
    return 1;
}

/* The module of a name and a file, its chunk upvalue 1. No stop comes before it is whole and among
 * those that are loaded: it would be read again, and wrap what it has wrapped. */
static int load(lua_State *L) {
    lua_settop(L, 2);
    lua_pushvalue(L, lua_upvalueindex(1));
    lua_insert(L, 1);
    lua_pushcfunction(L, read_module);
    lua_insert(L, 1);
    dml_hold_stops();
    const int status = lua_pcall(L, 3, 1, 0);
    dml_release_stops();
    return status == LUA_OK ? 1 : lua_error(L);
}

/* push what make has compiled: in the build tree, or under PREFIX/lib/dmlua */
static void push_compiled(lua_State *L) {
    static const char *const places[] = {"modules.luac", "../lib/dmlua/modules.luac"};
    char folder[LONGEST_PATH];
    dml_compiled *c = lua_newuserdatauv(L, sizeof *c, 0);
    *c = (dml_compiled){0};
    if (!own_folder(folder, sizeof folder)) return;
    for (size_t i = 0; i < sizeof places / sizeof *places && !c->bytes; i++) {
        *c = dml_compiled_open(lua_pushfstring(L, "%s/%s", folder, places[i]));
        lua_pop(L, 1);
    }
}

/* A searcher for dm and dm.* only. Upvalues: package.searchpath, the path, what is compiled. */
static int search(lua_State *L) {
    const char *name = luaL_checkstring(L, 1);
    const int ours = strcmp(name, "dm") == 0 || strncmp(name, "dm.", 3) == 0;
    if (!ours || lua_isnil(L, lua_upvalueindex(2))) return 0;
    lua_pushvalue(L, lua_upvalueindex(1));
    lua_pushvalue(L, 1);
    lua_pushvalue(L, lua_upvalueindex(2));
    lua_call(L, 2, 2);
    const char *file = lua_tostring(L, -2);
    if (!file) return 1; /* the list of files tried */
    if (dml_compiled_load(L, lua_touserdata(L, lua_upvalueindex(3)), file) != LUA_OK)
        return luaL_error(L, "error loading module '%s':\n\t%s", name, lua_tostring(L, -1));
    lua_pushcclosure(L, load, 1);
    lua_pushstring(L, file);
    return 2;
}

/* second of package.searchers: after package.preload, before package.path */
static void add_searcher(lua_State *L) {
    lua_getglobal(L, LUA_LOADLIBNAME);
    lua_getfield(L, -1, "searchers");
    for (lua_Integer i = luaL_len(L, -1); i >= 2; i--) {
        lua_rawgeti(L, -1, i);
        lua_rawseti(L, -2, i + 1);
    }
    lua_getfield(L, -2, "searchpath");
    push_path(L);
    push_compiled(L);
    lua_pushcclosure(L, search, 3);
    lua_rawseti(L, -2, 2);
    lua_pop(L, 2);
}

/* The core and the manual are built in, modules in Lua are looked for beside the program. */
static int open_home(lua_State *L) {
    static const luaL_Reg modules[] = {{"dm.core", luaopen_dm_core},
                                       {"dm.manual", dml_open_manual},
                                       {NULL, NULL}};
    luaL_getsubtable(L, LUA_REGISTRYINDEX, LUA_PRELOAD_TABLE);
    luaL_setfuncs(L, modules, 0);
    add_searcher(L);
    lua_getglobal(L, "require");
    lua_pushvalue(L, -1);
    lua_setfield(L, LUA_REGISTRYINDEX, "dm_require");
    lua_pushstring(L, "dm");
    lua_call(L, 1, 1);
    lua_setglobal(L, "dm");
    return 0;
}

int dml_open_home(lua_State *L) {
    lua_pushcfunction(L, open_home);
    return lua_pcall(L, 0, 0, 0);
}
