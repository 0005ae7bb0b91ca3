/* named.c - starts by the names of coordinates. */
#include "bind/model/named.h"

/* Vectors and lists are not. */
int dml_is_named(lua_State *L, int at) {
    if (lua_type(L, at) != LUA_TTABLE || lua_rawlen(L, at) > 0) return 0;
    at = lua_absindex(L, at);
    if (lua_getmetatable(L, at)) return lua_pop(L, 1), 0;
    lua_pushnil(L);
    if (!lua_next(L, at)) return 0;
    const int named = lua_type(L, -2) == LUA_TSTRING;
    lua_pop(L, 2);
    return named;
}

/* push "x, y, z" */
static const char *push_names(lua_State *L, int system, uint32_t n) {
    enum { SHOWN = 8 };
    luaL_Buffer b;
    luaL_buffinit(L, &b);
    for (uint32_t i = 0; i < n && i < SHOWN; i++) {
        if (i) luaL_addstring(&b, ", ");
        dml_coordinate(L, system, i);
        luaL_addvalue(&b);
    }
    if (n > SHOWN) luaL_addstring(&b, ", ...");
    luaL_pushresult(&b);
    return lua_tostring(L, -1);
}

/* every key must have been a coordinate */
static void check_keys(lua_State *L, int system, int at, const char *what) {
    const uint32_t n = dml_checksystem(L, system)->n;
    lua_pushnil(L);
    while (lua_next(L, at)) {
        const int key = lua_gettop(L) - 1;
        int known = 0;
        for (uint32_t i = 0; i < n && !known; i++) {
            dml_coordinate(L, system, i);
            known = lua_rawequal(L, key, -1);
            lua_pop(L, 1);
        }
        lua_settop(L, key);
        if (known) continue;
        const char *given = luaL_tolstring(L, key, NULL);
        const char *names = push_names(L, system, n);
        luaL_error(L, "%s: there is no coordinate '%s'; they are %s", what, given, names);
    }
}

/* The table at `at` is replaced, never written to. */
void dml_unname(lua_State *L, int system, int at, const char *what) {
    system = lua_absindex(L, system), at = lua_absindex(L, at);
    if (!dml_is_named(L, at)) return;
    const uint32_t n = dml_checksystem(L, system)->n;
    luaL_checkstack(L, 10, NULL);
    lua_createtable(L, (int)n, 0);
    const int list = lua_gettop(L);
    for (uint32_t i = 0; i < n; i++) {
        const char *name = dml_coordinate(L, system, i);
        if (lua_getfield(L, at, name) == LUA_TNIL) {
            check_keys(L, system, at, what);
            const char *names = push_names(L, system, n);
            luaL_error(L, "%s: the coordinate '%s' is missing; all of %s are needed", what, name,
                       names);
        }
        lua_rawseti(L, list, (lua_Integer)i + 1);
        lua_settop(L, list);
    }
    check_keys(L, system, at, what);
    lua_replace(L, at);
}

/* The field, a Lua object, knows its mesh. */
int dml_unfield(lua_State *L, int system, int at, const char *key) {
    system = lua_absindex(L, system), at = lua_absindex(L, at);
    if (!dml_checksystem(L, system)->field || lua_isnil(L, at)) return 0;
    dml_systemfield(L, system, "field");
    lua_getfield(L, -1, "start");
    lua_pushvalue(L, at);
    lua_pushstring(L, key);
    lua_call(L, 2, 1);
    lua_replace(L, at);
    lua_pop(L, 1);
    return 1;
}

/* The stack is left as it was. */
void dml_start_numbers(lua_State *L, int system, int options, const char *key, double *out,
                       uint32_t n) {
    const int top = lua_gettop(L);
    lua_getfield(L, options, key);
    const int field = dml_unfield(L, system, -1, key);
    if (!field && !dml_is_named(L, -1)) {
        lua_settop(L, top);
        dml_numbers(L, options, key, out, n);
        return;
    }
    const char *what = lua_pushfstring(L, "field '%s'", key);
    if (!field) dml_unname(L, system, -2, what);
    dml_vectorarg(L, -2, what, out, n);
    lua_settop(L, top);
}
