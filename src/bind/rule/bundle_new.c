/* bundle_new.c - from a table of options to a discrete tangent bundle. */
#include "bind/rule/bind_bundle.h"

/* L = v . v / 2, for a bundle of a space alone */
static int free_motion(lua_State *L) {
    lua_settop(L, 2);
    lua_getfield(L, 2, "dot");
    lua_pushvalue(L, 2);
    lua_pushvalue(L, 2);
    lua_call(L, 2, 1);
    lua_pushnumber(L, 0.5);
    lua_arith(L, LUA_OPMUL);
    return 1;
}

/* push the system of the options at 1: the one given, or free motion on Q */
static void push_system(lua_State *L, const dm_curve *c) {
    const int given = lua_getfield(L, 1, "system") != LUA_TNIL;
    const int space = lua_getfield(L, 1, "Q") != LUA_TNIL;
    if (given == space)
        luaL_error(L, "give either 'system' (whose field the segments follow) or 'Q' (straight "
                      "segments of a space)");
    if (given) {
        lua_pop(L, 1);
        const dml_system *s = luaL_testudata(L, -1, DML_SYSTEM);
        if (!s) luaL_error(L, "field 'system' must be a dm.system (got %s)", luaL_typename(L, -1));
        return;
    }
    if (c->s != 1)
        luaL_error(L, "segments of '%s' follow the field of a system: give 'system' instead of 'Q'",
                   c->name);
    lua_remove(L, -2);
    lua_createtable(L, 0, 2);
    lua_insert(L, -2);
    lua_setfield(L, -2, "Q");
    lua_pushcfunction(L, free_motion);
    lua_setfield(L, -2, "L");
    lua_pushcfunction(L, dml_system_new);
    lua_insert(L, -2);
    lua_call(L, 1, 1);
}

/* push the dm.rule of the segments: field `segments`, straight ones unless given */
static const dm_curve *push_segments(lua_State *L) {
    lua_getfield(L, 1, "segments");
    if (lua_isnil(L, -1)) lua_pop(L, 1), lua_pushliteral(L, "straight");
    const dm_curve *c = dml_tocurve(L, -1);
    const int biased = lua_getfield(L, 1, "bias") != LUA_TNIL;
    if (c && biased)
        luaL_error(L, "field 'bias': the segments are a dm.curve, which has a bias of its own");
    if (c) return lua_pop(L, 1), c;
    if (lua_type(L, -2) != LUA_TSTRING)
        luaL_error(L,
                   "field 'segments' must be \"straight\", the name of a one-step method or a "
                   "dm.curve (got %s)",
                   luaL_typename(L, -2));
    lua_newtable(L);
    lua_insert(L, -2);
    lua_setfield(L, -2, "bias");
    lua_pushcfunction(L, dml_curve_new);
    lua_insert(L, -3);
    lua_call(L, 2, 1);
    return dml_tocurve(L, -1);
}

/* Segments and system become user values; kernels are made when the bundle is asked for
 * something. */
int dml_bundle_new(lua_State *L) {
    static const char *const known[] = {"system", "Q", "h", "segments", "bias", NULL};
    lua_settop(L, 1);
    luaL_checktype(L, 1, LUA_TTABLE);
    dml_options(L, 1, known);
    const double h = dml_positive(L, 1, "h", 0);
    const dm_curve *c = push_segments(L);
    push_system(L, c);
    const dml_system *s = dml_checksystem(L, 3);
    c = dml_ruledata(L, 2, s->n);
    dml_bundle *b = lua_newuserdatauv(L, sizeof *b, 2);
    *b = (dml_bundle){.n = s->n, .h = h, .curve = c};
    lua_insert(L, 2);
    lua_setiuservalue(L, 2, DML_BUNDLE_SYSTEM);
    lua_setiuservalue(L, 2, DML_BUNDLE_SEGMENTS);
    luaL_setmetatable(L, DML_BUNDLE);
    return 1;
}
