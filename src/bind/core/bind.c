#include "bind/core/bind.h"

#include "base/times.h"
#include "bind/core/missing_key.h"

#include <limits.h>
#include <math.h>
#include <string.h>

int dml_is_stop(lua_State *L, int at) {
    const char *text = lua_type(L, at) == LUA_TSTRING ? lua_tostring(L, at) : NULL;
    if (text) return strstr(text, "interrupted!") != NULL;
    if (lua_type(L, at) != LUA_TTABLE) return 0;
    at = lua_absindex(L, at);
    lua_pushliteral(L, "code");
    lua_rawget(L, at);
    const char *code = lua_type(L, -1) == LUA_TSTRING ? lua_tostring(L, -1) : "";
    const int stopped = strcmp(code, "stopped") == 0;
    lua_pop(L, 1);
    return stopped;
}

int dml_try(lua_State *L, int arguments, int results) {
    const int status = lua_pcall(L, arguments, results, 0);
    if (status == LUA_OK) return 1;
    if (status == LUA_ERRMEM || dml_is_stop(L, -1)) lua_error(L);
    dml_checkstop(L); /* a stop that nobody has seen yet; what failed here is no answer to it */
    return 0;
}

void dml_cut(lua_State *L, int top) {
    luaL_checkstack(L, 3 * LUA_MINSTACK, NULL);
    lua_settop(L, top);
}

void dml_callone(lua_State *L, int arguments, const char *what) {
    const int before = lua_gettop(L) - arguments - 1;
    lua_call(L, arguments, LUA_MULTRET);
    const int results = lua_gettop(L) - before;
    if (results > 1)
        luaL_error(L,
                   "%s must return one value, not %d: a list of numbers is one as a table, return "
                   "{ a, b }",
                   what, results);
    lua_settop(L, before + 1);
}

/* ---- classes ---- */

void dml_setdoc(lua_State *L, int at, const char *doc) {
    at = lua_absindex(L, at);
    luaL_getsubtable(L, LUA_REGISTRYINDEX, "dm_docs");
    lua_pushvalue(L, at);
    lua_pushstring(L, doc); /* nil for NULL */
    lua_rawset(L, -3);
    lua_pop(L, 1);
}

/* A function that its doc says how many arguments it takes of: more than that raise. Upvalues: its
 * row, and the number. */
static int call_row(lua_State *L) {
    const dml_row *row = lua_touserdata(L, lua_upvalueindex(1));
    const int most = (int)lua_tointeger(L, lua_upvalueindex(2));
    if (lua_gettop(L) > most) dml_checksurplus(L, most, row->doc);
    return row->call(L);
}

lua_CFunction dml_rowof(lua_State *L, int at) {
    const lua_CFunction f = lua_tocfunction(L, at);
    if (f != call_row || !lua_getupvalue(L, at, 1)) return f;
    const dml_row *row = lua_touserdata(L, -1);
    lua_pop(L, 1);
    return row->call;
}

void dml_setfunction(lua_State *L, const dml_row *row) {
    if (row->doc) {
        const int most = dml_arity(row->doc);
        lua_pushlightuserdata(L, (void *)(uintptr_t)row);
        lua_pushinteger(L, most < 0 ? INT_MAX : most);
        lua_pushcclosure(L, call_row, 2);
        dml_setdoc(L, -1, row->doc);
    } else {
        lua_pushcfunction(L, row->call);
    }
    lua_setfield(L, -2, row->name);
}

void dml_setfunctions(lua_State *L, const dml_row *rows) {
    for (; rows && rows->name; rows++) dml_setfunction(L, rows);
}

/* value.key: the class's own field function first (upvalue 2), then its methods
 * (upvalue 1); upvalue 3: its name */
static int class_index(lua_State *L) {
    const lua_CFunction field = lua_tocfunction(L, lua_upvalueindex(2));
    if (lua_gettop(L) != 2) lua_settop(L, 2);
    const int results = field ? field(L) : 0;
    if (results) return results;
    lua_settop(L, 2);
    lua_pushvalue(L, 2);
    if (lua_rawget(L, lua_upvalueindex(1)) == LUA_TNIL)
        dml_miss(L, 1, lua_tostring(L, lua_upvalueindex(3)), 2);
    return 1;
}

/* __newindex of objects whose fields say what they are; tables of a class take what they are
 * given */
static int refuse_field(lua_State *L) {
    lua_settop(L, 3); /* it may be called by hand, with less */
    if (lua_istable(L, 1)) return lua_rawset(L, 1), 0;
    const char *class = lua_tostring(L, lua_upvalueindex(1));
    return luaL_error(L, "the field '%s' of a %s cannot be set: make another %s with it",
                      luaL_tolstring(L, 2, NULL), class, class);
}

void dml_setindex(lua_State *L, const char *name, lua_CFunction field) {
    luaL_getsubtable(L, -1, "methods");
    if (field)
        lua_pushcfunction(L, field);
    else
        lua_pushnil(L);
    lua_pushstring(L, name);
    lua_pushcclosure(L, class_index, 3);
    lua_setfield(L, -2, "__index");
}

static void begin_class(lua_State *L, const dml_class *c) {
    luaL_newmetatable(L, c->name);
    dml_setfunctions(L, c->meta);
    dml_setindex(L, c->name, c->field);
    if (lua_getfield(L, -1, "__newindex") == LUA_TNIL) {
        lua_pushstring(L, c->name);
        lua_pushcclosure(L, refuse_field, 1);
        lua_setfield(L, -3, "__newindex");
    }
    lua_pushstring(L, c->name);
    dml_setdoc(L, -1, c->doc);
    lua_pop(L, 3);
}

static void add_methods(lua_State *L, const char *class, const dml_row *methods) {
    luaL_getmetatable(L, class);
    lua_getfield(L, -1, "methods");
    dml_setfunctions(L, methods);
    lua_pop(L, 2);
}

void dml_register(lua_State *L, const dml_class *c) {
    if (c->name) begin_class(L, c), add_methods(L, c->name, c->methods);
    for (const dml_extension *e = c->more; e && e->class; e++) add_methods(L, e->class, e->methods);
    dml_setfunctions(L, c->functions);
    if (c->open) c->open(L);
}

/* ---- options tables ---- */

static int is_known(const char *key, const char *const *known) {
    while (*known && (**known != *key || strcmp(*known, key) != 0)) known++;
    return *known != NULL;
}

static void unknown_option(lua_State *L, const char *key, const char *const *known) {
    const char *near = dml_nearest(key, known);
    luaL_Buffer b;
    luaL_buffinit(L, &b);
    lua_pushfstring(L, "unknown field '%s'; ", key);
    luaL_addvalue(&b);
    if (near) {
        lua_pushfstring(L, "did you mean '%s'? ", near);
        luaL_addvalue(&b);
    }
    luaL_addstring(&b, "known fields: ");
    for (const char *const *k = known; *k; k++) {
        if (k != known) luaL_addstring(&b, ", ");
        luaL_addstring(&b, *k);
    }
    luaL_pushresult(&b);
    luaL_error(L, "%s", lua_tostring(L, -1));
}

void dml_options(lua_State *L, int arg, const char *const *known) {
    arg = lua_absindex(L, arg);
    luaL_checktype(L, arg, LUA_TTABLE);
    luaL_checkstack(L, 4, NULL);
    for (lua_pushnil(L); lua_next(L, arg); lua_pop(L, 1)) {
        if (lua_type(L, -2) != LUA_TSTRING) {
            const char *key = luaL_tolstring(L, -2, NULL);
            luaL_error(L, "unexpected entry [%s] in a table of options: write name = value", key);
        }
        const char *key = lua_tostring(L, -2);
        if (!is_known(key, known)) unknown_option(L, key, known);
    }
}

const char *dml_text_hint(lua_State *L, int arg) {
    const int reads_as_number = lua_type(L, arg) == LUA_TSTRING && lua_isnumber(L, arg);
    return reads_as_number ? DML_TEXT_HINT : "";
}

/* the value on top as a message shows it */
static const char *shown(lua_State *L) {
    if (lua_type(L, -1) == LUA_TNUMBER)
        return isnan(lua_tonumber(L, -1)) ? "NaN" : luaL_tolstring(L, -1, NULL);
    if (lua_type(L, -1) == LUA_TSTRING)
        return lua_pushfstring(L, "the string \"%s\"%s", lua_tostring(L, -1), dml_text_hint(L, -1));
    return luaL_getmetafield(L, -1, "__name") == LUA_TSTRING ? lua_tostring(L, -1)
                                                             : luaL_typename(L, -1);
}

int dml_wrongfield(lua_State *L, const char *key, const char *expected) {
    if (lua_isnil(L, -1))
        return luaL_error(L, "field '%s' is missing: it must be %s", key, expected);
    return luaL_error(L, "field '%s' must be %s (got %s)", key, expected, shown(L));
}

/* field `key` of the options at arg on top; 0 when it is nil */
int dml_field(lua_State *L, int arg, const char *key) {
    luaL_checkstack(L, 4, NULL);
    if (lua_isnoneornil(L, arg)) {
        lua_pushnil(L);
        return 0;
    }
    lua_getfield(L, arg, key);
    dml_unlock(L, -1);
    return !lua_isnil(L, -1);
}

static double read_number(lua_State *L, const char *key, const char *expected) {
    const double x = lua_tonumber(L, -1);
    if (lua_type(L, -1) != LUA_TNUMBER || !isfinite(x)) dml_wrongfield(L, key, expected);
    return x;
}

static void refuse_text(lua_State *L, int arg) {
    if (lua_type(L, arg) == LUA_TSTRING)
        luaL_argerror(L, arg,
                      lua_pushfstring(L, "number expected, got the text \"%s\"%s",
                                      lua_tostring(L, arg), dml_text_hint(L, arg)));
}

double dml_checknumber(lua_State *L, int arg) {
    refuse_text(L, arg);
    return luaL_checknumber(L, arg);
}

double dml_optnumber(lua_State *L, int arg, double fallback) {
    return lua_isnoneornil(L, arg) ? fallback : dml_checknumber(L, arg);
}

lua_Integer dml_checkinteger(lua_State *L, int arg) {
    refuse_text(L, arg);
    return luaL_checkinteger(L, arg);
}

lua_Integer dml_optinteger(lua_State *L, int arg, lua_Integer fallback) {
    return lua_isnoneornil(L, arg) ? fallback : dml_checkinteger(L, arg);
}

lua_Integer dml_tointegerx(lua_State *L, int at, int *is_whole) {
    if (lua_type(L, at) == LUA_TNUMBER) return lua_tointegerx(L, at, is_whole);
    return *is_whole = 0;
}

double dml_number(lua_State *L, int arg, const char *key, double fallback) {
    static const char expected[] = "a finite number";
    double x = fallback;
    if (dml_field(L, arg, key))
        x = read_number(L, key, expected);
    else if (isnan(fallback))
        dml_wrongfield(L, key, expected);
    lua_pop(L, 1);
    return x;
}

double dml_positive(lua_State *L, int arg, const char *key, double fallback) {
    static const char expected[] = "a finite number > 0";
    double x = fallback;
    if (dml_field(L, arg, key)) x = read_number(L, key, expected);
    if (!(x > 0)) dml_wrongfield(L, key, expected);
    lua_pop(L, 1);
    return x;
}

void dml_refuse_late(lua_State *L, double t0, double h) {
    if (!dm_times_differ(t0, h))
        luaL_error(L,
                   "field 't0': numbers near %f are %f apart, which is too far for steps of h = "
                   "%f: count the time from a nearer origin, from 0 where nothing depends on it",
                   t0, nextafter(fabs(t0), INFINITY) - fabs(t0), h);
}

long dml_count(lua_State *L, int arg, const char *key, long least, long fallback) {
    long n = fallback;
    int whole = 1;
    if (dml_field(L, arg, key)) {
        n = (long)lua_tointegerx(L, -1, &whole);
        whole = whole && lua_type(L, -1) == LUA_TNUMBER;
    }
    if (!whole || n < least) {
        const char *expected = lua_pushfstring(L, "a whole number >= %d", (int)least);
        lua_pushvalue(L, -2);
        dml_wrongfield(L, key, expected);
    }
    lua_pop(L, 1);
    return n;
}

int dml_flag(lua_State *L, int arg, const char *key, int fallback) {
    const int given = dml_field(L, arg, key), on = given ? lua_toboolean(L, -1) : fallback;
    if (given && !lua_isboolean(L, -1)) dml_wrongfield(L, key, "true or false");
    lua_pop(L, 1);
    return on;
}

void dml_text(lua_State *L, int arg, const char *key) {
    if (dml_field(L, arg, key) && lua_type(L, -1) != LUA_TSTRING)
        dml_wrongfield(L, key, "a string");
    lua_pop(L, 1);
}

/* what a session shows of it */
static int result_tostring(lua_State *L) {
    lua_settop(L, 1);
    lua_getglobal(L, "require");
    lua_pushliteral(L, "dm.session.pretty");
    lua_call(L, 1, 1);
    lua_getfield(L, -1, "pretty");
    lua_pushvalue(L, 1);
    lua_call(L, 1, 1);
    return 1;
}

void dml_setresult(lua_State *L) {
    if (luaL_newmetatable(L, "dm.result")) {
        lua_pushcfunction(L, result_tostring);
        lua_setfield(L, -2, "__tostring");
    }
    lua_setmetatable(L, -2);
}

void dml_pushcopy(lua_State *L, int table) {
    table = lua_absindex(L, table);
    lua_newtable(L);
    for (lua_pushnil(L); lua_next(L, table);) {
        lua_pushvalue(L, -2);
        lua_insert(L, -2);
        lua_rawset(L, -4);
    }
}
