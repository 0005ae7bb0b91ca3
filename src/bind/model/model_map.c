/* model_map.c - the map of a discrete Lagrangian against the equations of a step of Ld. */
#include "bind/model/model_map.h"
#include "base/random.h"
#include "linalg/lu.h"

#include <float.h>
#include <math.h>
#include <string.h>

enum { POINTS = 4, MOVES = 30 };
static const double scales[] = {0.1, 1e-3, 1.0};
enum { SCALES = sizeof scales / sizeof *scales };

/* What may be left of an equation, of the size of its terms: a map is written down, or solved for
 * to round-off; beside it the round-off of q0 and q1 by the slopes of the equation. */
static const double LEFT = 1e-9, ROUNDED = 1e3 * DBL_EPSILON;

/* One step of the map from (q0, p0), and what the equations of Ld are made of there. */
typedef struct {
    dml_model *m;
    const dm_constraints *t;
    size_t n, k, l;
    double h;
    double *q0, *p0;  /* [n] each */
    double *step;     /* q1[n], p1[n], lambda[k], mu[l]: outputs of the map */
    double *x;        /* (q0, q1, 0, lambda, mu): inputs of the kernels of constraints */
    double *pair;     /* D1, D2, D1D2 of Ld */
    double *F;        /* F1, F2; zeros where there is no force */
    double *reaction; /* G^T lambda + E^T mu [n]; derivatives behind */
    double *g, *phi;  /* at q1 and at (q0, q1), with their slopes, as the kernels give them */
    double *J;        /* scratch of the Newton method below: [(k+l)^2] */
    uint32_t *pivot;  /* [k + l] */
} map_step;

static size_t outputs(const dm_kernel *kernel) {
    return kernel->eval ? kernel->outputs : 0;
}

/* Kernels and one block for all of it; leaves a userdata on the stack. */
static map_step lay_out(lua_State *L, dml_model *m, double h) {
    const dm_constraints *t = &m->constraints;
    dml_want(L, m,
             DM_WANT_MAP | DM_WANT_PAIR | DM_WANT_HOLONOMIC | DM_WANT_ROLLING |
                 DM_WANT_CONSTRAINT_FORCE | DM_WANT_REACTION,
             NULL);
    map_step e = {.m = m, .t = t, .n = m->n, .k = t->holonomic, .l = t->rolling, .h = h};
    const size_t n = e.n, r = e.k + e.l, inputs = 2 * n + 1 + r;
    const size_t size = 2 * n + (2 * n + r) + inputs + m->model.pair.outputs + 2 * n +
                        outputs(&t->reaction) + outputs(&t->holonomic_kernel) +
                        outputs(&t->rolling_kernel) + r * r + r;
    e.q0 = lua_newuserdatauv(L, size * sizeof(double), 0);
    memset(e.q0, 0, size * sizeof(double));
    e.p0 = e.q0 + n;
    e.step = e.p0 + n;
    e.x = e.step + 2 * n + r;
    e.pair = e.x + inputs;
    e.F = e.pair + m->model.pair.outputs;
    e.reaction = e.F + 2 * n;
    e.g = e.reaction + outputs(&t->reaction);
    e.phi = e.g + outputs(&t->holonomic_kernel);
    e.J = e.phi + outputs(&t->rolling_kernel);
    e.pivot = (uint32_t *)(void *)(e.J + r * r);
    return e;
}

static void eval(const dm_kernel *kernel, const double *x, double *out) {
    if (!kernel->eval) return;
    dm_kernel_prepare(kernel, out);
    dm_kernel_eval(kernel, x, out);
}

static int is_finite(const double *x, size_t count) {
    for (size_t i = 0; i < count; i++)
        if (!isfinite(x[i])) return 0;
    return 1;
}

/* g, G at q1 and phi, its slopes at (q0, q1) */
static void eval_constraints(const map_step *e) {
    eval(&e->t->holonomic_kernel, e->x + e->n, e->g);
    eval(&e->t->rolling_kernel, e->x, e->phi);
}

/* Ld, its forces and reactions at e->x = (q0, q1, 0, lambda, mu) */
static void eval_terms(const map_step *e) {
    eval(&e->m->model.pair, e->x, e->pair);
    eval(&e->t->force, e->x, e->F);
    eval(&e->t->reaction, e->x, e->reaction);
    eval_constraints(e);
}

/* ---- the equations ---- */

/* an equation that does not hold: its name in words, which entry, and what is left */
typedef struct {
    const char *what;
    size_t entry;
    double left;
} defect;

/* sum_j |row_j| (|q0_j| + |q1_j|): what rounding the points moves by this row */
static double slope_of(const map_step *e, const double *row) {
    double sum = 0.0;
    for (size_t j = 0; j < e->n; j++) sum += fabs(row[j]) * (fabs(e->x[j]) + fabs(e->x[e->n + j]));
    return sum;
}

/* Momenta, of the size of the largest of them. */
static void compare_momenta(const map_step *e, defect *d) {
    const size_t n = e->n;
    const double *D1 = e->pair, *D2 = D1 + n, *D12 = D2 + n, *p1 = e->step + n;
    double size = 0.0;
    for (size_t i = 0; i < n; i++)
        size = fmax(size, fmax(fmax(fabs(e->p0[i]), fabs(D1[i])), fmax(fabs(p1[i]), fabs(D2[i]))));
    for (size_t i = 0; i < n && !d->what; i++) {
        const double bar = LEFT * size + ROUNDED * slope_of(e, D12 + i * n);
        const double pull = e->k + e->l ? e->reaction[i] : 0.0;
        const double start = e->p0[i] + D1[i] + e->F[i] + pull;
        const double end = p1[i] - D2[i] - e->F[n + i];
        if (fabs(start) > bar + LEFT * (fabs(e->F[i]) + fabs(pull)))
            *d = (defect){"p0 + D1 Ld(q0, q1), with forces and impulses,", i, start};
        else if (fabs(end) > bar + LEFT * fabs(e->F[n + i]))
            *d = (defect){"p1 - D2 Ld(q0, q1), with forces,", i, end};
    }
}

static void compare_constraints(const map_step *e, defect *d) {
    for (size_t c = 0; c < e->k + e->l && !d->what; c++) {
        const int rolls = c >= e->k;
        const double left = rolls ? e->phi[c - e->k] : e->g[c];
        const double *row =
            rolls ? e->phi + e->l + (e->l + c - e->k) * e->n : e->g + e->k + c * e->n;
        if (fabs(left) > LEFT * slope_of(e, row) + DBL_EPSILON)
            *d = (defect){rolls ? "phi(q0, q1)" : "g(q1)", rolls ? c - e->k : c, left};
    }
}

/* One step from e->q0, e->p0. 0: map or Ld have no value. */
static int compare(const map_step *e, defect *d) {
    const size_t n = e->n, r = e->k + e->l;
    double *start = e->x; /* (q0, p0) for a moment */
    memcpy(start, e->q0, 2 * n * sizeof *start);
    eval(&e->m->model.map, start, e->step);
    if (!is_finite(e->step, 2 * n + r)) return 0;
    memcpy(e->x + n, e->step, n * sizeof *e->x);
    e->x[2 * n] = 0.0;
    memcpy(e->x + 2 * n + 1, e->step + 2 * n, r * sizeof *e->x);
    eval_terms(e);
    if (!is_finite(e->pair, 2 * n + n * n) || !is_finite(e->F, 2 * n)) return 0;
    if (r && !is_finite(e->reaction, n)) return 0;
    compare_momenta(e, d);
    compare_constraints(e, d);
    return 1;
}

/* ---- made-up points ---- */

/* Row c of the equations that q1 must meet, and what is left of it; `rolling`: phi among them. */
static const double *row_of(const map_step *e, size_t c, double *left) {
    const size_t n = e->n;
    *left = c < e->k ? e->g[c] : e->phi[c - e->k];
    return c < e->k ? e->g + e->k + c * n : e->phi + e->l + (e->l + c - e->k) * n;
}

/* One move of q1 in e->x along the rows of g and, with r > k, of phi; 0: there is none. */
static int move_end(const map_step *e, size_t r, double *move) {
    const size_t n = e->n;
    double *y = e->step, left; /* scratch: [r] */
    for (size_t a = 0; a < r; a++) {
        const double *A = row_of(e, a, y + a);
        for (size_t b = 0; b < r; b++) {
            const double *B = row_of(e, b, &left);
            e->J[a * r + b] = 0.0;
            for (size_t j = 0; j < n; j++) e->J[a * r + b] += A[j] * B[j];
        }
    }
    if (dm_lu_factor(e->J, e->pivot, (uint32_t)r) != DM_OK) return 0;
    dm_lu_solve(y, e->J, e->pivot, (uint32_t)r);
    *move = 0.0;
    for (size_t j = 0; j < n; j++) {
        double sum = 0.0;
        for (size_t a = 0; a < r; a++) sum += row_of(e, a, &left)[j] * y[a];
        e->x[n + j] -= sum;
        *move = fmax(*move, fabs(sum) / (1 + fabs(e->x[n + j])));
    }
    return isfinite(*move);
}

/* q1 in e->x to the nearest point, about, that meets its first r equations; 0: none was found */
static int settle(const map_step *e, size_t r) {
    double move = r ? 1.0 : 0.0;
    for (int i = 0; i < MOVES && move > 1e-13; i++) {
        eval_constraints(e);
        if (!move_end(e, r, &move)) return 0;
    }
    return move <= 1e-13;
}

static double random_at(long point, uint64_t seed, size_t i) {
    return scales[point % SCALES] * (2 * dm_random_uniform(seed, (uint64_t)point, (uint32_t)i) - 1);
}

/* A start that a step of Ld leads from: q0 on the constraints, q1 near it, p0 = -D1 Ld - F1 - G^T
 * lambda - E^T mu with impulses that are made up, too: momenta of runs have a part across. */
static int make_start(const map_step *e, long point) {
    const size_t n = e->n, r = e->k + e->l;
    for (size_t i = 0; i < n; i++) e->x[i] = e->x[n + i] = random_at(point, 1, i);
    if (!settle(e, e->k)) return 0;
    memcpy(e->x, e->x + n, n * sizeof *e->x);
    for (size_t i = 0; i < n; i++) e->x[n + i] += e->h * random_at(point, 2, i);
    if (!settle(e, r)) return 0;
    e->x[2 * n] = 0.0;
    for (size_t c = 0; c < r; c++) e->x[2 * n + 1 + c] = random_at(point, 3, c);
    eval_terms(e);
    memcpy(e->q0, e->x, n * sizeof *e->x);
    for (size_t i = 0; i < n; i++) e->p0[i] = -e->pair[i] - e->F[i] - (r ? e->reaction[i] : 0.0);
    return is_finite(e->q0, 2 * n);
}

/* ---- the message ---- */

/* push "{x1, x2, ...}" */
static const char *push_numbers(lua_State *L, const double *x, size_t n) {
    enum { SHOWN = 6 };
    luaL_Buffer b;
    luaL_buffinit(L, &b);
    luaL_addchar(&b, '{');
    for (size_t i = 0; i < n && i < SHOWN; i++) {
        lua_pushfstring(L, i ? ", %f" : "%f", x[i]);
        luaL_addvalue(&b);
    }
    luaL_addstring(&b, n > SHOWN ? ", ...}" : "}");
    luaL_pushresult(&b);
    return lua_tostring(L, -1);
}

static void raise_defect(lua_State *L, const map_step *e, const defect *d) {
    const char *q0 = push_numbers(L, e->q0, e->n), *p0 = push_numbers(L, e->p0, e->n);
    luaL_error(L,
               "map is not the step of this Ld: from q0 = %s, p0 = %s it leads to q1 = %s, where "
               "%s is %f in entry %d and should be 0; leave 'map' out and \"del\" solves for q1",
               q0, p0, push_numbers(L, e->step, e->n), d->what, d->left, (int)d->entry + 1);
}

void dml_checkmap(lua_State *L, int arg, dml_model *m, const double *starts, long count,
                  size_t stride) {
    const dml_system *s = dml_checksystem(L, arg);
    const int top = lua_gettop(L);
    if (!m->constraint[DML_MAP].graph || s->solved) return;
    const map_step e = lay_out(L, m, s->h);
    dml_forgetroots(m);
    for (long point = 0; point < (starts ? count : POINTS * SCALES); point++) {
        defect d = {0};
        if (starts) memcpy(e.q0, starts + (size_t)point * stride, 2 * e.n * sizeof *starts);
        if (!starts && !make_start(&e, point)) continue;
        if (compare(&e, &d) && d.what) raise_defect(L, &e, &d);
    }
    dml_forgetroots(m);
    lua_settop(L, top);
}
