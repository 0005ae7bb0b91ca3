/* lie.c - steps in the natural chart: guess, Newton's method, the end. */
#include "integ/lie/lie.h"

#include "integ/lie/lie_inside.h"
#include "integ/lie/lie_joints.h"
#include "integ/method/stage_table.h"
#include "integ/stage/stage.h"
#include "numbers/compensated.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* Free coordinates are those of rules of stages: the same equations, solved there. */
static const dm_engine *choose(const dm_rule *rule, const dm_model *m) {
    if (!m->group) return dm_engine_stage.choose(rule, m);
    return dm_lie_is_jointed(m) ? &dm_engine_lie_joints : &dm_engine_lie;
}

/* A static sentence, or NULL. */
static const char *fits(const dm_rule *rule, const dm_model *m) {
    (void)rule;
    return dm_group_graph(m) ? NULL : "its L must be traced";
}

/* One velocity a step: its curves are straight in the chart. */
static int is_straight(const dm_rule *rule, const dm_model *m) {
    dm_galerkin g;
    dm_stage_basis(&g, rule, m);
    return g.s == 1;
}

/* The chart of one tau; the mass for the first guess where it is no constant. */
static unsigned wants(const dm_rule *rule, const dm_model *m) {
    const unsigned mass = m->structure & DM_CONSTANT_MASS ? 0 : DM_WANT_MASS;
    const unsigned straight = is_straight(rule, m) ? DM_WANT_STRAIGHT : 0;
    return (unsigned)DM_WANT_CHART << dm_lie_tau(rule) | straight | mass;
}

/* ---- memory ---- */

static size_t doubles(size_t bytes) {
    return (bytes + sizeof(double) - 1) / sizeof(double);
}

/* The next `count` doubles; *memory moves behind them. */
static double *take(double **memory, size_t count) {
    double *block = *memory;
    *memory += count;
    return block;
}

static size_t larger(size_t a, size_t b) {
    return a > b ? a : b;
}

/* all arrays of *e, whose sizes are known, from `memory` on, `work` last */
static void lay_out(dm_lie *e, double *memory) {
    const size_t n = e->n, d = e->d, s = e->s, r = e->r, m = e->m;
    e->a = take(&memory, r * s);
    e->D = take(&memory, r * s);
    e->b = take(&memory, r);
    e->c = take(&memory, r);
    e->beta = take(&memory, s);
    e->x = take(&memory, n + 2 * d + 2);
    e->slope = take(&memory, 3 * d);
    e->curve = take(&memory, 3 * d * (2 * d + 1));
    e->V = take(&memory, m);
    e->xi = take(&memory, d);
    e->gain = take(&memory, d);
    e->mu = take(&memory, d);
    e->mu_V = take(&memory, d * m);
    e->row = take(&memory, m);
    e->seeing = (uint32_t *)(void *)take(&memory, doubles(d * sizeof *e->seeing));
    e->in = take(&memory, n + 2 * d);
    e->pull = take(&memory, d * (2 * d + 1));
    e->pulled = take(&memory, d);
    e->end = take(&memory, n + d + (e->group ? e->group->arcs : 0));
    e->memory = take(&memory, 2 + DM_LIE_KEPT * m);
    e->sizes = take(&memory, m);
    e->work = memory;
}

/* Pointers are laid out later. */
static dm_lie sizes(const dm_galerkin *g, const dm_model *m) {
    dm_lie e = {.model = m, .group = m->group, .n = m->n};
    e.d = dm_momenta(m);
    e.s = (uint32_t)g->s;
    e.r = (uint32_t)g->q.r;
    e.m = e.s * e.d;
    return e;
}

/* what lay_out takes before `work` */
static size_t arrays(const dm_lie *e) {
    const size_t n = e->n, d = e->d, s = e->s, r = e->r, m = e->m;
    const size_t coefficients = 2 * r * s + 2 * r + s, point = n + 2 * d + 2 + 3 * d;
    const size_t end = n + 2 * d + n + d + (e->group ? e->group->arcs : 0);
    return coefficients + point + 4 * d * (2 * d + 1) + m + 4 * d + d * m + end + 2 +
           DM_LIE_KEPT * m + 2 * m + doubles(d * sizeof *e->seeing);
}

/* Newton's method, the Legendre transform and the table of coefficients take turns. */
static size_t work(const dm_rule *rule, const dm_model *m) {
    dm_galerkin g;
    dm_stage_basis(&g, rule, m);
    const dm_lie e = sizes(&g, m);
    const size_t solving = larger(dm_newton_work(e.m), dm_legendre_work(m) + m->n);
    return doubles(sizeof e) + arrays(&e) + larger(solving, dm_stage_table_size(e.s, e.r));
}

/* The structure stands at the beginning of the workspace. */
static dm_lie *lie_of(const dm_stepper *s) {
    return (dm_lie *)(void *)s->work;
}

/* the coefficients of the rule in doubles: what is rounded alike everywhere stays variational */
static void fill(dm_lie *e, const dm_galerkin *g, double *memory) {
    dm_stage_table t;
    dm_stage_table_find(&t, g, e->model, memory);
    for (uint32_t i = 0; i < e->r; i++) {
        e->b[i] = dm_weight_double(t.b[i]);
        e->c[i] = dm_weight_double(t.c[i]);
        for (uint32_t j = 0; j < e->s; j++) {
            e->a[i * e->s + j] = dm_weight_double(t.a[i * e->s + j]);
            e->D[i * e->s + j] = dm_weight_double(t.d[i * e->s + j]);
        }
    }
    for (uint32_t j = 0; j < e->s; j++) e->beta[j] = dm_weight_double(t.beta[j]);
}

/* of what q and p gain, or where that is not known of q and p themselves */
static const dm_kernel *end_kernel(const dm_lie *e) {
    return e->group->change.outputs ? &e->group->change : &e->group->finish;
}

/* Constant outputs of the kernels are filled in once, here. */
static dm_status open(dm_stepper *s) {
    dm_galerkin g;
    dm_lie *e = lie_of(s);
    dm_stage_basis(&g, s->rule, s->model);
    *e = sizes(&g, s->model);
    lay_out(e, s->work + doubles(sizeof *e));
    fill(e, &g, e->work);
    memset(e->memory, 0, (2 + DM_LIE_KEPT * (size_t)e->m) * sizeof *e->memory);
    e->at = e->s == 1 ? &e->group->line : &e->group->slope;
    e->around = e->s == 1 ? &e->group->line_curve : &e->group->curve;
    dm_kernel_prepare(e->at, e->slope);
    dm_kernel_prepare(e->around, e->curve);
    dm_kernel_prepare(&e->group->pull, e->pull);
    dm_kernel_prepare(&e->group->pulled, e->pulled);
    dm_kernel_prepare(end_kernel(e), e->end);
    s->report.operations = e->around->operations;
    return DM_OK;
}

/* a run depends on its start alone */
static dm_status start(dm_stepper *s, double *state, double t, double h) {
    dm_lie *e = lie_of(s);
    (void)state, (void)t, (void)h;
    e->memory[0] = 0.0;
    return DM_OK;
}

/* What `keep` leaves. */
static size_t memory(dm_stepper *s, double **place) {
    const dm_lie *e = lie_of(s);
    *place = e->memory;
    return 2 + DM_LIE_KEPT * (size_t)e->m;
}

/* ---- a step ---- */

/* the velocity of the state at all nodes */
static dm_status guess_at_rest(dm_lie *e) {
    double *v = e->work + dm_legendre_work(e->model);
    memset(v, 0, e->n * sizeof *v);
    const dm_status status =
        dm_legendre_inverse(e->model, v, e->state, e->state + e->n, e->t, e->work);
    if (status != DM_OK) return status;
    for (uint32_t j = 0; j < e->s; j++) memcpy(e->V + j * e->d, v, e->d * sizeof *v);
    return DM_OK;
}

/* the polynomial through the last steps, node by node: V, 2 V - V', 3 V - 3 V' + V'' ... */
static dm_status guess(dm_lie *e) {
    static const double weights[DM_LIE_KEPT][DM_LIE_KEPT] = {{1},
                                                             {2, -1},
                                                             {3, -3, 1},
                                                             {4, -6, 4, -1},
                                                             {5, -10, 10, -5, 1}};
    const int count = (int)e->memory[0];
    if (!count || e->memory[1] != e->h) return guess_at_rest(e);
    memset(e->V, 0, e->m * sizeof *e->V);
    for (int k = 0; k < count; k++)
        for (uint32_t i = 0; i < e->m; i++)
            e->V[i] += weights[count - 1][k] * e->memory[2 + (size_t)k * e->m + i];
    return DM_OK;
}

/* Steps of another length tell nothing of the next one. */
static void keep(dm_lie *e) {
    double *last = e->memory + 2;
    const int count = e->memory[1] == e->h ? (int)e->memory[0] : 0;
    memmove(last + e->m, last, (DM_LIE_KEPT - 1) * (size_t)e->m * sizeof *last);
    memcpy(last, e->V, e->m * sizeof *last);
    e->memory[0] = count < DM_LIE_KEPT ? count + 1 : count;
    e->memory[1] = e->h;
}

/* the largest angle of the end of the step */
static double turn_of(const dm_lie *e) {
    double most = 0.0;
    for (uint32_t i = 0; i < e->group->arcs; i++) most = fmax(most, e->end[e->n + e->d + i]);
    return sqrt(most);
}

/* g1 and p1, or their changes, into `end`, at the V and p0 + P of the last evaluation */
static void find_end(dm_lie *e) {
    memset(e->xi, 0, e->d * sizeof *e->xi);
    for (uint32_t j = 0; j < e->s; j++)
        for (uint32_t k = 0; k < e->d; k++) e->xi[k] += e->h * e->beta[j] * e->V[j * e->d + k];
    memcpy(e->in, e->state, e->n * sizeof *e->in);
    memcpy(e->in + e->n, e->xi, e->d * sizeof *e->in);
    memcpy(e->in + e->n + e->d, e->mu, e->d * sizeof *e->in);
    dm_kernel_eval(end_kernel(e), e->in, e->end);
}

/* NaN and infinity. */
static int is_finite(const double *x, uint32_t count) {
    for (uint32_t i = 0; i < count; i++)
        if (!isfinite(x[i])) return 0;
    return 1;
}

/* past half a turn the chart is not that of the step: log would not find xi again; exp alone */
static dm_status check_end(dm_lie *e) {
    find_end(e);
    e->turn = turn_of(e);
    if (e->turn >= DM_LIE_LARGEST_TURN) return DM_NO_CONVERGENCE;
    e->turn = 0.0;
    return is_finite(e->end, e->n + e->d) ? DM_OK : DM_NOT_FINITE;
}

/* V from a guess; reports what it took. */
static dm_status solve(dm_lie *e, dm_stepper *s) {
    dm_newton_report report;
    static const double angle = 1.0; /* of this size are displacements in a chart */
    const dm_newton_problem problem = {.m = e->m,
                                       .equation = dm_lie_equation,
                                       .ctx = e,
                                       .size = &e->size,
                                       .place = &angle,
                                       .places = 1,
                                       .over = e->h,
                                       .tolerance = s->tolerance,
                                       .max_iterations = s->max_iterations};
    dm_status status = guess(e);
    if (status != DM_OK) return status;
    status = dm_newton(e->V, &problem, e->work, &report);
    s->report.solves++;
    s->report.iterations = report.iterations;
    s->report.newton += report.iterations;
    s->report.residual = report.residual;
    s->report.evaluations += (long)e->r * (report.iterations + 1);
    return status;
}

/* a step that was guessed far away is tried once more from the velocity of the state; one that
 * fails there too tells the turn of that guess */
static dm_status solve_again(dm_lie *e, dm_stepper *s, dm_status status) {
    if (e->memory[0] > 0.0) {
        e->memory[0] = 0.0;
        status = solve(e, s);
        if (status == DM_OK) status = check_end(e);
    }
    if (status == DM_OK || e->turn > 0.0) return status;
    if (guess_at_rest(e) == DM_OK) check_end(e);
    return status;
}

/* from `end` into the state, q[n], p[n] and their low parts behind them; what the element gains in
 * a step is of size h */
static void finish(const dm_lie *e, double *state) {
    const uint32_t n = e->n, d = e->d;
    if (!e->group->change.outputs) {
        memcpy(state, e->end, n * sizeof *state);
        memcpy(state + n, e->end + n, d * sizeof *state);
        return;
    }
    dm_sum_add_n(state, state + 2 * (size_t)n, e->end, n);
    for (uint32_t k = 0; k < d; k++)
        dm_sum_add(state + n + k, state + 3 * (size_t)n + k, e->gain[k] + e->end[n + k]);
}

/* The state is changed at the end alone. */
static dm_status step(dm_stepper *s, double *state, double t, double h) {
    dm_lie *e = lie_of(s);
    e->state = state;
    e->t = t;
    e->h = h;
    e->turn = 0.0;
    memcpy(e->x, state, e->n * sizeof *state);
    dm_status status = solve(e, s);
    if (status == DM_OK) status = check_end(e);
    if (status != DM_OK) status = solve_again(e, s, status);
    if (status != DM_OK) return status;
    finish(e, state);
    keep(e);
    return DM_OK;
}

/* Both engines say the same. */
const char *dm_lie_why(char *text, size_t size, double turn, dm_status status) {
    if (status == DM_SINGULAR)
        return "is L degenerate in the velocity there, d2L/dxi2 without an inverse?";
    if (!(turn > 0.0)) return NULL;
    snprintf(text, size, "h turns the body by %.1f rad; the chart ends at pi: take a smaller step",
             turn);
    return text;
}

/* What the step left. */
static const char *why(dm_stepper *s, const double *state, dm_status status) {
    dm_lie *e = lie_of(s);
    (void)state;
    return dm_lie_why(e->text, sizeof e->text, e->turn, status);
}

const dm_engine dm_engine_lie = {
    .choose = choose,
    .fits = fits,
    .wants = wants,
    .work = work,
    .open = open,
    .start = start,
    .step = step,
    .memory = memory,
    .why = why,
};
