/* ensemble_summary.c - `ensemble:summary(name)`: what the rows of members say of a watched
 * column. */
#include "bind/ensemble/bind_ensemble.h"
#include "run/summary.h"

#include <stddef.h>
#include <string.h>

static const struct {
    const char *name;
    size_t offset;
} fields[] = {{"first", offsetof(dm_summary, first)}, {"last", offsetof(dm_summary, last)},
              {"least", offsetof(dm_summary, least)}, {"largest", offsetof(dm_summary, largest)},
              {"mean", offsetof(dm_summary, mean)},   {"slope", offsetof(dm_summary, slope)},
              {"error", offsetof(dm_summary, error)}, {"early", offsetof(dm_summary, early)},
              {"late", offsetof(dm_summary, late)},   {"nearest", offsetof(dm_summary, nearest)},
              {"span", offsetof(dm_summary, span)},   {"megno", offsetof(dm_summary, megno)}};
enum { FIELDS = sizeof fields / sizeof *fields };

/* place of a watched column in a row */
static uint32_t find_column(lua_State *L, const char *name) {
    if (lua_getiuservalue(L, 1, DML_ENSEMBLE_COLUMNS) != LUA_TTABLE)
        luaL_error(L, "this ensemble watched nothing: ask for rows with watch = { ... }");
    const lua_Integer count = luaL_len(L, -1);
    for (lua_Integer k = 1; k <= count; k++) {
        lua_rawgeti(L, -1, k);
        const int found = strcmp(lua_tostring(L, -1), name) == 0;
        lua_pop(L, 1);
        if (found) return lua_pop(L, 1), (uint32_t)k - 1;
    }
    return (uint32_t)luaL_error(L, "no column '%s' was watched", name);
}

static void summarize(dm_summary *out, const dml_ensemble *e, long i, uint32_t column, double *y) {
    const dm_ensemble_rows *rows = &e->rows;
    const double *data = dm_ensemble_rows_of(rows, i);
    for (long r = 0; r < rows->count[i]; r++) y[r] = data[(size_t)r * rows->width + column];
    dm_summary_make(out, data, rows->width, y, rows->count[i]);
}

int dml_ensemble_summary(lua_State *L) {
    const dml_ensemble *e = luaL_checkudata(L, 1, DML_ENSEMBLE);
    const uint32_t column = find_column(L, luaL_checkstring(L, 2));
    double *y = lua_newuserdatauv(L, ((size_t)e->rows.room + 1) * sizeof *y, 0);
    const int first = lua_gettop(L) + 2;
    luaL_checkstack(L, FIELDS + 4, NULL);
    lua_createtable(L, 0, FIELDS);
    dml_setresult(L);
    for (int k = 0; k < FIELDS; k++) {
        lua_createtable(L, (int)e->members, 0);
        lua_pushvalue(L, -1);
        lua_setfield(L, first - 1, fields[k].name);
    }
    for (long i = 0; i < e->members; i++) {
        dm_summary s;
        summarize(&s, e, i, column, y);
        for (int k = 0; k < FIELDS; k++) {
            lua_pushnumber(L, *(const double *)(const void *)((const char *)&s + fields[k].offset));
            lua_rawseti(L, first + k, i + 1);
        }
    }
    lua_settop(L, first - 1);
    return 1;
}
