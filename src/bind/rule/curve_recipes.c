#include "bind/rule/curve_recipes.h"

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
        out->timed = out->timed && kind == 1;
    }
    out->directions = directions;
}

/* The method of the table at `own`, traced; arena and graph live as long as what is left on the
 * stack. */
static dm_curve_recipe *push_recipe(lua_State *L, int own, uint32_t n) {
    static uint32_t serial;
    dm_curve_recipe *out = lua_newuserdatauv(L, sizeof *out, 1);
    const int at = lua_gettop(L);
    dml_curve_asked asked;
    lua_getfield(L, own, "method");
    dml_curve_ask(L, lua_gettop(L), n, &asked);
    *out = (dm_curve_recipe){.n = n,
                             .serial = ++serial,
                             .calls = asked.calls,
                             .graph = asked.traced.graph,
                             .out = asked.traced.out};
    read_kinds(L, &asked, out);
    lua_pushvalue(L, asked.arena_at);
    lua_setiuservalue(L, at, 1);
    lua_settop(L, at);
    return out;
}

/* A copy of the curve with its recipe, kept under n. */
const dm_curve *dml_curve_recipe(lua_State *L, int at, uint32_t n) {
    const int top = lua_gettop(L);
    const dm_curve *curve = lua_touserdata(L, at);
    lua_getiuservalue(L, at, 1);
    const int own = lua_gettop(L);
    if (lua_rawgeti(L, own, n) == LUA_TNIL) {
        dm_curve *copy = lua_newuserdatauv(L, sizeof *copy, 1);
        copy->recipe = push_recipe(L, own, n);
        lua_setiuservalue(L, -2, 1);
        lua_pushvalue(L, -1);
        lua_rawseti(L, own, n);
    }
    dm_curve *out = lua_touserdata(L, -1);
    const dm_curve_recipe *recipe = out->recipe;
    *out = *curve; /* order and bias may have been found since */
    out->recipe = recipe;
    lua_settop(L, top);
    return out;
}
