/* space_sphere.c - systems on S(n) and its products: R^N with the constraint q . q = 1 for each
 * sphere. */
#include "bind/model/bind_space.h"
#include "bind/model/model_params.h"
#include "bind/value/array.h"

enum { MOST_SPHERES = 256 };

/* where the unit vectors stand among the coordinates */
typedef struct {
    uint32_t n, spheres; /* coordinates, spheres found */
    uint32_t first[MOST_SPHERES], length[MOST_SPHERES];
} places;

/* add the space at stack index arg; 0 where it is neither a chart nor a sphere */
static int find_spheres(lua_State *L, int arg, places *p) {
    const dml_space *s = dml_checkspace(L, arg);
    luaL_checkstack(L, 4, NULL);
    if (s->row->sphere) {
        if (p->spheres == MOST_SPHERES)
            luaL_error(L, "field 'Q': more than %d spheres", MOST_SPHERES);
        p->first[p->spheres] = p->n;
        p->length[p->spheres++] = s->n + 1;
        p->n += s->n + 1;
        return 1;
    }
    if (s->chart) {
        p->n += s->row->dimension(s->n);
        return 1;
    }
    if (lua_getiuservalue(L, arg, DML_SPACE_PARTS) != LUA_TTABLE) return 0;
    const int parts = lua_gettop(L);
    int fine = 1;
    for (lua_Integer i = 1; fine && i <= luaL_len(L, parts); i++) {
        lua_geti(L, parts, i);
        fine = find_spheres(L, lua_gettop(L), p);
        lua_settop(L, parts);
    }
    lua_settop(L, parts - 1);
    return fine;
}

/* append the user's own constraint (upvalue 2), called with all arguments, to the table at out */
static void append_own(lua_State *L, int arguments, int out) {
    lua_pushvalue(L, lua_upvalueindex(2));
    for (int i = 1; i <= arguments; i++) lua_pushvalue(L, i);
    dml_callone(L, arguments, "the constraint");
    const int own = lua_gettop(L);
    const long count = dml_length(L, own);
    if (count < 0)
        luaL_error(L, "the constraint must return a number or a table or vector of them, got %s",
                   luaL_typename(L, own));
    for (long i = 0; i < count; i++) {
        const dml_scalar x = dml_entry(L, own, (uint32_t)i);
        dml_pushscalar(L, &x);
        lua_seti(L, out, luaL_len(L, out) + 1);
    }
}

/* |q_k|^2 - 1 of each sphere (upvalue 1), then the user's own */
static int equations(lua_State *L) {
    const places *p = lua_touserdata(L, lua_upvalueindex(1));
    const dml_array *q = dml_checkarray(L, 1, 1);
    const dml_scalar one = {.kind = DML_NUMBER, .as.number = 1.0};
    const int arguments = lua_gettop(L);
    if (q->rows != p->n) luaL_error(L, "q must have %d entries", (int)p->n);
    lua_newtable(L);
    for (uint32_t k = 0; k < p->spheres; k++) {
        const dml_run x = {q, p->first[k], 1};
        const dml_scalar square = dml_inner(L, x, x, p->length[k]);
        const dml_scalar off = dml_apply(L, DM_OP_SUB, &square, &one, NULL);
        dml_pushscalar(L, &off);
        lua_rawseti(L, -2, (lua_Integer)k + 1);
    }
    if (!lua_isnil(L, lua_upvalueindex(2))) append_own(L, arguments, arguments + 1);
    lua_settop(L, arguments + 1);
    return 1;
}

void dml_unfold_spheres(lua_State *L) {
    lua_getfield(L, 1, "Q");
    const dml_space *Q = luaL_testudata(L, -1, "dm.space");
    if (!Q || Q->chart) {
        lua_pop(L, 1);
        return;
    }
    places *p = lua_newuserdatauv(L, sizeof *p, 0);
    p->n = p->spheres = 0;
    if (!find_spheres(L, 2, p) || !p->spheres) {
        lua_settop(L, 1);
        return;
    }
    dml_pushcopy(L, 1);
    dml_pushspace(L, &dm_space_rn, p->n);
    lua_setfield(L, 4, "Q");
    lua_pushvalue(L, 3);
    lua_getfield(L, 1, "constraint");
    lua_pushcclosure(L, equations, 2);
    lua_setfield(L, 4, "constraint");
    lua_replace(L, 1);
    lua_settop(L, 1);
}
