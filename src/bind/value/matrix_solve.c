/* matrix_solve.c - numbers by LU with row exchanges (GSL). Symbols have no size to choose a
 * pivot by: up to 4 x 4 by cofactors, which hold wherever the determinant does not
 * vanish; larger ones by elimination on the pivots that are constants when there are any.
 * Hyper-dual numbers by elimination on the largest value. */
#include "bind/value/matrix_solve.h"
#include "bind/core/state.h"

#include <float.h>
#include <gsl/gsl_linalg.h>
#include <math.h>
#include <string.h>

enum { MOST_COFACTORS = 4 };

#define SINGULAR "the matrix is singular (its condition is infinite)"

/* ---- numbers ---- */

typedef struct {
    gsl_matrix_view lu;
    gsl_permutation p;
    int sign;
} factors;

/* P A = L U in a workspace that is left on the stack */
static void factor(lua_State *L, factors *f, const double *a, size_t n) {
    double *lu = lua_newuserdatauv(L, n * n * sizeof *lu, 0);
    f->p = (gsl_permutation){.size = n, .data = lua_newuserdatauv(L, n * sizeof(size_t), 0)};
    memcpy(lu, a, n * n * sizeof *lu);
    f->lu = gsl_matrix_view_array(lu, n, n);
    if (gsl_linalg_LU_decomp(&f->lu.matrix, &f->p, &f->sign) != GSL_SUCCESS)
        luaL_error(L, "not enough memory");
}

/* largest column sum of |a_ij| */
static double norm1(const double *a, size_t n) {
    double largest = 0;
    for (size_t j = 0; j < n; j++) {
        double sum = 0;
        for (size_t i = 0; i < n; i++) sum += fabs(a[i * n + j]);
        largest = fmax(largest, sum);
    }
    return largest;
}

/* a pivot that is nothing but the round-off of its column */
static int is_singular(const factors *f, const double *a, size_t n) {
    for (size_t j = 0; j < n; j++) {
        double column = 0;
        for (size_t i = 0; i < n; i++) column = fmax(column, fabs(a[i * n + j]));
        const double pivot = fabs(gsl_matrix_get(&f->lu.matrix, j, j));
        if (!(pivot > (double)n * DBL_EPSILON * column)) return 1;
    }
    return 0;
}

/* Tells the condition number in the norm of column sums. */
static void raise_singular(lua_State *L, const factors *f, const double *a, size_t n) {
    double *inverse = lua_newuserdatauv(L, n * n * sizeof *inverse, 0);
    gsl_matrix_view view = gsl_matrix_view_array(inverse, n, n);
    double condition = INFINITY;
    if (gsl_linalg_LU_invert(&f->lu.matrix, &f->p, &view.matrix) == GSL_SUCCESS)
        condition = norm1(a, n) * norm1(inverse, n);
    if (!isfinite(condition))
        luaL_error(L, "the matrix is singular (its condition is infinite): rows or columns are "
                      "linearly dependent");
    luaL_error(L,
               "the matrix is singular to working precision: its condition is %f, so no digit of a "
               "solution would be right",
               condition);
}

/* NaN would come out as a wrong solution, without an error. */
void dml_checkfinite(lua_State *L, const double *a, size_t n) {
    for (size_t i = 0; i < n; i++)
        if (!isfinite(a[i]))
            luaL_error(L, "the matrix has an entry that is %s, not a finite number",
                       isnan(a[i]) ? "NaN" : "infinite");
}

/* Entries of 1e308 may become infinite on the way, and a solution 0. */
static void check_factors(lua_State *L, const factors *f, size_t n) {
    for (size_t i = 0; i < n * n; i++)
        if (!isfinite(f->lu.matrix.data[i]))
            luaL_error(L, "the elimination of this matrix overflows: take other units");
}

static void factor_regular(lua_State *L, factors *f, const double *a, size_t n) {
    dml_checkfinite(L, a, n * n);
    factor(L, f, a, n);
    if (is_singular(f, a, n)) raise_singular(L, f, a, n);
    check_factors(L, f, n);
}

/* The product of the pivots, with the sign of the permutation. One that is zero leaves nothing to
 * divide by, and GSL NaN behind it. */
static void det_of_numbers(lua_State *L, const double *a, size_t n) {
    factors f;
    dml_checkfinite(L, a, n * n);
    factor(L, &f, a, n);
    double det = f.sign;
    for (size_t i = 0; i < n && det != 0.0; i++) det *= f.lu.matrix.data[i * n + i];
    if (isnan(det)) check_factors(L, &f, n);
    lua_pushnumber(L, det == 0.0 ? 0.0 : det);
}

/* One factorization serves all columns; Ctrl-C is looked for between them. */
static void solve_numbers(lua_State *L, const double *a, const dml_array *b) {
    const size_t n = b->rows, k = b->columns;
    const double *rhs = dml_numbersof(b);
    factors f;
    dml_checkfinite(L, rhs, n * k);
    factor_regular(L, &f, a, n);
    const dml_scalar kind = {.kind = DML_NUMBER};
    double *column = lua_newuserdatauv(L, n * sizeof *column, 0);
    double *x = dml_newarray(L, b->rank, b->rows, b->columns, &kind)->entries;
    gsl_vector_view view = gsl_vector_view_array(column, n);
    for (size_t j = 0; j < k; j++) {
        dml_checkstop(L);
        for (size_t i = 0; i < n; i++) column[i] = rhs[i * k + j];
        gsl_linalg_LU_svx(&f.lu.matrix, &f.p, &view.vector);
        for (size_t i = 0; i < n; i++) x[i * k + j] = column[i];
    }
}

/* ---- symbols: cofactors ---- */

static dml_scalar multiply(lua_State *L, const dml_scalar *a, const dml_scalar *b) {
    return dml_apply(L, DM_OP_MUL, a, b, NULL);
}

static dml_scalar subtract(lua_State *L, const dml_scalar *a, const dml_scalar *b) {
    return dml_apply(L, DM_OP_SUB, a, b, NULL);
}

/* determinant of the entries in the rows and columns of two bit sets of one size */
static dml_scalar expand(lua_State *L, const dml_array *m, unsigned rows, unsigned columns) {
    dml_scalar sum = {.kind = DML_NUMBER, .as.number = columns ? 0 : 1};
    uint32_t row = 0;
    int sign = 1;
    while (rows && !(rows & 1u << row)) row++;
    for (uint32_t j = 0; columns && j < m->columns; j++) {
        if (!(columns & 1u << j)) continue;
        const dml_scalar a = dml_get(m, row * m->columns + j);
        const dml_scalar rest = expand(L, m, rows & ~(1u << row), columns & ~(1u << j));
        const dml_scalar term = multiply(L, &a, &rest);
        sum = dml_apply(L, sign > 0 ? DM_OP_ADD : DM_OP_SUB, &sum, &term, NULL);
        sign = -sign;
    }
    return sum;
}

static unsigned all_of(const dml_array *m) {
    return (1u << m->rows) - 1;
}

static dml_scalar cofactor_det(lua_State *L, const dml_array *m) {
    return expand(L, m, all_of(m), all_of(m));
}

static int is_zero(lua_State *L, const dml_scalar *x) {
    double value = 1;
    if (x->kind == DML_NUMBER) return x->as.number == 0;
    const dml_frame *frame = dml_findframe(L, x->serial);
    return frame && dm_is_constant(frame->graph, x->as.node, &value) && value == 0;
}

/* rows and columns that entries other than zero join */
typedef struct {
    unsigned rows, columns;
} block;

static unsigned count(unsigned set) {
    unsigned n = 0;
    for (; set; set &= set - 1) n++;
    return n;
}

/* The block of column j; all of a matrix whose block is not square, and which is singular. */
static block block_of(lua_State *L, const dml_array *m, uint32_t j) {
    block b = {0, 1u << j}, before = {0, 0};
    while (b.rows != before.rows || b.columns != before.columns) {
        before = b;
        for (uint32_t k = 0; k < m->rows * m->columns; k++) {
            const unsigned row = 1u << k / m->columns, column = 1u << k % m->columns;
            const dml_scalar a = dml_get(m, k);
            if (!(b.rows & row) == !(b.columns & column) || is_zero(L, &a)) continue;
            b.rows |= row, b.columns |= column;
        }
    }
    return count(b.rows) == count(b.columns) ? b : (block){all_of(m), all_of(m)};
}

/* x_jk = sum_i C_ij b_ik / det, of the block of j alone: the determinant of another one would stand
 * above and below the line, and what it leaves of derivatives is the round-off of x_j */
static void cofactor_solve(lua_State *L, dml_array *x, const dml_array *m, const dml_array *b) {
    const uint32_t n = m->rows, k = b->columns;
    for (uint32_t j = 0; j < n; j++) {
        const block of = block_of(L, m, j);
        const unsigned columns = of.columns & ~(1u << j);
        const dml_scalar det = expand(L, m, of.rows, of.columns);
        if (is_zero(L, &det)) luaL_error(L, SINGULAR);
        for (uint32_t l = 0; l < k; l++) {
            dml_scalar sum = {.kind = DML_NUMBER};
            for (uint32_t i = 0; i < n; i++) {
                if (!(of.rows & 1u << i)) continue;
                const unsigned above = of.rows & ((1u << i) - 1), left = columns & ((1u << j) - 1);
                const dml_scalar c = expand(L, m, of.rows & ~(1u << i), columns);
                const dml_scalar r = dml_get(b, i * k + l), term = multiply(L, &c, &r);
                const int odd = (count(above) + count(left)) % 2;
                sum = dml_apply(L, odd ? DM_OP_SUB : DM_OP_ADD, &sum, &term, NULL);
            }
            sum = dml_apply(L, DM_OP_DIV, &sum, &det, NULL);
            dml_put(L, x, j * k + l, &sum);
        }
    }
}

/* ---- symbols and hyper-dual numbers: elimination ---- */

/* how good a pivot is; 0 for one that surely vanishes, NaN never wins */
static double weight(lua_State *L, const dml_scalar *x) {
    double value;
    if (x->kind == DML_NUMBER) return fabs(x->as.number);
    if (x->kind == DML_HYPERDUAL) return fabs(x->as.hyper.f);
    const dml_frame *frame = dml_findframe(L, x->serial);
    if (frame && dm_is_constant(frame->graph, x->as.node, &value)) return fabs(value);
    return DBL_MIN;
}

typedef struct {
    dml_scalar *a; /* n rows of `width`: the matrix and its right-hand sides */
    uint32_t n, width;
    dml_scalar det;
} tableau;

/* The row of the largest weight in column k; t->n where all are zero. */
static uint32_t find_pivot(lua_State *L, const tableau *t, uint32_t k) {
    uint32_t best = k;
    double most = 0;
    for (uint32_t i = k; i < t->n; i++) {
        const double w = weight(L, t->a + i * t->width + k);
        if (w > most) most = w, best = i;
    }
    return most > 0 ? best : t->n;
}

static void swap_rows(tableau *t, uint32_t i, uint32_t j) {
    for (uint32_t k = 0; i != j && k < t->width; k++) {
        const dml_scalar x = t->a[i * t->width + k];
        t->a[i * t->width + k] = t->a[j * t->width + k];
        t->a[j * t->width + k] = x;
    }
}

/* Gauss-Jordan; returns 0 when a column has no pivot */
static int eliminate(lua_State *L, tableau *t) {
    t->det = (dml_scalar){.kind = DML_NUMBER, .as.number = 1};
    for (uint32_t k = 0; k < t->n; k++) {
        const uint32_t pivot = find_pivot(L, t, k);
        if (pivot == t->n) return 0;
        swap_rows(t, pivot, k);
        dml_scalar *row = t->a + k * t->width;
        if (pivot != k) t->det = dml_apply(L, DM_OP_NEG, &t->det, NULL, NULL);
        t->det = multiply(L, &t->det, row + k);
        for (uint32_t j = k + 1; j < t->width; j++)
            row[j] = dml_apply(L, DM_OP_DIV, row + j, row + k, NULL);
        for (uint32_t i = 0; i < t->n; i++) {
            dml_scalar *other = t->a + i * t->width;
            dml_checkstop(L);
            for (uint32_t j = k + 1; i != k && j < t->width; j++) {
                const dml_scalar part = multiply(L, other + k, row + j);
                other[j] = subtract(L, other + j, &part);
            }
        }
    }
    return 1;
}

/* the tableau of m and (when there is one) b, in a block on the stack */
static tableau make_tableau(lua_State *L, const dml_array *m, const dml_array *b) {
    const uint32_t n = m->rows, more = b ? b->columns : 0;
    tableau t = {.n = n, .width = n + more};
    t.a = lua_newuserdatauv(L, (size_t)n * t.width * sizeof *t.a, 0);
    for (uint32_t i = 0; i < n; i++)
        for (uint32_t j = 0; j < t.width; j++)
            t.a[i * t.width + j] = j < n ? dml_get(m, i * n + j) : dml_get(b, i * more + j - n);
    return t;
}

/* Gauss elimination in the graph: the result is an expression in the entries. */
static void eliminate_solve(lua_State *L, dml_array *x, const dml_array *m, const dml_array *b) {
    tableau t = make_tableau(L, m, b);
    if (!eliminate(L, &t)) luaL_error(L, SINGULAR);
    for (uint32_t i = 0; i < t.n; i++)
        for (uint32_t j = 0; j < b->columns; j++)
            dml_put(L, x, i * b->columns + j, t.a + i * t.width + t.n + j);
    lua_pop(L, 1);
}

/* ---- any kind ---- */

void dml_checksquare(lua_State *L, const dml_array *m) {
    if (m->rows != m->columns) luaL_error(L, "a square matrix is needed, not %s", dml_shape(L, m));
}

static int by_cofactors(const dml_array *m) {
    return dml_kindof(m).kind == DML_SYMBOL && m->rows <= MOST_COFACTORS;
}

/* Numbers by LU, all else by elimination. */
void dml_det(lua_State *L, const dml_array *m) {
    const double *numbers = dml_numbersof(m);
    dml_checksquare(L, m);
    if (numbers) {
        det_of_numbers(L, numbers, m->rows);
        return;
    }
    dml_scalar det = {.kind = DML_NUMBER};
    if (by_cofactors(m)) {
        det = cofactor_det(L, m);
    } else {
        tableau t = make_tableau(L, m, NULL);
        if (eliminate(L, &t)) det = t.det;
    }
    dml_pushscalar(L, &det);
}

/* m x = b for a vector or a matrix b. */
void dml_solve(lua_State *L, const dml_array *m, const dml_array *b) {
    const double *numbers = dml_numbersof(m);
    dml_checksquare(L, m);
    if (b->rows != m->rows)
        luaL_error(L, "cannot solve with %s and a right-hand side that is %s", dml_shape(L, m),
                   dml_shape(L, b));
    if (numbers && dml_numbersof(b)) {
        solve_numbers(L, numbers, b);
        return;
    }
    const dml_scalar km = dml_kindof(m), kb = dml_kindof(b), kind = dml_common(L, &km, &kb);
    dml_array *x = dml_newarray(L, b->rank, b->rows, b->columns, &kind);
    if (by_cofactors(m))
        cofactor_solve(L, x, m, b);
    else
        eliminate_solve(L, x, m, b);
}
