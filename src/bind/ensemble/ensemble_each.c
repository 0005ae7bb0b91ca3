/* ensemble_each.c - what is done to the start of every member: all that cannot start are told
 * together, the first one with its reason. */
#include "bind/ensemble/bind_ensemble.h"

enum { TOLD = 8 }; /* members by number */

/* all members from s->next on; arguments: the stack of the caller, then s */
static int run_rest(lua_State *L) {
    dml_starting *s = lua_touserdata(L, -1);
    lua_pop(L, 1);
    luaL_checkstack(L, LUA_MINSTACK, NULL);
    for (; s->next < s->these->first + s->these->count; s->next++) s->body(L, s);
    return 0;
}

/* 0: a member has no start, and why is on top. The frame of that call has the same stack, so that
 * indices mean the same. */
static int is_through(lua_State *L, dml_starting *s) {
    const int top = lua_gettop(L);
    luaL_checkstack(L, top + 2, NULL);
    lua_pushcfunction(L, run_rest);
    for (int i = 1; i <= top; i++) lua_pushvalue(L, i);
    lua_pushlightuserdata(L, s);
    return dml_try(L, top + 1, 0);
}

void dml_each_start(lua_State *L, dml_starting *s) {
    const int top = lua_gettop(L), why = top + 1, numbers = top + 2;
    long bad = 0;
    s->next = s->these->first;
    for (; !is_through(L, s); s->next++) {
        if (s->theirs || lua_type(L, -1) != LUA_TSTRING) lua_error(L);
        if (++bad > 1) lua_pop(L, 1);
        if (bad == 1) lua_pushliteral(L, "");
        if (bad > TOLD) continue;
        lua_pushfstring(L, "%s%s%d", lua_tostring(L, numbers), bad == 1 ? "" : ", ",
                        (int)s->next + 1);
        lua_replace(L, numbers);
    }
    if (bad == 1) lua_settop(L, why), lua_error(L);
    if (bad)
        luaL_error(L, "%s (%d of %d members have no start: %s%s)", lua_tostring(L, why), (int)bad,
                   (int)s->these->count, lua_tostring(L, numbers), bad > TOLD ? ", ..." : "");
}
