#include "bind/core/state.h"
#include "bind/core/scope.h"

#include <stdatomic.h>
#include <string.h>

/* addresses are registry keys: of the state, and of the metatable of each class */
static const char state_key;
static const char class_key[DML_CLASSES];

/* The state that this thread used last, by the registry of its Lua, since every operation on a
 * symbol asks for it. A registry may come to lie where one lay that is gone: what was seen
 * before any Lua closed is not believed. */
static _Thread_local struct {
    const void *registry;
    dml_state *state;
    unsigned closed;
} seen;
static atomic_uint closed; /* Lua states so far */

static int close_state(lua_State *L) {
    dml_state *s = lua_touserdata(L, 1);
    s->closing = 1; /* finalizers that come later may still ask for it */
    atomic_fetch_add(&closed, 1);
    return 0;
}

static dml_state *new_state(lua_State *L) {
    dml_state *s = lua_newuserdatauv(L, sizeof *s, 0);
    memset(s, 0, sizeof *s);
    lua_createtable(L, 0, 1);
    lua_pushcfunction(L, close_state);
    lua_setfield(L, -2, "__gc");
    lua_setmetatable(L, -2);
    lua_rawsetp(L, LUA_REGISTRYINDEX, &state_key);
    return s;
}

static dml_state *find_state(lua_State *L, const void *registry) {
    lua_rawgetp(L, LUA_REGISTRYINDEX, &state_key);
    dml_state *s = lua_touserdata(L, -1);
    lua_pop(L, 1);
    if (!s) s = new_state(L);
    if (s->closing) return s;
    seen.registry = registry;
    seen.state = s;
    seen.closed = atomic_load(&closed);
    return s;
}

dml_state *dml_getstate(lua_State *L) {
    const void *registry = lua_topointer(L, LUA_REGISTRYINDEX);
    if (seen.registry == registry &&
        seen.closed == atomic_load_explicit(&closed, memory_order_relaxed))
        return seen.state;
    return find_state(L, registry);
}

void dml_setclass(lua_State *L, int class, const char *tname) {
    luaL_getmetatable(L, tname);
    dml_getstate(L)->metatable[class] = lua_topointer(L, -1);
    lua_rawsetp(L, LUA_REGISTRYINDEX, class_key + class);
}

int dml_classof(lua_State *L, int arg) {
    if (lua_type(L, arg) != LUA_TUSERDATA || !lua_getmetatable(L, arg)) return DML_NO_CLASS;
    const void *metatable = lua_topointer(L, -1);
    lua_pop(L, 1);
    const dml_state *s = dml_getstate(L);
    int class = 0;
    while (class < DML_CLASSES && s->metatable[class] != metatable) class ++;
    return class;
}

void *dml_newvalue(lua_State *L, int class, size_t size, int uservalues) {
    void *value = lua_newuserdatauv(L, size, uservalues);
    memset(value, 0, size);
    lua_rawgetp(L, LUA_REGISTRYINDEX, class_key + class);
    lua_setmetatable(L, -2);
    return value;
}

dml_frame *dml_findframe(lua_State *L, uint32_t serial) {
    dml_state *state = dml_getstate(L);
    dml_leavedead(state);
    dml_frame *frame = state->frames;
    while (frame && frame->serial != serial) frame = frame->next;
    return frame;
}

int dml_refusesymbol(lua_State *L, const char *how, uint32_t serial) {
    const dml_frame *frame = dml_findframe(L, serial);
    return luaL_error(L,
                      "%s met a symbol while %s is traced, when its arguments have no values: use "
                      "dm.where(c, a, b) (a where c > 0, else b), dm.abs, dm.max or dm.min%s",
                      how, frame ? frame->what : "a function",
                      frame && frame->may_branch ? ", or derivatives = \"hyperdual\"" : "");
}

void dml_checkgraph(lua_State *L, const dml_frame *frame) {
    if (dm_graph_status(frame->graph) == DM_NO_MEMORY) luaL_error(L, "not enough memory");
}
