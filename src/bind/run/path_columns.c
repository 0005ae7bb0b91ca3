/* path_columns.c - path.t, path.q, path.p as views, and the names of columns. */
#include "bind/model/space_group.h"
#include "bind/run/bind_path.h"
#include "bind/value/array.h"

#include <stdio.h>
#include <string.h>

#define COLUMNS "dm.columns"

enum { LISTED = 40 }; /* names of one kind that are told one by one */

/* The path at stack index 1. */
static dml_path *check(lua_State *L) {
    return luaL_checkudata(L, 1, DML_PATH);
}

typedef struct {
    const dml_path *path; /* kept alive by user value 1 */
    uint32_t first, count;
    const char *name;
} columns;

/* A view keeps its path alive, and sees the rows of it. */
int dml_path_columns(lua_State *L, const char *name, uint32_t first, uint32_t count) {
    columns *c = lua_newuserdatauv(L, sizeof *c, 1);
    *c = (columns){.path = check(L), .first = first, .count = count, .name = name};
    lua_pushvalue(L, 1);
    lua_setiuservalue(L, -2, 1);
    luaL_setmetatable(L, COLUMNS);
    return 1;
}

/* the element of a group whose flat coordinates are at q; the view is at 1 */
static int push_element(lua_State *L, const double *q) {
    lua_getiuservalue(L, 1, 1);
    lua_getiuservalue(L, -1, DML_PATH_SYSTEM);
    dml_pushposition(L, -1, q);
    dml_mark_copy(L);
    if (lua_istable(L, -1)) dml_lock(L, "a row of a path"); /* of a product */
    return 1;
}

/* Row i as a new vector, a copy that cannot be set; t alone as a number. nil one behind the last
 * row ends ipairs. */
static int columns_index(lua_State *L) {
    const columns *c = luaL_checkudata(L, 1, COLUMNS);
    const dml_path *p = c->path;
    int whole;
    const lua_Integer i = lua_tointegerx(L, 2, &whole);
    if (!whole)
        return luaL_error(L, "path.%s is indexed by a row number from 1 to %d (got %s)", c->name,
                          (int)p->rows, luaL_tolstring(L, 2, NULL));
    if (i == (lua_Integer)p->rows + 1) return 0; /* ends ipairs */
    if (i < 1 || i > p->rows)
        return luaL_error(L, "path.%s has rows 1 to %d (got %I)", c->name, (int)p->rows,
                          (LUAI_UACINT)i);
    const double *row = p->data + (size_t)(i - 1) * dml_path_width(p) + c->first;
    if (c->count == 1 && c->first == 0) return lua_pushnumber(L, *row), 1;
    if (p->placed && strcmp(c->name, "q") == 0) return push_element(L, row);
    memcpy(dml_pushvector(L, c->count), row, c->count * sizeof *row);
    dml_mark_copy(L);
    return 1;
}

/* Rows, as of the path. */
static int columns_len(lua_State *L) {
    const columns *c = luaL_checkudata(L, 1, COLUMNS);
    lua_pushinteger(L, c->path->rows);
    return 1;
}

enum { FIRST = 3 }; /* rows that are shown of more than LONGEST, and the last one */
static const long LONGEST = 12;

/* row i, from 1, as text on top */
static void push_row_text(lua_State *L, long i) {
    char text[40];
    lua_pushcfunction(L, columns_index);
    lua_pushvalue(L, 1);
    lua_pushinteger(L, (lua_Integer)i);
    lua_call(L, 2, 1);
    if (lua_type(L, -1) == LUA_TNUMBER) {
        snprintf(text, sizeof text, "%.14g", lua_tonumber(L, -1));
        lua_pushstring(L, text);
    } else {
        luaL_tolstring(L, -1, NULL);
    }
    lua_remove(L, -2);
}

/* The times as a vector and the rows as a matrix print themselves; elements of groups are shown by
 * index. */
static int columns_tostring(lua_State *L) {
    const columns *c = luaL_checkudata(L, 1, COLUMNS);
    const long rows = c->path->rows;
    const int is_time = c->count == 1 && c->first == 0, brief = rows > LONGEST;
    luaL_Buffer b;
    if (c->path->placed && strcmp(c->name, "q") == 0)
        return lua_pushfstring(L, "q of a path: %d elements", (int)rows), 1;
    luaL_buffinit(L, &b);
    luaL_addchar(&b, '[');
    for (long i = 1; i <= rows; i = brief && i == FIRST ? rows : i + 1) {
        const char *gap = is_time ? ", " : ",\n ";
        if (i > 1 && !(brief && i == rows)) luaL_addstring(&b, gap);
        if (brief && i == rows) luaL_addstring(&b, is_time ? ", ... , " : ",\n ...\n ");
        push_row_text(L, i);
        luaL_addvalue(&b);
    }
    luaL_addchar(&b, ']');
    if (brief && is_time)
        lua_pushfstring(L, " (%d)", (int)rows);
    else if (brief)
        lua_pushfstring(L, " (%d x %d)", (int)rows, (int)c->count);
    else
        lua_pushliteral(L, "");
    luaL_addvalue(&b);
    luaL_pushresult(&b);
    return 1;
}

void dml_state_names(lua_State *L, int system, uint32_t n, uint32_t momenta) {
    system = lua_absindex(L, system);
    const int given = dml_systemfield(L, system, "coordinates") != LUA_TNIL;
    lua_pop(L, 1);
    lua_createtable(L, (int)(1 + n + momenta), 0);
    dml_setresult(L);
    lua_pushliteral(L, "t");
    lua_rawseti(L, -2, 1);
    for (uint32_t i = 0; i < n; i++) {
        const char *name = dml_coordinate(L, system, i);
        if (given)
            lua_pushfstring(L, "p_%s", name);
        else
            lua_pushfstring(L, "p%d", (int)i + 1);
        if (i < momenta)
            lua_rawseti(L, -3, 2 + (lua_Integer)n + i);
        else
            lua_pop(L, 1);
        lua_rawseti(L, -2, 2 + (lua_Integer)i);
    }
}

/* Made when first asked for, where the run has named none. */
int dml_path_names(lua_State *L) {
    const dml_path *p = check(L);
    if (lua_getiuservalue(L, 1, DML_PATH_NAMES) != LUA_TNIL) return 1;
    lua_pop(L, 1);
    lua_getiuservalue(L, 1, DML_PATH_SYSTEM);
    dml_state_names(L, -1, p->n, p->momenta);
    return 1;
}

/* columns called `stem`, or stem1, stem2 ... in a row */
uint32_t dml_path_group(lua_State *L, const char *stem, uint32_t *first) {
    const dml_path *p = check(L);
    const size_t length = strlen(stem);
    uint32_t count = 0;
    dml_path_names(L);
    for (uint32_t c = 0; c < dml_path_width(p); c++, lua_pop(L, 1)) {
        lua_rawgeti(L, -1, (lua_Integer)c + 1);
        const char *name = lua_tostring(L, -1);
        if (strncmp(name, stem, length) != 0 ||
            strspn(name + length, "0123456789") != strlen(name + length))
            continue;
        if (!count++) *first = c;
    }
    lua_pop(L, 1);
    return count;
}

/* number of the column called `name`, -1: none; q1, p1 work beside given names */
static int find_column(lua_State *L, const char *name) {
    const dml_path *p = check(L);
    char kind, rest;
    unsigned i;
    const int top = lua_gettop(L);
    int found = -1;
    dml_path_names(L);
    for (uint32_t c = 0; found < 0 && c < dml_path_width(p); c++, lua_pop(L, 1)) {
        lua_rawgeti(L, -1, (lua_Integer)c + 1);
        if (strcmp(lua_tostring(L, -1), name) == 0) found = (int)c;
    }
    lua_settop(L, top);
    if (p->watched) return found;
    if (found < 0 && sscanf(name, "%c%u%c", &kind, &i, &rest) == 2 && i >= 1 && i <= p->n) {
        if (kind == 'q') found = (int)i;
        if (kind == 'p' && i <= p->momenta) found = (int)(p->n + i);
    }
    return found;
}

/* Where entry i of a row of `count` names that begins at `first` stands: 1 between its ends, 2 at
 * the last one, of rows that are too long to be told name by name. */
static int place_in(lua_Integer i, lua_Integer first, lua_Integer count) {
    if (count <= LISTED || i <= first || i >= first + count) return 0;
    return i == first + count - 1 ? 2 : 1;
}

/* Raises with all the names that there are, long rows of them from the first to the last. */
static void unknown_column(lua_State *L, const char *name) {
    const dml_path *p = check(L);
    const lua_Integer n = p->watched ? 0 : p->n, momenta = p->watched ? 0 : p->momenta;
    luaL_Buffer b;
    dml_path_names(L);
    const int names = lua_gettop(L);
    luaL_buffinit(L, &b);
    for (lua_Integer i = 1; lua_rawgeti(L, names, i) != LUA_TNIL; i++) {
        const int place = place_in(i, 2, n) + place_in(i, 2 + n, momenta);
        if (place == 1) {
            lua_pop(L, 1);
            continue;
        }
        if (i > 1) lua_pushfstring(L, place ? " to %s" : ", %s", lua_tostring(L, -1));
        if (i > 1) lua_remove(L, -2);
        luaL_addvalue(&b);
    }
    lua_pop(L, 1);
    luaL_pushresult(&b);
    luaL_error(L, "no column '%s'; this path has %s%s", name, lua_tostring(L, -1),
               !check(L)->watched ? ", and \"energy\"" : "");
}

int dml_path_has(lua_State *L, const char *name) {
    return find_column(L, name) >= 0;
}

/* "time" is t by another name. */
uint32_t dml_path_find(lua_State *L, const char *name) {
    const int c = find_column(L, strcmp(name, "time") == 0 ? "t" : name);
    if (c < 0) unknown_column(L, name);
    return (uint32_t)c;
}

static const dml_row columns_meta[] = {{"__len", columns_len, NULL},
                                       {"__tostring", columns_tostring, NULL},
                                       {NULL, NULL, NULL}};

/* dml_islist */
static void mark_list(lua_State *L) {
    luaL_getmetatable(L, COLUMNS);
    lua_pushboolean(L, 1);
    lua_setfield(L, -2, "__list");
    lua_pop(L, 1);
}

const dml_class dml_class_columns = {
    .name = COLUMNS,
    .doc = "dm.columns: path.t, path.q, path.p\n"
           "columns[i] is row i, #columns the number of rows; path.t is taken wherever a list of "
           "numbers is",
    .meta = columns_meta,
    .field = columns_index,
    .open = mark_list,
};
