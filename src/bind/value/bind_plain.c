/* bind_plain.c - lists of plain numbers, read at once: for what modules do at every sample that
 * they try (lua/dm/action, lua/dm/frame; first, bench frames). */
#include "base/random.h"
#include "bind/core/bind.h"
#include "bind/value/array.h"

#include <math.h>
#include <string.h>

enum { MOST = 1 << 28 }; /* entries */

static uint32_t check_length(lua_State *L, int arg) {
    const lua_Integer n = dml_checkinteger(L, arg);
    luaL_argcheck(L, n >= 0 && n <= MOST, arg, "a length from 0 to 2^28 expected");
    return (uint32_t)n;
}

/* the numbers of the vector at `at`, or NULL */
static const double *numbers(lua_State *L, int at, size_t *n) {
    const dml_array *a = dml_toarray(L, at, 1);
    *n = a ? a->rows : 0;
    return a ? dml_numbersof(a) : NULL;
}

/* A new vector on top, of what is there; 0: it is not n finite numbers. */
static int make_plain(lua_State *L, size_t n) {
    const int at = lua_gettop(L), is_number = lua_type(L, at) == LUA_TNUMBER;
    const dml_array *a = dml_toarray(L, at, 1);
    size_t count = 1;
    if (!is_number) {
        if (!a && (!lua_istable(L, at) || lua_getmetatable(L, at))) return 0;
        count = a ? a->rows : lua_rawlen(L, at);
        if (dml_surplus(L, at, (lua_Integer)count)) return 0; /* told by who reads it slowly */
    }
    if (count != n || n > MOST) return 0;
    double *out = dml_pushvector(L, (uint32_t)n);
    if (!is_number) return dml_readplain(L, at, out, (uint32_t)n) == n;
    *out = lua_tonumber(L, at);
    return isfinite(*out);
}

static double larger(double most, const double *x, size_t n) {
    for (size_t i = 0; i < n && !isnan(most); i++)
        if (!(fabs(x[i]) <= most)) most = fabs(x[i]);
    return most;
}

/* (x, n) -> a new vector, or nothing */
static int plain(lua_State *L) {
    const uint32_t n = check_length(L, 2);
    lua_settop(L, 1);
    return make_plain(L, n);
}

/* x -> number, or nothing */
static int largest(lua_State *L) {
    lua_settop(L, 1);
    if (lua_istable(L, 1) && !make_plain(L, lua_rawlen(L, 1))) return 0;
    size_t n;
    const double *x = numbers(L, -1, &n);
    if (!x) return 0;
    lua_pushnumber(L, larger(0, x, n));
    return 1;
}

/* list -> a new vector, or nothing */
static int joined(lua_State *L) {
    luaL_checktype(L, 1, LUA_TTABLE);
    const lua_Integer count = (lua_Integer)lua_rawlen(L, 1);
    size_t total = 0, n;
    lua_settop(L, 1);
    for (lua_Integer i = 1; i <= count; i++, lua_settop(L, 1)) {
        lua_rawgeti(L, 1, i);
        if (!numbers(L, 2, &n)) return 0;
        total += n;
    }
    if (total > MOST) return 0;
    double *out = dml_pushvector(L, (uint32_t)total);
    for (lua_Integer i = 1; i <= count; i++, out += n, lua_settop(L, 2)) {
        lua_rawgeti(L, 1, i);
        const double *x = numbers(L, 3, &n);
        if (n > total) return 0; /* a collected object has changed the list */
        if (n) memcpy(out, x, n * sizeof *out);
        total -= n;
    }
    return 1;
}

/* (random, i, n, deviation) -> a new vector */
static int normals(lua_State *L) {
    const uint64_t seed = *(const uint64_t *)luaL_checkudata(L, 1, "dm.random");
    const uint64_t i = (uint64_t)dml_checkinteger(L, 2);
    const uint32_t n = check_length(L, 3);
    const double deviation = dml_checknumber(L, 4);
    double *out = dml_pushvector(L, n);
    for (uint32_t k = 0; k < n; k++) out[k] = deviation * dm_random_normal(seed, i, k);
    return 1;
}

/* f(g, a copy of x[n]) as a new vector on top; 0: it is not n finite numbers. f and g at 1 and 2 */
static int make_image(lua_State *L, const double *x, uint32_t n) {
    lua_pushvalue(L, 1);
    lua_pushvalue(L, 2);
    memcpy(dml_pushvector(L, n), x, n * sizeof *x);
    lua_call(L, 2, 1);
    return make_plain(L, n);
}

/* (f, g, list, n) -> list of f(g, x), largest; or nothing */
static int images(lua_State *L) {
    const uint32_t n = check_length(L, 4);
    luaL_checktype(L, 3, LUA_TTABLE);
    const lua_Integer count = (lua_Integer)lua_rawlen(L, 3);
    double most = 0;
    size_t size;
    lua_settop(L, 3);
    lua_createtable(L, (int)count, 0);
    for (lua_Integer i = 1; i <= count; i++, lua_settop(L, 4)) {
        lua_rawgeti(L, 3, i);
        const double *x = numbers(L, 5, &size);
        if (!x || size != n || !make_image(L, x, n)) return 0;
        most = larger(most, numbers(L, -1, &size), n);
        lua_rawseti(L, 4, i);
    }
    lua_pushnumber(L, most);
    return 2;
}

static const dml_row functions[] =
    {{"plain", plain,
      "core.plain(x, n) -> dm.vector   or nothing\n"
      "A new vector of the n finite numbers that x is: a vector, a table of them or, for n = 1, a "
      "number; nothing where it is anything else."},
     {"largest", largest,
      "core.largest(x) -> number   or nothing\n"
      "The largest absolute value in a vector of plain numbers, NaN where there is one, or in a "
      "table of finite ones; nothing of anything else."},
     {"joined", joined,
      "core.joined(list) -> dm.vector   or nothing\n"
      "The entries of the vectors of a list, one after the other; nothing where one is no vector "
      "of plain numbers."},
     {"normals", normals,
      "core.normals(random, i, n, deviation) -> dm.vector\n"
      "The numbers 0 to n - 1 of place i of a dm.random, normal with that deviation."},
     {"images", images,
      "core.images(f, g, list, n) -> list, number   or nothing\n"
      "f(g, x) of copies of the vectors x of a list, as vectors, and the largest absolute value in "
      "them; nothing where any of these is not n finite numbers."},
     {NULL, NULL, NULL}};

const dml_class dml_class_plain = {
    .functions = functions,
};
