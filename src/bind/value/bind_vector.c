/* bind_vector.c - `dm.vector`: entries from 1; numbers, symbols and hyper-dual numbers
 * alike. */
#include "bind/core/missing_key.h"
#include "bind/core/state.h"
#include "bind/value/array.h"

#include <float.h>
#include <math.h>
#include <string.h>

#define TNAME "dm.vector"
static const dml_scalar zero = {.kind = DML_NUMBER};

static dml_array *check(lua_State *L) {
    return dml_checkarray(L, 1, 1);
}

/* the vector or table at arg, of the length of a */
static const dml_array *same_length(lua_State *L, const dml_array *a, int arg) {
    const dml_array *b = dml_vectorat(L, arg);
    if (b->rows != a->rows)
        luaL_error(L, "the vectors have %d and %d entries", (int)a->rows, (int)b->rows);
    return b;
}

/* ---- making one ---- */

/* Entries of a new vector of zeros. */
static uint32_t check_length(lua_State *L, int arg) {
    const lua_Integer n = dml_checkinteger(L, arg);
    luaL_argcheck(L, n >= 0 && n <= 1 << 28, arg, "a length from 0 to 2^28 expected");
    return (uint32_t)n;
}

/* n entries from the one `first` on, of any kind. */
static int copy(lua_State *L, const dml_array *a, uint32_t first, uint32_t n) {
    const dml_scalar kind = dml_kindof(a);
    dml_array *out = dml_newarray(L, 1, n, 1, &kind);
    const double *numbers = dml_numbersof(a);
    if (numbers && n) memcpy(out->entries, numbers + first, n * sizeof *numbers);
    for (uint32_t i = 0; !numbers && i < n; i++) {
        const dml_scalar x = dml_get(a, first + i);
        dml_put(L, out, i, &x);
    }
    return 1;
}

/* A table, a vector or a number of zeros. */
static int vector_new(lua_State *L) {
    if (lua_gettop(L) > 1)
        return luaL_error(L, "dm.vector takes one table of entries, or a length: write "
                             "dm.vector{...}");
    if (lua_type(L, 1) == LUA_TNUMBER) {
        dml_newarray(L, 1, check_length(L, 1), 1, &zero);
        return 1;
    }
    const dml_array *given = dml_toarray(L, 1, 1);
    if (given) return copy(L, given, 0, given->rows);
    dml_vectorat(L, 1);
    return 1;
}

static int vector_copy(lua_State *L) {
    const dml_array *a = check(L);
    return copy(L, a, 0, a->rows);
}

static int vector_slice(lua_State *L) {
    const dml_array *a = check(L);
    const lua_Integer n = a->rows, i = dml_checkinteger(L, 2), j = dml_optinteger(L, 3, n);
    if (i < 1 || j > n || i > j + 1)
        return luaL_error(L, "slice(%I, %I) is out of range: the vector has %I entries",
                          (LUAI_UACINT)i, (LUAI_UACINT)j, (LUAI_UACINT)n);
    return copy(L, a, (uint32_t)(i - 1), (uint32_t)(j - i + 1));
}

/* ---- entries ---- */

/* index at arg as 0 .. limit-1 */
static uint32_t check_index(lua_State *L, int arg, uint32_t limit) {
    int whole;
    const lua_Integer i = lua_tointegerx(L, arg, &whole);
    if (dml_classof(L, arg) == DML_CLASS_SYMBOL)
        luaL_error(L, "a symbol cannot be an index: it has no value while a function is traced");
    if (!whole || lua_type(L, arg) != LUA_TNUMBER)
        luaL_error(L, "an index must be a whole number, got %s", luaL_tolstring(L, arg, NULL));
    if (i < 1 || i > (lua_Integer)limit)
        luaL_error(L, "index %I is out of range: the vector has %d entries", (LUAI_UACINT)i,
                   (int)limit);
    return (uint32_t)(i - 1);
}

/* v[i] from 1; anything else is a method. Beyond the end it is nil, so that ipairs ends. */
static int vector_field(lua_State *L) {
    const dml_array *a = check(L);
    if (lua_isinteger(L, 2)) {
        const lua_Unsigned i = (lua_Unsigned)lua_tointeger(L, 2) - 1;
        const dml_scalar x = i < a->rows ? dml_get(a, (uint32_t)i) : zero;
        if (i < a->rows) return dml_pushscalar(L, &x), 1;
    }
    if (lua_type(L, 2) == LUA_TSTRING) return 0;
    if (lua_type(L, 2) == LUA_TNUMBER && lua_tointeger(L, 2) == (lua_Integer)a->rows + 1) {
        lua_pushfstring(L, "a vector of %d", (int)a->rows);
        dml_miss(L, 1, lua_tostring(L, -1), 2);
        lua_pushnil(L); /* one past the end: ipairs stops here */
        return 1;
    }
    const dml_scalar x = dml_get(a, check_index(L, 2, a->rows));
    dml_pushscalar(L, &x);
    return 1;
}

/* Entries may be of a higher kind than those there are: then all are lifted. */
static int vector_set(lua_State *L) {
    const dml_array *a = check(L);
    dml_scalar x;
    const uint32_t i = check_index(L, 2, a->rows);
    if (!dml_toscalar(L, 3, &x))
        return luaL_error(L, "an entry must be a number, got %s", luaL_typename(L, 3));
    dml_check_own(L, a);
    dml_assign(L, 1, i, &x);
    return 0;
}

static int vector_len(lua_State *L) {
    lua_pushinteger(L, check(L)->rows);
    return 1;
}

/* ---- products and sums ---- */

/* See dml_inner for the order of the sum. */
static int vector_dot(lua_State *L) {
    const dml_array *a = check(L), *b = same_length(L, a, 2);
    const dml_scalar sum = dml_inner(L, (dml_run){a, 0, 1}, (dml_run){b, 0, 1}, a->rows);
    dml_pushscalar(L, &sum);
    return 1;
}

/* sqrt(sum x^2), scaled only where the plain sum overflows or loses its digits */
static double norm_of_numbers(const double *x, uint32_t n) {
    double sum = 0, largest = 0;
    for (uint32_t i = 0; i < n; i++) sum += x[i] * x[i];
    if (sum >= DBL_MIN / DBL_EPSILON && sum <= DBL_MAX) return sqrt(sum);
    for (uint32_t i = 0; i < n; i++) largest = fmax(largest, fabs(x[i]));
    if (!(largest > 0) || !isfinite(largest) || isnan(sum)) return sqrt(sum);
    sum = 0;
    for (uint32_t i = 0; i < n; i++) sum += (x[i] / largest) * (x[i] / largest);
    return largest * sqrt(sum);
}

/* Of numbers without overflow; of symbols the root of the sum of squares. */
static int vector_norm(lua_State *L) {
    const dml_array *a = check(L);
    const double *numbers = dml_numbersof(a);
    if (numbers) {
        lua_pushnumber(L, norm_of_numbers(numbers, a->rows));
        return 1;
    }
    const dml_run run = {a, 0, 1};
    dml_scalar norm = dml_inner(L, run, run, a->rows);
    norm = dml_apply(L, DM_OP_SQRT, &norm, NULL, NULL);
    dml_pushscalar(L, &norm);
    return 1;
}

static int vector_sum(lua_State *L) {
    const dml_array *a = check(L);
    dml_scalar sum = a->rows ? dml_get(a, 0) : zero;
    for (uint32_t i = 1; i < a->rows; i++) {
        const dml_scalar x = dml_get(a, i);
        sum = dml_apply(L, DM_OP_ADD, &sum, &x, NULL);
    }
    dml_pushscalar(L, &sum);
    return 1;
}

/* a_i b_j - a_j b_i */
static dml_scalar minor(lua_State *L, const dml_array *a, const dml_array *b, uint32_t i,
                        uint32_t j) {
    const dml_scalar ai = dml_get(a, i), aj = dml_get(a, j), bi = dml_get(b, i), bj = dml_get(b, j);
    const dml_scalar plus = dml_apply(L, DM_OP_MUL, &ai, &bj, NULL);
    const dml_scalar minus = dml_apply(L, DM_OP_MUL, &aj, &bi, NULL);
    return dml_apply(L, DM_OP_SUB, &plus, &minus, NULL);
}

/* In the plane the one number that is left of it. */
static int vector_cross(lua_State *L) {
    const dml_array *a = check(L), *b = same_length(L, a, 2);
    if (a->rows == 2) {
        const dml_scalar z = minor(L, a, b, 0, 1);
        dml_pushscalar(L, &z);
        return 1;
    }
    if (a->rows != 3)
        return luaL_error(L, "cross needs vectors of 2 or 3 entries (got %d)", (int)a->rows);
    const dml_scalar c[3] = {minor(L, a, b, 1, 2), minor(L, a, b, 2, 0), minor(L, a, b, 0, 1)};
    dml_pushscalars(L, c, 3);
    return 1;
}

static int vector_outer(lua_State *L) {
    const dml_array *a = check(L), *b = dml_vectorat(L, 2);
    const dml_scalar ka = dml_kindof(a), kb = dml_kindof(b), kind = dml_common(L, &ka, &kb);
    dml_array *m = dml_newarray(L, 2, a->rows, b->rows, &kind);
    for (uint32_t i = 0; i < a->rows; i++)
        for (uint32_t j = 0; j < b->rows; j++) {
            const dml_scalar x = dml_get(a, i), y = dml_get(b, j);
            const dml_scalar z = dml_apply(L, DM_OP_MUL, &x, &y, NULL);
            dml_put(L, m, i * b->rows + j, &z);
        }
    return 1;
}

/* f sees the entry and its number; results may be of any kind. */
static int vector_map(lua_State *L) {
    const dml_array *a = check(L);
    lua_settop(L, 2);
    if (!lua_isfunction(L, 2) && (lua_isnumber(L, 2) || !luaL_getmetafield(L, 2, "__call")))
        luaL_typeerror(L, 2, "function"); /* numbers: see bind/dec/mesh_euler.c */
    lua_settop(L, 2);
    dml_newarray(L, 1, a->rows, 1, &zero);
    const int with_place = lua_type(L, 2) == LUA_TFUNCTION && !lua_iscfunction(L, 2);
    for (uint32_t i = 0; i < a->rows; i++) {
        const dml_scalar x = dml_get(a, i);
        dml_scalar y;
        lua_pushvalue(L, 2);
        dml_pushscalar(L, &x);
        if (with_place) lua_pushinteger(L, (lua_Integer)i + 1);
        dml_callone(L, 1 + with_place, "map: the function");
        if (!dml_toscalar(L, -1, &y))
            return luaL_error(L, "map: the function must return a number (got %s for entry %d)",
                              luaL_typename(L, -1), (int)i + 1);
        dml_assign(L, 3, i, &y);
        lua_pop(L, 1);
    }
    return 1;
}

static int vector_totable(lua_State *L) {
    const dml_array *a = check(L);
    lua_createtable(L, (int)a->rows, 0);
    for (uint32_t i = 0; i < a->rows; i++) {
        const dml_scalar x = dml_get(a, i);
        dml_pushscalar(L, &x);
        lua_rawseti(L, -2, (lua_Integer)i + 1);
    }
    return 1;
}

/* Shape and values; symbols have no value to compare, and raise. */
int dml_equal(lua_State *L) {
    const int rank = dml_toarray(L, 1, 1) ? 1 : 2;
    const dml_array *a = dml_toarray(L, 1, rank), *b = dml_toarray(L, 2, rank);
    int equal = a && b && a->rows == b->rows && a->columns == b->columns;
    for (uint32_t i = 0; equal && i < dml_size(a); i++) {
        const dml_scalar x = dml_get(a, i), y = dml_get(b, i);
        if (x.kind == DML_SYMBOL || y.kind == DML_SYMBOL)
            return luaL_error(L,
                              "== met symbols while a function is traced: use dm.where(c, a, b)");
        equal = (x.kind ? x.as.hyper.f : x.as.number) == (y.kind ? y.as.hyper.f : y.as.number);
    }
    lua_pushboolean(L, equal);
    return 1;
}

static const dml_row meta[] = {DML_ARITHMETIC,
                               {"__eq", dml_equal, NULL},
                               {"__len", vector_len, NULL},
                               {"__newindex", vector_set, NULL},
                               {"__tostring", dml_vectortext, NULL},
                               {NULL, NULL, NULL}};
static const dml_row methods[] =
    {{"dot", vector_dot,
      "v:dot(w) -> number\n"
      "The inner product of two vectors of the same length. Raises when the lengths differ."},
     {"norm", vector_norm, "v:norm() -> number\nThe Euclidean norm sqrt(v . v), without overflow."},
     {"cross", vector_cross,
      "v:cross(w) -> dm.vector or number\n"
      "The cross product of two vectors of 3 entries; of 2 entries the number v1 w2 - v2 w1. "
      "Raises for other lengths."},
     {"outer", vector_outer, "v:outer(w) -> dm.matrix\nThe matrix v_i w_j, #v x #w."},
     {"sum", vector_sum, "v:sum() -> number\nThe sum of the entries."},
     {"map", vector_map,
      "v:map(f) -> dm.vector\n"
      "A new vector of f(v[i], i), or f(v[i]) of a function written in C, as those of math and dm "
      "are. Raises when f returns no number."},
     {"slice", vector_slice,
      "v:slice(i [, j]) -> dm.vector\n"
      "A copy of the entries i to j (the last one when left out). Raises when they are out of "
      "range."},
     {"copy", vector_copy, "v:copy() -> dm.vector\nA new vector with the same entries."},
     {"totable", vector_totable, "v:totable() -> table\nThe entries as a Lua table."},
     {NULL, NULL, NULL}};
/* the table, vector or matrix at 1 is handed out to be read */
static int locked(lua_State *L) {
    const char *what = luaL_checkstring(L, 2);
    luaL_checkany(L, 1);
    lua_pushvalue(L, 1);
    if (lua_istable(L, -1))
        dml_lock(L, what);
    else
        dml_mark_copy(L);
    return 1;
}

static int unlocked(lua_State *L) {
    lua_settop(L, 1);
    dml_unlock(L, 1);
    return 1;
}

static const dml_row functions[] =
    {{"vector", vector_new,
      "dm.vector{x1, x2, ...} -> dm.vector\n"
      "A vector of the entries of a table or another vector; dm.vector(n) has n zeros. Entries are "
      "numbers, or symbols and hyper-dual numbers inside a traced function. + - * / work with "
      "vectors and numbers; tables of numbers are taken as vectors; v[i] counts from 1. Raises "
      "when an entry is no number."},
     {"locked", locked,
      "core.locked(x, what) -> x\n"
      "x as what an object hands out and would not see change: a vector or a matrix whose entries "
      "cannot be set from now on, or in the place of a table what reads as it does; `what` it is, "
      "of the message. It is no table: next(x) raises."},
     {"unlocked", unlocked,
      "core.unlocked(x) -> x\n"
      "A table with the entries of what core.locked put in the place of one; anything else as it "
      "is."},
     {NULL, NULL, NULL}};

static void open_vector(lua_State *L) {
    dml_setclass(L, DML_CLASS_VECTOR, TNAME);
}

const dml_class dml_class_vector = {
    .name = TNAME,
    .doc = "dm.vector: entries in one block, made by dm.vector{...} or dm.zeros(n)\n"
           "v[i] from 1, #v, + - * / with vectors and numbers, == entry by entry",
    .meta = meta,
    .methods = methods,
    .field = vector_field,
    .functions = functions,
    .open = open_vector,
};
