/* trial.c - steps of curves in any space: the engine, and its row. */
#include "base/doubles.h"
#include "integ/trial/trial_inside.h"
#include "linalg/solve/newton.h"

#include <math.h>
#include <string.h>

/* What the options of the script became. */
static const dm_trial_row *row_of(const dm_rule *rule) {
    return rule->data;
}

/* The name alone is no space. */
static const char *check(const dm_rule *rule) {
    return rule->data ? NULL
                      : "a space of curves is made by dm.galerkin { functions =, quadrature = } or "
                        "dm.multiscale { frequency = }";
}

/* Second derivatives at the points, the velocity of the start for the first guess, and the energy
 * that curves are to keep. */
static unsigned wants(const dm_rule *rule, const dm_model *m) {
    const unsigned plain = DM_SEPARABLE | DM_CONSTANT_MASS;
    (void)rule;
    return DM_WANT_STAGE | DM_WANT_ENERGY |
           ((m->structure & plain) == plain ? 0 : (unsigned)DM_WANT_MASS);
}

/* Nodes of all pieces, or nodes times phases. */
static uint32_t points_of(const dm_trial_row *row) {
    return (uint32_t)row->q.r * (row->phases ? row->phases : row->pieces);
}

/* Newton's method, the matrix of straight lines, or the Legendre transform. */
static size_t scratch_size(const dm_model *m, size_t unknowns) {
    const size_t a = dm_newton_work((uint32_t)unknowns), b = dm_legendre_work(m);
    const size_t c = unknowns * unknowns + 3 * unknowns;
    return a > b ? (a > c ? a : c) : (b > c ? b : c);
}

/* In the order of `open`. */
static size_t work(const dm_rule *rule, const dm_model *m) {
    const size_t n = m->n, K = rule->data ? dm_trial_parameters(row_of(rule), m->n) : 0;
    const size_t points = rule->data ? points_of(row_of(rule)) : 0;
    return dm_doubles(sizeof(dm_trial)) + 2 * points + 3 + K + 2 * n + 2 * n + 2 * n * K + K * K +
           (points + 3) * (2 * n + 2 * n * K) + 2 * n * K + 2 * n + 1 + 2 * n + 3 * n * n + 2 * n +
           2 * n * (K + 1) + K + n + n + 2 * n + 1 + scratch_size(m, K + n);
}

/* It stands at the beginning of the workspace. */
static dm_trial *trial_of(const dm_stepper *s) {
    return (dm_trial *)(void *)s->work;
}

/* Tables are laid with the first step, since they belong to its length. */
static dm_status open(dm_stepper *s) {
    dm_trial *e = trial_of(s);
    const dm_trial_row *row = row_of(s->rule);
    const dm_trial_kernels *k = s->brought;
    const size_t n = k->n, K = k->parameters, points = points_of(row);
    double *memory = s->work + dm_doubles(sizeof *e);
    *e = (dm_trial){.row = row, .k = k, .m = s->model, .n = k->n, .K = k->parameters};
    e->unknowns = e->K + e->n, e->points = (uint32_t)points;
    e->weight = dm_take(&memory, points);
    e->at = dm_take(&memory, points);
    e->in = dm_take(&memory, 3 + K + 2 * n);
    e->out = dm_take(&memory, 2 * n + 2 * n * K + K * K);
    e->table = dm_take(&memory, (points + 3) * (2 * n + 2 * n * K));
    e->line = dm_take(&memory, 2 * n * K);
    e->x = dm_take(&memory, 2 * n + 1);
    e->stage = dm_take(&memory, 2 * n + 3 * n * n);
    e->q = dm_take(&memory, n);
    e->v = dm_take(&memory, n);
    e->A = dm_take(&memory, 2 * n * (K + 1));
    e->z = dm_take(&memory, K + n);
    e->v0 = dm_take(&memory, n);
    e->solved = dm_take(&memory, 2 * n + 1);
    e->scratch = memory;
    dm_kernel_prepare(&s->model->stage, e->stage);
    if (!k->linear) dm_kernel_prepare(&k->point, e->out);
    s->report.operations = k->point.operations + s->model->stage.operations;
    return DM_OK;
}

/* z of the straight line from q0 with velocity v0 (`moves`), or of the constant curve, and p1 = p0;
 * 0: `start` of the script gave NaN */
static int guess(dm_trial *e, int moves) {
    const uint32_t n = e->n, K = e->K;
    double sum = 0.0;
    memcpy(e->z + K, e->p0, n * sizeof *e->z);
    if (e->k->start.outputs) {
        memcpy(e->in, e->q0, n * sizeof *e->in);
        memcpy(e->in + n, e->v0, n * sizeof *e->in);
        for (uint32_t i = 0; !moves && i < n; i++) e->in[n + i] = 0.0;
        e->in[2 * n] = e->h;
        dm_kernel_prepare(&e->k->start, e->z);
        dm_kernel_eval(&e->k->start, e->in, e->z);
    } else {
        for (uint32_t a = 0; a < K; a++) {
            const double *line = e->line + a * 2 * (size_t)n;
            e->z[a] = 0.0;
            for (uint32_t i = 0; i < n; i++)
                e->z[a] += line[i] * e->q0[i] + (moves ? line[n + i] * e->v0[i] : 0.0);
        }
    }
    for (uint32_t a = 0; a < K; a++) sum += 0.0 * e->z[a];
    return sum == 0.0;
}

/* For dm_newton, damped, where the plain iteration fails. */
static dm_status solve_damped(dm_trial *e, dm_stepper *s) {
    const dm_newton_problem problem = {.m = e->unknowns,
                                       .equation = dm_trial_equation,
                                       .ctx = e,
                                       .size = &e->size,
                                       .tolerance = s->tolerance,
                                       .max_iterations = s->max_iterations};
    dm_newton_report report;
    const dm_status status = dm_newton(e->z, &problem, e->scratch, &report);
    s->report.newton += report.iterations, s->report.iterations = report.iterations;
    s->report.matrices += report.jacobians;
    s->report.residual = report.residual;
    return status;
}

/* Of a space with a fast phase that is not linear, which has many roots: a curve whose momentum at
 * the end is not that of the step, the defect relative to it, is another one than was meant. */
static const double DOUBTFUL = 0.5, WRONG = 1.0;

/* from one of both guesses */
static dm_status solve(dm_trial *e, dm_stepper *s, int moves) {
    if (!guess(e, moves)) return DM_NOT_FINITE;
    s->report.solves++;
    if (dm_trial_iterate(e, s) == DM_OK) return DM_OK;
    guess(e, moves);
    return solve_damped(e, s);
}

/* The better one of the roots of both guesses, if that is one of the motion. */
static dm_status choose_root(dm_trial *e, dm_stepper *s, int moves, double *defect) {
    const double first = *defect;
    *defect = solve(e, s, !moves) == DM_OK ? dm_trial_defect(e) : INFINITY;
    if (!(*defect < first)) {
        const dm_status status = solve(e, s, moves);
        if (status != DM_OK) return status;
        *defect = first;
    }
    return *defect <= WRONG ? DM_OK : DM_NO_CONVERGENCE;
}

/* Is z the step of length h from this state? */
static int is_solved(const dm_trial *e, const double *state, double t, double h) {
    return e->is_solved && e->h == h && e->solved[2 * e->n] == t &&
           memcmp(e->solved, state, 2 * e->n * sizeof *state) == 0;
}

/* z is known for this state: what else is asked of the step, as by events, is read off it. */
static void note_solved(dm_trial *e, const double *state, double t) {
    memcpy(e->solved, state, 2 * e->n * sizeof *state);
    e->solved[2 * e->n] = t;
    e->is_solved = 1;
}

/* z and p1. A curve with a fast phase begins at rest, since a fast velocity is none of a line; what
 * does not converge begins the other way. */
static dm_status find_curve(dm_stepper *s, const double *state, double t, double h) {
    dm_trial *e = trial_of(s);
    const uint32_t n = e->n;
    const int moves = e->row->phases == 0;
    e->q0 = state, e->p0 = state + n, e->t = t, e->evaluations = 0;
    if (is_solved(e, state, t, h)) return DM_OK;
    e->is_solved = 0;
    dm_status status = dm_trial_lay(e, h);
    memset(e->v0, 0, n * sizeof *e->v0);
    if (status == DM_OK) status = dm_legendre_inverse(e->m, e->v0, state, state + n, t, e->scratch);
    if (status != DM_OK) return status;
    status = solve(e, s, moves);
    if (status != DM_OK && solve(e, s, !moves) == DM_OK) status = DM_OK;
    double defect = status == DM_OK && e->row->phases ? dm_trial_defect(e) : 0.0;
    if (defect > DOUBTFUL && !e->k->linear) status = choose_root(e, s, moves, &defect);
    s->report.evaluations += e->evaluations;
    if (status != DM_OK) return status;
    note_solved(e, state, t);
    if (e->row->phases && (!e->k->linear || s->report.condition == 0.0))
        s->report.condition = fmax(s->report.condition, dm_trial_condition(e));
    s->report.defect = fmax(s->report.defect, defect);
    return DM_OK;
}

/* A part of a step whose vibration polynomials would follow is read off the curve of the whole one.
 */
static int is_inside(const dm_trial *e, double h) {
    return e->row->phases && h > 0.0 && h < e->whole;
}

/* The end of the curve, or a place inside it; the state is changed at the end alone. */
static dm_status step(dm_stepper *s, double *state, double t, double h) {
    dm_trial *e = trial_of(s);
    const uint32_t n = e->n;
    const int inside = is_inside(e, h);
    double *q = e->v0, *p = e->z + e->K;
    const dm_status status = find_curve(s, state, t, inside ? e->whole : h);
    if (status != DM_OK) return status;
    if (inside)
        p = e->v, dm_trial_inside(e, q, p, h);
    else
        memcpy(q, dm_trial_at(e, e->points + 1, e->z, NULL).q, n * sizeof *q);
    for (uint32_t i = 0; i < n; i++)
        if (!isfinite(q[i] + p[i])) return DM_NOT_FINITE;
    if (!inside && dm_trial_watch(e, q, p) != DM_OK) return DM_BLOW_UP;
    s->report.drift = e->drift;
    memcpy(state, q, n * sizeof *state);
    memcpy(state + n, p, n * sizeof *state);
    memset(state + 2 * (size_t)n, 0, 2 * (size_t)n * sizeof *state);
    return DM_OK;
}

/* A run begins. */
static dm_status start(dm_stepper *s, double *state, double t, double h) {
    dm_trial *e = trial_of(s);
    (void)state, (void)t;
    e->whole = h, e->is_solved = 0;
    dm_trial_watch_begin(e);
    return DM_OK;
}

/* Of the last step. */
static const char *why(dm_stepper *s, const double *state, dm_status status) {
    const dm_trial *e = trial_of(s);
    (void)state;
    if (status == DM_BLOW_UP && !e->row->phases)
        return "it has moved by more than two fifths of the largest v . L_v: the curves of the "
               "space do not follow the motion, or others of their roots were found; take other "
               "functions, another 'start' or a smaller h";
    if (status == DM_BLOW_UP)
        return "it has moved by more than a fifth of the largest v . L_v: the frequency is not "
               "that "
               "of the motion (path:frequency of a resolved run), or not its only fast one";
    if (e->row->phases && !e->k->linear)
        return "the product ansatz has no solution near a straight line, or only one whose "
               "momentum "
               "at the end is not that of the step: take the additive one";
    if (e->row->phases)
        return "the space of two scales fits a step of several radians of the fast phase: take "
               "more "
               "'nodes' and 'phases', or, where h times the frequency is below 3, another rule";
    return status == DM_SINGULAR
               ? "parameters that the quadrature does not see, or a singular d2L/dv2: more nodes, "
                 "fewer functions"
               : NULL;
}

static const dm_engine engine = {
    .wants = wants,
    .work = work,
    .open = open,
    .start = start,
    .step = step,
    .why = why,
};

const dm_method dm_method_trial = {
    .name = "trial",
    .signature = "trial",
    .doc = "Curves in a space of functions of one's own, or with a fast phase, and any quadrature: "
           "dm.galerkin{functions=, quadrature=}, dm.multiscale. Leok 5.2, 5.7.",
    .orders = "that of the space",
    .stages = "points of the quadrature",
    .cost = "parameters + n unknowns",
    .instances = "",
    .traits = DM_SYMPLECTIC | DM_OF_FUNCTIONS,
    .check = check,
    .engine = &engine,
};
