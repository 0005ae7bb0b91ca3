/* bind_random.c - `dm.random`: random numbers that depend on a seed and a place alone, for
 * starts of ensembles. */
#include "base/random.h"
#include "bind/core/bind.h"

#include <math.h>

#define TNAME "dm.random"

static uint64_t seed_of(lua_State *L) {
    return *(const uint64_t *)luaL_checkudata(L, 1, TNAME);
}

static uint32_t check_place(lua_State *L) {
    const lua_Integer k = dml_checkinteger(L, 3);
    luaL_argcheck(L, k >= 0 && k <= (lua_Integer)UINT32_MAX, 3,
                  "the number's place k must be between 0 and 2^32 - 1");
    return (uint32_t)k;
}

static double check_finite(lua_State *L, int arg, double fallback) {
    const double x = dml_optnumber(L, arg, fallback);
    luaL_argcheck(L, isfinite(x), arg, "must be finite");
    return x;
}

static int random_new(lua_State *L) {
    const lua_Integer seed = dml_checkinteger(L, 1);
    *(uint64_t *)lua_newuserdatauv(L, sizeof(uint64_t), 0) = (uint64_t)seed;
    luaL_setmetatable(L, TNAME);
    return 1;
}

static int random_uniform(lua_State *L) {
    const uint64_t seed = seed_of(L), i = (uint64_t)dml_checkinteger(L, 2);
    const uint32_t k = check_place(L);
    const double a = check_finite(L, 4, 0.0), b = check_finite(L, 5, a + 1.0);
    luaL_argcheck(L, lua_isnoneornil(L, 4) == lua_isnoneornil(L, 5), lua_isnoneornil(L, 4) ? 4 : 5,
                  "give both ends of the interval or none");
    const double x = dm_random_uniform(seed, i, k);
    lua_pushnumber(L, a * (1.0 - x) + b * x);
    return 1;
}

static int random_normal(lua_State *L) {
    const uint64_t seed = seed_of(L), i = (uint64_t)dml_checkinteger(L, 2);
    const uint32_t k = check_place(L);
    const double mean = check_finite(L, 4, 0.0), deviation = check_finite(L, 5, 1.0);
    luaL_argcheck(L, deviation >= 0.0, 5, "the standard deviation must not be negative");
    lua_pushnumber(L, mean + deviation * dm_random_normal(seed, i, k));
    return 1;
}

static int random_field(lua_State *L) {
    const lua_Integer seed = (lua_Integer)seed_of(L);
    lua_pushliteral(L, "seed");
    if (!lua_rawequal(L, 2, -1)) return 0;
    lua_pushinteger(L, seed);
    return 1;
}

static int random_tostring(lua_State *L) {
    lua_pushfstring(L, "random numbers of seed %I", (LUAI_UACINT)seed_of(L));
    return 1;
}

static const dml_row meta[] = {{"__tostring", random_tostring, NULL}, {NULL, NULL, NULL}};
static const dml_row methods[] =
    {{"uniform", random_uniform,
      "random:uniform(i, k [, a, b]) -> number\n"
      "Number k (0 to 2^32 - 1) of member i, uniform in (0, 1) or between a and b. The same "
      "arguments give the same number, in any order of asking."},
     {"normal", random_normal,
      "random:normal(i, k [, mean, deviation]) -> number\n"
      "Number k (0 to 2^32 - 1) of member i, normal with that mean (0) and standard deviation (1); "
      "independent of uniform(i, k)."},
     {NULL, NULL, NULL}};
static const dml_row functions[] =
    {{"random", random_new,
      "dm.random(seed) -> dm.random\n"
      "Random numbers for starts of ensembles: r:uniform(i, k), r:normal(i, k) depend on the whole "
      "number `seed` and their place alone, not on what was asked before. Philox4x32-10, Salmon et "
      "al. 2011."},
     {NULL, NULL, NULL}};

const dml_class dml_class_random = {
    .name = TNAME,
    .doc = "dm.random: random numbers by counting, made by dm.random(seed)\n"
           "field: seed",
    .meta = meta,
    .methods = methods,
    .field = random_field,
    .functions = functions,
};
