/* space_product.c - spaces that have no row of geom/spaces.def: `dm.product(G, H, ...)`,
 * `dm.semidirect(G, V, action)`, and groups that a script defines (lua/dm/group/own.lua). */
#include "bind/model/bind_space.h"

static uint32_t dimension(uint32_t n) {
    return n;
}

static int acts(uint32_t n, uint32_t block) {
    (void)n, (void)block;
    return 0;
}

static void generator(double *out, const double *x, uint32_t n, uint32_t block, uint32_t a) {
    (void)x, (void)n, (void)a;
    for (uint32_t i = 0; i < block; i++) out[i] = 0.0;
}

/* signature: what stands between the factors when they are shown */
static const dm_space product_row = {.kit = "product",
                                     .name = "product",
                                     .signature = " x ",
                                     .dimension = dimension,
                                     .acts = acts,
                                     .generator = generator};
static const dm_space semidirect_row = {.kit = "semidirect",
                                        .name = "semidirect",
                                        .signature = " |x ",
                                        .dimension = dimension,
                                        .acts = acts,
                                        .generator = generator};

static uint32_t dimension_of(const dml_space *s) {
    return s->row->dimension(s->n);
}

/* push the product of the spaces at 1 .. count */
static void push_product(lua_State *L, const dm_space *row, int count) {
    uint64_t sum = 0;
    int chart = row == &product_row;
    for (int i = 1; i <= count; i++) {
        const dml_space *s = dml_checkspace(L, i);
        sum += dimension_of(s);
        chart = chart && s->chart;
    }
    if (sum > DM_LARGEST_SPACE)
        luaL_error(L, "the product has more than %d dimensions", DM_LARGEST_SPACE);
    dml_pushspace(L, row, (uint32_t)sum)->chart = chart;
    lua_createtable(L, count, 0);
    for (int i = 1; i <= count; i++) {
        lua_pushvalue(L, i);
        lua_rawseti(L, -2, i);
    }
    lua_setiuservalue(L, -2, DML_SPACE_PARTS);
}

int dml_product(lua_State *L) {
    const int count = lua_gettop(L);
    luaL_argcheck(L, count >= 2, 1, "dm.product takes two or more spaces");
    luaL_checkstack(L, 4, NULL);
    push_product(L, &product_row, count);
    return 1;
}

int dml_semidirect(lua_State *L) {
    lua_settop(L, 3);
    dml_checkspace(L, 1);
    luaL_argcheck(L, dml_checkspace(L, 2)->row->vectors, 2, "V must be a vector space dm.R(n)");
    luaL_argcheck(L, lua_isnil(L, 3) || lua_isfunction(L, 3), 3,
                  "action must be a function of (g, v) that is linear in v");
    push_product(L, &semidirect_row, 2);
    lua_pushvalue(L, 3);
    lua_setiuservalue(L, -2, DML_SPACE_ACTION);
    return 1;
}

/* The row lives as long as the space, and the name with it. */
int dml_own_group(lua_State *L) {
    const char *name = luaL_checkstring(L, 1);
    const lua_Integer d = dml_checkinteger(L, 2);
    luaL_checktype(L, 3, LUA_TTABLE);
    dm_space *row = lua_newuserdatauv(L, sizeof *row, 1);
    *row = product_row;
    row->kit = "own";
    row->name = row->signature = name;
    lua_pushvalue(L, 1);
    lua_setiuservalue(L, -2, 1);
    dml_pushspace(L, row, (uint32_t)d);
    lua_insert(L, -2);
    lua_setiuservalue(L, -2, DML_SPACE_ROW);
    lua_pushvalue(L, 3);
    lua_setiuservalue(L, -2, DML_SPACE_KIT);
    return 1;
}
