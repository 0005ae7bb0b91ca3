#include "bind/model_sums.h"

#include "bind/state.h"
#include "expr/sum.h"
#include "mech/loops.h"

/* __close and __gc: sums are loops again, or what they were before */
static int end_given(lua_State *L) {
    const dml_given *given = lua_touserdata(L, 1);
    dml_given **link = &dml_getstate(L)->given;
    while (*link && *link != given) link = &(*link)->before;
    if (*link) *link = given->before;
    return 0;
}

static void push_given(lua_State *L, const dml_model *m) {
    dml_state *state = dml_getstate(L);
    dml_given *given = lua_newuserdatauv(L, sizeof *given, 0);
    *given =
        (dml_given){.graph = m->graph, .within = state->frames, .before = state->given};
    if (luaL_newmetatable(L, "dm.given")) {
        lua_pushcfunction(L, end_given);
        lua_setfield(L, -2, "__gc");
        lua_pushcfunction(L, end_given);
        lua_setfield(L, -2, "__close");
    }
    lua_setmetatable(L, -2);
    lua_toclose(L, -1);
    state->given = given;
}

const double *dml_givesums(lua_State *L, const dml_model *m, const dm_kernel **kernel,
                           const double *x) {
    double value;
    const double *with;
    if (!(m->model.structure & DM_LOOPS) || !dm_sums(m->graph)) return x;
    if (x) dm_kernel_eval(*kernel, x, &value);
    *kernel = dm_loops_outer(*kernel, &with);
    push_given(L, m);
    return x ? with : NULL;
}

dml_apart dml_setapart(dml_state *state) {
    dml_given *given = state->given;
    dml_frame *frame = state->frames;
    const dml_apart apart = {given, given ? given->values : NULL, frame,
                             frame ? frame->sums : 0};
    if (given) given->values = NULL;
    return apart;
}

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
