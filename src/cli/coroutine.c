/* coroutine.c - hooks belong to a thread: Ctrl-C sets its own on the one that runs, which these
 * two know. */
#include "cli/coroutine.h"

#include "cli/call.h"

#include <lauxlib.h>

/* results of co on the stack of L, and their number; -1: what it raised */
static int finish(lua_State *L, lua_State *co, int status, int results) {
    if (status != LUA_OK && status != LUA_YIELD) {
        lua_xmove(co, L, 1);
        return -1;
    }
    if (!lua_checkstack(L, results + 1)) {
        lua_pop(co, results);
        lua_pushliteral(L, "too many results to resume");
        return -1;
    }
    lua_xmove(co, L, results);
    return results;
}

/* go on in co with the `count` values on top */
static int go_on(lua_State *L, lua_State *co, int count) {
    int results;
    if (!lua_checkstack(co, count)) {
        lua_pushliteral(L, "too many arguments to resume");
        return -1;
    }
    lua_xmove(L, co, count);
    lua_State *before = dml_running(co);
    const int status = lua_resume(co, L, count, &results);
    dml_running(before);
    return finish(L, co, status, results);
}

/* Notes which thread runs meanwhile, as hooks belong to one thread. */
static int resume(lua_State *L) {
    lua_State *co = lua_tothread(L, 1);
    luaL_argexpected(L, co, 1, "thread");
    const int results = go_on(L, co, lua_gettop(L) - 1);
    if (results < 0 && dml_interrupted()) return lua_error(L); /* not one of several */
    lua_pushboolean(L, results >= 0);
    lua_insert(L, results < 0 ? -2 : -(results + 1));
    return results < 0 ? 2 : results + 1;
}

/* raise what co did; variables that wait to be closed are closed first, and a message gets its
 * place */
static int raise_again(lua_State *L, lua_State *co) {
    const int status = lua_status(co);
    if (status != LUA_OK && status != LUA_YIELD) {
        lua_pop(L, 1);
        lua_resetthread(co);
        lua_xmove(co, L, 1);
    }
    if (status != LUA_ERRMEM && lua_type(L, -1) == LUA_TSTRING) {
        luaL_where(L, 1);
        lua_insert(L, -2);
        lua_concat(L, 2);
    }
    return lua_error(L);
}

/* As coroutine.wrap, by way of resume above. */
static int wrapped(lua_State *L) {
    lua_State *co = lua_tothread(L, lua_upvalueindex(1));
    const int results = go_on(L, co, lua_gettop(L));
    if (results >= 0) return results;
    dml_interrupted();
    return raise_again(L, co);
}

static int wrap(lua_State *L) {
    luaL_checktype(L, 1, LUA_TFUNCTION);
    lua_State *co = lua_newthread(L);
    lua_pushvalue(L, 1);
    lua_xmove(L, co, 1);
    lua_pushcclosure(L, wrapped, 1);
    return 1;
}

/* In the place of the library's two functions; all else of it stays. */
void dml_open_coroutines(lua_State *L) {
    static const luaL_Reg functions[] = {{"resume", resume}, {"wrap", wrap}, {NULL, NULL}};
    if (lua_getglobal(L, "coroutine") == LUA_TTABLE) luaL_setfuncs(L, functions, 0);
    lua_pop(L, 1);
}
