#include "bind/trace/apart.h"

/* What it returns must be given back by dml_endapart, or by the close of dml_pushapart. */
dml_apart dml_setapart(dml_state *state) {
    dml_given *given = state->given;
    dml_frame *frame = state->frames;
    const dml_apart apart = {given, given ? given->values : NULL, frame, frame ? frame->sums : 0};
    if (given) given->values = NULL;
    return apart;
}

/* Nothing where nothing was under way. */
void dml_endapart(const dml_apart *a) {
    if (a->given) a->given->values = a->values;
    if (a->frame) a->frame->sums = a->sums;
}

/* __close: not __gc, when what it points to may be gone */
static int end_apart(lua_State *L) {
    dml_apart *a = lua_touserdata(L, 1);
    dml_endapart(a);
    *a = (dml_apart){0};
    return 0;
}

/* A value to be closed is left on the stack. */
void dml_pushapart(lua_State *L) {
    dml_state *state = dml_getstate(L);
    if (!state->given && !state->frames) return;
    dml_apart *a = lua_newuserdatauv(L, sizeof *a, 0);
    *a = dml_setapart(state);
    if (luaL_newmetatable(L, "dm.apart")) {
        lua_pushcfunction(L, end_apart);
        lua_setfield(L, -2, "__close");
    }
    lua_setmetatable(L, -2);
    lua_toclose(L, -1);
}
