/* lua_memory.c - arenas whose memory is userdata of Lua: the collector sees their size, and what a
 * finalizer can still reach is still there. The blocks stand on the stack of a thread, the
 * keeper, which lives as long as the arena. What a kernel has outside of Lua (pages of native
 * code, a shared object) stands there too, as a userdata with a finalizer of its own: the large
 * blocks have none and go at once. A finalizer of the script may run after it; it finds the
 * arena lost (dml_arenalost), and its kernels are made again. */
#include "bind/core/state.h"

typedef struct outside {
    dm_giveback *give_back; /* NULL: done */
    void *thing;
    size_t size;
    struct outside *next; /* of the same arena */
} outside;

typedef struct {
    dm_arena arena;
    lua_State *keeper;
    outside *things;
} owned_arena;

static int give_back(lua_State *L) {
    outside *o = lua_touserdata(L, 1);
    if (o->give_back) o->give_back(o->thing, o->size);
    o->give_back = NULL;
    return 0;
}

/* protected: an empty thing */
static int make_outside(lua_State *L) {
    outside *o = lua_newuserdatauv(L, sizeof *o, 0);
    *o = (outside){.give_back = NULL};
    if (luaL_newmetatable(L, "dm.outside")) {
        lua_pushcfunction(L, give_back);
        lua_setfield(L, -2, "__gc");
    }
    lua_setmetatable(L, -2);
    return 1;
}

/* protected: a userdata of the size that the argument points to */
static int make_block(lua_State *L) {
    lua_newuserdatauv(L, *(const size_t *)lua_touserdata(L, 1), 0);
    return 1;
}

/* LUA_GCRESTART alone forgets how much had been allocated: in the generational mode a collection of
 * what is young, which goes through all stacks, would begin with every block. A negative step gives
 * room again, for a fifth of the least memory seen since it last shrank, or DML_ROOM where
 * that is more, less what came since. */
static void restart(lua_State *L) {
    dml_state *state = dml_getstate(L);
    const int now = lua_gc(L, LUA_GCCOUNT); /* KB */
    if (now < state->memory_seen || !state->memory_least) state->memory_least = now;
    state->memory_seen = now;
    lua_gc(L, LUA_GCRESTART);
    const int fifth = state->memory_least / 5;
    const int room = (fifth > DML_ROOM ? fifth : DML_ROOM) - (now - state->memory_least);
    if (room > 0) lua_gc(L, LUA_GCSTEP, -room);
}

/* The userdata that `make` makes, on the keeper's stack. The collector rests meanwhile: a
 * finalizer must not find a graph that is half made. */
static void *hold(lua_State *keeper, lua_CFunction make, size_t size) {
    if (!lua_checkstack(keeper, 3)) return NULL;
    const int running = lua_gc(keeper, LUA_GCISRUNNING) > 0;
    if (running) lua_gc(keeper, LUA_GCSTOP);
    lua_pushcfunction(keeper, make);
    lua_pushlightuserdata(keeper, &size);
    const int status = lua_pcall(keeper, 1, 1, 0);
    if (running) restart(keeper);
    if (status == LUA_OK) return lua_touserdata(keeper, -1);
    lua_pop(keeper, 1);
    return NULL;
}

/* leave the block to the collector: what is scratch is among the newest */
static void let_go(lua_State *keeper, const void *block) {
    for (int i = lua_gettop(keeper); i > 1; i--)
        if (lua_touserdata(keeper, i) == block) {
            lua_remove(keeper, i);
            return;
        }
}

/* Blocks are never resized. Those that are not given back live as long as the arena. */
static void *allocate(void *ud, void *block, size_t old_size, size_t new_size) {
    lua_State *keeper = ((owned_arena *)ud)->keeper;
    (void)old_size;
    if (!block) return new_size ? hold(keeper, make_block, new_size) : NULL;
    if (!new_size) let_go(keeper, block);
    return NULL;
}

static int keep(void *ud, dm_giveback *how, void *thing, size_t size) {
    owned_arena *a = ud;
    outside *o = hold(a->keeper, make_outside, 0);
    if (!o) return 0;
    *o = (outside){.give_back = how, .thing = thing, .size = size, .next = a->things};
    a->things = o;
    return 1;
}

/* protected: a thread */
static int make_stack(lua_State *L) {
    lua_sethook(lua_newthread(L), NULL, 0, 0);
    return 1;
}

lua_State *dml_arenastack(const dm_arena *arena) {
    const owned_arena *a = arena->ud;
    if (arena->allocate != allocate) return NULL;
    const int before = lua_gettop(a->keeper);
    hold(a->keeper, make_stack, 0);
    return lua_gettop(a->keeper) > before ? lua_tothread(a->keeper, -1) : NULL;
}

int dml_arenalost(const dm_arena *arena) {
    const owned_arena *a = arena->ud;
    if (arena->allocate != allocate) return 0;
    for (const outside *o = a->things; o; o = o->next)
        if (!o->give_back) return 1;
    return 0;
}

/* its address is the registry key of an arena that was given back */
static const char spare_key;
enum { LARGEST_SPARE = 1 << 20 }; /* bytes */

void dml_sparearena(lua_State *L, int arg) {
    owned_arena *a = lua_touserdata(L, arg);
    arg = lua_absindex(L, arg);
    if (a->things || a->arena.scratch || !a->arena.chunks) return;
    dm_arena_reset(&a->arena); /* the newest block stays */
    if (a->arena.room > LARGEST_SPARE) return;
    lua_pushvalue(L, arg);
    lua_rawsetp(L, LUA_REGISTRYINDEX, &spare_key);
    dml_getstate(L)->spare = 1;
}

/* the arena that was given back, if there is one */
static owned_arena *push_spare(lua_State *L) {
    dml_state *state = dml_getstate(L);
    if (!state->spare) return NULL;
    state->spare = 0;
    lua_rawgetp(L, LUA_REGISTRYINDEX, &spare_key);
    lua_pushnil(L);
    lua_rawsetp(L, LUA_REGISTRYINDEX, &spare_key);
    return lua_touserdata(L, -1);
}

dm_arena *dml_pusharena(lua_State *L) {
    luaL_checkstack(L, 4, NULL);
    owned_arena *spare = push_spare(L);
    if (spare) return &spare->arena;
    owned_arena *a = lua_newuserdatauv(L, sizeof *a, 1);
    a->keeper = lua_newthread(L);
    lua_sethook(a->keeper, NULL, 0, 0); /* hooks of the script see no allocation */
    lua_pushvalue(L, -2);
    lua_xmove(L, a->keeper, 1); /* who holds the keeper holds the arena */
    lua_setiuservalue(L, -2, 1);
    dm_arena_init(&a->arena, allocate, a);
    a->arena.keep = keep;
    a->things = NULL;
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
