/* bind_sparse.c - `dm.sparse`: sparse matrices of numbers, on which operators of meshes stand. */
#include "bind/dec/bind_sparse.h"
#include "bind/value/array.h"

#include <math.h>
#include <string.h>

/* ---- making and reading ---- */

const dm_sparse *dml_checksparse(lua_State *L, int arg) {
    return luaL_checkudata(L, arg, DML_SPARSE);
}

dm_sparse *dml_newsparse(lua_State *L, dm_arena **arena) {
    dm_sparse *A = lua_newuserdatauv(L, sizeof *A, 1);
    *A = (dm_sparse){.rows = 0};
    *arena = dml_pusharena(L);
    return A;
}

void dml_sparsedone(lua_State *L, dm_status status) {
    dm_arena *arena = lua_touserdata(L, -1);
    if (status == DM_STOPPED) dml_checkstop(L);
    if (status == DM_TOO_LARGE) luaL_error(L, "a sparse matrix of more than 2^31 entries");
    if (status != DM_OK) luaL_error(L, "a sparse matrix: %s", dm_status_text(status));
    if (arena->scratch) dm_arena_release(arena->scratch);
    lua_setiuservalue(L, -2, 1);
    luaL_setmetatable(L, DML_SPARSE);
}

const double *dml_numbersat(lua_State *L, int arg, const char *name, int32_t n) {
    const dml_array *a = dml_toarray(L, arg, 1);
    const double *x = a && dml_size(a) == (uint32_t)n ? dml_numbersof(a) : NULL;
    for (int32_t i = 0; x && i < n; i++)
        if (!isfinite(x[i])) x = NULL;
    if (x) return x;
    double *copy = lua_newuserdatauv(L, ((size_t)n + 1) * sizeof *copy, 0);
    dml_vectorarg(L, arg, name, copy, (uint32_t)n);
    return copy;
}

/* 1 where a number of the list at arg is not 0, NULL for nil; pushed */
static const unsigned char *marks_at(lua_State *L, int arg, int32_t n) {
    if (lua_isnoneornil(L, arg)) return NULL;
    const double *x = dml_numbersat(L, arg, "the marks of what is kept", n);
    unsigned char *mark = lua_newuserdatauv(L, (size_t)n + 1, 0);
    for (int32_t i = 0; i < n; i++) mark[i] = x[i] != 0.0;
    return mark;
}

/* one index from 1 to n of a list */
static int32_t index_at(lua_State *L, int list, lua_Integer i, int32_t n) {
    int whole = 0;
    lua_geti(L, list, i);
    const lua_Integer x = dml_tointegerx(L, -1, &whole);
    if (!whole || x < 1 || x > n)
        luaL_error(L, "entry %I of list %d must be a whole number from 1 to %d", i, list - 2,
                   (int)n);
    lua_pop(L, 1);
    return (int32_t)(x - 1);
}

/* core.sparse(rows, columns, {i}, {j}, {x}) */
static int sparse_new(lua_State *L) {
    dm_arena *arena;
    const lua_Integer rows = dml_checkinteger(L, 1), columns = dml_checkinteger(L, 2);
    luaL_argcheck(L, rows >= 0 && rows < INT32_MAX, 1, "a count of rows is needed");
    luaL_argcheck(L, columns >= 0 && columns < INT32_MAX, 2, "a count of columns is needed");
    for (int arg = 3; arg <= 5; arg++)
        luaL_checktype(L, arg, arg < 5 ? LUA_TTABLE : lua_type(L, 5));
    lua_settop(L, 5);
    const long count = dml_length(L, 5);
    if (count < 0 || luaL_len(L, 3) != count || luaL_len(L, 4) != count)
        luaL_error(L, "the lists of rows, columns and entries have different lengths");
    const double *x = dml_numbersat(L, 5, "the entries", (int32_t)count);
    int32_t *row = lua_newuserdatauv(L, ((size_t)count + 1) * sizeof *row, 0);
    int32_t *column = lua_newuserdatauv(L, ((size_t)count + 1) * sizeof *column, 0);
    for (long p = 0; p < count; p++) {
        row[p] = index_at(L, 3, p + 1, (int32_t)rows);
        column[p] = index_at(L, 4, p + 1, (int32_t)columns);
    }
    dm_sparse *A = dml_newsparse(L, &arena);
    dml_sparsedone(L, dm_sparse_assemble(A, arena, (int32_t)rows, (int32_t)columns, count, row,
                                         column, x));
    return 1;
}

/* ---- of one matrix ---- */

/* Methods: the matrix at 1, a new one is made; nothing changes one that is there. */
static int sparse_transpose(lua_State *L) {
    dm_arena *arena;
    const dm_sparse *A = dml_checksparse(L, 1);
    dm_sparse *T = dml_newsparse(L, &arena);
    dml_sparsedone(L, dm_sparse_transpose(T, arena, A));
    return 1;
}

/* A^T diag(w) A */
static int sparse_gram(lua_State *L) {
    dm_arena *arena;
    const dm_sparse *A = dml_checksparse(L, 1);
    const double *w = dml_numbersat(L, 2, "the weights of the rows", A->rows);
    dm_sparse *out = dml_newsparse(L, &arena);
    dml_sparsedone(L, dm_sparse_gram(out, arena, A, w, &dml_stop));
    return 1;
}

/* diag(left) A diag(right) */
static int sparse_scale(lua_State *L) {
    dm_arena *arena;
    const dm_sparse *A = dml_checksparse(L, 1);
    lua_settop(L, 3);
    const double *left =
        lua_isnil(L, 2) ? NULL : dml_numbersat(L, 2, "the factors of the rows", A->rows);
    const double *right =
        lua_isnil(L, 3) ? NULL : dml_numbersat(L, 3, "the factors of the columns", A->columns);
    dm_sparse *out = dml_newsparse(L, &arena);
    dml_sparsedone(L, dm_sparse_scaled(out, arena, A, left, right));
    return 1;
}

/* the rows and columns with marks */
static int sparse_pick(lua_State *L) {
    dm_arena *arena;
    const dm_sparse *A = dml_checksparse(L, 1);
    lua_settop(L, 3);
    const unsigned char *row = marks_at(L, 2, A->rows), *column = marks_at(L, 3, A->columns);
    dm_sparse *out = dml_newsparse(L, &arena);
    dml_sparsedone(L, dm_sparse_pick(out, arena, A, row, column));
    return 1;
}

/* {{diag(r), -A^T}, {-A, 0}} */
static int sparse_saddle(lua_State *L) {
    dm_arena *arena;
    const dm_sparse *A = dml_checksparse(L, 1);
    const double *r = dml_numbersat(L, 2, "the diagonal", A->columns);
    dm_sparse *out = dml_newsparse(L, &arena);
    dml_sparsedone(L, dm_sparse_saddle(out, arena, r, A));
    return 1;
}

static int sparse_diagonal(lua_State *L) {
    const dm_sparse *A = dml_checksparse(L, 1);
    double *out = dml_pushvector(L, (uint32_t)(A->rows < A->columns ? A->rows : A->columns));
    dm_sparse_diagonal(out, A);
    return 1;
}

/* of moduli: a bound of the eigenvalues */
static int sparse_row_sums(lua_State *L) {
    const dm_sparse *A = dml_checksparse(L, 1);
    double *out = dml_pushvector(L, (uint32_t)A->rows);
    for (int32_t k = 0; k < A->start[A->columns]; k++) out[A->row[k]] += fabs(A->value[k]);
    return 1;
}

/* how far from symmetric, as a share of the largest entry */
static int sparse_asymmetry(lua_State *L) {
    dm_arena *arena;
    const dm_sparse *A = dml_checksparse(L, 1);
    if (A->rows != A->columns) luaL_error(L, "the matrix is not square");
    dm_sparse *T = dml_newsparse(L, &arena);
    dml_sparsedone(L, dm_sparse_transpose(T, arena, A));
    lua_pushnumber(L, dm_sparse_asymmetry(A, T));
    return 1;
}

/* for looking at small ones: what is not stored is 0 */
static int sparse_dense(lua_State *L) {
    const dm_sparse *A = dml_checksparse(L, 1);
    if ((int64_t)A->rows * A->columns > 1 << 24)
        luaL_error(L, "a dense matrix of %d rows and %d columns is too large to write out",
                   (int)A->rows, (int)A->columns);
    double *out = dml_pushmatrix(L, (uint32_t)A->rows, (uint32_t)A->columns);
    for (int32_t j = 0; j < A->columns; j++)
        for (int32_t p = A->start[j]; p < A->start[j + 1]; p++)
            out[(size_t)A->row[p] * (size_t)A->columns + (size_t)j] = A->value[p];
    return 1;
}

/* stored entries may be 0 where a script gave them so; nonzeros counts the others */
static int sparse_field(lua_State *L) {
    const dm_sparse *A = dml_checksparse(L, 1);
    const char *key = luaL_checkstring(L, 2);
    int32_t nonzeros = 0;
    if (strcmp(key, "rows") == 0) {
        lua_pushinteger(L, A->rows);
    } else if (strcmp(key, "columns") == 0) {
        lua_pushinteger(L, A->columns);
    } else if (strcmp(key, "nonzeros") == 0) {
        for (int32_t p = 0; p < A->start[A->columns]; p++) nonzeros += A->value[p] != 0.0;
        lua_pushinteger(L, nonzeros);
    } else {
        return 0;
    }
    return 1;
}

/* ---- of two ---- */

/* every column times the factor */
static int times_number(lua_State *L, const dm_sparse *A, double factor) {
    dm_arena *arena;
    double *factors = lua_newuserdatauv(L, ((size_t)A->columns + 1) * sizeof *factors, 0);
    for (int32_t j = 0; j < A->columns; j++) factors[j] = factor;
    dm_sparse *out = dml_newsparse(L, &arena);
    dml_sparsedone(L, dm_sparse_scaled(out, arena, A, NULL, factors));
    return 1;
}

/* A * B, A * x, A * number and number * A */
static int sparse_mul(lua_State *L) {
    dm_arena *arena;
    if (lua_type(L, 1) == LUA_TNUMBER)
        return times_number(L, dml_checksparse(L, 2), lua_tonumber(L, 1));
    const dm_sparse *A = dml_checksparse(L, 1), *B = luaL_testudata(L, 2, DML_SPARSE);
    if (lua_type(L, 2) == LUA_TNUMBER) return times_number(L, A, lua_tonumber(L, 2));
    if (!B) {
        const double *x = dml_numbersat(L, 2, "the vector", A->columns);
        dm_sparse_apply(dml_pushvector(L, (uint32_t)A->rows), A, x);
        return 1;
    }
    if (A->columns != B->rows)
        luaL_error(L, "the product of a %d x %d and a %d x %d matrix", (int)A->rows,
                   (int)A->columns, (int)B->rows, (int)B->columns);
    dm_sparse *out = dml_newsparse(L, &arena);
    dml_sparsedone(L, dm_sparse_product(out, arena, A, B, &dml_stop));
    return 1;
}

/* A + factor B */
static int combine(lua_State *L, double factor) {
    dm_arena *arena;
    const dm_sparse *A = dml_checksparse(L, 1), *B = dml_checksparse(L, 2);
    if (A->rows != B->rows || A->columns != B->columns)
        luaL_error(L, "the sum of a %d x %d and a %d x %d matrix", (int)A->rows, (int)A->columns,
                   (int)B->rows, (int)B->columns);
    dm_sparse *out = dml_newsparse(L, &arena);
    dml_sparsedone(L, dm_sparse_sum(out, arena, 1.0, A, factor, B));
    return 1;
}

/* metamethods: both are matrices, or dml_checksparse names what is not */
static int sparse_add(lua_State *L) {
    return combine(L, 1.0);
}

static int sparse_sub(lua_State *L) {
    return combine(L, -1.0);
}

static int sparse_text(lua_State *L) {
    const dm_sparse *A = dml_checksparse(L, 1);
    lua_pushfstring(L, "sparse matrix, %d x %d, %d entries", (int)A->rows, (int)A->columns,
                    (int)A->start[A->columns]);
    return 1;
}

/* ---- parts of vectors ---- */

/* core.constant(n, x) */
static int vector_constant(lua_State *L) {
    const lua_Integer n = dml_checkinteger(L, 1);
    const double x = dml_checknumber(L, 2);
    luaL_argcheck(L, n >= 0 && n < INT32_MAX, 1, "a count is needed");
    double *out = dml_pushvector(L, (uint32_t)n);
    for (lua_Integer i = 0; i < n; i++) out[i] = x;
    return 1;
}

/* core.pick(x, marks) */
/* How many are marked is counted first: the result is made in its final size. */
static int vector_pick(lua_State *L) {
    const long n = dml_length(L, 1);
    luaL_argcheck(L, n >= 0 && n < INT32_MAX, 1, "a vector is needed");
    lua_settop(L, 2);
    const double *x = dml_numbersat(L, 1, "the vector", (int32_t)n);
    const double *mark = dml_numbersat(L, 2, "the marks", (int32_t)n);
    uint32_t count = 0, to = 0;
    for (long i = 0; i < n; i++) count += mark[i] != 0.0;
    double *out = dml_pushvector(L, count);
    for (long i = 0; i < n; i++)
        if (mark[i] != 0.0) out[to++] = x[i];
    return 1;
}

/* core.spread(x, marks, rest) */
static int vector_spread(lua_State *L) {
    const long n = dml_length(L, 2);
    luaL_argcheck(L, n >= 0 && n < INT32_MAX, 2, "a vector is needed");
    lua_settop(L, 3);
    const double *mark = dml_numbersat(L, 2, "the marks", (int32_t)n);
    int32_t count = 0, from = 0;
    for (long i = 0; i < n; i++) count += mark[i] != 0.0;
    const double *x = dml_numbersat(L, 1, "the vector", count);
    const double *rest =
        lua_isnil(L, 3) ? NULL : dml_numbersat(L, 3, "what stands elsewhere", (int32_t)n);
    double *out = dml_pushvector(L, (uint32_t)n);
    for (long i = 0; i < n; i++) out[i] = mark[i] != 0.0 ? x[from++] : rest ? rest[i] : 0.0;
    return 1;
}

static const dml_row methods[] =
    {{"transpose", sparse_transpose, "A:transpose() -> dm.sparse\nThe transpose."},
     {"gram", sparse_gram,
      "A:gram(w) -> dm.sparse\nA^T diag(w) A, w a number for every row: the matrix of a weighted "
      "sum of squares."},
     {"scale", sparse_scale,
      "A:scale(left, right) -> dm.sparse\ndiag(left) A diag(right); nil stands for ones."},
     {"pick", sparse_pick,
      "A:pick(rows, columns) -> dm.sparse\n"
      "The rows and columns whose marks, a number each, are not 0; nil keeps all."},
     {"saddle", sparse_saddle,
      "A:saddle(r) -> dm.sparse\n"
      "{{diag(r), -A^T}, {-A, 0}}: of r x = A^T y with A x given."},
     {"diagonal", sparse_diagonal, "A:diagonal() -> dm.vector\nThe diagonal."},
     {"row_sums", sparse_row_sums,
      "A:row_sums() -> dm.vector\nThe sum of the moduli of the entries of every row."},
     {"asymmetry", sparse_asymmetry,
      "A:asymmetry() -> number\nThe largest |A - A^T| over the largest |entry|."},
     {"dense", sparse_dense, "A:dense() -> dm.matrix\nAll entries; raises above 2^24 of them."},
     {NULL, NULL, NULL}};

static const dml_row meta[] = {{"__mul", sparse_mul, NULL},
                               {"__add", sparse_add, NULL},
                               {"__sub", sparse_sub, NULL},
                               {"__tostring", sparse_text, NULL},
                               {NULL, NULL, NULL}};

static const dml_row functions[] =
    {{"sparse", sparse_new,
      "core.sparse(rows, columns, {i}, {j}, {x}) -> dm.sparse\n"
      "The matrix with the sums of entries x at (i, j), from 1. Raises on indices out of range."},
     {"constant", vector_constant, "core.constant(n, x) -> dm.vector\nn entries that are all x."},
     {"pick", vector_pick,
      "core.pick(x, marks) -> dm.vector\nThe entries of x whose mark is not 0, in their order."},
     {"spread", vector_spread,
      "core.spread(x, marks [, rest]) -> dm.vector\n"
      "The entries of x where marks are not 0, in their order; elsewhere those of rest, or 0."},
     {NULL, NULL, NULL}};

const dml_class dml_class_sparse = {
    .name = DML_SPARSE,
    .doc = "dm.sparse: a sparse matrix of numbers, the A.matrix of a dm.operator\n"
           "fields: rows, columns, nonzeros (entries that are not 0); A * x, A * B, A + B, A - B, "
           "number * A",
    .meta = meta,
    .methods = methods,
    .field = sparse_field,
    .functions = functions,
};
