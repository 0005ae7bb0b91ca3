/* system_dual.c - dm.system{Q =, H =}: where H is quadratic in p, with a regular mass, the system
 * is that of its Lagrangian (lua/dm/base/hamiltonian.lua). */
#include "bind/model/system_dual.h"

#include "bind/model/bind_system.h"

/* beside an H that has no Lagrangian nothing else is known */
static void check_alone(lua_State *L) {
    static const char *const beside[] = {"constraint", "rolling",     "control", "force",
                                         "reaction",   "derivatives", NULL};
    for (const char *const *key = beside; *key; key++, lua_pop(L, 1))
        if (lua_getfield(L, 1, *key) != LUA_TNIL)
            luaL_error(L,
                       "field '%s'%s needs a Lagrangian, and this H has none with a formula: "
                       "d2H/dp2 is singular, or H is not quadratic in p",
                       *key, key == beside ? " (also |q| = 1 of a space S(n))" : "");
}

static void check_given(lua_State *L) {
    if (lua_type(L, -1) != LUA_TFUNCTION)
        luaL_error(L, "field 'H' must be a function of (q, p) or (q, p, t) (got %s)",
                   luaL_typename(L, -1));
    if (lua_getfield(L, 1, "L") != LUA_TNIL)
        luaL_error(L, "give the Lagrangian L or the Hamiltonian H, not both");
    lua_pop(L, 1);
}

/* H stays as the field that was given. */
int dml_add_lagrangian(lua_State *L, uint32_t n) {
    const int top = lua_gettop(L);
    if (lua_getfield(L, 1, "H") == LUA_TNIL) return lua_pop(L, 1), 0;
    check_given(L);
    lua_getglobal(L, "require");
    lua_pushliteral(L, "dm.base.hamiltonian");
    lua_call(L, 1, 1);
    lua_getfield(L, -1, "lagrangian");
    lua_pushvalue(L, -3);
    lua_pushinteger(L, n);
    lua_getfield(L, 1, "params");
    luaL_where(L, 1);
    lua_call(L, 4, 1);
    const int none = lua_isnil(L, -1);
    if (none) {
        check_alone(L);
    } else {
        dml_pushcopy(L, 1);
        lua_pushvalue(L, -2);
        lua_setfield(L, -2, "L");
        lua_replace(L, 1);
    }
    lua_settop(L, top);
    return none;
}

void dml_need_lagrangian(lua_State *L, const char *what) {
    const dml_system *s = luaL_checkudata(L, 1, DML_SYSTEM);
    if (s->hamiltonian)
        luaL_error(L,
                   "%s: this H has no Lagrangian with a formula (d2H/dp2 is singular, or H is not "
                   "quadratic in p)",
                   what);
}
