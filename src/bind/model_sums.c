#include "bind/model_sums.h"

#include "bind/state.h"
#include "expr/sum.h"
#include "mech/loops.h"

/* __close and __gc: sums are loops again */
static int end_given(lua_State *L) {
    dml_state *state = dml_getstate(L);
    if (state->given == lua_touserdata(L, 1)) state->given = NULL;
    return 0;
}

static void push_given(lua_State *L, const dml_model *m) {
    dml_given *given = lua_newuserdatauv(L, sizeof *given, 0);
    *given = (dml_given){.graph = m->graph};
    if (luaL_newmetatable(L, "dm.given")) {
        lua_pushcfunction(L, end_given);
        lua_setfield(L, -2, "__gc");
        lua_pushcfunction(L, end_given);
        lua_setfield(L, -2, "__close");
    }
    lua_setmetatable(L, -2);
    lua_toclose(L, -1);
    dml_getstate(L)->given = given;
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
