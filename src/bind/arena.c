/*
** arena.c - arenas whose memory is userdata of Lua: the collector sees their size, and
** what a finalizer can still reach is still there. The blocks stand on the stack of a
** thread, the keeper, which lives as long as the arena.
*/
#include "bind/state.h"

typedef struct {
    dm_arena arena;
    lua_State *keeper;
} owned_arena;

/* protected: a userdata of the size that the argument points to */
static int make_block(lua_State *L) {
    lua_newuserdatauv(L, *(const size_t *)lua_touserdata(L, 1), 0);
    return 1;
}

/* The collector rests meanwhile: a finalizer must not find a graph that is half made.
** Blocks are never resized, and given back all together by the collector. */
static void *allocate(void *ud, void *block, size_t old_size, size_t new_size) {
    lua_State *keeper = ((owned_arena *)ud)->keeper;
    (void)old_size;
    if (block || !new_size || !lua_checkstack(keeper, 3)) return NULL;
    const int running = lua_gc(keeper, LUA_GCISRUNNING) > 0;
    if (running) lua_gc(keeper, LUA_GCSTOP);
    lua_pushcfunction(keeper, make_block);
    lua_pushlightuserdata(keeper, &new_size);
    const int status = lua_pcall(keeper, 1, 1, 0);
    if (running) lua_gc(keeper, LUA_GCRESTART);
    if (status == LUA_OK) return lua_touserdata(keeper, -1);
    lua_pop(keeper, 1);
    return NULL;
}

dm_arena *dml_pusharena(lua_State *L) {
    luaL_checkstack(L, 4, NULL);
    owned_arena *a = lua_newuserdatauv(L, sizeof *a, 1);
    a->keeper = lua_newthread(L);
    lua_sethook(a->keeper, NULL, 0, 0); /* hooks of the script see no allocation */
    lua_pushvalue(L, -2);
    lua_xmove(L, a->keeper, 1); /* who holds the keeper holds the arena */
    lua_setiuservalue(L, -2, 1);
    dm_arena_init(&a->arena, allocate, a);
    return &a->arena;
}

void dml_pushkeeper(lua_State *L, const dm_arena *arena) {
    const owned_arena *a = arena->ud;
    if (arena->allocate != allocate) {
        lua_pushnil(L);
        return;
    }
    lua_pushthread(a->keeper);
    lua_xmove(a->keeper, L, 1);
}
