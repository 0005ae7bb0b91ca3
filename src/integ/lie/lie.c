/* lie.c - steps in the natural chart: guess, Newton's method, the end. */
#include "integ/lie/lie.h"

#include "base/doubles.h"
#include "code/native/jit.h"
#include "integ/lie/lie_joints.h"
#include "integ/lie/lie_lanes.h"
#include "integ/method/stage_table.h"
#include "integ/stage/stage.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#define W 1
#define HOW
#define DM_LANES_FUSED 0
#include "integ/lie/lie_step_text.h"

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

size_t dm_lie_lay_out(dm_lie *e, uint32_t lanes, double *memory) {
    const size_t n = e->n, d = e->d, s = e->s, r = e->r, m = e->m, w = lanes;
    const size_t arcs = e->group ? e->group->arcs : 0;
    dm_layout to = {memory, 0};
    e->a = dm_layout_take(&to, r * s);
    e->D = dm_layout_take(&to, r * s);
    e->b = dm_layout_take(&to, r);
    e->c = dm_layout_take(&to, r);
    e->beta = dm_layout_take(&to, s);
    e->seeing = (uint32_t *)(void *)dm_layout_take(&to, dm_doubles(d * sizeof *e->seeing));
    to.used = (to.used + 7) / 8 * 8; /* what follows are vectors */
    e->h = dm_layout_take(&to, w);
    e->x = dm_layout_take(&to, (n + 2 * d + 2) * w);
    e->slope = dm_layout_take(&to, 3 * d * w);
    e->curve = dm_layout_take(&to, 3 * d * (2 * d + 1) * w);
    e->V = dm_layout_take(&to, m * w);
    e->xi = dm_layout_take(&to, d * w);
    e->gain = dm_layout_take(&to, d * w);
    e->mu = dm_layout_take(&to, d * w);
    e->mu_V = dm_layout_take(&to, d * m * w);
    e->row = dm_layout_take(&to, m * w);
    e->sees = dm_layout_take(&to, d * w);
    e->in = dm_layout_take(&to, (n + 2 * d + 3) * w);
    e->pull = dm_layout_take(&to, d * (2 * d + 1) * w);
    e->pulled = dm_layout_take(&to, d * w);
    e->end = dm_layout_take(&to, (n + d + arcs) * w);
    e->sizes = dm_layout_take(&to, m * w);
    e->room = dm_layout_take(&to, dm_group_map_room(n + 7 * d + 2));
    e->memory = dm_layout_take(&to, (2 + DM_LIE_KEPT * m) * w);
    e->work = dm_layout_take(&to, 0);
    return to.used;
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

/* Newton's method, the Legendre transform and the table of coefficients take turns. */
static size_t work(const dm_rule *rule, const dm_model *m) {
    dm_galerkin g;
    dm_stage_basis(&g, rule, m);
    dm_lie e = sizes(&g, m);
    const size_t solving = dm_larger(dm_newton_work(e.m), dm_legendre_work(m) + m->n);
    return dm_doubles(sizeof e) + dm_lie_lay_out(&e, 1, NULL) +
           dm_larger(solving, dm_stage_table_size(e.s, e.r));
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
static const dm_kernel *end_kernel(const dm_group *group) {
    return group->change.outputs ? &group->change : &group->finish;
}

static void prepare(const dm_kernel *k, uint32_t lanes, double *out) {
    if (lanes > 1)
        dm_kernel_prepare_lanes(k, lanes, out);
    else
        dm_kernel_prepare(k, out);
}

/* Constant outputs of the kernels are filled in once, here. */
void dm_lie_choose(dm_lie *e, const dm_group *group, uint32_t lanes) {
    e->group = group;
    e->at = e->s == 1 ? &group->line : &group->point;
    e->last = end_kernel(group);
    prepare(&e->at->plain, lanes, e->slope);
    dm_group_map_prepare(e->at, lanes, e->curve);
    prepare(&group->pull.plain, lanes, e->pulled);
    dm_group_map_prepare(&group->pull, lanes, e->pull);
    e->is_free = e->s == 1 && e->r == 1 && group->free.outputs;
    if (e->is_free) prepare(&group->free_matrix, lanes, e->pull);
    prepare(e->last, lanes, e->end);
}

static dm_status open(dm_stepper *s) {
    dm_galerkin g;
    dm_lie *e = dm_lie_of(s);
    dm_stage_basis(&g, s->rule, s->model);
    *e = sizes(&g, s->model);
    dm_lie_lay_out(e, 1, s->work + dm_doubles(sizeof *e));
    fill(e, &g, e->work);
    memset(e->memory, 0, (2 + DM_LIE_KEPT * (size_t)e->m) * sizeof *e->memory);
    dm_lie_choose(e, e->group, 1);
    s->report.operations = (e->at->whole.outputs ? e->at->whole : e->at->row).operations;
    return DM_OK;
}

/* a run depends on its start alone */
static dm_status start(dm_stepper *s, double *state, double t, double h) {
    dm_lie *e = dm_lie_of(s);
    (void)state, (void)t, (void)h;
    e->memory[0] = 0.0;
    return DM_OK;
}

/* What `keep` leaves. */
static size_t memory(dm_stepper *s, double **place) {
    const dm_lie *e = dm_lie_of(s);
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

/* from the steps before, or from the state alone */
static dm_status guess(dm_lie *e) {
    return guess_ahead(e) ? DM_OK : guess_at_rest(e);
}

/* past half a turn the chart is not that of the step: log would not find xi again */
static dm_status check_end(dm_lie *e) {
    find_end(e);
    e->turn = sqrt(arc_of(e));
    if (e->turn >= dm_lie_reach(e->group->tau)) return DM_NO_CONVERGENCE;
    e->turn = 0.0;
    return has_finite_end(e) ? DM_OK : DM_NOT_FINITE;
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
                                       .over = *e->h,
                                       .tolerance = s->tolerance,
                                       .max_iterations = s->max_iterations};
    dm_status status = guess(e);
    if (status != DM_OK) return status;
    status = dm_newton(e->V, &problem, e->work, &report);
    if (status == DM_OK) correct_momenta(e, e->work);
    s->report.solves++;
    s->report.iterations = report.iterations;
    s->report.newton += report.iterations;
    s->report.matrices += report.jacobians;
    s->report.residual = report.residual;
    s->report.evaluations += (long)e->r * (report.iterations + 1);
    return status;
}

/* a step that was guessed far away is tried once more from the velocity of the state; one that
 * fails there too tells the turn by that velocity */
static dm_status solve_again(dm_lie *e, dm_stepper *s, dm_status status) {
    if (e->memory[0] > 0.0) {
        e->memory[0] = 0.0;
        status = solve(e, s);
        if (status == DM_OK) status = check_end(e);
    }
    if (status == DM_OK || e->turn > 0.0) return status;
    if (status != DM_SINGULAR && guess_at_rest(e) == DM_OK) {
        find_end(e);
        e->turn = dm_lie_told_turn(sqrt(arc_of(e)), e->group->tau);
    }
    return status;
}

/* The state is changed at the end alone. */
static dm_status step(dm_stepper *s, double *state, double t, double h) {
    dm_lie *e = dm_lie_of(s);
    e->state = state;
    e->t = t;
    *e->h = h;
    e->turn = 0.0;
    memcpy(e->x, state, e->n * sizeof *state);
    dm_status status = solve(e, s);
    if (status == DM_OK) status = check_end(e);
    if (status != DM_OK) status = solve_again(e, s, status);
    s->report.trouble.turn = e->turn;
    if (status != DM_OK) return status;
    leave_end(e, 1);
    keep_step(e, 1);
    return DM_OK;
}

/* Both engines say the same. */
const char *dm_lie_why(char *text, size_t size, double turn, dm_tau tau, dm_status status) {
    if (status == DM_SINGULAR)
        return "is L degenerate in the velocity there, d2L/dxi2 without an inverse?";
    if (!(turn > 0.0) || status == DM_INERTIA) return NULL;
    snprintf(text, size,
             tau == DM_TAU_EXP
                 ? "h turns the body by %.1f rad; the chart ends at pi: take a smaller step"
                 : "xi of the step is %.1f, and roots so far away turn the body elsewhere: take a "
                   "smaller step, or exp",
             turn);
    return text;
}

/* What the step left. */
static const char *why(dm_stepper *s, const double *state, dm_status status) {
    dm_lie *e = dm_lie_of(s);
    (void)state;
    return dm_lie_why(e->text, sizeof e->text, s->report.trouble.turn, e->group->tau, status);
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
    .widen = dm_lie_widen,
    .advance_lanes = dm_lie_advance_lanes,
    .why = why,
};
