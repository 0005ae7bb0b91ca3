/* del.c - the discrete Euler-Lagrange equations of a user's Ld(q0, q1), position-momentum form. */
#include "base/sum.h"
#include "integ/method.h"
#include "solve/newton.h"

#include <math.h>
#include <string.h>

/* p0 + D1 Ld(q0, q0 + z) = 0 for z[n]; out = D1[n], D2[n], D1D2[n*n] */
typedef struct {
    const dm_model *m;
    const double *state;
    double *x, *out, *z, *next, *scratch;
    double *
        left; /* by the step before: h, the state behind it, q1 - q0, and how much that grew */
    double size;
    long evaluations;
} pair;

static const char *check(const dm_rule *rule) {
    return rule->count ? "del takes no argument" : NULL;
}

/* what Ld is accurate to is not known to the rule */
static int order(const dm_rule *rule) {
    (void)rule;
    return 0;
}

static unsigned wants(const dm_rule *rule, const dm_model *m) {
    (void)rule, (void)m;
    return DM_WANT_PAIR;
}

static size_t work(const dm_rule *rule, const dm_model *m) {
    const size_t n = m->n;
    (void)rule;
    return 2 * n + (2 * n + n * n) + n + 4 * n + (1 + 6 * n) + dm_newton_work(m->n);
}

static pair lay_out(const dm_stepper *s) {
    const size_t n = s->model->n;
    pair e = {.m = s->model, .x = s->work};
    e.out = e.x + 2 * n;
    e.z = e.out + 2 * n + n * n;
    e.next = e.z + n;
    e.left = e.next + 4 * n;
    e.scratch = e.left + 1 + 6 * n;
    return e;
}

static size_t memory(dm_stepper *s, double **place) {
    *place = lay_out(s).left;
    return 1 + 6 * (size_t)s->model->n;
}

/* was the step before one of h that led to this state? */
static int is_known(const pair *e, double h) {
    return e->left[0] == h &&
           memcmp(e->left + 1, e->state, 4 * (size_t)e->m->n * sizeof *e->state) == 0;
}

static void remember(pair *e, double h, int known) {
    const uint32_t n = e->m->n;
    double *z = e->left + 1 + 4 * (size_t)n, *growth = z + n;
    for (uint32_t i = 0; i < n; i++) {
        growth[i] = known ? e->z[i] - z[i] : 0.0;
        z[i] = e->z[i];
    }
    e->left[0] = h;
    memcpy(e->left + 1, e->next, 4 * (size_t)n * sizeof *e->next);
}

static dm_status open(dm_stepper *s) {
    const pair e = lay_out(s);
    dm_kernel_prepare(&s->model->pair, e.out);
    memset(e.left, 0, (1 + 6 * (size_t)s->model->n) * sizeof *e.left);
    return DM_OK;
}

static void evaluate(pair *e, const double *z) {
    const uint32_t n = e->m->n;
    const double *low = e->state + 2 * n;
    for (uint32_t i = 0; i < n; i++) {
        e->x[i] = e->state[i];
        e->x[n + i] = e->state[i] + (low[i] + z[i]);
    }
    dm_kernel_eval(&e->m->pair, e->x, e->out);
    e->evaluations++;
}

static dm_status equation(void *ctx, double *r, double *J, const double *z) {
    pair *e = ctx;
    const uint32_t n = e->m->n;
    const double *p0 = e->state + n, *low = e->state + 3 * n;
    evaluate(e, z);
    e->size = 0.0;
    for (uint32_t i = 0; i < n; i++) {
        r[i] = (p0[i] + e->out[i]) + low[i];
        e->size = fmax(e->size, fmax(fabs(p0[i]), fabs(e->out[i])));
    }
    if (J) memcpy(J, e->out + 2 * n, (size_t)n * n * sizeof *J);
    return DM_OK;
}

/* q1 = q0 + z; p1 = D2 Ld, written p0 + (D1 + D2): velocity terms cancel before they are rounded */
static dm_status finish(pair *e) {
    const uint32_t n = e->m->n;
    evaluate(e, e->z);
    memcpy(e->next, e->state, 4 * (size_t)n * sizeof *e->next);
    dm_sum_add_n(e->next, e->next + 2 * n, e->z, n);
    for (uint32_t i = 0; i < n; i++)
        dm_sum_add(e->next + n + i, e->next + 3 * n + i, e->out[i] + e->out[n + i]);
    for (uint32_t i = 0; i < 4 * n; i++)
        if (!isfinite(e->next[i])) return DM_NOT_FINITE;
    return DM_OK;
}

/* from where the last two steps lead; else from z = 0, where one iteration finds h M^-1 p0 whatever the masses; where
** Ld(q, q) is not defined from z = h p0 */
static dm_status solve(pair *e, const dm_stepper *s, dm_newton_report *report,
                       int known) {
    const uint32_t n = e->m->n;
    const double *last = e->left + 1 + 4 * (size_t)n;
    const dm_newton_problem problem = {.m = n,
                                       .equation = equation,
                                       .ctx = e,
                                       .size = &e->size,
                                       .tolerance = s->tolerance,
                                       .max_iterations = s->max_iterations};
    if (known) {
        for (uint32_t i = 0; i < n; i++) e->z[i] = last[i] + last[n + i];
        if (dm_newton(e->z, &problem, e->scratch, report) == DM_OK) return DM_OK;
    }
    memset(e->z, 0, n * sizeof *e->z);
    dm_status status = dm_newton(e->z, &problem, e->scratch, report);
    if (status != DM_NOT_FINITE && status != DM_SINGULAR) return status;
    for (uint32_t i = 0; i < n; i++) e->z[i] = s->h * e->state[n + i];
    return dm_newton(e->z, &problem, e->scratch, report);
}

static dm_status step(dm_stepper *s, double *state, double t) {
    pair e = lay_out(s);
    dm_newton_report report;
    (void)t;
    e.state = state;
    const int known = is_known(&e, s->h);
    dm_status status = solve(&e, s, &report, known);
    if (status == DM_OK) status = finish(&e);
    if (status == DM_OK) remember(&e, s->h, known);
    s->report.iterations = report.iterations;
    s->report.residual = report.residual;
    s->report.solves++;
    s->report.newton += report.iterations;
    s->report.evaluations += e.evaluations;
    if (status == DM_OK) memcpy(state, e.next, 4 * (size_t)e.m->n * sizeof *state);
    return status;
}

const dm_method dm_method_del = {
    .name = "del",
    .signature = "del",
    .doc =
        "Discrete Euler-Lagrange equations of a discrete Lagrangian: p0 = -D1 Ld(q0, "
        "q1), "
        "p1 = D2 Ld(q0, q1); n unknowns a step (Marsden-West 2001 sec. 1.5, Leok 2.2).",
    .traits = DM_SYMPLECTIC | DM_FOR_PAIRS,
    .check = check,
    .order = order,
    .wants = wants,
    .work = work,
    .open = open,
    .memory = memory,
    .step = step,
};
