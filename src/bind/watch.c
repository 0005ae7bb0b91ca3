/* watch.c - `watch = { "q1", "energy", r = function(q, v, t, p) ... end }`: what a run records beside t. */
#include "bind/observables.h"

#include <stdio.h>
#include <string.h>

/* entry of (q, p) that is called `name`, -1: none */
static int find_entry(lua_State *L, const dml_stepping *r, const char *name) {
    const uint32_t n = r->solver->n;
    char kind, rest;
    unsigned i;
    int found = -1;
    for (uint32_t k = 0; k < n && found < 0; k++, lua_pop(L, 1)) {
        const char *coordinate = dml_coordinate(L, r->system, k);
        if (strcmp(coordinate, name) == 0) found = (int)k;
        if (strncmp(name, "p_", 2) == 0 && strcmp(coordinate, name + 2) == 0)
            found = (int)(n + k);
    }
    if (found < 0 && sscanf(name, "%c%u%c", &kind, &i, &rest) == 2 && i >= 1 && i <= n &&
        (kind == 'q' || kind == 'p'))
        found = (int)(kind == 'q' ? i - 1 : n + i - 1);
    return found;
}

static void add_name(lua_State *L, int names, const char *name) {
    for (lua_Integer i = 1; i <= (lua_Integer)lua_rawlen(L, names); i++, lua_pop(L, 1)) {
        lua_rawgeti(L, names, i);
        if (strcmp(lua_tostring(L, -1), name) == 0)
            luaL_error(
                L, "field 'watch': there is a column '%s' already; choose another name",
                name);
    }
    lua_pushstring(L, name);
    lua_rawseti(L, names, (lua_Integer)lua_rawlen(L, names) + 1);
}

/* a name alone: a column, or the energy */
static void add_column(lua_State *L, dml_observables *o, const dml_stepping *r,
                       const char *name) {
    const int entry = find_entry(L, r, name);
    if (strcmp(name, "energy") == 0)
        dml_observables_energy(L, o, r);
    else if (entry >= 0)
        dml_observables_entry(L, o, (uint32_t)entry);
    else
        luaL_error(L,
                   "field 'watch': no column '%s'; watch coordinates (\"%s\"), momenta "
                   "(\"p1\"), \"energy\", or "
                   "name = function(q, v, t, p) ... end",
                   name, dml_coordinate(L, r->system, 0));
}

/* r, or r1, r2, ... where the function gives several numbers */
static void add_names(lua_State *L, int names, const char *name,
                      const dm_kernel *kernel) {
    if (kernel->outputs == 1) {
        add_name(L, names, name);
        return;
    }
    for (uint32_t i = 0; i < kernel->outputs; i++) {
        add_name(L, names, lua_pushfstring(L, "%s%d", name, (int)i + 1));
        lua_pop(L, 1);
    }
}

/* the entry `key` on top of the table at `table` */
static void read_entry(lua_State *L, dml_observables *o, const dml_stepping *r, int table,
                       int names) {
    const int named = lua_type(L, -1) == LUA_TSTRING;
    lua_pushvalue(L, -1);
    lua_gettable(L, table);
    if (!named) {
        if (lua_type(L, -1) != LUA_TSTRING)
            luaL_error(L,
                       "field 'watch': entry %d must be the name of a column (got %s); a "
                       "function needs a "
                       "name: watch = { r = function(q, v, t, p) ... end }",
                       (int)lua_tointeger(L, -2), luaL_typename(L, -1));
        add_column(L, o, r, lua_tostring(L, -1));
        add_name(L, names, lua_tostring(L, -1));
        return;
    }
    const char *name = lua_tostring(L, -2);
    const char *what = lua_pushfstring(L, "watch.%s", name);
    lua_insert(L, -2);
    dml_observables_add(L, o, r, what, 1);
    add_names(L, names, name, o->list[o->observer.count - 1].kernel);
}

void dml_watch_read(lua_State *L, dml_observables *o, const dml_stepping *r) {
    lua_newtable(L);
    const int names = lua_gettop(L);
    add_name(L, names, "t");
    lua_getfield(L, 2, "watch");
    const int table = lua_gettop(L);
    if (!lua_istable(L, table))
        luaL_error(
            L,
            "field 'watch' must be a table of names of columns and of functions: { "
            "\"q1\", \"energy\", r = "
            "function(q, v, t, p) ... end } (got %s)",
            luaL_typename(L, table));
    dml_observables_start(o, r);
    dml_pushkeys(L, table, "watch");
    const int keys = lua_gettop(L);
    const lua_Integer count = (lua_Integer)lua_rawlen(L, keys);
    if (!count) luaL_error(L, "field 'watch' is empty: leave it out, or name a column");
    for (lua_Integer i = 1; i <= count; i++) {
        luaL_checkstack(L, 12, NULL);
        lua_rawgeti(L, keys, i);
        read_entry(L, o, r, table, names);
    }
    dml_observables_end(L, o);
}
