/* del.c - the discrete Euler-Lagrange equations of a user's Ld(q0, q1), position-momentum form,
 * with holonomic constraints, rolling constraints on pairs and discrete forces. */
#include "integ/rules/del.h"

#include <string.h>

/* Derivatives of Ld; g, G, g_t; what a model does not have is not made. */
static unsigned wants(const dm_rule *rule, const dm_model *m) {
    (void)rule;
    if (!m->constraints) return DM_WANT_PAIR;
    return DM_WANT_PAIR | DM_WANT_HOLONOMIC | DM_WANT_ROLLING | DM_WANT_FORCE_CURVE |
           (dm_del_rolling(m) ? DM_WANT_REACTION : 0);
}

static size_t work(const dm_rule *rule, const dm_model *m) {
    (void)rule;
    return dm_del_work(m);
}

/* Memory begins empty, and roots of implicit functions at those that the kernel has. */
static dm_status open(dm_stepper *s) {
    const dm_del *e = dm_del_lay_out(s);
    const dm_constraints *c = s->model->constraints;
    dm_kernel_prepare(&s->model->pair, e->out);
    if (s->model->pair_sum.eval) dm_kernel_prepare(&s->model->pair_sum, e->sum);
    memset(e->constraint_x, 0, (2 * (size_t)e->n + 1 + e->k + e->l) * sizeof *e->constraint_x);
    if (e->k) dm_kernel_prepare(&c->holonomic_kernel, e->here);
    if (e->k) dm_kernel_prepare(&c->holonomic_kernel, e->there);
    if (e->l) dm_kernel_prepare(&c->rolling_kernel, e->roll);
    if (e->l) dm_kernel_prepare(&c->reaction, e->turn);
    if (c && c->forced) dm_kernel_prepare(&c->force_curve, e->push);
    memset(e->memory, 0, dm_del_memory(s->model) * sizeof *e->memory);
    dm_kernel_remember(&s->model->pair, 1);
    dm_del_leave_roots(e);
    return DM_OK;
}

/* a step that is known to lead to q1 begins there, as one that continues others */
static void begin_toward(const dm_stepper *s, const double *state) {
    const uint32_t n = s->model->n;
    double *memory = dm_del_of(s)->memory, *end = memory + DM_DEL_END, *last = end + 4 * (size_t)n;
    memory[DM_DEL_COUNT] = 1.0;
    memcpy(end, state, 4 * (size_t)n * sizeof *end);
    for (uint32_t i = 0; i < n; i++) last[i] = s->toward[i] - state[i];
}

/* As if it were opened now; steps have the length that is in Ld. */
static dm_status start(dm_stepper *s, double *state, double t, double h) {
    const dm_status status = open(s);
    (void)t, (void)h;
    if (status == DM_OK && s->toward) begin_toward(s, state);
    return status;
}

/* The last steps, then the roots. */
static size_t memory(dm_stepper *s, double **place) {
    *place = dm_del_of(s)->memory;
    return dm_del_memory(s->model);
}

/* Does the step go over a place where holonomic constraints cross? D1D2 is nearly the mass over h.
 */
static dm_status look_for_crossing(dm_stepper *s, const dm_del *e, double t, double h) {
    const dm_crossing_way way = {.q0 = e->state, .q1 = e->next, .t0 = t, .t1 = t + h};
    const double *mass = e->out + 2 * (size_t)e->n;
    dm_crossing_place place;
    if (!e->k || !dm_crossing_at_end(s->model->constraints, e->memory + DM_DEL_WATCHED, e->there,
                                     mass, way, &place, e->scratch))
        return DM_OK;
    s->report.trouble = (dm_trouble){.dependent = (int)place.row, .crosses = 1, .at = place.t};
    return DM_SINGULAR;
}

/* h is in Ld; it only helps where Ld(q, q) is not defined. */
static dm_status step(dm_stepper *s, double *state, double t, double h) {
    dm_del *e = dm_del_of(s);
    dm_newton_report report = {0};
    e->state = state;
    e->sign = 0.0;
    e->evaluations = 0;
    s->report.trouble = (dm_trouble){0};
    dm_del_take_roots(e);
    dm_del_constrain_at(e, e->here, state);
    int follows;
    dm_status status = dm_del_solve(e, s, h, &report, &follows);
    if (status == DM_OK) status = dm_del_finish(e);
    if (status == DM_OK) status = look_for_crossing(s, e, t, h);
    if (status == DM_OK) status = dm_del_look(e);
    s->report.iterations = report.iterations;
    s->report.residual = report.residual;
    s->report.solves++;
    s->report.newton += report.iterations;
    s->report.matrices += report.jacobians;
    s->report.evaluations += e->evaluations;
    if (status != DM_OK) {
        /* where constraints cross the determinant vanishes by them */
        s->report.trouble.fading = !s->report.trouble.crosses && dm_del_is_fading(e);
        return status;
    }
    dm_del_keep(e, follows);
    dm_del_copy_state(state, e->next, e->n);
    if (e->k) s->report.constraint = fmax(s->report.constraint, dm_del_norm(e->there, e->k));
    if (e->l) s->report.rolling = fmax(s->report.rolling, dm_del_norm(e->roll, e->l));
    return DM_OK;
}

static const char *why(dm_stepper *s, const double *state, dm_status status) {
    (void)state;
    if (status == DM_INERTIA)
        return "the determinant of D1 D2 Ld, nearly that of -d2L/dv2 over h, changes its sign "
               "there: p0 no longer determines q1, and the motion ends";
    if (s->report.trouble.fading && (status == DM_NO_CONVERGENCE || status == DM_SINGULAR))
        return "the determinant of D1 D2 Ld, nearly that of -d2L/dv2 over h, goes to zero there, "
               "behind which p0 determines no q1 near this one: a fold of the momentum, where "
               "motions end, or a pole of the coordinates";
    return NULL;
}

/* the discrete equations put all of it at the start of the step */
static void impulses(const dm_stepper *s, double *out) {
    const dm_del *e = dm_del_of(s);
    const uint32_t all = e->k + e->l;
    for (uint32_t c = 0; c < all; c++) {
        out[c] = e->pull[c] * e->z[e->n + c];
        out[all + c] = 0.0;
    }
}

static const dm_engine engine = {
    .wants = wants,
    .work = work,
    .open = open,
    .start = start,
    .step = step,
    .memory = memory,
    .why = why,
    .impulses = impulses,
};

const dm_method dm_method_del = {
    .name = "del",
    .signature = "del",
    .doc =
        "Discrete Euler-Lagrange equations of a discrete Lagrangian: p0 = -D1 Ld(q0, q1), p1 = "
        "D2 Ld(q0, q1); n unknowns a step (Marsden-West 2001 sec. 1.5, Leok 2.2). With a "
        "constraint g: p0 = -D1 Ld - G^T lambda, g(q1) = 0, one more unknown for each; with "
        "rolling "
        "constraints phi(q0, q1) = 0 and the rows E of their reactions: p0 = -D1 Ld - E^T mu; with "
        "discrete forces: p0 = -D1 Ld - F1, p1 = D2 Ld + F2 (Leok 2.8.2; Cuell-Patrick 2009, 3).",
    .orders = "that of Ld: Ld:order()",
    .stages = "-",
    .cost = "n unknowns",
    .instances = "",
    .traits = DM_SYMPLECTIC | DM_FOR_PAIRS | DM_CONSTRAINTS | DM_LOOSE_MOMENTUM,
    .engine = &engine,
};
