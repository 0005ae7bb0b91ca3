#include "bind/state.h"

#include <string.h>

/* addresses are registry keys: of the state, and of the metatable of each class */
static const char state_key;
static const char class_key[DML_CLASSES];

dml_state *dml_getstate(lua_State *L) {
    lua_rawgetp(L, LUA_REGISTRYINDEX, &state_key);
    dml_state *s = lua_touserdata(L, -1);
    lua_pop(L, 1);
    if (s) return s;
    s = lua_newuserdatauv(L, sizeof *s, 0);
    memset(s, 0, sizeof *s);
    lua_rawsetp(L, LUA_REGISTRYINDEX, &state_key);
    return s;
}

void dml_setclass(lua_State *L, int class, const char *tname) {
    luaL_getmetatable(L, tname);
    dml_getstate(L)->metatable[class] = lua_topointer(L, -1);
    lua_rawsetp(L, LUA_REGISTRYINDEX, class_key + class);
}

int dml_classof(lua_State *L, int arg) {
    if (lua_type(L, arg) != LUA_TUSERDATA || !lua_getmetatable(L, arg))
        return DML_NO_CLASS;
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
    dml_frame *frame = dml_getstate(L)->frames;
    while (frame && frame->serial != serial) frame = frame->next;
    return frame;
}

void dml_checkgraph(lua_State *L, const dml_frame *frame) {
    if (dm_graph_status(frame->graph) == DM_NO_MEMORY) luaL_error(L, "not enough memory");
}
