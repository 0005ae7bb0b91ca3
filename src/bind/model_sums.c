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
