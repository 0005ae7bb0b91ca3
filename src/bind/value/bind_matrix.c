/* bind_matrix.c - `dm.matrix`: rows in one block; m[i] is a view of row i. */
#include "bind/core/missing_key.h"
#include "bind/core/state.h"
#include "bind/value/matrix_solve.h"

#include <gsl/gsl_errno.h>
#include <string.h>

#define TNAME "dm.matrix"
static const dml_scalar zero = {.kind = DML_NUMBER};

static dml_array *check(lua_State *L) {
    return dml_checkarray(L, 1, 2);
}

/* ---- making one ---- */

/* A number of rows or columns. */
static uint32_t check_extent(lua_State *L, int arg) {
    const lua_Integer n = dml_checkinteger(L, arg);
    luaL_argcheck(L, n >= 1 && n <= 1 << 24, arg, "a number of rows or columns >= 1 expected");
    return (uint32_t)n;
}

/* entry j of row i, which is at stack index `row` */
static dml_scalar entry_of_row(lua_State *L, int row, uint32_t i, uint32_t j) {
    const char *type = "";
    dml_scalar x;
    if (!dml_tryentry(L, row, j, &x, &type))
        luaL_error(L, "entry %d of row %d must be a number, got %s", (int)j + 1, (int)i + 1, type);
    return x;
}

/* row i of the matrix at stack index m = the vector or table on top, which is popped */
static void set_row(lua_State *L, int m, uint32_t i) {
    const dml_array *a = lua_touserdata(L, m);
    const int row = lua_gettop(L);
    const long n = dml_length(L, row);
    if (n != (long)a->columns)
        luaL_error(L, "row %d has %d entries, but the matrix has %d columns", (int)i + 1, (int)n,
                   (int)a->columns);
    double *numbers = dml_numbersof(a);
    uint32_t j = numbers ? dml_readplain(L, row, numbers + (size_t)i * a->columns, a->columns) : 0;
    for (; j < a->columns; j++) {
        const dml_scalar x = entry_of_row(L, row, i, j);
        dml_assign(L, m, i * a->columns + j, &x);
    }
    lua_pop(L, 1);
}

/* push entry i + 1 of the table at 1, which must be a row */
static void push_row_of_table(lua_State *L, uint32_t i) {
    lua_geti(L, 1, (lua_Integer)i + 1);
    if (!lua_istable(L, -1) && !dml_toarray(L, -1, 1))
        luaL_error(L,
                   "row %d must be a table or vector of numbers (got %s): dm.matrix{{1, 2}, {3, "
                   "4}}",
                   (int)i + 1, luaL_typename(L, -1));
}

/* All rows have the length of the first; entries may be of any kind. */
static int from_rows(lua_State *L) {
    const lua_Integer n = dml_length(L, 1);
    luaL_argcheck(L, n >= 1 && n <= 1 << 24, 1,
                  "a table of rows expected: dm.matrix{{1, 2}, {3, 4}}");
    push_row_of_table(L, 0);
    const long columns = dml_length(L, -1);
    lua_pop(L, 1);
    luaL_argcheck(L, columns >= 1 && columns <= 1 << 24, 1, "the first row is empty or too long");
    dml_newarray(L, 2, (uint32_t)n, (uint32_t)columns, &zero);
    const int m = lua_gettop(L);
    for (uint32_t i = 0; i < (uint32_t)n; i++) {
        push_row_of_table(L, i);
        set_row(L, m, i);
    }
    return 1;
}

static int copy(lua_State *L, const dml_array *a) {
    const dml_scalar kind = dml_kindof(a);
    dml_array *out = dml_newarray(L, 2, a->rows, a->columns, &kind);
    for (uint32_t i = 0; i < dml_size(a); i++) {
        const dml_scalar x = dml_get(a, i);
        dml_put(L, out, i, &x);
    }
    return 1;
}

/* A table of rows, a matrix to copy, or two numbers. */
static int matrix_new(lua_State *L) {
    const dml_array *given = dml_toarray(L, 1, 2);
    if (given || dml_islist(L, 1))
        luaL_argcheck(L, lua_isnoneornil(L, 2), 2, "a surplus argument: dm.matrix(rows)");
    if (given) return copy(L, given);
    if (dml_islist(L, 1)) return from_rows(L);
    const uint32_t rows = check_extent(L, 1), columns = check_extent(L, 2);
    dml_newarray(L, 2, rows, columns, &zero);
    return 1;
}

static int zeros(lua_State *L) {
    const lua_Integer n = dml_checkinteger(L, 1);
    if (!lua_isnoneornil(L, 2)) return matrix_new(L);
    luaL_argcheck(L, n >= 0 && n <= 1 << 28, 1, "a length from 0 to 2^28 expected");
    dml_pushvector(L, (uint32_t)n);
    return 1;
}

static int identity(lua_State *L) {
    const uint32_t n = check_extent(L, 1);
    double *a = dml_pushmatrix(L, n, n);
    for (size_t i = 0; i < n; i++) a[i * n + i] = 1;
    return 1;
}

static int matrix_copy(lua_State *L) {
    return copy(L, check(L));
}

/* ---- rows, columns, entries ---- */

/* From 1; `what` is "row" or "column". */
static uint32_t check_index(lua_State *L, int arg, uint32_t limit, const char *what) {
    int whole;
    const lua_Integer i = lua_tointegerx(L, arg, &whole);
    if (!whole || lua_type(L, arg) != LUA_TNUMBER)
        luaL_error(L, "a %s is given by a whole number, got %s", what,
                   luaL_tolstring(L, arg, NULL));
    if (i < 1 || i > (lua_Integer)limit)
        luaL_error(L, "%s %I is out of range: the matrix has %d", what, (LUAI_UACINT)i, (int)limit);
    return (uint32_t)(i - 1);
}

/* m[i] is a view, so that m[i][j] = x changes the matrix. */
static int matrix_field(lua_State *L) {
    const dml_array *m = check(L);
    if (lua_type(L, 2) == LUA_TSTRING) {
        const char *key = lua_tostring(L, 2);
        const int rows = strcmp(key, "rows") == 0;
        if (!rows && strcmp(key, "columns") != 0) return 0;
        lua_pushinteger(L, rows ? m->rows : m->columns);
    } else if (lua_type(L, 2) == LUA_TNUMBER && lua_tointeger(L, 2) == (lua_Integer)m->rows + 1) {
        lua_pushfstring(L, "a matrix of %d rows", (int)m->rows);
        dml_miss(L, 1, lua_tostring(L, -1), 2);
        lua_pushnil(L); /* one past the end: ipairs stops here */
    } else {
        dml_pushrow(L, 1, check_index(L, 2, m->rows, "row"));
    }
    return 1;
}

static int matrix_set(lua_State *L) {
    const dml_array *m = check(L);
    const uint32_t i = check_index(L, 2, m->rows, "row");
    dml_check_own(L, m);
    lua_settop(L, 3);
    set_row(L, 1, i);
    return 0;
}

static int matrix_len(lua_State *L) {
    lua_pushinteger(L, check(L)->rows);
    return 1;
}

/* n entries from `first` on, `step` apart */
static int extract(lua_State *L, const dml_array *m, dml_run from, uint32_t n) {
    const dml_scalar kind = dml_kindof(m);
    dml_array *out = dml_newarray(L, 1, n, 1, &kind);
    for (uint32_t k = 0; k < n; k++) {
        const dml_scalar x = dml_get(m, from.first + k * from.step);
        dml_put(L, out, k, &x);
    }
    return 1;
}

static int matrix_row(lua_State *L) {
    const dml_array *m = check(L);
    const uint32_t i = check_index(L, 2, m->rows, "row");
    return extract(L, m, (dml_run){m, i * m->columns, 1}, m->columns);
}

static int matrix_column(lua_State *L) {
    const dml_array *m = check(L);
    const uint32_t j = check_index(L, 2, m->columns, "column");
    return extract(L, m, (dml_run){m, j, m->columns}, m->rows);
}

static int matrix_totable(lua_State *L) {
    const dml_array *m = check(L);
    lua_createtable(L, (int)m->rows, 0);
    for (uint32_t i = 0; i < m->rows; i++) {
        lua_createtable(L, (int)m->columns, 0);
        for (uint32_t j = 0; j < m->columns; j++) {
            const dml_scalar x = dml_get(m, i * m->columns + j);
            dml_pushscalar(L, &x);
            lua_rawseti(L, -2, (lua_Integer)j + 1);
        }
        lua_rawseti(L, -2, (lua_Integer)i + 1);
    }
    return 1;
}

/* ---- algebra ---- */

/* A new matrix: rows and columns exchanged. */
static int matrix_transpose(lua_State *L) {
    const dml_array *m = check(L);
    const dml_scalar kind = dml_kindof(m);
    dml_array *out = dml_newarray(L, 2, m->columns, m->rows, &kind);
    for (uint32_t i = 0; i < m->rows; i++)
        for (uint32_t j = 0; j < m->columns; j++) {
            const dml_scalar x = dml_get(m, i * m->columns + j);
            dml_put(L, out, j * m->rows + i, &x);
        }
    return 1;
}

static void check_square(lua_State *L, const dml_array *m) {
    if (m->rows != m->columns) luaL_error(L, "a square matrix is needed, not %s", dml_shape(L, m));
}

static int matrix_trace(lua_State *L) {
    const dml_array *m = check(L);
    check_square(L, m);
    dml_scalar sum = dml_get(m, 0);
    for (uint32_t i = 1; i < m->rows; i++) {
        const dml_scalar x = dml_get(m, i * m->columns + i);
        sum = dml_apply(L, DM_OP_ADD, &sum, &x, NULL);
    }
    dml_pushscalar(L, &sum);
    return 1;
}

static int matrix_det(lua_State *L) {
    dml_det(L, check(L));
    return 1;
}

static int matrix_solve(lua_State *L) {
    const dml_array *m = check(L), *b = dml_toarray(L, 2, 2);
    lua_settop(L, 2);
    dml_solve(L, m, b ? b : dml_vectorat(L, 2));
    return 1;
}

/* By the linear system with the identity: one factorization. */
static int matrix_inverse(lua_State *L) {
    const dml_array *m = check(L);
    check_square(L, m);
    double *one = dml_pushmatrix(L, m->rows, m->rows);
    for (size_t i = 0; i < m->rows; i++) one[i * m->rows + i] = 1;
    dml_solve(L, m, lua_touserdata(L, -1));
    return 1;
}

static int matrix_eigenvalues(lua_State *L) {
    dml_eigenvalues(L, check(L));
    return 2;
}

/* Values and vectors of the stiffness at 1 in the mass at 2. */
static int matrix_modes(lua_State *L) {
    const dml_array *a = check(L), *b = dml_toarray(L, 2, 2);
    luaL_argcheck(L, b, 2, "a matrix expected");
    dml_modes(L, a, b);
    return 2;
}

static const dml_row meta[] = {DML_ARITHMETIC,
                               {"__eq", dml_equal, NULL},
                               {"__len", matrix_len, NULL},
                               {"__newindex", matrix_set, NULL},
                               {"__tostring", dml_matrixtext, NULL},
                               {NULL, NULL, NULL}};
static const dml_row methods[] =
    {{"row", matrix_row,
      "m:row(i) -> dm.vector\nA copy of row i; m[i] is a view that can be assigned to."},
     {"column", matrix_column, "m:column(j) -> dm.vector\nA copy of column j."},
     {"transpose", matrix_transpose,
      "m:transpose() -> dm.matrix\nThe matrix with m[j][i] at i, j."},
     {"trace", matrix_trace,
      "m:trace() -> number\nThe sum of the diagonal. Raises when m is not square."},
     {"det", matrix_det, "m:det() -> number\nThe determinant. Raises when m is not square."},
     {"solve", matrix_solve,
      "m:solve(b) -> dm.vector or dm.matrix\n"
      "x with m * x = b, for a vector (or table) or a matrix b with as many rows as m. Numbers by "
      "LU with row exchanges; symbols up to 4 x 4 by cofactors, larger ones by elimination. Raises "
      "when m is not square, or singular (with its condition)."},
     {"inverse", matrix_inverse,
      "m:inverse() -> dm.matrix\n"
      "The inverse; m:solve(b) is more exact. Raises as m:solve does."},
     {"eigenvalues", matrix_eigenvalues,
      "m:eigenvalues() -> dm.vector, dm.vector\n"
      "Real and imaginary parts of the eigenvalues, sorted; the latter are zero for a symmetric "
      "matrix. Numbers only."},
     {"modes", matrix_modes,
      "a:modes(b) -> dm.vector, dm.matrix\n"
      "The values k, sorted, and in the columns of the matrix the vectors x with a x = k b x and "
      "x^T b x = 1, of two symmetric matrices of numbers, b positive definite: of a stiffness and "
      "a mass omega^2 and the modes (GSL). Raises where b is not positive definite."},
     {"copy", matrix_copy, "m:copy() -> dm.matrix\nA new matrix with the same entries."},
     {"totable", matrix_totable, "m:totable() -> table\nThe rows as a table of tables."},
     {NULL, NULL, NULL}};
static const dml_row functions[] =
    {{"matrix", matrix_new,
      "dm.matrix{{a11, a12, ...}, ...} -> dm.matrix   or   dm.matrix(rows, columns)\n"
      "A matrix from a table of rows (tables or vectors of one length), or of zeros. m[i][j] "
      "counts from 1, m[i] is a view of row i; * takes numbers, vectors and matrices. Raises when "
      "the rows differ in length."},
     {"zeros", zeros,
      "dm.zeros(n [, columns]) -> dm.vector or dm.matrix\n"
      "n zeros, or n x columns of them."},
     {"identity", identity, "dm.identity(n) -> dm.matrix\nThe n x n unit matrix."},
     {NULL, NULL, NULL}};

static void open_matrix(lua_State *L) {
    gsl_set_error_handler_off(); /* statuses, not abort() */
    dml_setclass(L, DML_CLASS_MATRIX, TNAME);
}

const dml_class dml_class_matrix = {
    .name = TNAME,
    .doc = "dm.matrix: rows x columns entries in one block, made by dm.matrix{{...}, ...}\n"
           "fields: rows, columns; m[i][j] from 1, #m rows, + - * with matrices, vectors, numbers",
    .meta = meta,
    .methods = methods,
    .field = matrix_field,
    .functions = functions,
    .open = open_matrix,
};
