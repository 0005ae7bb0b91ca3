#include "integ/lie/lie_joints.h"

#include "integ/lie/lie_joints_inside.h"

#include <math.h>
#include <string.h>

enum { MANY = 24 }; /* dimensions for which a matrix is worth a look at its entries */

/* Controls too are told by kernels of this engine alone. */
int dm_lie_is_jointed(const dm_model *m) {
    const dm_constraints *c = m->constraints;
    return dm_momenta(m) > MANY || (c && c->holonomic + c->rolling + c->controls > 0);
}

/* A static sentence, or NULL. */
static const char *fits(const dm_rule *rule, const dm_model *m) {
    (void)rule;
    return dm_group_graph(m) ? NULL : "its L must be traced";
}

/* The chart of one tau, by entries; what the model has of constraints; the mass for the first guess
 * where it is no constant. */
static unsigned wants(const dm_rule *rule, const dm_model *m) {
    const dm_constraints *c = m->constraints;
    const unsigned mass = m->structure & DM_CONSTANT_MASS ? 0 : DM_WANT_MASS;
    dm_galerkin g;
    dm_stage_basis(&g, rule, m);
    return (unsigned)DM_WANT_CHART << dm_lie_tau(rule) | DM_WANT_JOINTS | mass |
           (g.s == 1 ? DM_WANT_STRAIGHT : 0) | (c && c->holonomic ? DM_WANT_HOLONOMIC : 0) |
           (c && c->rolling ? DM_WANT_ROLLING : 0) |
           (c && c->controls ? DM_WANT_CONSTRAINT_FORCE : 0);
}

/* a run depends on its start alone */
static dm_status start(dm_stepper *s, double *state, double t, double h) {
    dm_lie_joints *e = dm_lie_joints_of(s);
    (void)state, (void)t, (void)h;
    e->memory[DM_LIE_AT_COUNT] = e->memory[DM_LIE_AT_MASS] = 0.0;
    memset(e->memory + DM_LIE_AT_VOLUMES, 0, DM_CROSSING_WATCHED * sizeof *e->memory);
    return DM_OK;
}

static size_t memory(dm_stepper *s, double **place) {
    const dm_lie_joints *e = dm_lie_joints_of(s);
    *place = e->memory;
    return dm_lie_joints_memory_size(e);
}

/* Where the constraints have no row a multiplier acts nowhere. */
static double unit(double mass, double size) {
    return size > 0.0 ? mass / size : 1.0;
}

/* ---- units: once a run ---- */

/* the largest entry of d2L/dv2 at the start, and its diagonal: that of L_rate by the rate where the
 * chart begins */
static double find_mass(dm_lie_joints *e, double *own) {
    const dm_group_entries *f = e->along;
    const uint32_t d = e->d;
    double most = 0.0, *M = e->work;
    memset(M, 0, (size_t)d * d * sizeof *M);
    memset(e->x + e->n, 0, 2 * d * sizeof *e->x);
    e->x[e->n + 2 * d] = e->t;
    dm_group_entries_eval(f, e->x, e->slope, 1);
    for (uint32_t i = 0; i < f->count; i++) {
        if (!(f->row[i] >= 2 * d && f->column[i] >= d && f->column[i] < 2 * d)) continue;
        const double entry = fabs(e->slope[f->values + i]);
        M[(f->row[i] - 2 * d) * (size_t)d + f->column[i] - d] = entry;
        most = fmax(most, entry);
    }
    const dm_crossing_mass mass = {M, d, d};
    dm_crossing_weights(own, &mass, e->constraints && e->constraints->prolonged);
    for (uint32_t i = 0; i < d; i++) own[i] = 1.0 / own[i];
    return most > 0.0 && most < INFINITY ? most : 1.0;
}

static double largest(const double *x, uint32_t count) {
    double most = 0.0;
    for (uint32_t i = 0; i < count; i++) most = fmax(most, fabs(x[i]));
    return most;
}

/* largest entries of the rows of G and phi_v, and of G and E */
static void find_sizes(dm_lie_joints *e, double *rows, double *impulses) {
    const size_t n = e->n;
    dm_lie_joints_look(e, e->state, e->v, e->t);
    for (uint32_t c = 0; c < e->k; c++)
        rows[c] = impulses[c] = largest(e->holonomic + e->k + c * n, e->n);
    for (uint32_t c = 0; c < e->l; c++) {
        const double *E = e->rolling + e->l + c * n;
        impulses[e->k + c] = largest(E, e->n);
        rows[e->k + c] = largest(E + e->l * n, e->n);
    }
}

static void take_units(dm_lie_joints *e) {
    double *rows = e->memory + DM_LIE_AT_UNITS, *impulses = rows + e->m;
    if (!(e->memory[DM_LIE_AT_MASS] > 0.0)) {
        e->memory[DM_LIE_AT_MASS] = find_mass(e, impulses + e->m);
        if (e->m) find_sizes(e, rows, impulses);
    }
    e->mass = e->memory[DM_LIE_AT_MASS];
    for (uint32_t c = 0; c < e->m; c++) {
        e->row_unit[c] = unit(e->mass, rows[c]);
        e->impulse_unit[c] = unit(e->mass, impulses[c]);
    }
}

/* ---- a step ---- */

/* velocity at the start */
static dm_status find_velocity(dm_lie_joints *e, double *v) {
    memset(v, 0, e->n * sizeof *v);
    return dm_legendre_inverse(e->model, v, e->state, e->state + e->n, e->t, e->work);
}

/* the velocity of the state at all nodes, no impulses */
static dm_status guess_at_rest(dm_lie_joints *e) {
    double *v = e->work + dm_legendre_work(e->model);
    const dm_status status = find_velocity(e, v);
    if (status != DM_OK) return status;
    memset(e->z, 0, e->N * sizeof *e->z);
    for (uint32_t j = 0; j < e->s; j++) memcpy(e->z + j * e->d, v, e->d * sizeof *v);
    return DM_OK;
}

/* do the velocities of the guess go not much further than those of the last two steps? (is_near of
 * lie_step_text.h) */
static int is_near(const dm_lie_joints *e, const double *kept) {
    const uint32_t m = e->s * e->d;
    return largest(e->z, m) <= 4.0 * fmax(largest(kept, m), largest(kept + e->N, m));
}

/* polynomials through the last steps: z, 2 z - z', 3 z - 3 z' + z'' ... */
static dm_status guess(dm_lie_joints *e) {
    static const double weights[DM_LIE_JOINTS_KEPT][DM_LIE_JOINTS_KEPT] = {{1},
                                                                           {2, -1},
                                                                           {3, -3, 1},
                                                                           {4, -6, 4, -1},
                                                                           {5, -10, 10, -5, 1}};
    const int count = (int)e->memory[DM_LIE_AT_COUNT];
    const double *kept = e->memory + dm_lie_joints_kept(e);
    if (!count || e->memory[DM_LIE_AT_H] != e->h) return guess_at_rest(e);
    memset(e->z, 0, e->N * sizeof *e->z);
    for (int k = 0; k < count; k++)
        for (uint32_t i = 0; i < e->N; i++)
            e->z[i] += weights[count - 1][k] * kept[(size_t)k * e->N + i];
    return is_near(e, kept) ? DM_OK : guess_at_rest(e);
}

/* Steps of another length tell nothing of the next one. */
static void keep(dm_lie_joints *e) {
    double *last = e->memory + dm_lie_joints_kept(e);
    const int count = e->memory[DM_LIE_AT_H] == e->h ? (int)e->memory[DM_LIE_AT_COUNT] : 0;
    memmove(last + e->N, last, (DM_LIE_JOINTS_KEPT - 1) * (size_t)e->N * sizeof *last);
    memcpy(last, e->z, e->N * sizeof *last);
    e->memory[DM_LIE_AT_COUNT] = count < DM_LIE_JOINTS_KEPT ? count + 1 : count;
    e->memory[DM_LIE_AT_H] = e->h;
}

dm_status dm_lie_joints_newton(dm_lie_joints *e, const dm_stepper *s, dm_newton_report *report) {
    static const double angle = 1.0; /* of this size are displacements in a chart */
    const dm_newton_problem problem = {.m = e->N,
                                       .equation = dm_lie_joints_equation,
                                       .ctx = e,
                                       .size = &e->size,
                                       .band = dm_step_matrix_band(&e->step),
                                       .place = &angle,
                                       .places = 1,
                                       .exact = 1,
                                       .shared = e->N - e->s * e->d,
                                       .over = e->h,
                                       .tolerance = s->tolerance,
                                       .max_iterations = s->max_iterations};
    memcpy(e->x, e->state, e->n * sizeof *e->x);
    dm_status status = dm_newton(e->z, &problem, e->work, report);
    if (status == DM_OK) status = dm_lie_joints_equation(e, e->work, NULL, e->z);
    e->iterations += report->iterations;
    e->matrices += report->jacobians;
    e->residual = report->residual;
    return status;
}

/* z from a guess to the root, and to the end of the step */
static dm_status solve(dm_lie_joints *e, const dm_stepper *s) {
    dm_newton_report report = {0};
    dm_status status = guess(e);
    if (status != DM_OK) return status;
    dm_lie_joints_turning_guess(e);
    status = dm_lie_joints_newton(e, s, &report);
    if (status == DM_OK) status = dm_lie_joints_finish(e, s);
    return status == DM_OK && dm_lie_joints_turn(e) ? dm_lie_joints_turning_end(e, s) : status;
}

/* a constraint that depends on those before it at the start of the step or where it ended */
static uint32_t dependent(dm_lie_joints *e, const double *q) {
    dm_lie_joints_look(e, q, e->last, e->t);
    return dm_constraints_dependent(e->constraints, e->k ? e->holonomic : NULL,
                                    e->l ? e->rolling : NULL, DM_CONSTRAINTS_NEAR, e->work);
}

/* that by the velocity of the start */
static void tell_turn(dm_lie_joints *e) {
    if (find_velocity(e, e->v) != DM_OK) return;
    for (uint32_t i = 0; i < e->d; i++) e->xi[i] = e->h * e->v[i];
    dm_lie_joints_carry(e, e->end, e->xi, e->state + e->n, 1.0);
    e->turn = dm_lie_told_turn(dm_lie_joints_arc(e), e->joints->tau);
}

/* a step that was guessed far away is tried once more from the velocity of the state; one that
 * fails there too tells the turn of that guess, or which constraint it lost */
static dm_status solve_again(dm_lie_joints *e, const dm_stepper *s, dm_status status) {
    if (e->memory[DM_LIE_AT_COUNT] > 0.0) {
        e->memory[DM_LIE_AT_COUNT] = 0.0;
        e->turn = 0.0;
        status = solve(e, s);
    }
    if (status == DM_OK || e->turn > 0.0) return status;
    if (e->m && find_velocity(e, e->v) == DM_OK) {
        memcpy(e->last, e->v, e->d * sizeof *e->last);
        e->lost = dependent(e, e->state);
        if (!e->lost) e->lost = dependent(e, e->end);
    }
    if (!e->lost && status != DM_SINGULAR) tell_turn(e);
    return e->lost ? DM_SINGULAR : status;
}

/* |g| and |phi| at the end of the step */
static void report_constraints(const dm_lie_joints *e, dm_report *report) {
    if (e->k) report->constraint = fmax(report->constraint, largest(e->holonomic, e->k));
    if (e->l) report->rolling = fmax(report->rolling, largest(e->rolling, e->l));
}

/* what a step holds: its controls, and the velocity at its start where reactions turn with it */
static dm_status begin(dm_lie_joints *e) {
    const dm_constraints *c = e->constraints;
    const int asks = e->joints->turns || (c && c->controls);
    memcpy(e->x, e->state, e->n * sizeof *e->x);
    memset(e->v, 0, e->n * sizeof *e->v);
    const dm_status status = asks ? find_velocity(e, e->v) : DM_OK;
    if (status != DM_OK || !c || !c->controls) return status;
    memset(e->end_x, 0, (2 * (size_t)e->n + 1 + e->m + c->controls) * sizeof *e->end_x);
    memcpy(e->end_x, e->state, e->n * sizeof *e->end_x);
    memcpy(e->end_x + e->n, e->v, e->d * sizeof *e->end_x);
    e->end_x[2 * e->n] = e->t;
    double *u = e->x + e->n + 3 * e->d + 1 + e->m;
    dm_kernel_prepare(&c->control, u);
    dm_kernel_eval(&c->control, e->end_x, u);
    return DM_OK;
}

/* The state is changed at the end alone. */
static dm_status step(dm_stepper *s, double *state, double t, double h) {
    dm_lie_joints *e = dm_lie_joints_of(s);
    e->state = state;
    e->t = t;
    e->h = h;
    e->turn = 0.0;
    e->lost = 0;
    s->report.trouble = (dm_trouble){0};
    e->evaluations = 0;
    e->iterations = e->matrices = 0;
    memcpy(e->end, state, e->n * sizeof *state);
    dm_status status = begin(e);
    if (status != DM_OK) return status;
    take_units(e);
    status = solve(e, s);
    if (status != DM_OK) status = solve_again(e, s, status);
    s->report.solves++;
    s->report.iterations = e->iterations;
    s->report.newton += e->iterations;
    s->report.matrices += e->matrices;
    s->report.residual = e->residual;
    s->report.evaluations += e->evaluations;
    s->report.trouble = (dm_trouble){.turn = e->turn, .dependent = (int)e->lost};
    if (status != DM_OK) return status;
    if (dm_lie_joints_cross(e, &s->report.trouble)) return DM_SINGULAR;
    report_constraints(e, &s->report);
    memcpy(state, e->end, e->n * sizeof *state);
    memcpy(state + e->n, e->end + e->n, e->d * sizeof *state);
    keep(e);
    return DM_OK;
}

static void impulses(const dm_stepper *s, double *out) {
    const dm_lie_joints *e = dm_lie_joints_of(s);
    memcpy(out, e->momenta, (e->K + 1) * (size_t)e->m * sizeof *out);
}

/* Of a singular matrix with constraints the general advice speaks of both. */
static const char *why(dm_stepper *s, const double *state, dm_status status) {
    dm_lie_joints *e = dm_lie_joints_of(s);
    (void)state;
    if (status == DM_SINGULAR && e->m) return NULL;
    return dm_lie_why(e->text, sizeof e->text, s->report.trouble.turn, e->joints->tau, status);
}

const dm_engine dm_engine_lie_joints = {
    .fits = fits,
    .wants = wants,
    .work = dm_lie_joints_work,
    .open = dm_lie_joints_open,
    .start = start,
    .step = step,
    .memory = memory,
    .impulses = impulses,
    .why = why,
};
