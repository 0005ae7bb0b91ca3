#include "bind/rule/curve_recipes.h"

#include "code/tape/tape.h"
#include "integ/curve/curve_choice.h"

#include <string.h>

/* directions of every call; is each told its time? */
static void read_kinds(lua_State *L, const dml_curve_asked *asked, dm_curve_recipe *out) {
    int *directions = dm_arena_take(asked->arena, ((size_t)asked->calls + 1) * sizeof *directions);
    if (!directions) luaL_error(L, "the method: %s", dm_status_text(DM_NO_MEMORY));
    out->timed = 1;
    for (int i = 0; i < asked->calls; i++) {
        lua_rawgeti(L, asked->kinds, i + 1);
        const int kind = (int)lua_tointeger(L, -1);
        lua_pop(L, 1);
        directions[i] = kind / 2;
        out->timed = out->timed && kind % 2;
    }
    out->directions = directions;
}

/* The method of the table at `own`, traced; arena and graph live as long as what is left on the
 * stack. */
static dm_curve_recipe *push_recipe(lua_State *L, int own, uint32_t n) {
    static uint32_t last;
    const uint32_t serial = ++last;
    dm_curve_recipe *out = lua_newuserdatauv(L, sizeof *out, 1);
    const int at = lua_gettop(L);
    dml_curve_asked asked;
    lua_getfield(L, own, "method");
    dml_curve_ask(L, lua_gettop(L), n, &asked);
    *out = (dm_curve_recipe){.n = n,
                             .serial = serial,
                             .calls = asked.calls,
                             .graph = asked.traced.graph,
                             .out = asked.traced.out};
    read_kinds(L, &asked, out);
    lua_pushvalue(L, asked.arena_at);
    lua_setiuservalue(L, at, 1);
    lua_settop(L, at);
    return out;
}

/* ---- substeps ---- */

/* The function that chooses substeps, traced: (x, h, t) -> weights, or how many. */
static dm_curve_choice *push_choice(lua_State *L, int own, uint32_t n) {
    static uint32_t last;
    const dml_signature signature = {.what = "the function 'substeps'",
                                     .arguments = 3,
                                     .length = {2 * (int)n, DML_SCALAR_ARGUMENT,
                                                DML_SCALAR_ARGUMENT}};
    dm_curve_choice *out = lua_newuserdatauv(L, sizeof *out, 1);
    const int at = lua_gettop(L);
    dml_traced traced;
    lua_getfield(L, own, "substeps");
    dm_arena *arena = dml_pusharena(L);
    dml_trace(L, at + 1, &signature, arena, &traced);
    *out = (dm_curve_choice){.n = n,
                             .serial = ++last,
                             .bare = traced.bare,
                             .outputs = (int)traced.outputs,
                             .graph = traced.graph,
                             .out = traced.out};
    dm_kernel kernel; /* for the check alone: threads share what the rule has */
    const dm_status status =
        dm_tape_build(&kernel, traced.graph, traced.out, traced.outputs, arena);
    if (status != DM_OK) luaL_error(L, "the function 'substeps': %s", dm_status_text(status));
    dml_trace_check(L, at + 1, &signature, &kernel, NULL);
    lua_setiuservalue(L, at, 1);
    lua_settop(L, at);
    return out;
}

/* ---- both ---- */

/* Push a copy for n coordinates; its user value keeps what it points to. */
static void push_copy(lua_State *L, const dm_curve *curve, int own, uint32_t n) {
    dm_curve *copy = lua_newuserdatauv(L, sizeof *copy, 1);
    *copy = *curve;
    lua_createtable(L, 2, 0);
    const int kept = lua_gettop(L);
    lua_getfield(L, own, "method");
    if (!lua_isnil(L, -1)) {
        copy->recipe = push_recipe(L, own, n);
        lua_rawseti(L, kept, 1);
    }
    lua_settop(L, kept);
    lua_getfield(L, own, "substeps");
    if (!lua_isnil(L, -1)) {
        dm_curve_choice *choice = push_choice(L, own, n);
        if (!choice->bare && curve->substeps && choice->outputs != curve->substeps)
            luaL_error(L, "the function 'substeps' gives %d weights here, and %d elsewhere",
                       choice->outputs, curve->substeps);
        copy->choice = choice;
        lua_rawseti(L, kept, 2);
    }
    lua_settop(L, kept);
    lua_setiuservalue(L, -2, 1);
}

/* Order, bias and the number of substeps may have been found since the copy was made. */
const dm_curve *dml_curve_for(lua_State *L, int at, uint32_t n) {
    const int top = lua_gettop(L);
    const dm_curve *curve = lua_touserdata(L, at);
    lua_getiuservalue(L, at, 1);
    const int own = lua_gettop(L);
    if (lua_rawgeti(L, own, n) == LUA_TNIL) {
        push_copy(L, curve, own, n);
        lua_pushvalue(L, -1);
        lua_rawseti(L, own, n);
    }
    dm_curve *out = lua_touserdata(L, -1);
    const struct dm_curve_recipe *recipe = out->recipe;
    const struct dm_curve_choice *choice = out->choice;
    *out = *curve;
    out->recipe = recipe;
    out->choice = choice;
    lua_settop(L, top);
    return out;
}
