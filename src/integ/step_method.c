/* step_method.c - dm.step as a rule: one row for all steps that scripts write. */
#include "integ/step_method.h"

#include "base/doubles.h"
#include "integ/method/method.h"
#include "integ/step_inside.h"
#include "linalg/solve/newton.h"
#include "mech/group.h"
#include "numbers/compensated.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* of the size of the terms at the start: a residual above is none of round-off, nor of a tolerance
 * that was asked for */
static const double LEFT = 1e-6;
/* of an element that `next` gives, from its group */
static const double OFF = 1e-8;

/* States whose parts are known, in the memory of the stepper, since the state of a run has no room
 * for them: where the last step began, where it led, and where another step from there led, as
 * those on the side do that look for events. Each has a mark (1: it is there), q[n], p[d], t and
 * parts[w]. */
enum { BASE, FIRST, OTHER, PLACES };

enum { CONDITIONS = 64 }; /* at most */

/* What dm.step said of it. */
static const dm_step_row *row_of(const dm_rule *rule) {
    return rule->data;
}

/* The name alone is no step. */
static const char *check(const dm_rule *rule) {
    return rule->data ? NULL : "a step is made by dm.step { equation =, next =, start = }";
}

/* As declared. */
static int order(const dm_rule *rule) {
    return rule->data ? row_of(rule)->order : 0;
}

/* Nothing of L but what a start needs. */
static unsigned wants(const dm_rule *rule, const dm_model *m) {
    (void)rule;
    return m->structure & (DM_CONSTANT_MASS | DM_HAMILTONIAN) ? 0 : DM_WANT_MASS;
}

/* As `open` lays it out. */
static size_t work(const dm_rule *rule, const dm_model *m) {
    const dm_step_row *row = row_of(rule);
    const size_t k = row ? row->unknowns : 0, states = m->n + (size_t)dm_momenta(m) + 1;
    const size_t y = states + (row ? row->parts : 0);
    return dm_doubles(sizeof(dm_made_step)) + 4 * y + 2 * (size_t)m->n + 3 + k + k + k * k + 2 * k +
           CONDITIONS + dm_step_watched(row) + PLACES * (1 + y) + dm_step_scratch(m, k);
}

/* It stands at the beginning of the workspace. */
static dm_made_step *step_of(const dm_stepper *s) {
    return (dm_made_step *)(void *)s->work;
}

/* Constant outputs of all kernels are filled in here. */
static dm_status open(dm_stepper *s) {
    dm_made_step *e = step_of(s);
    const dm_step_kernels *k = s->brought;
    const size_t y = k->n + (size_t)k->d + 1 + k->w, m = k->m;
    *e = (dm_made_step){.k = k, .in = s->work + dm_doubles(sizeof *e), .pace = 1.0};
    e->short_in = e->in + y + m + 1;
    e->out = e->short_in + y + 1;
    e->x = e->out + m + m * m;
    e->scale = e->x + m;
    e->after = e->scale + m;
    e->reached = e->after + y + 1;
    e->low = e->reached + y;
    e->inside = e->low + 2 * (size_t)k->n;
    e->watched = e->inside + CONDITIONS;
    e->places = e->watched + dm_step_watched(row_of(s->rule));
    e->row = row_of(s->rule);
    e->ties = e->row->holonomic + e->row->rolling;
    e->newton = e->places + PLACES * (1 + y);
    memset(e->scale, 0, m * sizeof *e->scale);
    memset(e->places, 0, PLACES * (1 + y) * sizeof *e->places);
    dm_kernel_prepare(&k->tangent, e->out);
    dm_kernel_prepare(&k->next, e->after);
    if (k->scale.outputs) dm_kernel_prepare(&k->scale, e->scale);
    if (k->inside.outputs) dm_kernel_prepare(&k->inside, e->inside);
    s->report.operations = k->tangent.operations;
    return DM_OK;
}

/* ---- parts ---- */

/* its mark; behind it q, p, t, parts */
static double *place_of(const dm_made_step *e, int which) {
    return e->places + (size_t)which * (1 + dm_step_numbers(e));
}

/* Has t a part in what a state is? Only where it is not counted from the number of the step. */
static int is_timed(const dm_stepper *s) {
    return (s->rule->method->traits & DM_OWN_TIME) != 0;
}

/* where the parts of (q, p, t) are known, -1: nowhere; the newest first */
static int find(const dm_stepper *s, const double *y) {
    const dm_made_step *e = step_of(s);
    const size_t key = dm_step_states(e) - (is_timed(s) ? 0 : 1);
    for (int which = OTHER; which >= BASE; which--) {
        const double *place = place_of(e, which);
        if (place[0] != 0.0 && memcmp(place + 1, y, key * sizeof *y) == 0) return which;
    }
    return -1;
}

/* parts[w] of y = (q, p, t): those that a step left, or those of a beginning */
static void find_parts(const dm_stepper *s, double *parts, const double *y) {
    dm_made_step *e = step_of(s);
    const size_t states = dm_step_states(e), w = e->k->w;
    const int which = find(s, y);
    memset(parts, 0, w * sizeof *parts);
    if (which >= 0) {
        memcpy(parts, place_of(e, which) + 1 + states, w * sizeof *parts);
    } else if (e->k->begin.outputs) {
        memcpy(e->short_in, y, (states - 1) * sizeof *y);
        e->short_in[states - 1] = e->h;
        dm_kernel_prepare(&e->k->begin, parts);
        dm_kernel_eval(&e->k->begin, e->short_in, parts);
    }
}

/* y with its parts */
static void put(dm_made_step *e, int which, const double *y) {
    double *place = place_of(e, which);
    place[0] = 1.0;
    memcpy(place + 1, y, dm_step_numbers(e) * sizeof *y);
}

/* a step led from `before` to `after`: another one from the same state is one on the side */
static void keep(const dm_stepper *s, const double *before, const double *after) {
    dm_made_step *e = step_of(s);
    const int again = find(s, before) == BASE;
    if (!again) {
        put(e, BASE, before);
        place_of(e, FIRST)[0] = place_of(e, OTHER)[0] = 0.0;
    }
    put(e, place_of(e, FIRST)[0] != 0.0 ? OTHER : FIRST, after);
}

static size_t memory(dm_stepper *s, double **place) {
    const dm_made_step *e = step_of(s);
    *place = e->watched;
    return dm_step_watched(row_of(s->rule)) + (e->k->w ? PLACES * (1 + dm_step_numbers(e)) : 0);
}

/* A run begins: of its state no parts are known. */
static dm_status start(dm_stepper *s, double *state, double t, double h) {
    dm_made_step *e = step_of(s);
    double *own = state + 4 * (size_t)e->k->n;
    memset(e->places, 0, PLACES * (1 + dm_step_numbers(e)) * sizeof *e->places);
    memset(e->watched, 0, dm_step_watched(row_of(s->rule)) * sizeof *e->watched);
    e->h = h;
    if (is_timed(s)) own[0] = t, own[1] = own[2] = 0.0;
    return DM_OK;
}

/* t of a state, where it carries one. */
static double pace(const dm_stepper *s, const double *state) {
    (void)state;
    return step_of(s)->pace;
}

/* (q, p, t) from the state of a run */
static void read_state(const dm_made_step *e, double *y, const double *state, double t) {
    const size_t n = e->k->n, d = e->k->d;
    memcpy(y, state, n * sizeof *y);
    memcpy(y + n, state + n, d * sizeof *y);
    y[n + d] = t;
}

/* For rows: the parts of a state that a step led to, or a run begins at. */
static void parts(const dm_stepper *s, double *out, const double *state, double t, uint32_t first,
                  uint32_t count) {
    dm_made_step *e = step_of(s);
    double *all = e->in + dm_step_states(e);
    read_state(e, e->in, state, t);
    find_parts(s, all, e->in);
    memcpy(out, all + first, count * sizeof *out);
}

/* ---- the equation ---- */

/* max_i sum_j |J_ij| (|x_j| + scale_j): what cancels in F is not smaller */
static double size_of_terms(const dm_made_step *e, const double *J, const double *x) {
    const uint32_t m = e->k->m;
    double largest = 0.0;
    for (uint32_t i = 0; i < m; i++) {
        double sum = 0.0;
        for (uint32_t j = 0; j < m; j++)
            sum += fabs(J[i * m + j]) * (fabs(x[j]) + fabs(e->scale[j]));
        largest = fmax(largest, sum);
    }
    return largest;
}

/* For dm_newton. F alone is the beginning of what the tangent gives. */
static dm_status equation(void *ctx, double *R, double *J, const double *x) {
    dm_made_step *e = ctx;
    const uint32_t m = e->k->m;
    memcpy(e->in + dm_step_numbers(e), x, m * sizeof *x);
    if (!J) dm_kernel_prepare(&e->k->equation, R);
    dm_kernel_eval(J ? &e->k->tangent : &e->k->equation, e->in, J ? e->out : R);
    if (!J) return DM_OK;
    memcpy(R, e->out, m * sizeof *R);
    memcpy(J, e->out + m, (size_t)m * m * sizeof *J);
    e->size = size_of_terms(e, J, x);
    if (e->first < 0.0) {
        e->first = e->size;
        for (uint32_t i = 0; i < m; i++) e->first = fmax(e->first, fabs(R[i]));
    }
    return DM_OK;
}

/* (q, p, t, parts, ., h) and (q, p, t, parts, h) */
static void place(const dm_stepper *s, const double *state, double t, double h) {
    dm_made_step *e = step_of(s);
    const size_t y = dm_step_numbers(e);
    read_state(e, e->in, state, t);
    if (e->k->w) find_parts(s, e->in + dm_step_states(e), e->in);
    e->in[y + e->k->m] = h;
    memcpy(e->short_in, e->in, y * sizeof *e->in);
    e->short_in[y] = h;
}

/* NaN and infinity. */
static int is_finite(const double *x, size_t count) {
    for (size_t i = 0; i < count; i++)
        if (!isfinite(x[i])) return 0;
    return 1;
}

/* With words of its own. */
static dm_status fail(dm_made_step *e, dm_status status, const char *words) {
    snprintf(e->trouble, sizeof e->trouble, "%s", words);
    return status;
}

/* NaN breaks a condition, too. */
static uint32_t first_broken(dm_made_step *e) {
    const uint32_t count = e->k->inside.outputs;
    if (count) dm_kernel_eval(&e->k->inside, e->in, e->inside);
    for (uint32_t i = 0; i < count; i++)
        if (!(e->inside[i] > 0.0)) return i + 1;
    return 0;
}

/* the root of a step, behind (q, p, t) in e->in */
static dm_status solve(dm_made_step *e, dm_stepper *s) {
    dm_newton_report report;
    static const double angle = 1.0; /* of this size are displacements in a chart */
    const dm_newton_problem problem = {.m = e->k->m,
                                       .equation = equation,
                                       .ctx = e,
                                       .size = &e->size,
                                       .place = e->ties ? &angle : e->scale,
                                       .places = e->ties ? 1 : e->k->m,
                                       .shared = e->ties,
                                       .over = 1.0,
                                       .tolerance = s->tolerance,
                                       .max_iterations = s->max_iterations};
    dm_kernel_prepare(&e->k->start, e->x); /* constants: of the last step it holds the root */
    dm_kernel_eval(&e->k->start, e->short_in, e->x);
    if (e->k->scale.outputs) dm_kernel_eval(&e->k->scale, e->short_in, e->scale);
    if (!is_finite(e->x, e->k->m)) return fail(e, DM_NOT_FINITE, "'start' gives NaN or infinity");
    if (!is_finite(e->scale, e->k->m))
        return fail(e, DM_NOT_FINITE, "'scale' gives NaN or infinity");
    e->first = -1.0;
    const dm_status status = dm_newton(e->x, &problem, e->newton, &report);
    s->report.solves++;
    s->report.iterations = report.iterations;
    s->report.newton += report.iterations;
    s->report.matrices += report.jacobians;
    s->report.residual = report.residual;
    s->report.evaluations += report.iterations + 1;
    if (status == DM_SINGULAR)
        return fail(e, status, "dF/dx of 'equation' is singular: does F determine all unknowns?");
    if (status != DM_OK) return status;
    if (report.residual > fmax(LEFT, 10.0 * s->tolerance) * e->first) return DM_NO_CONVERGENCE;
    memcpy(e->in + dm_step_numbers(e), e->x, e->k->m * sizeof *e->x);
    const uint32_t broken = first_broken(e);
    if (!broken) return DM_OK;
    snprintf(e->trouble, sizeof e->trouble,
             "the root breaks condition %u of 'inside': take a smaller step", broken);
    return DM_NO_CONVERGENCE;
}

/* what `next` gave: numbers, an element of the group, a later t where it is its own */
static dm_status check_next(dm_made_step *e, int timed, double t, double h) {
    const size_t y = dm_step_numbers(e);
    if (!is_finite(e->after, y + 1)) return fail(e, DM_NOT_FINITE, "'next' gives NaN or infinity");
    const double off = sqrt(e->after[y]);
    if (off > OFF) {
        snprintf(e->trouble, sizeof e->trouble,
                 "'next' gives a q that is no element of the group, off by %.2g", off);
        return DM_CALLBACK;
    }
    if (timed && !((e->after[dm_step_states(e) - 1] - t) * h > 0.0))
        return fail(e, DM_CALLBACK, "'next' gives a t that is not later");
    return DM_OK;
}

/* what `next` gave into e->reached and e->low; `sums`: q and p are what they gain */
static void reach(dm_made_step *e, const double *state, int sums) {
    const size_t n = e->k->n, d = e->k->d;
    memcpy(e->reached, e->after, dm_step_numbers(e) * sizeof *e->after);
    memset(e->low, 0, 2 * n * sizeof *e->low);
    if (!sums) return;
    memcpy(e->reached, state, (n + d) * sizeof *state);
    memcpy(e->low, state + 2 * n, 2 * n * sizeof *state);
    dm_sum_add_n(e->reached, e->low, e->after, (uint32_t)(n + d));
}

/* The state is changed at the end alone. */
static dm_status step(dm_stepper *s, double *state, double t, double h) {
    dm_made_step *e = step_of(s);
    const size_t n = e->k->n, d = e->k->d;
    double *own = state + 4 * n;
    if (is_timed(s)) t = own[0];
    e->trouble[0] = '\0';
    s->report.trouble = (dm_trouble){0};
    place(s, state, t, h);
    dm_status status = solve(e, s);
    if (status != DM_OK) return dm_step_stuck(e, s, t, h, status);
    dm_kernel_eval(&e->k->next, e->in, e->after);
    status = check_next(e, is_timed(s), t, h);
    if (status != DM_OK) return status;
    reach(e, state, e->row->sums);
    status = dm_step_crosses(e, s, t, h);
    if (status != DM_OK) return status;
    if (e->ties) dm_step_report_ties(e, s);
    if (e->k->w) keep(s, e->in, e->reached);
    e->pace = (e->after[n + d] - t) / h;
    memcpy(state, e->reached, (n + d) * sizeof *state);
    memcpy(state + 2 * n, e->low, 2 * n * sizeof *state);
    if (is_timed(s)) own[0] = e->after[n + d];
    return DM_OK;
}

static void impulses(const dm_stepper *s, double *out) {
    const dm_made_step *e = step_of(s);
    memcpy(out, e->x + (e->k->m - e->ties), e->ties * sizeof *out);
    memset(out + e->ties, 0, e->ties * sizeof *out);
}

/* Of the last step. */
static const char *why(dm_stepper *s, const double *state, dm_status status) {
    (void)state;
    const dm_made_step *e = step_of(s);
    if (e->ties && status == DM_SINGULAR) return NULL; /* constraints may be at fault */
    return *e->trouble ? e->trouble : NULL;
}

static const dm_engine engine = {
    .hamiltonian = 1,
    .keyed = 1,
    .wants = wants,
    .work = work,
    .open = open,
    .start = start,
    .pace = pace,
    .step = step,
    .memory = memory,
    .parts = parts,
    .impulses = impulses,
    .why = why,
};

#define ROW(...)                                                                                   \
    {                                                                                              \
        .name = "step", .signature = "step",                                                       \
        .doc =                                                                                     \
            "A step that a script writes, an equation and what follows from its root, traced and " \
            "solved in C: dm.step.",                                                               \
        .orders = "as declared", .stages = "-", .cost = "its unknowns", .instances = "",           \
        .traits = DM_ON_GROUPS | DM_OF_FUNCTIONS | (__VA_ARGS__), .check = check, .order = order,  \
        .engine = &engine                                                                          \
    }

const dm_method dm_method_step = ROW(0);
const dm_method dm_method_step_timed = ROW(DM_OWN_TIME);
const dm_method dm_method_step_tied = ROW(DM_CONSTRAINTS | DM_LOOSE_MOMENTUM);
