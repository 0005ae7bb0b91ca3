#include "bind/core/scope.h"

#include <string.h>

/* What is dead is the newest: what enters a scope leaves the dead first. */
static void leave_newest(dml_state *state) {
    dml_scope *scope = state->scopes;
    state->scopes = scope->before;
    scope->entered = 0;
    scope->leave(state, scope);
}

void dml_leavedead(dml_state *state) {
    const dml_scope *s;
    while ((s = state->scopes) && s->thread && lua_status(s->thread) > LUA_YIELD)
        leave_newest(state);
}

void dml_enter(dml_state *state, dml_scope *scope, lua_State *thread,
               void (*leave)(dml_state *, dml_scope *)) {
    dml_leavedead(state);
    *scope = (dml_scope){.thread = thread, .leave = leave, .before = state->scopes, .entered = 1};
    state->scopes = scope;
}

void dml_leave(dml_state *state, dml_scope *scope) {
    while (scope->entered) leave_newest(state);
}

/* __close, and __gc for a coroutine that is collected before anything was looked at */
static int end_scope(lua_State *L) {
    dml_leave(dml_getstate(L), lua_touserdata(L, 1));
    return 0;
}

/* The thread stays as long as the scope, which may outlive it by a round of the collector. */
void *dml_pushscope(lua_State *L, size_t size, int uservalues,
                    void (*leave)(dml_state *, dml_scope *)) {
    void *scope = lua_newuserdatauv(L, size, uservalues + 1);
    memset(scope, 0, size);
    lua_pushthread(L);
    lua_setiuservalue(L, -2, 1);
    if (luaL_newmetatable(L, "dm.scope")) {
        lua_pushcfunction(L, end_scope);
        lua_setfield(L, -2, "__gc");
        lua_pushcfunction(L, end_scope);
        lua_setfield(L, -2, "__close");
    }
    lua_setmetatable(L, -2);
    lua_toclose(L, -1);
    dml_enter(dml_getstate(L), scope, L, leave);
    return scope;
}
