/* ensemble_steps.c - `h = ...` of an ensemble: members with steps of their own; how often rows
 * are kept. */
#include "bind/ensemble/bind_ensemble.h"

#include <math.h>

static int has(lua_State *L, const char *key) {
    const int there = lua_getfield(L, 2, key) != LUA_TNIL;
    lua_pop(L, 1);
    return there;
}

long dml_read_every(lua_State *L, long steps) {
    if (!has(L, "rows")) return dml_count(L, 2, "every", 1, 1);
    if (has(L, "every"))
        luaL_error(L, "give either 'every' (steps from row to row) or 'rows' (how many), not both");
    const long rows = dml_count(L, 2, "rows", 1, 1);
    return steps > rows ? (steps - 1) / rows + 1 : 1;
}

static double read_step(lua_State *L, long i) {
    dml_push_source(L, 2, "h", i);
    const double h = lua_type(L, -1) == LUA_TNUMBER ? lua_tonumber(L, -1) : NAN;
    if (!(h > 0.0) || isinf(h))
        luaL_error(L, "field 'h': the step of member %d must be a number > 0 (got %s)", (int)i + 1,
                   luaL_tolstring(L, -1, NULL));
    lua_pop(L, 1);
    return h;
}

const dm_pace *dml_read_steps(lua_State *L, const dml_solver *solver, long members, long *most) {
    if (!has(L, "h")) return lua_pushnil(L), NULL;
    if (solver->pair) luaL_error(L, "field 'h': a discrete Lagrangian has a step of its own");
    if (has(L, "t") && has(L, "steps"))
        luaL_error(L, "give either 'steps' or 't' (a duration), not both");
    const double t = has(L, "t") ? dml_positive(L, 2, "t", 0) : 0.0;
    const long steps = has(L, "t") ? 0 : dml_count(L, 2, "steps", 0, -1);
    dml_check_source(L, 2, "h", members);
    dm_pace *pace = lua_newuserdatauv(L, (size_t)members * sizeof *pace, 0);
    *most = 0;
    for (long i = 0; i < members; i++) {
        const double h = read_step(L, i);
        const long count = t > 0.0 ? dml_stepping_cover(L, solver, t, h) : steps;
        pace[i] = (dm_pace){.h = h, .steps = count, .every = dml_read_every(L, count)};
        if (count > *most) *most = count;
    }
    return pace;
}
