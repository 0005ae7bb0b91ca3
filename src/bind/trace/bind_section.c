/* bind_section.c - core.section: the level set of a cross-section, its angle with the orbits of a
 * group, and the folds where that changes its sign (level/level.h, level/folds.h). */
#include "bind/core/bind.h"
#include "bind/trace/function.h"
#include "bind/value/array.h"
#include "level/folds.h"

#include <math.h>
#include <string.h>

#define SECTION "dm.level_set"
enum { ARENA = 1, INSIDE, VALUES };

/* inside: of dm_level_function conditions, which must be > 0; NULL: a function of Lua, or none */
typedef struct {
    dm_level level;
    dml_function *conditions;
    int has_function;
} section;

static section *check(lua_State *L) {
    return luaL_checkudata(L, 1, SECTION);
}

static dm_level_function traced(const dml_function *f) {
    return (dm_level_function){f->graph, f->parts[DML_VALUE].nodes, f->inputs, dml_outputs(f)};
}

/* (F, moved, inside) -> section */
static int new (lua_State *L) {
    const dm_level_function F = traced(luaL_checkudata(L, 1, DML_FUNCTION)),
                            moved = traced(luaL_checkudata(L, 2, DML_FUNCTION));
    luaL_argcheck(L, moved.inputs > F.inputs && moved.outputs == F.inputs, 2,
                  "a function (y, x) -> x expected");
    luaL_argcheck(L, moved.inputs - F.inputs <= F.outputs, 2,
                  "at most as many y as equations expected");
    luaL_argcheck(L, F.outputs <= F.inputs, 1, "no more equations than entries of x expected");
    lua_settop(L, 3);
    section *s = lua_newuserdatauv(L, sizeof *s, VALUES - 1);
    *s = (section){.conditions = luaL_testudata(L, 3, DML_FUNCTION)};
    s->has_function = !s->conditions && !lua_isnil(L, 3);
    dm_arena *arena = dml_pusharena(L);
    lua_setiuservalue(L, 4, ARENA);
    lua_pushvalue(L, 3);
    lua_setiuservalue(L, 4, INSIDE);
    const dm_level_function inside =
        s->conditions ? traced(s->conditions) : (dm_level_function){.graph = NULL};
    luaL_argcheck(L, !s->conditions || inside.inputs == F.inputs, 3, "a function of x expected");
    const dm_status status =
        dm_level_build(&s->level, &F, &moved, s->conditions ? &inside : NULL, arena);
    if (status != DM_OK) return luaL_error(L, "the section: %s", dm_status_text(status));
    luaL_setmetatable(L, SECTION);
    return 1;
}

/* do the conditions hold at x? The section is at stack index 1 */
static int is_inside(void *ud, const double *x) {
    lua_State *L = ud;
    const section *s = lua_touserdata(L, 1);
    const uint32_t n = s->level.n;
    int is = 1;
    if (s->conditions) {
        const double *value = dml_function_values(L, s->conditions, x);
        for (uint32_t i = 0; i < dml_outputs(s->conditions); i++) is &= value[i] > 0;
    } else if (s->has_function) {
        lua_getiuservalue(L, 1, INSIDE);
        memcpy(dml_pushvector(L, n), x, n * sizeof *x);
        lua_call(L, 1, 1);
        is = lua_toboolean(L, -1);
        lua_pop(L, 1);
    }
    return is;
}

static void push_point(lua_State *L, const double *x, uint32_t n) {
    memcpy(dml_pushvector(L, n), x, n * sizeof *x);
}

/* (section, x, step) -> x, sine, inside or nothing */
static int node(lua_State *L) {
    section *s = check(L);
    const uint32_t n = s->level.n;
    double *x = dml_pushvector(L, n);
    dml_vectorarg(L, 2, "x", x, n);
    if (!dm_level_bring(&s->level, x, dml_checknumber(L, 3))) return 0;
    const double sine = dm_level_sine(&s->level, NULL);
    if (!isfinite(sine)) return 0;
    lua_pushnumber(L, sine);
    lua_pushboolean(L, is_inside(L, x));
    return 3;
}

/* D J psi (r x r) at x on top, behind it r numbers: D; their places are told. The condition. */
static double cut_at(lua_State *L, section *s, int at, double **A, double **inverse,
                     double **unit) {
    const uint32_t n = s->level.n, r = s->level.r;
    double condition;
    double *x = lua_newuserdatauv(L, (n + r + (size_t)r * r) * sizeof *x, 0);
    *unit = x + n, *inverse = x + n + r;
    dml_vectorarg(L, at, "x", x, n);
    *A = dml_pushmatrix(L, r, r);
    if (!dm_level_cut(&s->level, x, *A, *inverse, *unit, &condition))
        luaL_error(L, "the section or the action has no finite derivative there");
    return condition;
}

/* (section, x) -> J psi, condition */
static int cut(lua_State *L) {
    section *s = check(L);
    const uint32_t r = s->level.r;
    double *A, *inverse, *unit;
    const double condition = cut_at(L, s, 2, &A, &inverse, &unit);
    for (uint32_t i = 0; i < r * r; i++) A[i] /= unit[i / r];
    lua_pushnumber(L, condition);
    return 2;
}

/* (section, x, Z) -> distance, condition, |(J psi)^-1| */
static int distance(lua_State *L) {
    section *s = check(L);
    const uint32_t r = s->level.r;
    double *A, *inverse, *unit, off = 0, size = 0;
    const double condition = cut_at(L, s, 2, &A, &inverse, &unit);
    dml_vectorarg(L, 3, "Z", A, r);
    for (uint32_t i = 0; i < r; i++) {
        double sum = 0;
        for (uint32_t j = 0; j < r; j++) {
            const double b = inverse[i * r + j] * unit[j];
            sum += b * A[j], size += b * b;
        }
        off += sum * sum;
    }
    lua_pushnumber(L, isfinite(condition) ? sqrt(off) : INFINITY);
    lua_pushnumber(L, condition);
    lua_pushnumber(L, isfinite(condition) ? sqrt(size) : INFINITY);
    return 3;
}

/* (section, x, i, w) -> y or nothing. Row i of J psi becomes that of Z_i / |w|: less Z_i w / |w|^2,
 * a change of rank one. */
static int deflated(lua_State *L) {
    section *s = check(L);
    const uint32_t r = s->level.r;
    double *A, *inverse, *unit, square = 0, along_p = 0, along_q = 0;
    const double condition = cut_at(L, s, 2, &A, &inverse, &unit);
    const lua_Integer i = dml_checkinteger(L, 3) - 1;
    luaL_argcheck(L, i >= 0 && i < r, 3, "no such equation");
    double *w = lua_newuserdatauv(L, 2 * (size_t)r * sizeof *w, 0), *p = w + r;
    dml_vectorarg(L, 4, "w", w, r);
    if (!isfinite(condition)) return 0;
    for (uint32_t k = 0; k < r; k++) {
        double sum = 0;
        for (uint32_t j = 0; j < r; j++)
            sum += inverse[k * r + j] * unit[j] * (s->level.value[j] - 1);
        p[k] = sum, square += w[k] * w[k];
        along_p += w[k] * sum, along_q += w[k] * inverse[k * r + (uint32_t)i] * unit[i];
    }
    const double rate = (s->level.value[i] - 1) / square;
    double *y = dml_pushvector(L, r);
    for (uint32_t k = 0; k < r; k++)
        y[k] =
            -p[k] - inverse[k * r + (uint32_t)i] * unit[i] * rate * along_p / (1 - rate * along_q);
    return 1;
}

/* (section, x, goal) -> y or nothing */
static int approach(lua_State *L) {
    section *s = check(L);
    const uint32_t n = s->level.n;
    double *x = lua_newuserdatauv(L, 2 * (size_t)n * sizeof *x, 0);
    dml_vectorarg(L, 2, "x", x, n);
    dml_vectorarg(L, 3, "goal", x + n, n);
    return dm_level_approach(&s->level, x, x + n, dml_pushvector(L, s->level.r));
}

/* The list of what is found is at stack index 5: tables {a, b} or {a, b, left, left}. */
static int found(void *ud, const double *a, const double *b, const double *const left[2]) {
    lua_State *L = ud;
    const section *s = lua_touserdata(L, 1);
    const double *const points[] = {a, b, left ? left[0] : NULL, left ? left[1] : NULL};
    const lua_Integer count = (lua_Integer)lua_rawlen(L, 5) + 1;
    lua_createtable(L, 4, 0);
    for (int i = 0; i < 4 && points[i]; i++) {
        push_point(L, points[i], s->level.n);
        lua_rawseti(L, -2, i + 1);
    }
    lua_rawseti(L, 5, count);
    return count < lua_tointeger(L, 4);
}

/* (section, starts, nodes, most) -> list */
static int folds(lua_State *L) {
    section *s = check(L);
    luaL_checktype(L, 2, LUA_TTABLE);
    const uint32_t n = s->level.n, count = (uint32_t)lua_rawlen(L, 2);
    const lua_Integer nodes = dml_checkinteger(L, 3);
    dml_checkinteger(L, 4);
    luaL_argcheck(L, nodes > 0 && nodes < 1 << 20, 3, "a number of nodes expected");
    lua_settop(L, 4);
    lua_newtable(L);
    dm_arena *arena = dml_pusharena(L);
    double *x = lua_newuserdatauv(L, (n + 1) * (size_t)(count + 1) * sizeof *x, 0);
    double *step = x + (size_t)n * count;
    for (uint32_t i = 0; i < count; i++) {
        if (lua_rawgeti(L, 2, i + 1) != LUA_TTABLE) luaL_argerror(L, 2, "{ x, step } expected");
        lua_rawgeti(L, -1, 1);
        dml_vectorarg(L, lua_gettop(L), "x", x + (size_t)i * n, n);
        lua_rawgeti(L, -2, 2);
        step[i] = dml_checknumber(L, -1);
        lua_settop(L, 7);
    }
    const dm_folds how = {&s->level, is_inside, found, L, (uint32_t)nodes};
    if (dm_folds_search(&how, x, step, count, arena) != DM_OK)
        return luaL_error(L, "not enough memory");
    lua_settop(L, 5);
    dml_setresult(L);
    return 1;
}

static const dml_row methods[] =
    {{"node", node,
      "level_set:node(x, step) -> x, sine, inside   or nothing\n"
      "The point of F = 1 beside x, by Newton steps of least length, which fit a step of that "
      "length; the product of the sines of the angles of that level set with the orbits of the "
      "group, with a sign; do the conditions hold there?"},
     {"cut", cut,
      "level_set:cut(x) -> J psi, condition\n"
      "Slopes of the section at x, which need not be on it, by the generators of the action: r x "
      "r. Its condition number in the norm of Frobenius, with rows of J as long as 1, since a "
      "section may have any units; or, if that is larger, how much the frame turns for a relative "
      "change of the points, |(J psi)^-1| |J| |x|: near a fixed point psi itself vanishes. Raises "
      "where J or psi is not finite."},
     {"distance", distance,
      "level_set:distance(x, Z) -> number, condition, number\n"
      "|(J psi)^-1 Z| of the r values Z of the section at x: how far in the algebra that is, "
      "however the section is written; the condition number as of cut, and |(J psi)^-1|."},
     {"deflated", deflated,
      "level_set:deflated(x, i, w) -> dm.vector   or nothing\n"
      "Newton's step in the algebra for the section at x, of which entry i is divided by |w|: w "
      "leads from a root, which that takes away. Nothing where J psi is singular."},
     {"approach", approach,
      "level_set:approach(x, goal) -> dm.vector   or nothing\n"
      "The algebra vector that moves the point x as close to the goal as it can, to first order: y "
      "of "
      "least squares in psi y = goal - x. Nothing where the generators psi depend on each other."},
     {"folds", folds,
      "level_set:folds(starts, nodes, most) -> list\n"
      "Where the sine changes its sign along curves from the starts { { x, step } ... }, each "
      "brought to F = 1 within its step: pairs { a, b } of points beside a fold, or { a, b, c, d } "
      "where a curve leaves what is inside between c and d and comes back between a and b; at "
      "most so many of them, by about so many nodes of three kinds. F is followed with steps that "
      "fit what is narrow in it, as its graph tells. A search, not a proof."},
     {NULL, NULL, NULL}};

static const dml_row functions[] =
    {{"section", new,
      "core.section(F, moved, inside) -> dm.level_set\n"
      "The level set F = 1, F a dm.function of x whose first entries are a cross-section; moved: "
      "one of (y, x), x moved by y in the algebra of a group. inside: a dm.function of x whose "
      "entries are conditions > 0, or a function that gives true or false, or nil."},
     {NULL, NULL, NULL}};

const dml_class dml_class_section = {
    .name = SECTION,
    .doc = "dm.level_set: the points of a cross-section of orbits, made by core.section(F, moved, "
           "inside)\n"
           "What a frame looks at when it is made: how far points are from the section, how it "
           "cuts the orbits there, and where it folds.",
    .methods = methods,
    .functions = functions,
};
