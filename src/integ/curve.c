/*
** curve.c - an explicit one-step method made variational (Cuell-Patrick 2008; Leok-Shingel 2012, shooting). From
** dLd = p1 dq1 - p0 dq0 with q0 = d-(y), q1 = d+(y) a step from (q0, p0) finds y = (q, v) and p1 with
**   (Ld - p1 . d+ + p0 . d-)_y = 0,  d-(y) = q0,   then q1 = d+(y).
** Unknowns: v, the change p1 - p0 in units of velocity, and where d- is not q itself (q - q0) / h.
** The errors of both Legendre transforms agree to leading order, so that the step has the order of the method.
*/
#include "integ/curve.h"
#include "integ/curve_segment.h"

#include "base/sum.h"
#include "solve/newton.h"

#include <math.h>
#include <string.h>

/* at the head of the workspace */
typedef struct {
    dm_curve curve;
    dm_segment segment;
    const double *state;
    double t, h;
    size_t n, unknowns;
    double *mass;          /* [n] size of M by rows: what turns velocities into momenta */
    double *z, *y, *p1;    /* [3n] unknowns; [2n] q - q0, v of the last run; [n] */
    double *next, *memory; /* [4n]; see below */
    double *slope;         /* [2n] of L at the end */
    double *scratch;
    double size; /* of the momenta */
    int ran;     /* the segment is at y */
    long evaluations;
} stepper;

static size_t head(void) {
    return (sizeof(stepper) + sizeof(double) - 1) / sizeof(double);
}

/* ---- the rule ---- */

static int read_curve(dm_curve *out, const dm_rule *rule) {
    const double bias = rule->count == 2 ? rule->arg[1].number : 1.0;
    return dm_curve_find(out, rule->arg[0].rule->name) && dm_curve_bias(out, bias);
}

static const char *check(const dm_rule *rule) {
    dm_curve curve;
    const dm_rule *method = rule->arg[0].rule;
    if (rule->count < 1 || rule->count > 2 || !method || method->count)
        return "curve takes the name of an explicit one-step method, and a bias";
    const double bias = rule->count == 2 ? rule->arg[1].number : 1.0;
    if ((rule->count == 2 && rule->arg[1].rule) || !(bias >= 0.0 && bias <= 1.0))
        return "the bias of a curve is a number from 0 to 1";
    if (!dm_curve_find(&curve, method->name))
        return "there is no such one-step method: euler, midpoint, heun, kutta3, rk4, "
               "dopri5, "
               "butcher6, fehlberg7, dop853, gsl-rk2, gsl-rk4, gsl-rkf45, gsl-rkck, "
               "gsl-rk8pd";
    if (!dm_curve_bias(&curve, bias))
        return "this method has too many stages for a bias other than 0 and 1";
    return NULL;
}

static const char *fits(const dm_rule *rule, const dm_model *m) {
    (void)rule;
    if (!m->source.graph && !m->structure)
        return "it runs on hyper-dual numbers, and curve segments need derivatives of "
               "the "
               "acceleration, which come from a trace";
    if (m->structure & DM_LINEAR_IN_V)
        return "L is linear in v, so that it has no second-order field";
    return NULL;
}

static int order(const dm_rule *rule) {
    dm_curve curve;
    return read_curve(&curve, rule) ? dm_curve_order(&curve) : 0;
}

static unsigned wants(const dm_rule *rule, const dm_model *m) {
    (void)rule, (void)m;
    return DM_WANT_SLOPE | DM_WANT_MASS;
}

static size_t unknowns(const dm_curve *c, size_t n) {
    return (c->centred ? 3 : 2) * n;
}

/* h, the state at the end, v of the next segment */
static size_t memory_size(size_t n) {
    return 1 + 4 * n + n;
}

static size_t scratch_size(const dm_curve *c, const dm_model *m) {
    const size_t newton = dm_newton_work((uint32_t)unknowns(c, m->n));
    const size_t legendre = dm_legendre_work(m);
    return newton > legendre ? newton : legendre;
}

static size_t work(const dm_rule *rule, const dm_model *m) {
    const size_t n = m->n;
    dm_curve c;
    if (!read_curve(&c, rule)) return 0;
    return head() + n + 3 * n + 2 * n + n + 4 * n + memory_size(n) + 2 * n + n * n + n +
           scratch_size(&c, m) + dm_segment_work(&c, n);
}

static dm_status open(dm_stepper *s) {
    stepper *e = (stepper *)(void *)s->work;
    const size_t n = s->model->n;
    *e = (stepper){.n = n, .mass = s->work + head()};
    if (!read_curve(&e->curve, s->rule)) return DM_NO_MEMORY;
    e->unknowns = unknowns(&e->curve, n);
    e->z = e->mass + n;
    e->y = e->z + 3 * n;
    e->p1 = e->y + 2 * n;
    e->next = e->p1 + n;
    e->memory = e->next + 4 * n;
    e->slope = e->memory + memory_size(n);
    e->scratch = e->slope + 2 * n + n * n + n;
    dm_kernel_prepare(&s->model->slope, e->slope);
    return dm_segment_open(&e->segment, &e->curve, s->model,
                           e->scratch + scratch_size(&e->curve, s->model));
}

static dm_status start(dm_stepper *s, double *state, double t) {
    stepper *e = (stepper *)(void *)s->work;
    (void)state, (void)t;
    e->memory[0] = 0.0;
    return DM_OK;
}

static size_t memory(dm_stepper *s, double **place) {
    stepper *e = (stepper *)(void *)s->work;
    *place = e->memory;
    return memory_size(e->n);
}

/* ---- the step equation ---- */

/* points and ends for the unknowns z, unless they are there already */
static dm_status run(stepper *e, const double *z) {
    const size_t n = e->n;
    const double *w = e->curve.centred ? z + 2 * n : NULL, *low = e->state + 2 * n;
    double y[2] = {0};
    int same = e->ran;
    for (size_t k = 0; k < n; k++) {
        y[0] = low[k] + (w ? e->h * w[k] : 0.0);
        y[1] = z[k];
        same = same && e->y[k] == y[0] && e->y[n + k] == y[1];
        e->y[k] = y[0];
        e->y[n + k] = y[1];
    }
    if (same) return DM_OK;
    const dm_segment_place at = {
        .q = e->state, .shift = e->y, .v = e->y + n, .t = e->t, .h = e->h};
    const dm_status status = dm_segment_run(&e->segment, &at);
    e->ran = status == DM_OK;
    e->evaluations += (long)e->segment.points;
    return status;
}

/* J for r = (r1, r2, r3) and z = (v, (p1 - p0) / m, (q - q0) / h) */
static void fill_jacobian(const stepper *e, double *J) {
    const size_t n = e->n, N = 2 * n, m = e->unknowns;
    const double *G = e->segment.hessian, *Dp = e->segment.plus_tangent;
    const double *Dm = e->segment.minus_tangent, h = e->h;
    for (size_t i = 0; i < n; i++)
        for (size_t j = 0; j < n; j++) {
            const double one = i == j;
            J[i * m + j] = G[i * N + n + j];
            J[(n + i) * m + j] = G[(n + i) * N + n + j] / h;
            J[i * m + n + j] = -(one + Dp[j * N + i]) * e->mass[j];
            J[(n + i) * m + n + j] = -Dp[j * N + n + i] * e->mass[j] / h;
            if (!e->curve.centred) continue;
            J[i * m + N + j] = G[i * N + j] * h;
            J[(n + i) * m + N + j] = G[(n + i) * N + j];
            J[(N + i) * m + j] = Dm[i * N + n + j] / h;
            J[(N + i) * m + n + j] = 0.0;
            J[(N + i) * m + N + j] = one + Dm[i * N + j];
        }
}

static dm_status equation(void *ctx, double *r, double *J, const double *z) {
    stepper *e = ctx;
    const size_t n = e->n;
    const double *p0 = e->state + n, *low = e->state + 3 * n;
    dm_status status = run(e, z);
    if (status != DM_OK) return status;
    e->size = 0.0;
    for (size_t k = 0; k < n; k++) {
        e->p1[k] = p0[k] + (low[k] + e->mass[k] * z[n + k]);
        e->size = fmax(e->size, fabs(p0[k]) + fabs(e->p1[k]));
    }
    dm_segment_gradient(&e->segment, e->p1, e->curve.centred ? p0 : NULL, e->h);
    for (size_t k = 0; k < n; k++) {
        r[k] = e->segment.slope[k] - e->mass[k] * z[n + k];
        r[n + k] = e->segment.slope[n + k] / e->h;
        if (e->curve.centred) r[2 * n + k] = z[2 * n + k] + e->segment.minus[k] / e->h;
    }
    if (J) {
        dm_segment_hessian(&e->segment, e->h);
        fill_jacobian(e, J);
    }
    return DM_OK;
}

/* ---- the start of the iteration ---- */

static int fits_memory(const stepper *e) {
    return e->memory[0] == e->h &&
           memcmp(e->memory + 1, e->state, 4 * e->n * sizeof *e->state) == 0;
}

/* the velocity at the end of the last segment is that of this one to the order of the method and one more */
static dm_status guess_velocity(stepper *e, const dm_model *m, double *v) {
    const size_t n = e->n;
    if (fits_memory(e)) {
        memcpy(v, e->memory + 1 + 4 * n, n * sizeof *v);
        return DM_OK;
    }
    memset(v, 0, n * sizeof *v);
    return dm_legendre_inverse(m, v, e->state, e->state + n, e->t, e->scratch);
}

/* rows of M, by their largest entries */
static void measure_mass(stepper *e, const dm_model *m) {
    const size_t n = e->n;
    const int diagonal = (m->structure & DM_DIAGONAL_MASS) != 0;
    const double *M = m->mass_matrix;
    double *x = e->scratch, *out = e->slope + 2 * n;
    if (!M) {
        memcpy(x, e->state, n * sizeof *x);
        memcpy(x + n, e->z, n * sizeof *x);
        x[2 * n] = e->t;
        dm_kernel_prepare(&m->mass, out);
        dm_kernel_eval(&m->mass, x, out);
        M = out + n;
    }
    for (size_t i = 0; i < n; i++) {
        e->mass[i] = diagonal ? fabs(M[i]) : 0.0;
        for (size_t j = 0; j < n && !diagonal; j++)
            e->mass[i] = fmax(e->mass[i], fabs(M[i * n + j]));
        if (!(e->mass[i] > 0.0)) e->mass[i] = 1.0;
    }
}

/* p1 = L_v where the segment of the guess ends */
static dm_status guess(stepper *e, const dm_model *m) {
    const size_t n = e->n;
    dm_status status = guess_velocity(e, m, e->z);
    if (status != DM_OK) return status;
    measure_mass(e, m);
    for (size_t k = 0; k < n; k++) e->z[2 * n + k] = (1.0 - e->curve.bias) * e->z[k];
    status = run(e, e->z);
    if (status != DM_OK) return status;
    double *x = e->scratch;
    for (size_t k = 0; k < n; k++) {
        x[k] = e->state[k] + (e->y[k] + e->segment.plus[k]);
        x[n + k] = e->segment.arrival[k];
    }
    x[2 * n] = e->t + e->h;
    dm_kernel_eval(&m->slope, x, e->slope);
    for (size_t k = 0; k < n; k++)
        e->z[n + k] = (e->slope[n + k] - e->state[n + k]) / e->mass[k];
    return DM_OK;
}

/* ---- the step ---- */

static dm_status solve(stepper *e, dm_stepper *s, dm_newton_report *report) {
    const dm_newton_problem problem = {.m = (uint32_t)e->unknowns,
                                       .equation = equation,
                                       .ctx = e,
                                       .size = &e->size,
                                       .tolerance = s->tolerance,
                                       .max_iterations = s->max_iterations};
    *report = (dm_newton_report){0};
    const dm_status status = guess(e, s->model);
    return status == DM_OK ? dm_newton(e->z, &problem, e->scratch, report) : status;
}

/* q1 = d+(y), p1; and what the next step starts from */
static dm_status finish(stepper *e) {
    const size_t n = e->n;
    double *next = e->next;
    const dm_status status = run(e, e->z);
    if (status != DM_OK) return status;
    memcpy(next, e->state, 4 * n * sizeof *next);
    for (size_t k = 0; k < n; k++) {
        const double shift = e->curve.centred ? e->h * e->z[2 * n + k] : 0.0;
        dm_sum_add(next + k, next + 2 * n + k, shift + e->segment.plus[k]);
        dm_sum_add(next + n + k, next + 3 * n + k, e->mass[k] * e->z[n + k]);
    }
    for (size_t k = 0; k < 4 * n; k++)
        if (!isfinite(next[k])) return DM_NOT_FINITE;
    e->memory[0] = e->h;
    memcpy(e->memory + 1, next, 4 * n * sizeof *next);
    memcpy(e->memory + 1 + 4 * n, e->segment.next, n * sizeof *next);
    return DM_OK;
}

static dm_status step(dm_stepper *s, double *state, double t) {
    stepper *e = (stepper *)(void *)s->work;
    dm_newton_report report;
    e->state = state;
    e->h = s->h;
    e->t = t + (1.0 - e->curve.bias) * s->h; /* of y */
    e->ran = 0;
    e->evaluations = 0;
    dm_status status = solve(e, s, &report);
    if (status == DM_OK) status = finish(e);
    s->report.iterations = report.iterations;
    s->report.residual = report.residual;
    s->report.solves++;
    s->report.newton += report.iterations;
    s->report.evaluations += e->evaluations;
    if (status == DM_OK) memcpy(state, e->next, 4 * e->n * sizeof *state);
    return status;
}

const dm_method dm_method_curve = {
    .name = "curve",
    .signature = "curve(method, bias)",
    .doc = "An explicit one-step method of any order made variational: curve(rk4) is "
           "symplectic and has "
           "order 4, without the drift of rk4 itself. The method gives the curves along "
           "which the action "
           "is summed; bias (1 unless given) is the part of a step behind the point (q, "
           "v) it starts "
           "from, 1/2 makes the rule symmetric; curve(euler, 1/2) is the midpoint rule. "
           "2 n unknowns a "
           "step, 3 n with a bias other than 1 (Cuell-Patrick 2008; Leok-Shingel 2012).",
    .traits = DM_SYMPLECTIC | DM_KEEPS,
    .check = check,
    .fits = fits,
    .order = order,
    .wants = wants,
    .work = work,
    .open = open,
    .start = start,
    .step = step,
    .memory = memory,
};
