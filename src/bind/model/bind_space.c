/* bind_space.c - `dm.R(n)`, `dm.T(n)`, `dm.SO(n)`: one constructor per row of
 * geom/spaces.def. */
#include "bind/model/bind_space.h"
#include "base/largest.h"
#include "bind/model/bind_system.h"

#include <math.h>
#include <string.h>

#define TNAME "dm.space"

const dml_space *dml_checkspace(lua_State *L, int arg) {
    return luaL_checkudata(L, arg, TNAME);
}

/* Are coordinates of the space at `arg` angles? A torus has free coordinates and no vectors. */
static int has_angles(lua_State *L, int arg) {
    const int top = lua_gettop(L);
    const dml_space *s = dml_checkspace(L, arg);
    int any = s->row->chart && !s->row->vectors;
    if (lua_getiuservalue(L, arg, DML_SPACE_PARTS) == LUA_TTABLE) {
        any = 0;
        for (lua_Integer i = 1; !any && i <= luaL_len(L, top + 1); i++) {
            lua_geti(L, top + 1, i);
            any = has_angles(L, lua_gettop(L));
        }
    }
    lua_settop(L, top);
    return any;
}

/* Raise where a group that acts on vectors would turn angles of the system at `system`. */
static void check_angles(lua_State *L, int arg, int system) {
    if (dml_checkspace(L, arg)->row->chart) return; /* shifts */
    dml_systemfield(L, system, "Q");
    const int space = lua_gettop(L);
    if (has_angles(L, space))
        luaL_error(L,
                   "%s acts on vectors, and coordinates of %s are angles: give dm.R(n) for shifts, "
                   "or a generator, as function(q) return {-q[2], q[1], 1} end for x, y and a "
                   "heading",
                   luaL_tolstring(L, arg, NULL), luaL_tolstring(L, space, NULL));
    lua_settop(L, space - 1);
}

dm_action dml_standard_action(lua_State *L, int arg, int options, int system, uint32_t n) {
    static const char *const known[] = {"block", NULL};
    const dml_space *s = dml_checkspace(L, arg);
    uint32_t other;
    uint32_t block = dm_action_block(s->row, s->n, n, &other);
    if (options && !lua_isnoneornil(L, options)) {
        dml_options(L, options, known);
        const long given = dml_count(L, options, "block", 1, (long)block);
        block = given <= DM_MAX_BLOCK ? (uint32_t)given : 0;
        other = 0;
        if (block && (n % block || !s->row->acts(s->n, block))) block = 0;
    }
    check_angles(L, arg, system);
    if (!block)
        luaL_error(L,
                   "%s has no standard action on %d coordinates: give a dm.action, or the "
                   "generator as a function of q, for instance function(q) return {-q[2], q[1]} "
                   "end",
                   luaL_tolstring(L, arg, NULL), (int)n);
    if (other)
        luaL_error(L,
                   "%s(%d) can act on %d coordinates in blocks of %d or of %d: say which with { "
                   "block = %d }",
                   s->row->name, (int)s->n, (int)n, (int)block, (int)other, (int)block);
    return (dm_action){.group = s->row, .k = s->n, .block = block};
}

/* to = (q, v) moved by e along generator g: v by its linear part */
static void move(const dm_action *a, uint32_t n, uint32_t g, double e, const double *x,
                 double *to) {
    static const double origin[DM_MAX_BLOCK];
    double xi[DM_MAX_BLOCK], still[DM_MAX_BLOCK];
    a->group->generator(still, origin, a->k, a->block, g);
    for (uint32_t i = 0; i < 2 * n; i++) {
        const uint32_t k = i % a->block; /* n is a whole number of blocks */
        if (k == 0) a->group->generator(xi, x + i, a->k, a->block, g);
        to[i] = x[i] + e * (i < n ? xi[k] : xi[k] - still[k]);
    }
}

/* M X + X^T M of the linear part X of generator g, M and out n x n; 0: X is zero, a shift */
static int turn_mass(const dm_action *a, uint32_t n, uint32_t g, const double *M, double *out) {
    static const double origin[DM_MAX_BLOCK];
    double unit[DM_MAX_BLOCK] = {0}, still[DM_MAX_BLOCK], xi[DM_MAX_BLOCK];
    int any = 0;
    memset(out, 0, (size_t)n * n * sizeof *out);
    a->group->generator(still, origin, a->k, a->block, g);
    for (uint32_t j = 0; j < n; j++) { /* column j of X */
        const uint32_t first = j - j % a->block;
        unit[j % a->block] = 1.0;
        a->group->generator(xi, unit, a->k, a->block, g);
        unit[j % a->block] = 0.0;
        for (uint32_t k = 0; k < a->block; k++) {
            const double X = xi[k] - still[k];
            any |= X != 0.0;
            for (uint32_t i = 0; i < n; i++) {
                out[i * (size_t)n + j] += M[i * (size_t)n + first + k] * X;
                out[j * (size_t)n + i] += M[i * (size_t)n + first + k] * X;
            }
        }
    }
    return any;
}

double dml_turned_mass(const dm_action *action, const dm_kernel *mass, uint32_t n, const double *x,
                       double *work) {
    static const double E = 1e-5; /* of central differences */
    const size_t size = (size_t)n * n;
    double *here = work, *up = here + n + size, *down = up + n + size, *at = down + n + size;
    double *turned = at + 2 * n + 1, worst = 0.0;
    at[2 * n] = x[2 * n];
    dm_kernel_eval(mass, x, here);
    for (uint32_t g = 0; g < action->group->dimension(action->k); g++) {
        if (!turn_mass(action, n, g, here + n, turned)) continue;
        move(action, n, g, E, x, at), dm_kernel_eval(mass, at, up);
        move(action, n, g, -E, x, at), dm_kernel_eval(mass, at, down);
        for (size_t i = 0; i < size; i++)
            worst = dm_largest(worst, turned[i] + (up[n + i] - down[n + i]) / (2.0 * E));
    }
    double largest = 0.0;
    for (size_t i = 0; i < size; i++) largest = dm_largest(largest, here[n + i]);
    return largest > 0.0 ? worst / largest : 0.0;
}

dml_space *dml_pushspace(lua_State *L, const dm_space *row, uint32_t n) {
    dml_space *s = lua_newuserdatauv(L, sizeof *s, DML_SPACE_ROW);
    *s = (dml_space){.row = row, .n = n, .chart = row->chart};
    luaL_setmetatable(L, TNAME);
    return s;
}

static int space_new(lua_State *L) {
    const dm_space *row = lua_touserdata(L, lua_upvalueindex(1));
    dml_checksurplus(L, 1, row->signature);
    const lua_Number given = row->usual ? dml_optnumber(L, 1, row->usual) : dml_checknumber(L, 1);
    const lua_Integer n = given == floor(given) && fabs(given) < 1e9 ? (lua_Integer)given : -1;
    luaL_argcheck(L, n >= (lua_Integer)row->least && n <= (lua_Integer)row->most, 1,
                  lua_pushfstring(L, "%s needs a whole number from %d to %d", row->signature,
                                  (int)row->least, (int)row->most));
    luaL_argcheck(L, n % (lua_Integer)row->multiple == 0, 1,
                  lua_pushfstring(L, "%s needs a multiple of %d", row->signature,
                                  (int)row->multiple));
    dml_pushspace(L, row, (uint32_t)n);
    return 1;
}

/* "SO(3)", "R^2", a name, or the factors with a sign between them */
static int space_tostring(lua_State *L) {
    const dml_space *s = dml_checkspace(L, 1);
    if (lua_getiuservalue(L, 1, DML_SPACE_KIT) == LUA_TTABLE) {
        lua_pushstring(L, s->row->name);
        return 1;
    }
    if (lua_getiuservalue(L, 1, DML_SPACE_PARTS) != LUA_TTABLE) {
        lua_pushfstring(L, s->row->chart ? "%s^%d" : "%s(%d)", s->row->name, (int)s->n);
        return 1;
    }
    const int parts = lua_gettop(L);
    luaL_Buffer b;
    luaL_buffinit(L, &b);
    for (lua_Integer i = 1; i <= luaL_len(L, parts); i++) {
        if (i > 1) luaL_addstring(&b, s->row->signature);
        lua_geti(L, parts, i);
        luaL_tolstring(L, -1, NULL);
        lua_remove(L, -2);
        luaL_addvalue(&b);
    }
    luaL_pushresult(&b);
    return 1;
}

/* the factors in the tables on top of the stack are the same, two and two */
static int same_parts(lua_State *L) {
    const int b = lua_gettop(L), a = b - 1;
    const lua_Integer count = luaL_len(L, a);
    int same = count == luaL_len(L, b);
    for (lua_Integer i = 1; same && i <= count; i++) {
        lua_geti(L, a, i);
        lua_geti(L, b, i);
        same = lua_compare(L, -2, -1, LUA_OPEQ);
        lua_pop(L, 2);
    }
    return same;
}

static int space_eq(lua_State *L) {
    const dml_space *a = luaL_testudata(L, 1, TNAME), *b = luaL_testudata(L, 2, TNAME);
    int equal = a && b && a->row == b->row && a->n == b->n;
    if (equal && lua_getiuservalue(L, 1, DML_SPACE_PARTS) == LUA_TTABLE) {
        lua_getiuservalue(L, 2, DML_SPACE_PARTS);
        equal = same_parts(L);
        lua_getiuservalue(L, 1, DML_SPACE_ACTION);
        lua_getiuservalue(L, 2, DML_SPACE_ACTION);
        equal = equal && lua_rawequal(L, -1, -2);
    }
    lua_pushboolean(L, equal);
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
    else if (strcmp(key, "kit") == 0)
        lua_pushstring(L, s->row->kit);
    else if (strcmp(key, "chart") == 0)
        lua_pushboolean(L, s->chart);
    else if (strcmp(key, "parts") == 0)
        lua_getiuservalue(L, 1, DML_SPACE_PARTS);
    else if (strcmp(key, "own") == 0)
        lua_getiuservalue(L, 1, DML_SPACE_KIT);
    else if (strcmp(key, "representation") == 0)
        lua_getiuservalue(L, 1, DML_SPACE_ACTION);
    else
        return 0;
    return 1;
}

static const dml_row meta[] = {{"__tostring", space_tostring, NULL},
                               {"__eq", space_eq, NULL},
                               {NULL, NULL, NULL}};
static const dml_row functions[] =
    {{"product", dml_product,
      "dm.product(G, H, ...) -> dm.space\n"
      "The product of two or more spaces. Of groups: the group of lists {g, h, ...}, whose algebra "
      "has the vectors of the factors one after the other; of R(n), T(n), S(n): a space that a "
      "system can live on."},
     {"semidirect", dml_semidirect,
      "dm.semidirect(G, V [, action]) -> dm.space\n"
      "The semidirect product of a group G and V = dm.R(n): lists {g, v} with (g, v)(h, w) = (g h, "
      "v + g w), where g w is action(g, w), linear in w (left out: the standard one of G, matrix "
      "times vector). The algebra has that of G first, then V."},
     {"own_group", dml_own_group,
      "core.own_group(name, dimension, kit) -> dm.space\n"
      "The group whose elements and operations are those of a kit, a table of functions as "
      "dm.group makes it."},
     {NULL, NULL, NULL}};

/* dm.SO, dm.SE ...: a constructor for each row of the spaces */
static void open_spaces(lua_State *L) {
    for (const dm_space *const *row = dm_spaces; *row; row++) {
        lua_pushlightuserdata(L, (void *)(uintptr_t)*row);
        lua_pushcclosure(L, space_new, 1);
        lua_pushfstring(L, "dm.%s -> dm.space\n%s", (*row)->signature, (*row)->doc);
        dml_setdoc(L, -2, lua_tostring(L, -1));
        lua_pop(L, 1);
        lua_setfield(L, -2, (*row)->name);
    }
}

const dml_class dml_class_space = {
    .name = TNAME,
    .doc = "dm.space: a manifold or group, made by dm.R(n), dm.T(n), dm.S(n), dm.SO(n), dm.SE(n), "
           "dm.SL(n), dm.GL(n), dm.Sp(n), dm.SU(2), dm.Heisenberg(n), dm.product, dm.semidirect, "
           "dm.group\n"
           "fields: name, n, dimension, chart (can a system live on it with these coordinates), "
           "parts (of a product)",
    .meta = meta,
    .field = space_field,
    .functions = functions,
    .open = open_spaces,
};

/* Fields have more values than dm.R allows. */
void dml_push_rn(lua_State *L, uint32_t n) {
    dml_pushspace(L, &dm_space_rn, n);
}
