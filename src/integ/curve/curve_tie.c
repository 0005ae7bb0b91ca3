/* curve_tie.c - constraints in the step of curve segments. The segment follows the constrained
 * field, so that (g)'' = 0 and phi' = 0 hold along it. The discrete constraints are g(d+(y)) = 0
 * and phi(y) = 0 (D_d is D itself, since V = TQ), the admissible variations of a node are those of
 * its point, E_d = ker (G, E)(q0): the reaction R0 = G^T lambda + E^T mu joins p0. What holonomic
 * constraints do inside of a segment is not counted, since variations of it within the constraints
 * feel nothing: Ld stays a function and the step symplectic. What rolling ones do there is, in
 * sigma_d, and R0 has only what the method misses: without it the order would be 1 (Cuell-Patrick
 * 2009, 3 and 5). At the end of the step p1 is put onto the hidden constraints, which the next R0
 * would do. */
#include "base/doubles.h"
#include "integ/curve/curve_inside.h"

#include "base/largest.h"
#include "linalg/solve/newton.h"

#include <math.h>
#include <string.h>

/* g, G, g_t; phi, E, phi_v, phi_q; R0 and its derivatives */
static size_t held_size(const dm_constraints *c) {
    return c->holonomic * ((size_t)c->n + 2);
}

static size_t roll_size(const dm_constraints *c) {
    return c->rolling * (1 + 3 * (size_t)c->n);
}

/* (q, v, t, lambda, mu, u) */
static size_t inputs(const dm_constraints *c) {
    return 2 * (size_t)c->n + 1 + c->holonomic + c->rolling + c->controls;
}

/* In the order of dm_curve_tie_open. */
size_t dm_curve_tie_work(const dm_model *m) {
    const dm_constraints *c = m->constraints;
    const size_t n = m->n, rows = dm_field_rows(m) - n;
    if (!c) return 0;
    return inputs(c) + 2 * held_size(c) + 2 * roll_size(c) + n + 2 * n * n + 4 * rows + n +
           (n + rows) + n + n * n;
}

/* Buffers of kernels get the outputs that never vary. */
static void prepare(dm_curve_tie *c, const dm_model *m) {
    dm_kernel_prepare(&m->mass, c->mass);
    if (c->k) dm_kernel_prepare(&c->c->holonomic_kernel, c->start);
    if (c->k) dm_kernel_prepare(&c->c->holonomic_kernel, c->end);
    if (c->l) dm_kernel_prepare(&c->c->rolling_kernel, c->roll_start);
    if (c->l) dm_kernel_prepare(&c->c->rolling_kernel, c->roll);
    if (c->m) dm_kernel_prepare(&c->c->reaction, c->reaction);
}

void dm_curve_tie_open(dm_curve_tie *c, const dm_model *m, double *memory) {
    const size_t n = m->n;
    *c = (dm_curve_tie){.c = m->constraints};
    if (!c->c) return;
    c->k = c->c->holonomic;
    c->l = c->c->rolling;
    c->m = c->k + c->l;
    c->x = dm_take(&memory, inputs(c->c));
    c->start = dm_take(&memory, held_size(c->c));
    c->end = dm_take(&memory, held_size(c->c));
    c->roll_start = dm_take(&memory, roll_size(c->c));
    c->roll = dm_take(&memory, roll_size(c->c));
    c->reaction = dm_take(&memory, n + 2 * n * n);
    c->unit = dm_take(&memory, c->m);
    c->pull = dm_take(&memory, c->m);
    c->impulse = dm_take(&memory, 2 * c->m);
    c->p0 = dm_take(&memory, n);
    c->hidden = dm_take(&memory, n + c->m);
    c->mass = dm_take(&memory, n + n * n);
    memset(c->x, 0, inputs(c->c) * sizeof *c->x);
    prepare(c, m);
}

/* ---- rows ---- */

/* x = (q, v, t) of the kernels */
static void place(dm_curve_tie *c, const double *q, const double *v, double t) {
    const size_t n = c->c->n;
    memcpy(c->x, q, n * sizeof *q);
    memcpy(c->x + n, v, n * sizeof *v);
    c->x[2 * n] = t;
}

/* the row that multiplier i pulls along, at the start, and the derivative of its equation */
static const double *pull_row(const dm_curve_tie *c, size_t i) {
    const size_t n = c->c->n;
    return i < c->k ? c->start + c->k + i * n : c->roll_start + c->l + (i - c->k) * n;
}

static const double *slope_row(const dm_curve_tie *c, size_t i) {
    const size_t n = c->c->n;
    return i < c->k ? c->end + c->k + i * n : c->roll + c->l + (c->l + i - c->k) * n;
}

/* NaN where there is one. */
static double largest(const double *x, size_t n) {
    double size = 0.0;
    for (size_t i = 0; i < n; i++) size = dm_largest(size, x[i]);
    return size;
}

/* A row of the equation in units of momentum, a multiplier in those of velocity. */
static dm_status find_units(dm_curve_step *e) {
    dm_curve_tie *c = &e->tie;
    c->stiffness = largest(e->mass, e->n);
    memcpy(c->end, c->start, held_size(c->c) * sizeof *c->end);
    memcpy(c->roll, c->roll_start, roll_size(c->c) * sizeof *c->roll);
    for (size_t i = 0; i < c->m; i++) {
        const double pull = largest(pull_row(c, i), e->n), slope = largest(slope_row(c, i), e->n);
        if (!isfinite(pull + slope)) return DM_NOT_FINITE;
        if (pull == 0.0 || slope == 0.0) return DM_SINGULAR;
        c->pull[i] = c->stiffness / pull;
        c->unit[i] = c->stiffness / (i < c->k ? fabs(e->h) * slope : slope);
    }
    return DM_OK;
}

/* Kernels of the field see them beside every point. */
static dm_status hold_controls(dm_curve_step *e) {
    dm_curve_tie *c = &e->tie;
    double *u = e->segment.held;
    if (!c->c->controls) return DM_OK;
    dm_kernel_prepare(&c->c->control, u);
    dm_kernel_eval(&c->c->control, c->x, u);
    return isfinite(largest(u, c->c->controls)) ? DM_OK : DM_NOT_FINITE;
}

/* A force alone has no rows. */
dm_status dm_curve_tie_begin(dm_curve_step *e, const double *v) {
    dm_curve_tie *c = &e->tie;
    if (!c->c) return DM_OK;
    place(c, e->state, v, e->t - (1.0 - e->curve.bias) * e->h);
    const dm_status status = hold_controls(e);
    if (status != DM_OK || !c->m) return status;
    if (c->k) dm_kernel_eval(&c->c->holonomic_kernel, c->x, c->start);
    if (c->l) dm_kernel_eval(&c->c->rolling_kernel, c->x, c->roll_start);
    return find_units(e);
}

/* ---- the equation ---- */

static const double *multipliers(const dm_curve_step *e, const double *z) {
    return z + (e->unknowns - e->tie.m);
}

/* E is that of (q0, v), with the v of the segment */
void dm_curve_tie_react(dm_curve_step *e, const double *z) {
    dm_curve_tie *c = &e->tie;
    const size_t n = e->n;
    const double *kappa = multipliers(e, z), *p0 = e->state + n;
    place(c, e->state, z, e->t - (1.0 - e->curve.bias) * e->h);
    for (size_t i = 0; i < c->m; i++) c->x[2 * n + 1 + i] = c->pull[i] * kappa[i];
    dm_kernel_eval(&c->c->reaction, c->x, c->reaction);
    if (c->l) dm_kernel_eval(&c->c->rolling_kernel, c->x, c->roll_start);
    for (size_t i = 0; i < n; i++) c->p0[i] = p0[i] + c->reaction[i];
}

/* g at q1 and phi at y. Rounding q moves g by G q, which is no error of the step. */
void dm_curve_tie_residual(dm_curve_step *e, double *r) {
    dm_curve_tie *c = &e->tie;
    const size_t n = e->n, first = e->unknowns - c->m;
    const double *at = e->segment.x; /* of the point y */
    if (c->l) {
        place(c, at, at + n, at[2 * n]);
        dm_kernel_eval(&c->c->rolling_kernel, c->x, c->roll);
    }
    place(c, e->state, at + n, e->t + e->curve.bias * e->h);
    for (size_t i = 0; i < n; i++) c->x[i] += e->y[i] + e->segment.plus[i];
    if (c->k) dm_kernel_eval(&c->c->holonomic_kernel, c->x, c->end);
    for (size_t i = 0; i < c->m; i++)
        r[first + i] = c->unit[i] * (i < c->k ? c->end[i] : c->roll[i - c->k]);
    if (c->k) e->size = fmax(e->size, c->stiffness * largest(e->state, n) / fabs(e->h));
    e->size = fmax(e->size, largest(c->reaction, n));
}

/* derivatives of g(q1) in y: row G on that of the end, 1 + plus_tangent */
static void add_end_row(const dm_curve_step *e, double *row, size_t i) {
    const size_t n = e->n, N = 2 * n;
    const double *G = slope_row(&e->tie, i), *Dp = e->segment.plus_tangent;
    for (size_t k = 0; k < n; k++)
        for (size_t j = 0; j < n; j++) {
            row[j] += e->tie.unit[i] * G[k] * Dp[k * N + n + j];
            if (e->curve.centred)
                row[N + j] += e->tie.unit[i] * e->h * G[k] * ((k == j) + Dp[k * N + j]);
        }
}

/* derivatives of phi(y) */
static void add_roll_row(const dm_curve_step *e, double *row, size_t i) {
    const size_t n = e->n;
    const double *phi_v = slope_row(&e->tie, i), *phi_q = phi_v + e->tie.l * n;
    for (size_t j = 0; j < n; j++) {
        row[j] += e->tie.unit[i] * phi_v[j];
        if (e->curve.centred) row[2 * n + j] += e->tie.unit[i] * e->h * phi_q[j];
    }
}

/* J += what the change w dR of R0 with the unknown of that column does, by (1 + minus_tangent)^T;
 * entries of dR are `stride` apart */
static void add_reaction(const dm_curve_step *e, double *J, size_t column, double w,
                         const double *dR, size_t stride) {
    const size_t n = e->n, N = 2 * n, m = e->unknowns;
    const double *Dm = e->segment.minus_tangent;
    for (size_t i = 0; i < n; i++) {
        J[i * m + column] += w * dR[i * stride];
        for (size_t k = 0; k < n && e->curve.centred; k++) {
            J[i * m + column] += Dm[k * N + i] * w * dR[k * stride];
            J[(n + i) * m + column] += Dm[k * N + n + i] * w * dR[k * stride] / e->h;
        }
    }
}

/* Columns of the multipliers, rows of the constraints; R0 turns with v where E does. */
void dm_curve_tie_matrix(const dm_curve_step *e, double *J) {
    const dm_curve_tie *c = &e->tie;
    const size_t n = e->n, m = e->unknowns, first = m - c->m;
    for (size_t i = 0; i < m; i++) {
        memset(J + i * m + first, 0, c->m * sizeof *J);
        if (i >= first) memset(J + i * m, 0, m * sizeof *J);
    }
    for (size_t j = 0; j < n; j++) add_reaction(e, J, j, 1.0, c->reaction + n + n * n + j, n);
    for (size_t i = 0; i < c->m; i++) {
        add_reaction(e, J, first + i, c->pull[i], pull_row(c, i), 1);
        if (i < c->k)
            add_end_row(e, J + (first + i) * m, i);
        else
            add_roll_row(e, J + (first + i) * m, i);
    }
}

/* ---- the hidden constraints ---- */

typedef struct {
    dm_curve_tie *c;
    const dm_model *m;
    const double *p, *q;
    double t, size;
} hiding;

/* kernels at (q, v, t) with the multipliers behind v; holonomic ones do not see v */
static void look(const hiding *e, const double *z) {
    dm_curve_tie *c = e->c;
    const size_t n = c->c->n;
    place(c, e->q, z, e->t);
    for (size_t i = 0; i < c->m; i++) c->x[2 * n + 1 + i] = c->pull[i] * z[n + i];
    dm_kernel_eval(&e->m->mass, c->x, c->mass);
    dm_kernel_eval(&c->c->reaction, c->x, c->reaction);
    if (c->l) dm_kernel_eval(&c->c->rolling_kernel, c->x, c->roll_start);
}

/* derivative of equation i in v */
static const double *hidden_row(const dm_curve_tie *c, size_t i) {
    const size_t n = c->c->n;
    return i < c->k ? pull_row(c, i) : pull_row(c, i) + c->l * n;
}

static void hidden_matrix(const dm_curve_tie *c, double *J) {
    const size_t n = c->c->n, m = n + c->m;
    const double *M = c->mass + n, *R_v = c->reaction + n + n * n;
    memset(J, 0, m * m * sizeof *J);
    for (size_t i = 0; i < n; i++)
        for (size_t j = 0; j < n; j++) J[i * m + j] = M[i * n + j] - R_v[i * n + j];
    for (size_t i = 0; i < c->m; i++)
        for (size_t j = 0; j < n; j++) {
            J[j * m + n + i] = -c->pull[i] * pull_row(c, i)[j];
            J[(n + i) * m + j] = c->unit[i] * hidden_row(c, i)[j];
        }
}

/* L_v = p + R, G v + g_t = 0, phi = 0 for z = (v, kappa), for dm_newton */
static dm_status hidden_equation(void *ctx, double *r, double *J, const double *z) {
    hiding *e = ctx;
    const dm_curve_tie *c = e->c;
    const size_t n = c->c->n;
    look(e, z);
    e->size = 0.0;
    for (size_t i = 0; i < n; i++) {
        r[i] = c->mass[i] - e->p[i] - c->reaction[i];
        e->size = fmax(e->size, fabs(c->mass[i]) + fabs(c->reaction[i]));
    }
    for (size_t i = 0; i < c->m; i++) {
        const double *G = pull_row(c, i);
        double sum = i < c->k ? c->start[c->k + c->k * n + i] : c->roll_start[i - c->k];
        for (size_t j = 0; j < n && i < c->k; j++) sum += G[j] * z[j];
        r[n + i] = c->unit[i] * sum;
    }
    if (J) hidden_matrix(c, J);
    return DM_OK;
}

/* rows at (q, v, t) and their units */
static dm_status hide_begin(hiding *e, const double *v) {
    dm_curve_tie *c = e->c;
    const size_t n = c->c->n;
    memcpy(c->hidden, v, n * sizeof *v);
    memset(c->hidden + n, 0, c->m * sizeof *c->hidden);
    place(c, e->q, v, e->t);
    if (c->k) dm_kernel_eval(&c->c->holonomic_kernel, c->x, c->start);
    look(e, c->hidden);
    const double M = largest(c->mass + n, n * n);
    for (size_t i = 0; i < c->m; i++) {
        const double pull = largest(pull_row(c, i), n), slope = largest(hidden_row(c, i), n);
        if (!isfinite(M + pull + slope)) return DM_NOT_FINITE;
        if (pull == 0.0 || slope == 0.0) return DM_SINGULAR;
        c->pull[i] = M / pull;
        c->unit[i] = M / slope;
    }
    return DM_OK;
}

/* The reaction is left in c->reaction; rows of the step are lost. */
dm_status dm_curve_tie_hide(dm_curve_step *e, const dm_stepper *s, double *v, const double *p,
                            const double *q, double t) {
    dm_curve_tie *c = &e->tie;
    const size_t n = e->n;
    hiding hide = {.c = c, .m = s->model, .p = p, .q = q, .t = t};
    dm_newton_report report = {0};
    const dm_newton_problem problem = {.m = (uint32_t)(n + c->m),
                                       .equation = hidden_equation,
                                       .ctx = &hide,
                                       .size = &hide.size,
                                       .place = q,
                                       .places = (uint32_t)n,
                                       .shared = (uint32_t)c->m,
                                       .over = e->h,
                                       .tolerance = s->tolerance,
                                       .max_iterations = s->max_iterations};
    dm_status status = hide_begin(&hide, v);
    if (status == DM_OK) status = dm_newton(c->hidden, &problem, e->scratch, &report);
    if (status != DM_OK) return status;
    look(&hide, c->hidden);
    memcpy(v, c->hidden, n * sizeof *v);
    return DM_OK;
}

/* ---- places where they cross ---- */

size_t dm_curve_tie_crossing_work(const dm_model *m) {
    const dm_constraints *c = m->constraints;
    return c && c->holonomic ? m->n + dm_crossing_work(c) : 0;
}

dm_status dm_curve_tie_look(dm_curve_step *e, double *watched, double t, dm_trouble *trouble) {
    const dm_curve_tie *c = &e->tie;
    const dm_crossing_way way = {.q0 = e->state, .q1 = e->next, .t0 = t, .t1 = t + e->h};
    dm_crossing_place place;
    *trouble = (dm_trouble){0};
    if (!c->k ||
        !dm_crossing_at_end(c->c, watched, c->start, c->mass + e->n, way, &place, e->scratch))
        return DM_OK;
    *trouble = (dm_trouble){.dependent = (int)place.row, .crosses = 1, .at = place.t};
    return DM_SINGULAR;
}

/* ---- impulses ---- */

/* Of the start: R0; rolling constraints act along the segment too. */
void dm_curve_tie_keep(dm_curve_step *e, const double *z) {
    dm_curve_tie *c = &e->tie;
    const double *kappa = multipliers(e, z);
    double *inside = c->hidden; /* [2][l] */
    for (size_t i = 0; i < c->m; i++) {
        c->impulse[i] = c->pull[i] * kappa[i];
        c->impulse[c->m + i] = 0.0;
    }
    dm_segment_impulses(&e->segment, inside);
    for (size_t i = 0; i < c->l; i++) {
        c->impulse[c->k + i] += inside[i];
        c->impulse[c->m + c->k + i] += inside[c->l + i];
    }
}

/* The multipliers that `hide` found for the end. */
void dm_curve_tie_end(dm_curve_step *e) {
    dm_curve_tie *c = &e->tie;
    for (size_t i = 0; i < c->m; i++) c->impulse[c->m + i] += c->pull[i] * c->hidden[e->n + i];
}
