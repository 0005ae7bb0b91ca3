/* bind_factor.c - `dm.factor`: what solves systems with one sparse matrix, again and again, and
 * eigenpairs of symmetric ones. */
#include "bind/dec/bind_sparse.h"
#include "bind/value/array.h"
#include "linalg/lu.h"
#include "linalg/sparse/conjugate_gradient.h"
#include "linalg/sparse/symmetric_eigen.h"

#include <math.h>
#include <string.h>

/* The first two are of dm/sparse.so, the others always there. */
typedef enum { BY_CHOLESKY, BY_LU, BY_GRADIENTS, BY_DENSE_LU } way;
static const char *const ways[] = {"cholesky", "lu", "gradients", "dense", NULL};

/* User value 1 keeps the matrix, 2 the arena. */
typedef struct {
    way way;
    const dm_sparse *A;
    const dm_solvers *solvers; /* of the first two ways */
    dm_factor *factor;
    double condition; /* estimate of the reciprocal one; 1: there is none */
    double *dense;    /* [n][n] factors, or [4 n] work of gradients */
    uint32_t *pivot;
    double *right; /* [n] */
} solver;

/* stack index of the matrix in its methods, user values of a solver, unknowns of dense ways */
enum { MATRIX = 1, KEPT_MATRIX = 1, KEPT_ARENA = 2, MOST_DENSE = 1200 };

/* ---- making one ---- */

/* A as it stands, row by row, eliminated with partial pivoting; its condition is guessed from the
 * pivots, of which lu.h keeps the reciprocals. */
static dm_status dense_lu(solver *s, dm_arena *arena) {
    const size_t n = (size_t)s->A->columns;
    s->dense = dm_arena_take(arena, (n * n + 1) * sizeof *s->dense);
    s->pivot = dm_arena_take(arena, (n + 1) * sizeof *s->pivot);
    if (!s->dense || !s->pivot) return DM_NO_MEMORY;
    memset(s->dense, 0, n * n * sizeof *s->dense);
    for (size_t j = 0; j < n; j++)
        for (int32_t p = s->A->start[j]; p < s->A->start[j + 1]; p++)
            s->dense[(size_t)s->A->row[p] * n + j] = s->A->value[p];
    const dm_status status = dm_lu_factor(s->dense, s->pivot, (uint32_t)n);
    double least = INFINITY, most = 0.0; /* reciprocals of pivots */
    for (size_t i = 0; status == DM_OK && i < n; i++) {
        least = fmin(least, fabs(s->dense[i * n + i]));
        most = fmax(most, fabs(s->dense[i * n + i]));
    }
    s->condition = n ? least / most : 1.0;
    return status;
}

/* What the way needs besides the matrix. DM_SINGULAR is no error here: the caller tries another
 * way. */
static dm_status make(lua_State *L, solver *s, dm_arena *arena) {
    const size_t n = (size_t)s->A->columns;
    const char *why;
    s->condition = 1.0;
    s->right = dm_arena_take(arena, (n + 1) * sizeof *s->right);
    if (!s->right) return DM_NO_MEMORY;
    if (s->way == BY_GRADIENTS) {
        s->dense = dm_arena_take(arena, (4 * n + 1) * sizeof *s->dense);
        return s->dense ? DM_OK : DM_NO_MEMORY;
    }
    if (s->way == BY_DENSE_LU) return dense_lu(s, arena);
    s->solvers = dml_solvers(&why);
    if (!s->solvers) luaL_error(L, "%s", why);
    return s->solvers->factor(&s->factor, s->way == BY_CHOLESKY ? DM_CHOLESKY : DM_LU, s->A, arena,
                              &s->condition);
}

/* A:factor("cholesky" | "lu" | "gradients" | "dense") -> dm.factor or nil */
static int sparse_factor(lua_State *L) {
    const dm_sparse *A = dml_checksparse(L, MATRIX);
    const way how = (way)luaL_checkoption(L, 2, NULL, ways);
    if (A->rows != A->columns) luaL_error(L, "the matrix is not square");
    if (how == BY_DENSE_LU && A->columns > MOST_DENSE)
        luaL_error(L, "dense elimination is for up to %d unknowns, not %d", (int)MOST_DENSE,
                   (int)A->columns);
    for (int32_t p = 0; p < A->start[A->columns]; p++)
        if (!isfinite(A->value[p])) luaL_error(L, "the matrix has an entry that is not finite");
    /* no metatable before it is whole: an error on the way leaves a plain block of memory */
    solver *s = lua_newuserdatauv(L, sizeof *s, 2);
    *s = (solver){.way = how, .A = A};
    dm_arena *arena = dml_pusharena(L);
    lua_setiuservalue(L, -2, KEPT_ARENA);
    lua_pushvalue(L, MATRIX);
    lua_setiuservalue(L, -2, KEPT_MATRIX);
    const dm_status status = make(L, s, arena);
    if (status == DM_SINGULAR) return 0;
    if (status == DM_STOPPED) dml_checkstop(L);
    if (status != DM_OK) luaL_error(L, "a factorization: %s", dm_status_text(status));
    luaL_setmetatable(L, DML_FACTOR);
    return 1;
}

/* ---- using it ---- */

/* For loops in C: raises nothing. x and b do not overlap. */
dm_status dml_factorsolve(void *factor, double *x, const double *b) {
    solver *s = factor;
    const int32_t n = s->A->columns;
    if (s->way == BY_GRADIENTS) {
        dm_cg how = {.tolerance = 1e-14, .most = 20 * n + 1000, .stop = &dml_stop};
        memset(x, 0, (size_t)n * sizeof *x);
        const dm_status status = dm_conjugate_gradient(x, s->A, b, s->dense, &how);
        return status == DM_NO_CONVERGENCE && how.residual <= 1e-8 ? DM_OK : status;
    }
    if (s->way != BY_DENSE_LU) return s->solvers->solve(s->factor, x, b);
    memcpy(x, b, (size_t)n * sizeof *x);
    dm_lu_solve(x, s->dense, s->pivot, (uint32_t)n);
    return DM_OK;
}

uint32_t dml_factorunknowns(const void *factor) {
    return (uint32_t)((const solver *)factor)->A->columns;
}

/* iterations; -1: the matrix is not positive semidefinite */
static int by_gradients(lua_State *L, const solver *s, double *x) {
    dm_cg how = {.tolerance = 1e-13, .most = 20 * s->A->columns + 1000, .stop = &dml_stop};
    const dm_status status = dm_conjugate_gradient(x, s->A, s->right, s->dense, &how);
    if (status == DM_STOPPED) dml_checkstop(L);
    if (status == DM_SINGULAR) return -1;
    if (status != DM_OK && !(how.residual <= 1e-8)) /* 1e-13 may be below rounding */
        luaL_error(L, "conjugate gradients end after %d iterations with a residual of %f",
                   (int)how.iterations, how.residual);
    return how.iterations;
}

/* f:solve(b) -> x, iterations. b is copied first: x may be what Lua moves it to, and a library
 * must not see a block that the collector could take. */
static int factor_solve(lua_State *L) {
    solver *s = luaL_checkudata(L, 1, DML_FACTOR);
    const int32_t n = s->A->columns;
    lua_settop(L, 2);
    memcpy(s->right, dml_numbersat(L, 2, "the right-hand side", n), (size_t)n * sizeof(double));
    double *x = dml_pushvector(L, (uint32_t)n);
    int iterations = 0;
    dm_status status = DM_OK;
    if (s->way == BY_GRADIENTS) {
        iterations = by_gradients(L, s, x);
        if (iterations < 0) return 0;
    } else if (s->way == BY_DENSE_LU) {
        memcpy(x, s->right, (size_t)n * sizeof *x);
        dm_lu_solve(x, s->dense, s->pivot, (uint32_t)n);
    } else {
        status = s->solvers->solve(s->factor, x, s->right);
    }
    if (status != DM_OK) luaL_error(L, "a solve: %s", dm_status_text(status));
    for (int32_t i = 0; i < n; i++)
        if (!isfinite(x[i])) luaL_error(L, "the solution is not finite: the matrix is singular");
    lua_pushinteger(L, iterations);
    return 2;
}

/* f.kind, f.condition, f.unknowns */
static int factor_field(lua_State *L) {
    const solver *s = luaL_checkudata(L, 1, DML_FACTOR);
    const char *key = luaL_checkstring(L, 2);
    if (strcmp(key, "kind") == 0)
        lua_pushstring(L, ways[s->way]);
    else if (strcmp(key, "condition") == 0)
        lua_pushnumber(L, s->condition);
    else if (strcmp(key, "unknowns") == 0)
        lua_pushinteger(L, s->A->columns);
    else
        return 0;
    return 1;
}

/* ---- eigenpairs ---- */

/* The vector that an iteration begins with: numbers between -1 and 1 without order, the same for
 * the same size (splitmix64). */
static void start_vector(double *x, int32_t n, uint64_t which) {
    for (int32_t i = 0; i < n; i++) {
        uint64_t z = ((uint64_t)i + 1 + (which << 32)) * 0x9E3779B97F4A7C15u;
        z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9u;
        z = (z ^ (z >> 27)) * 0x94D049BB133111EBu;
        z ^= z >> 31;
        x[i] = ldexp((double)(z >> 11), -52) - 1.0;
    }
}

/* core.start_vector(n, which) */
static int core_start_vector(lua_State *L) {
    const lua_Integer n = dml_checkinteger(L, 1);
    const lua_Integer which = dml_optinteger(L, 2, 0);
    luaL_argcheck(L, n >= 0 && n < INT32_MAX, 1, "a count is needed");
    start_vector(dml_pushvector(L, (uint32_t)n), (int32_t)n, (uint64_t)which);
    return 1;
}

/* |S x - lambda M x| in the product of M^-1, for x of length 1; r[n] */
static double residual_of(const dm_sparse *S, const double *mass, const double *x, double lambda,
                          double *r) {
    double sum = 0.0;
    dm_sparse_apply_transpose(r, S, x);
    for (int32_t i = 0; i < S->columns; i++) {
        const double off = r[i] - lambda * mass[i] * x[i];
        if (mass[i] > 0.0) sum += off * off / mass[i];
    }
    return sqrt(sum);
}

/* Methods differ in the sign: the first entry of half the largest modulus is made positive. */
static void turn(double *x, int32_t n) {
    double largest = 0.0;
    int32_t i = 0;
    for (int32_t j = 0; j < n; j++) largest = fmax(largest, fabs(x[j]));
    while (i < n && fabs(x[i]) < 0.5 * largest) i++;
    if (i == n || x[i] >= 0.0) return;
    for (int32_t j = 0; j < n; j++) x[j] = -x[j];
}

/* values, a list of vectors, residuals; vector[count][n] is changed */
static int push_pairs(lua_State *L, const dm_sparse *S, const double *mass, const double *value,
                      double *vector, int32_t count) {
    const size_t n = (size_t)S->columns;
    double *r = lua_newuserdatauv(L, (n + 1) * sizeof *r, 0);
    memcpy(dml_pushvector(L, (uint32_t)count), value, (size_t)count * sizeof *value);
    lua_createtable(L, count, 0);
    dml_setresult(L);
    double *residuals = dml_pushvector(L, (uint32_t)count);
    for (int32_t k = 0; k < count; k++) {
        double *x = vector + (size_t)k * n;
        turn(x, S->columns);
        residuals[k] = residual_of(S, mass, x, value[k], r);
        memcpy(dml_pushvector(L, (uint32_t)n), x, n * sizeof *x);
        lua_rawseti(L, -3, k + 1);
    }
    return 3;
}

/* S:eigenpairs(mass, factor, shift, count, above) -> values, vectors, residuals, solves */
/* The start depends on the count alone, so that asking again for more begins elsewhere. */
static int sparse_eigenpairs(lua_State *L) {
    const char *why;
    const dm_solvers *solvers = dml_solvers(&why);
    if (!solvers) luaL_error(L, "%s", why);
    dm_eigen_problem p = {.S = dml_checksparse(L, MATRIX), .stop = &dml_stop};
    const int32_t n = p.S->columns;
    lua_settop(L, 6);
    p.mass = dml_numbersat(L, 2, "the masses", n);
    const solver *s = luaL_checkudata(L, 3, DML_FACTOR);
    if (!s->factor || s->A->columns != n)
        luaL_argerror(L, 3, "not a factorization of S - shift M by dm/sparse.so");
    p.shifted = s->factor;
    p.shift = dml_checknumber(L, 4);
    p.count = (int32_t)dml_checkinteger(L, 5);
    p.above = lua_toboolean(L, 6);
    luaL_argcheck(L, p.count >= 1 && p.count < n, 5, "fewer eigenvalues than unknowns are needed");
    dm_arena *arena = dml_pusharena(L);
    const size_t count = (size_t)p.count;
    p.value = dm_arena_take(arena, count * sizeof *p.value);
    p.vector = dm_arena_take(arena, count * (size_t)n * sizeof *p.vector);
    double *start = dm_arena_take(arena, (size_t)n * sizeof *start);
    if (!p.value || !p.vector || !start) luaL_error(L, "eigenvalues: not enough memory");
    start_vector(start, n, (uint64_t)p.count);
    p.start = start;
    const dm_status status = solvers->eigen(&p, arena);
    if (status == DM_STOPPED) dml_checkstop(L);
    if (status == DM_NO_CONVERGENCE)
        luaL_error(L, "the Lanczos iteration did not converge: ask for fewer eigenvalues, or for "
                      "others by near =");
    if (status != DM_OK) luaL_error(L, "eigenvalues: %s", dm_status_text(status));
    push_pairs(L, p.S, p.mass, p.value, p.vector, p.count);
    lua_pushinteger(L, p.solves);
    return 4;
}

/* A:negatives() -> integer, nothing where a pivot is 0 */
static int sparse_negatives(lua_State *L) {
    const char *why;
    const dm_sparse *A = dml_checksparse(L, MATRIX);
    const dm_solvers *solvers = dml_solvers(&why);
    int64_t negatives = 0;
    if (!solvers) luaL_error(L, "%s", why);
    if (A->rows != A->columns) luaL_error(L, "the matrix is not square");
    const dm_status status = solvers->inertia(&negatives, A, dml_pusharena(L));
    if (status == DM_SINGULAR) return 0;
    if (status == DM_STOPPED) dml_checkstop(L);
    if (status != DM_OK) luaL_error(L, "an inertia: %s", dm_status_text(status));
    lua_pushinteger(L, (lua_Integer)negatives);
    return 1;
}

/* S:all_eigenpairs(mass) -> values, vectors, residuals, of M^-1/2 S M^-1/2 as a dense matrix */
static int sparse_all_eigenpairs(lua_State *L) {
    const dm_sparse *S = dml_checksparse(L, MATRIX);
    const int32_t n = S->columns;
    const size_t size = (size_t)n;
    const double *mass = dml_numbersat(L, 2, "the masses", n);
    if (n > MOST_DENSE) luaL_error(L, "dense eigenvalues are for up to %d unknowns", MOST_DENSE);
    for (int32_t i = 0; i < n; i++) luaL_argcheck(L, mass[i] > 0.0, 2, "masses must be > 0");
    double *A = lua_newuserdatauv(L, (size * size + 3 * size + 1) * sizeof *A, 0);
    double *value = A + size * size, *work = value + size, *root = work + size;
    memset(A, 0, size * size * sizeof *A);
    for (size_t i = 0; i < size; i++) root[i] = 1.0 / sqrt(mass[i]);
    for (size_t j = 0; j < size; j++)
        for (int32_t p = S->start[j]; p < S->start[j + 1]; p++)
            A[(size_t)S->row[p] * size + j] = S->value[p] * root[S->row[p]] * root[j];
    /* rows of A become eigenvectors M^1/2 x; below they are divided again */
    const dm_status status = dm_symmetric_eigen(A, value, work, (uint32_t)n, &dml_stop);
    if (status == DM_STOPPED) dml_checkstop(L);
    if (status != DM_OK) luaL_error(L, "eigenvalues: %s", dm_status_text(status));
    for (size_t k = 0; k < size; k++)
        for (size_t i = 0; i < size; i++) A[k * size + i] *= root[i];
    return push_pairs(L, S, mass, value, A, n);
}

/* core.solvers(): opens the library, so that a script can ask before it starts */
static int core_solvers(lua_State *L) {
    const char *why;
    const dm_solvers *solvers = dml_solvers(&why);
    if (solvers) {
        lua_pushstring(L, solvers->name);
        return 1;
    }
    lua_pushnil(L);
    lua_pushstring(L, why);
    return 2;
}

static const dml_row sparse_methods[] = {
    {"factor", sparse_factor,
     "A:factor(\"cholesky\" | \"lu\" | \"gradients\" | \"dense\") -> dm.factor   or nothing\n"
     "What solves A x = b: Cholesky (CHOLMOD) or LU (UMFPACK) factors, conjugate gradients with "
     "the diagonal as preconditioner, or dense elimination up to 1200 unknowns. Nothing where A is "
     "singular, for \"cholesky\" not positive definite; raises where dm/sparse.so is missing."},
    {"eigenpairs", sparse_eigenpairs,
     "S:eigenpairs(mass, factor, shift, count [, above]) -> values, list of dm.vector, residuals, "
     "solves\n"
     "count solutions of S x = lambda M x, S symmetric, M = diag(mass) with masses >= 0, x^T M x = "
     "1, by Lanczos iterations with the factor of S - shift M: nearest to the shift, with above "
     "the least beyond it, in no order. Residuals are |M^-1 S x - lambda x|."},
    {"negatives", sparse_negatives,
     "S:negatives() -> integer   or nothing\n"
     "How many eigenvalues of a symmetric matrix are negative, by the signs of D in L D L^T "
     "(CHOLMOD); nothing where a pivot is 0."},
    {"all_eigenpairs", sparse_all_eigenpairs,
     "S:all_eigenpairs(mass) -> values, list of dm.vector, residuals\n"
     "All solutions of S x = lambda M x, ascending, by dense rotations: up to 1200 unknowns, "
     "masses > 0."},
    {NULL, NULL, NULL}};

static const dml_extension more[] = {{DML_SPARSE, sparse_methods}, {NULL, NULL}};

static const dml_row methods[] =
    {{"solve", factor_solve,
      "f:solve(b) -> dm.vector, iterations   or nothing\n"
      "x with A x = b, and how many iterations that took (0: a factorization). Nothing where "
      "conjugate gradients find that A is not positive semidefinite."},
     {NULL, NULL, NULL}};

static const dml_row functions[] =
    {{"solvers", core_solvers,
      "core.solvers() -> string   or nil, why\n"
      "The libraries of dm/sparse.so, which is loaded now if it was not; or why it is not there."},
     {"start_vector", core_start_vector,
      "core.start_vector(n [, which]) -> dm.vector\n"
      "n numbers between -1 and 1 without order, always the same for one `which` (0): what "
      "iterations begin with."},
     {NULL, NULL, NULL}};

const dml_class dml_class_factor = {
    .name = DML_FACTOR,
    .doc = "dm.factor: what solves systems with one sparse matrix, made by A:factor\n"
           "fields: kind, condition (an estimate of the reciprocal one), unknowns",
    .methods = methods,
    .field = factor_field,
    .functions = functions,
    .more = more,
};
