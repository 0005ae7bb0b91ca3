/* bind_space.c - `dm.R(n)`, `dm.T(n)`, `dm.SO(n)`: one constructor per row of
 * geom/spaces.def. */
#include "bind/space.h"

#include <string.h>

static const char *const TNAME = "dm.space";
enum { LARGEST = 100000 };

const dml_space *dml_checkspace(lua_State *L, int arg) {
    return luaL_checkudata(L, arg, TNAME);
}

dm_action dml_standard_action(lua_State *L, int arg, int options, uint32_t n) {
    const dml_space *s = dml_checkspace(L, arg);
    uint32_t other;
    uint32_t block = dm_action_block(s->row, s->n, n, &other);
    if (options && !lua_isnoneornil(L, options)) {
        block = (uint32_t)dml_count(L, options, "block", 1, (long)block);
        other = 0;
        if (block > DM_MAX_BLOCK || n % block || !s->row->acts(s->n, block)) block = 0;
    }
    if (!block)
        luaL_error(
            L,
            "%s(%d) has no standard action on %d coordinates: give the generator as a "
            "function of q, for instance function(q) return {-q[2], q[1]} end",
            s->row->name, (int)s->n, (int)n);
    if (other)
        luaL_error(
            L,
            "%s(%d) can act on %d coordinates in blocks of %d or of %d: say which with "
            "{ block = %d }",
            s->row->name, (int)s->n, (int)n, (int)block, (int)other, (int)block);
    return (dm_action){.group = s->row, .k = s->n, .block = block};
}

static int space_new(lua_State *L) {
    const dm_space *row = lua_touserdata(L, lua_upvalueindex(1));
    const lua_Integer n = luaL_checkinteger(L, 1);
    luaL_argcheck(L, n >= (lua_Integer)row->least && n <= LARGEST, 1,
                  lua_pushfstring(L, "%s needs a whole number from %d to %d",
                                  row->signature, (int)row->least, LARGEST));
    dml_space *s = lua_newuserdatauv(L, sizeof *s, 0);
    s->row = row;
    s->n = (uint32_t)n;
    luaL_setmetatable(L, TNAME);
    return 1;
}

static int space_tostring(lua_State *L) {
    const dml_space *s = dml_checkspace(L, 1);
    lua_pushfstring(L, s->row->chart ? "%s^%d" : "%s(%d)", s->row->name, (int)s->n);
    return 1;
}

static int space_eq(lua_State *L) {
    const dml_space *a = luaL_testudata(L, 1, TNAME), *b = luaL_testudata(L, 2, TNAME);
    lua_pushboolean(L, a && b && a->row == b->row && a->n == b->n);
    return 1;
}

static int space_field(lua_State *L) {
    const dml_space *s = dml_checkspace(L, 1);
    const char *key = luaL_checkstring(L, 2);
    if (strcmp(key, "dimension") == 0)
        lua_pushinteger(L, s->row->dimension(s->n));
    else if (strcmp(key, "n") == 0)
        lua_pushinteger(L, s->n);
    else if (strcmp(key, "name") == 0)
        lua_pushstring(L, s->row->name);
    else
        return 0;
    return 1;
}

static const dml_row meta[] = {
    {"__tostring", space_tostring, NULL}, {"__eq", space_eq, NULL}, {NULL, NULL, NULL}};
static const dml_row methods[] = {{NULL, NULL, NULL}};

void dml_open_space(lua_State *L) {
    dml_newclass(L, TNAME,
                 "dm.space: a manifold or group, made by dm.R(n), dm.T(n), dm.SO(n)\n"
                 "fields: name, n, dimension",
                 meta, methods, space_field);
    luaL_getsubtable(L, LUA_REGISTRYINDEX, "dm_docs");
    for (const dm_space *const *row = dm_spaces; *row; row++) {
        lua_pushlightuserdata(L, (void *)(uintptr_t)*row);
        lua_pushcclosure(L, space_new, 1);
        lua_pushvalue(L, -1);
        lua_pushfstring(L, "dm.%s -> dm.space\n%s", (*row)->signature, (*row)->doc);
        lua_rawset(L, -4);
        lua_setfield(L, -3, (*row)->name);
    }
    lua_pop(L, 1);
}
