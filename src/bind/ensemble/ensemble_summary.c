/* ensemble_summary.c - what the rows of members say of watched columns: `ensemble:summary`, and
 * beside a resolved flow `ensemble:departure` and `ensemble:range`. */
#include "bind/ensemble/bind_ensemble.h"
#include "bind/run/bind_path.h"
#include "run/departure.h"
#include "run/summary.h"

#include <math.h>
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

/* names of the columns of rows, the time first */
static void push_columns(lua_State *L, int arg) {
    const dml_ensemble *e = luaL_checkudata(L, arg, DML_ENSEMBLE);
    if (lua_getiuservalue(L, arg, DML_ENSEMBLE_COLUMNS) == LUA_TTABLE) return;
    if (!e->rows.room)
        luaL_error(L, "this ensemble kept only the ends: ask for rows with every = or watch = { "
                      "\"energy\" }, or another column of a path");
    lua_getiuservalue(L, arg, DML_ENSEMBLE_SOLVER);
    lua_getiuservalue(L, -1, DML_SOLVER_SYSTEM);
    dml_state_names(L, -1, e->n, e->rows.width - 1 - e->n);
    lua_replace(L, -4);
    lua_pop(L, 2);
}

uint32_t dml_ensemble_column(lua_State *L, int arg, const char *name) {
    push_columns(L, arg);
    const lua_Integer count = luaL_len(L, -1);
    for (lua_Integer k = 1; k <= count; k++) {
        lua_rawgeti(L, -1, k);
        const int found = strcmp(lua_tostring(L, -1), name) == 0;
        lua_pop(L, 1);
        if (found) return lua_pop(L, 1), (uint32_t)k - 1;
    }
    lua_pushliteral(L, "t");
    for (lua_Integer k = 2; k <= count; k++) {
        lua_pushliteral(L, ", ");
        lua_rawgeti(L, -3, k);
        lua_concat(L, 3);
    }
    return (uint32_t)luaL_error(L, "rows have no column '%s', but %s", name, lua_tostring(L, -1));
}

/* how many steps lie between two rows of member i */
static long every_of(const dml_ensemble *e, long i) {
    return e->pace ? e->pace[i].every : e->rows.every;
}

static void summarize(dm_summary *out, const dml_ensemble *e, long i, uint32_t column, double *y) {
    const dm_ensemble_rows *rows = &e->rows;
    const double *data = dm_ensemble_rows_of(rows, i);
    for (long r = 0; r < rows->count[i]; r++) y[r] = data[(size_t)r * rows->width + column];
    dm_summary_make(out, data, rows->width, y, rows->count[i]);
}

static double number_of(const dm_summary *s, int k) {
    return *(const double *)(const void *)((const char *)s + fields[k].offset);
}

/* {least, mean, largest} of a column over the rows of all members; NaN where none has rows */
static void push_extent(lua_State *L, const dml_ensemble *e, uint32_t column, double *y) {
    double least = NAN, largest = NAN, sum = 0.0;
    long rows = 0;
    for (long i = 0; i < e->members; i++) {
        dm_summary s;
        if (!e->rows.count[i]) continue;
        summarize(&s, e, i, column, y);
        least = fmin(least, s.least), largest = fmax(largest, s.largest);
        sum += s.mean * (double)e->rows.count[i], rows += e->rows.count[i];
    }
    lua_createtable(L, 0, 3);
    dml_setresult(L);
    lua_pushnumber(L, least), lua_setfield(L, -2, "least");
    lua_pushnumber(L, largest), lua_setfield(L, -2, "largest");
    lua_pushnumber(L, sum / (double)rows), lua_setfield(L, -2, "mean");
}

/* {name = extent} of all columns but the time */
static int push_all(lua_State *L, const dml_ensemble *e) {
    lua_settop(L, 1);
    double *y = lua_newuserdatauv(L, ((size_t)e->rows.room + 1) * sizeof *y, 0);
    push_columns(L, 1);
    lua_newtable(L);
    dml_setresult(L);
    for (lua_Integer k = 2; lua_rawgeti(L, 3, k) == LUA_TSTRING; k++) {
        push_extent(L, e, (uint32_t)k - 1, y);
        lua_rawset(L, 4);
    }
    lua_settop(L, 4);
    return 1;
}

int dml_ensemble_summary(lua_State *L) {
    const dml_ensemble *e = luaL_checkudata(L, 1, DML_ENSEMBLE);
    if (lua_isnoneornil(L, 2)) return push_all(L, e);
    const uint32_t column = dml_ensemble_column(L, 1, luaL_checkstring(L, 2));
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
            lua_pushnumber(L, number_of(&s, k));
            lua_rawseti(L, first + k, i + 1);
        }
    }
    lua_settop(L, first - 1);
    return 1;
}

/* numbers of the list or number at `arg`, which may be NaN */
static void read_any(lua_State *L, int arg, double *out, long count) {
    for (long i = 0; i < count; i++) {
        const dml_scalar x = dml_entry(L, arg, (uint32_t)i);
        luaL_argcheck(L, x.kind == DML_NUMBER, arg, "plain numbers are needed");
        out[i] = x.as.number;
    }
}

/* core.summary(t, y) */
int dml_core_summary(lua_State *L) {
    const long rows = dml_length(L, 2);
    luaL_argcheck(L, rows > 0 && dml_length(L, 1) == rows, 1,
                  "as many times as numbers, at least 1");
    double *t = lua_newuserdatauv(L, 2 * (size_t)rows * sizeof *t, 0), *y = t + rows;
    read_any(L, 1, t, rows);
    read_any(L, 2, y, rows);
    dm_summary s;
    dm_summary_make(&s, t, 1, y, rows);
    lua_createtable(L, 0, FIELDS);
    dml_setresult(L);
    for (int k = 0; k < FIELDS; k++) {
        lua_pushnumber(L, number_of(&s, k));
        lua_setfield(L, -2, fields[k].name);
    }
    return 1;
}

/* ---- beside a resolved flow ---- */

/* the number of the member behind the ensemble at `arg`, from 0 */
static long member_at(lua_State *L, int arg) {
    const dml_ensemble *e = luaL_checkudata(L, arg, DML_ENSEMBLE);
    const lua_Integer i = dml_checkinteger(L, arg + 1);
    if (i < 1 || i > e->members)
        luaL_error(L, "there are members 1 to %I (got %I)", (LUAI_UACINT)e->members,
                   (LUAI_UACINT)i);
    return (long)i - 1;
}

dm_run_table dml_ensemble_table(lua_State *L, int arg) {
    const long i = member_at(L, arg);
    const dml_ensemble *e = lua_touserdata(L, arg);
    return (dm_run_table){.data = dm_ensemble_rows_of(&e->rows, i),
                          .rows = e->rows.room ? e->rows.count[i] : 0,
                          .width = e->rows.width};
}

static void read_columns(lua_State *L, int arg, int names, uint32_t *out, uint32_t count) {
    for (uint32_t k = 0; k < count; k++) {
        lua_rawgeti(L, names, (lua_Integer)k + 1);
        out[k] = dml_ensemble_column(L, arg, luaL_checkstring(L, -1));
        lua_pop(L, 1);
    }
}

/* bounds[count] of the table at `arg`, or NULL */
static const double *read_bounds(lua_State *L, int arg, double *out, uint32_t count) {
    if (lua_isnoneornil(L, arg)) return NULL;
    luaL_checktype(L, arg, LUA_TTABLE);
    for (uint32_t k = 0; k < count; k++) {
        lua_rawgeti(L, arg, (lua_Integer)k + 1);
        out[k] = dml_checknumber(L, -1);
        lua_pop(L, 1);
    }
    return out;
}

/* (ensemble, member, flow, member, names, until, bounds) */
int dml_ensemble_departure(lua_State *L) {
    lua_settop(L, 7);
    const dm_run_table own = dml_ensemble_table(L, 1), flow = dml_ensemble_table(L, 3);
    luaL_checktype(L, 5, LUA_TTABLE);
    const uint32_t count = (uint32_t)lua_rawlen(L, 5);
    double *work = lua_newuserdatauv(L, (5 * sizeof *work + 2 * sizeof(uint32_t)) * (count + 1), 0);
    uint32_t *columns = (uint32_t *)(void *)(work + 5 * (size_t)count);
    read_columns(L, 1, 5, columns, count);
    read_columns(L, 3, 5, columns + count, count);
    const dm_departure d = {.own = columns,
                            .flow = columns + count,
                            .count = count,
                            .until = dml_optnumber(L, 6, INFINITY),
                            .bound = read_bounds(L, 7, work + 4 * (size_t)count, count),
                            .between = every_of(lua_touserdata(L, 1), member_at(L, 1)) > 1};
    const double beyond = dm_departure_find(work, &d, &own, &flow, work + count);
    lua_createtable(L, (int)count, 0);
    for (uint32_t k = 0; k < count; k++) {
        lua_pushnumber(L, work[k]);
        lua_rawseti(L, -2, (lua_Integer)k + 1);
    }
    lua_pushnumber(L, beyond);
    return 2;
}

/* (ensemble, member, name, until) */
int dml_ensemble_range(lua_State *L) {
    lua_settop(L, 4);
    const dm_run_table rows = dml_ensemble_table(L, 1);
    const uint32_t column = dml_ensemble_column(L, 1, luaL_checkstring(L, 3));
    lua_pushnumber(L, dm_flow_range(&rows, column, dml_optnumber(L, 4, INFINITY)));
    lua_pushnumber(L, rows.rows > 0 ? rows.data[column] : NAN);
    return 2;
}

/* (ensemble, member, names, share) */
int dml_ensemble_stride(lua_State *L) {
    lua_settop(L, 4);
    const dm_run_table rows = dml_ensemble_table(L, 1);
    luaL_checktype(L, 3, LUA_TTABLE);
    const uint32_t count = (uint32_t)lua_rawlen(L, 3);
    double *work = lua_newuserdatauv(L, (5 * sizeof *work + sizeof(uint32_t)) * (count + 1), 0);
    uint32_t *columns = (uint32_t *)(void *)(work + 5 * (size_t)count);
    read_columns(L, 1, 3, columns, count);
    const long most = rows.rows > 0 ? rows.rows : 1;
    lua_pushinteger(L, dm_flow_stride(&rows, columns, count, dml_checknumber(L, 4), most, work));
    return 1;
}
