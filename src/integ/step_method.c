/* step_method.c - dm.step as a rule: one row for all steps that scripts write. */
#include "integ/step_method.h"

#include "integ/method/method.h"
#include "linalg/solve/newton.h"
#include "mech/group.h"

#include <math.h>
#include <string.h>

/* of the size of the terms at the start: a residual above is none of round-off */
static const double LEFT = 1e-6;

/* what a step works on, laid into the workspace of its stepper */
typedef struct {
    const dm_step_kernels *k;
    double *in;       /* [n + d + 1 + m + 1] */
    double *short_in; /* [n + d + 2] */
    double *out;      /* [m + m*m] */
    double *x;        /* [m] */
    double *scale;    /* [m] */
    double *after;    /* [n + d] */
    double *inside;   /* what the conditions gave */
    double *newton;
    double size, first; /* of the terms of F, now and where Newton's method began */
    uint32_t broken;    /* number of the condition that the root broke, from 1; 0: none */
} made_step;

enum { CONDITIONS = 64 }; /* at most */

static uint32_t unknowns(const dm_rule *rule) {
    return rule->data ? ((const dm_step_row *)rule->data)->unknowns : 0;
}

/* The name alone is no step. */
static const char *check(const dm_rule *rule) {
    return rule->data ? NULL : "a step is made by dm.step { equation =, next =, start = }";
}

/* As declared. */
static int order(const dm_rule *rule) {
    return rule->data ? ((const dm_step_row *)rule->data)->order : 0;
}

/* Nothing of L but what a start needs. */
static unsigned wants(const dm_rule *rule, const dm_model *m) {
    (void)rule;
    return m->structure & DM_CONSTANT_MASS ? 0 : DM_WANT_MASS;
}

/* Of structures in front of arrays. */
static size_t doubles(size_t bytes) {
    return (bytes + sizeof(double) - 1) / sizeof(double);
}

/* As `open` lays it out. */
static size_t work(const dm_rule *rule, const dm_model *m) {
    const size_t n = m->n, d = dm_momenta(m), k = unknowns(rule);
    return doubles(sizeof(made_step)) + 3 * (n + d) + 4 + k + k + k * k + 2 * k + CONDITIONS +
           dm_newton_work((uint32_t)k);
}

/* It stands at the beginning of the workspace. */
static made_step *step_of(const dm_stepper *s) {
    return (made_step *)(void *)s->work;
}

/* Constant outputs of all kernels are filled in here. */
static dm_status open(dm_stepper *s) {
    made_step *e = step_of(s);
    const dm_step_kernels *k = s->brought;
    const size_t states = k->n + (size_t)k->d, m = k->m;
    *e = (made_step){.k = k, .in = s->work + doubles(sizeof *e)};
    e->short_in = e->in + states + 2 + m;
    e->out = e->short_in + states + 2;
    e->x = e->out + m + m * m;
    e->scale = e->x + m;
    e->after = e->scale + m;
    e->inside = e->after + states;
    e->newton = e->inside + CONDITIONS;
    memset(e->scale, 0, m * sizeof *e->scale);
    dm_kernel_prepare(&k->tangent, e->out);
    dm_kernel_prepare(&k->next, e->after);
    dm_kernel_prepare(&k->start, e->x);
    if (k->scale.outputs) dm_kernel_prepare(&k->scale, e->scale);
    if (k->inside.outputs) dm_kernel_prepare(&k->inside, e->inside);
    s->report.operations = k->tangent.operations;
    return DM_OK;
}

/* max_i sum_j |J_ij| (|x_j| + scale_j): what cancels in F is not smaller */
static double size_of_terms(const made_step *e, const double *J, const double *x) {
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
    made_step *e = ctx;
    const uint32_t m = e->k->m;
    memcpy(e->in + e->k->n + e->k->d + 1, x, m * sizeof *x);
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

/* (q, p, t, h) and (q, p, t, ., h) */
static void place(made_step *e, const double *state, double t, double h) {
    const size_t n = e->k->n, d = e->k->d;
    memcpy(e->in, state, n * sizeof *state);
    memcpy(e->in + n, state + n, d * sizeof *state);
    e->in[n + d] = t;
    e->in[n + d + 1 + e->k->m] = h;
    memcpy(e->short_in, e->in, (n + d + 1) * sizeof *state);
    e->short_in[n + d + 1] = h;
}

/* NaN and infinity. */
static int is_finite(const double *x, size_t count) {
    for (size_t i = 0; i < count; i++)
        if (!isfinite(x[i])) return 0;
    return 1;
}

/* NaN breaks a condition, too. */
static uint32_t first_broken(made_step *e) {
    const uint32_t count = e->k->inside.outputs;
    if (count) dm_kernel_eval(&e->k->inside, e->in, e->inside);
    for (uint32_t i = 0; i < count; i++)
        if (!(e->inside[i] > 0.0)) return i + 1;
    return 0;
}

/* the root of a step, behind (q, p, t) in e->in */
static dm_status solve(made_step *e, dm_stepper *s) {
    dm_newton_report report;
    const dm_newton_problem problem = {.m = e->k->m,
                                       .equation = equation,
                                       .ctx = e,
                                       .size = &e->size,
                                       .tolerance = s->tolerance,
                                       .max_iterations = s->max_iterations};
    dm_kernel_eval(&e->k->start, e->short_in, e->x);
    if (e->k->scale.outputs) dm_kernel_eval(&e->k->scale, e->short_in, e->scale);
    if (!is_finite(e->x, e->k->m)) return DM_NOT_FINITE;
    e->first = -1.0;
    const dm_status status = dm_newton(e->x, &problem, e->newton, &report);
    s->report.solves++;
    s->report.iterations = report.iterations;
    s->report.newton += report.iterations;
    s->report.residual = report.residual;
    s->report.evaluations += report.iterations + 1;
    if (status != DM_OK) return status;
    if (report.residual > LEFT * e->first) return DM_NO_CONVERGENCE;
    memcpy(e->in + e->k->n + e->k->d + 1, e->x, e->k->m * sizeof *e->x);
    e->broken = first_broken(e);
    return e->broken ? DM_NO_CONVERGENCE : DM_OK;
}

/* The state is changed at the end alone. */
static dm_status step(dm_stepper *s, double *state, double t, double h) {
    made_step *e = step_of(s);
    const size_t states = e->k->n + (size_t)e->k->d;
    e->broken = 0;
    place(e, state, t, h);
    const dm_status status = solve(e, s);
    if (status != DM_OK) return status;
    dm_kernel_eval(&e->k->next, e->in, e->after);
    if (!is_finite(e->after, states)) return DM_NOT_FINITE;
    memcpy(state, e->after, states * sizeof *state);
    return DM_OK;
}

/* Of the last step. */
static const char *why(dm_stepper *s, const double *state, dm_status status) {
    (void)state, (void)status;
    return step_of(s)->broken ? "the root breaks a condition of 'inside': take a smaller step"
                              : NULL;
}

static const dm_engine engine = {
    .wants = wants,
    .work = work,
    .open = open,
    .step = step,
    .why = why,
};

const dm_method dm_method_step = {
    .name = "step",
    .signature = "step",
    .doc = "A step that a script writes, an equation and what follows from its root, traced and "
           "solved in C: dm.step.",
    .orders = "as declared",
    .stages = "-",
    .cost = "its unknowns",
    .instances = "",
    .traits = DM_ON_GROUPS | DM_OF_FUNCTIONS,
    .check = check,
    .order = order,
    .engine = &engine,
};
