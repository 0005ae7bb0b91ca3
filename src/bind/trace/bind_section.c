/* bind_section.c - core.section_node: a point of the level set F = 1 beside another, found by
 * Newton steps of least length, and the angle of the set with the orbits of a group there. (1, not
 * 0: a trace is compared with plain calls, and beside 1 what cancels is.) */
#include "bind/core/bind.h"
#include "bind/trace/function.h"
#include "bind/value/array.h"
#include "linalg/lu.h"

#include <math.h>
#include <string.h>

enum { CORRECTIONS = 3 };
static const double MOST = 0.3, /* of a step: a correction that is larger is refused, */
    LAST = 0.02,                /* the last one is smaller */
    ALONG = 1e-3;               /* of a unit vector, what has a direction along the set */

/* The level set: F of n numbers gives c, of which the first r stand for the section. moved(y, x)
 * gives n numbers, its slope by y[r] at y = 0 is psi. x[n] and v[n] are what is improved. */
typedef struct {
    dml_function *F, *moved;
    uint32_t n, c, r;
    double *x, *v;
    double *J, *y, *gram;    /* [c n], [c], [c c] with pivot */
    double *psi, *A, *turns; /* [r n] transposed, [r r], [r r] */
    uint32_t *pivot;
} level;

/* out[rows rows] = A A^T of the first rows, `n` long */
static void square(double *out, const double *A, uint32_t rows, uint32_t n) {
    for (uint32_t i = 0; i < rows; i++)
        for (uint32_t j = 0; j <= i; j++) {
            double sum = 0;
            for (uint32_t k = 0; k < n; k++) sum += A[i * n + k] * A[j * n + k];
            out[i * rows + j] = out[j * rows + i] = sum;
        }
}

/* determinant of A[n n], which becomes its factors */
static double determinant(double *A, uint32_t *pivot, uint32_t n) {
    double out = 1;
    if (dm_lu_factor(A, pivot, n)) return 0;
    for (uint32_t i = 0; i < n; i++) out *= pivot[i] == i ? A[i * n + i] : -A[i * n + i];
    return 1 / out;
}

/* J, J J^T and F - 1 at x; 0 where dF has no full rank */
static int look(lua_State *L, level *s) {
    memcpy(s->F->x, s->x, s->n * sizeof *s->x);
    const double *value = dml_function_evaluate(L, s->F, DML_VALUE, "the section");
    for (uint32_t i = 0; i < s->c; i++) s->y[i] = value[i] - 1;
    memcpy(s->J, dml_function_evaluate(L, s->F, DML_JACOBIAN, "the slope of the section"),
           (size_t)s->c * s->n * sizeof *s->J);
    square(s->gram, s->J, s->c, s->n);
    return dm_lu_factor(s->gram, s->pivot, s->c) == DM_OK;
}

/* from[n] -= J^T (J J^T)^-1 y; the length of the change */
static double normal_step(level *s, double *from) {
    double size = 0;
    dm_lu_solve(s->y, s->gram, s->pivot, s->c);
    for (uint32_t k = 0; k < s->n; k++) {
        double sum = 0;
        for (uint32_t i = 0; i < s->c; i++) sum += s->J[i * s->n + k] * s->y[i];
        from[k] -= sum;
        size += sum * sum;
    }
    return sqrt(size);
}

/* x brought to the level set by corrections that fit a step of this length */
static int bring(lua_State *L, level *s, double step) {
    for (int i = 0; i < CORRECTIONS; i++) {
        if (!look(L, s)) return 0;
        const double size = normal_step(s, s->x);
        if (!(size < MOST * step)) return 0;
        if (size <= LAST * step) return 1;
    }
    return 0;
}

/* v becomes the unit vector along the level set beside it; 0: there is none */
static int turn(level *s) {
    double size = 0;
    for (uint32_t i = 0; i < s->c; i++) {
        s->y[i] = 0;
        for (uint32_t k = 0; k < s->n; k++) s->y[i] += s->J[i * s->n + k] * s->v[k];
    }
    normal_step(s, s->v);
    for (uint32_t k = 0; k < s->n; k++) size += s->v[k] * s->v[k];
    size = sqrt(size);
    if (!(size > ALONG)) return 0;
    for (uint32_t k = 0; k < s->n; k++) s->v[k] /= size;
    return 1;
}

/* The product of the sines of the angles between section and orbit, with a sign: det J psi
 * / (det J J^T det psi^T psi)^1/2. It passes zero where the section turns back along orbits. */
static double sine(lua_State *L, level *s) {
    const uint32_t n = s->n, r = s->r;
    memset(s->moved->x, 0, r * sizeof *s->moved->x);
    memcpy(s->moved->x + r, s->x, n * sizeof *s->x);
    const double *slope =
        dml_function_evaluate(L, s->moved, DML_JACOBIAN, "the slope of the action");
    for (uint32_t i = 0; i < r; i++)
        for (uint32_t k = 0; k < n; k++) s->psi[i * n + k] = slope[k * (size_t)(r + n) + i];
    for (uint32_t i = 0; i < r; i++)
        for (uint32_t j = 0; j < r; j++) {
            double sum = 0;
            for (uint32_t k = 0; k < n; k++) sum += s->J[i * n + k] * s->psi[j * n + k];
            s->A[i * r + j] = sum;
        }
    const double cut = determinant(s->A, s->pivot, r);
    square(s->turns, s->psi, r, n);
    const double turns = determinant(s->turns, s->pivot, r);
    square(s->turns, s->J, r, n);
    return cut / sqrt(turns * determinant(s->turns, s->pivot, r));
}

static int node(lua_State *L) {
    level s = {.F = luaL_checkudata(L, 1, DML_FUNCTION),
               .moved = luaL_checkudata(L, 2, DML_FUNCTION)};
    const double step = luaL_checknumber(L, 5);
    s.n = s.F->inputs, s.c = dml_outputs(s.F);
    luaL_argcheck(L, s.moved->inputs > s.n && dml_outputs(s.moved) == s.n, 2,
                  "a function (y, x) -> x expected");
    s.r = s.moved->inputs - s.n;
    luaL_argcheck(L, s.r <= s.c, 2, "at most as many y as equations expected");
    const size_t n = s.n, c = s.c, r = s.r;
    s.x = dml_pushvector(L, s.n);
    lua_pushnil(L);
    s.v = dml_pushvector(L, s.n);
    dml_vectorarg(L, 3, "x", s.x, s.n);
    if (!lua_isnil(L, 4)) dml_vectorarg(L, 4, "v", s.v, s.n);
    s.pivot = lua_newuserdatauv(L, c * sizeof *s.pivot, 0);
    s.J = lua_newuserdatauv(L, (c * n + c + c * c + n * r + 2 * r * r) * sizeof *s.J, 0);
    s.y = s.J + c * n, s.gram = s.y + c, s.psi = s.gram + c * c;
    s.A = s.psi + n * r, s.turns = s.A + r * r;
    lua_rotate(L, -5, 2);
    if (!bring(L, &s, step)) return 0;
    const int has_direction = !lua_isnil(L, 4) && turn(&s);
    lua_pushnumber(L, sine(L, &s));
    lua_replace(L, -3);
    if (!has_direction) lua_pop(L, 1);
    return has_direction ? 3 : 2;
}

static const dml_row functions[] =
    {{"section_node", node,
      "core.section_node(F, moved, x, v, step) -> x, sine, v   or nothing\n"
      "The point of F = 1 beside x, by Newton steps of least length, which fit a step of that "
      "length; the product of the sines of the angles of that level set with the orbits of a "
      "group, with a sign; and the unit vector along it beside v (left out where v is nil). F: a "
      "dm.function of x, whose first entries are the section; moved: one of (y, x), x moved by y "
      "in the algebra."},
     {NULL, NULL, NULL}};

const dml_class dml_class_section = {
    .functions = functions,
};
