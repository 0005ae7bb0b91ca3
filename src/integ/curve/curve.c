/* curve.c - an explicit one-step method made variational (Cuell-Patrick 2008; Leok-Shingel 2012,
 * shooting). From dLd = p1 dq1 - p0 dq0 with q0 = d-(y), q1 = d+(y) a step from (q0, p0) finds y
 * = (q, v) and p1 with (Ld - p1 . d+ + p0 . d-)_y = 0,  d-(y) = q0,   then q1 = d+(y). Unknowns:
 * v, the change p1 - p0 in units of velocity, and where d- is not q itself (q - q0) / h. The
 * errors of both Legendre transforms agree to leading order, so that the step has the order of
 * the method. */
#include "integ/curve/curve.h"
#include "base/doubles.h"
#include "integ/curve/curve_inside.h"
#include "integ/curve/curve_recipe.h"

#include "base/largest.h"
#include "linalg/solve/newton.h"
#include "numbers/compensated.h"

#include <math.h>
#include <string.h>

/* shares of a step, what the choice takes and gives, the next shares */
static size_t choice_size(const dm_rule *rule, size_t n) {
    const dm_curve *own = rule->data;
    return own && own->choice ? 3 * (size_t)own->substeps + 2 * n + 2 : 0;
}

/* The struct at the head of the workspace, in doubles. */
static size_t head(void) {
    return dm_doubles(sizeof(dm_curve_step));
}

/* ---- the rule ---- */

/* Of a dm.rule the curve itself, with all its substeps; of a text the method that it names, with
 * the bias that it names or the method has. */
static int read_curve(dm_curve *out, const dm_rule *rule) {
    if (rule->data) {
        const dm_curve *own = rule->data;
        double share[DM_CURVE_STAGES];
        *out = *own;
        if (!own->choice || own->recipe) return 1;
        for (int i = 0; i < own->substeps; i++) share[i] = 1.0 / own->substeps;
        return dm_curve_compose(out, own, share) && dm_curve_bias(out, own->bias);
    }
    if (!dm_curve_find(out, rule->arg[0].rule->name)) return 0;
    return dm_curve_bias(out, rule->count == 2 ? rule->arg[1].number : out->bias);
}

static const char *check(const dm_rule *rule) {
    dm_curve curve;
    const dm_rule *method = rule->arg[0].rule;
    if (rule->data) return NULL;
    if (rule->count < 1 || rule->count > 2 || !method || method->count)
        return "curve takes the name of an explicit one-step method, and a bias";
    const double bias = rule->count == 2 ? rule->arg[1].number : 1.0;
    if ((rule->count == 2 && rule->arg[1].rule) || !(bias >= 0.0 && bias <= 1.0))
        return "the bias of a curve is a number from 0 to 1";
    if (!dm_curve_find(&curve, method->name))
        return "there is no such one-step method: straight, euler, midpoint, heun, kutta3, rk4, "
               "dopri5, butcher6, fehlberg7, dop853, gsl-rk2, gsl-rk4, gsl-rkf45, gsl-rkck, "
               "gsl-rk8pd";
    if (!dm_curve_bias(&curve, bias))
        return "this method has too many stages for a bias other than 0 and 1";
    return NULL;
}

static int is_timed(const dm_model *m) {
    return !(m->structure & DM_AUTONOMOUS) ||
           (m->constraints && m->constraints->structure & DM_CONSTRAINTS_TIMED);
}

/* The field needs second derivatives of L, as a graph, and M that is not zero. */
static const char *fits(const dm_rule *rule, const dm_model *m) {
    const dm_curve *own = rule->data;
    if (!m->source.graph && !m->structure)
        return "it runs on hyper-dual numbers, and curve segments need derivatives of the "
               "acceleration, which come from a trace";
    if (m->structure & DM_CELLS)
        return "curve segments need derivatives of the acceleration as one formula, which the sums "
               "over cells of a field do not have; explicit Runge-Kutta rules (rk4, rk8), verlet, "
               "midpoint and gauss(s) step fields";
    if (m->structure & DM_LINEAR_IN_V)
        return "L is linear in v, so that it has no second-order field";
    if (own && ((own->recipe && own->recipe->n != m->n) || (own->choice && own->choice->n != m->n)))
        return "its method was traced for another number of coordinates";
    if (own && own->recipe && !own->recipe->timed && is_timed(m))
        return "the system depends on t, and its method, which is not linear in the values of f, "
               "asks for f without the time: write f(x, t) and f:along(x, t, u)";
    return NULL;
}

/* 0 where a text names no method; check has told that. */
static int order(const dm_rule *rule) {
    dm_curve curve;
    return read_curve(&curve, rule) ? dm_curve_order(&curve) : 0;
}

/* For the momentum at the ends and the size of M; all else are kernels of its own. */
static unsigned wants(const dm_rule *rule, const dm_model *m) {
    (void)rule;
    const unsigned tied = DM_WANT_HOLONOMIC | DM_WANT_ROLLING | DM_WANT_REACTION;
    return DM_WANT_SLOPE | DM_WANT_MASS | (m->constraints ? tied | DM_WANT_CONSTRAINT_FORCE : 0);
}

/* h, the state at the end, v of the next segment; 1 when factors hold, factors and pivots of the
 * last matrix; volumes of rows (mech/crossing.h) */
static size_t memory_size(const dm_curve *c, const dm_model *model) {
    const size_t n = model->n, m = dm_curve_unknowns(c, model);
    return 1 + 4 * n + n + 1 + m * m + (m + 1) / 2 + DM_CROSSING_WATCHED;
}

/* Newton's method or the Legendre transform, never both. */
static size_t scratch_size(const dm_curve *c, const dm_model *m) {
    const size_t newton = dm_newton_work((uint32_t)dm_curve_unknowns(c, m));
    const size_t legendre = dm_legendre_work(m), crossing = dm_curve_tie_crossing_work(m);
    const size_t most = newton > legendre ? newton : legendre;
    return crossing > most ? crossing : most;
}

static size_t work(const dm_rule *rule, const dm_model *m) {
    const size_t n = m->n;
    dm_curve c;
    if (!read_curve(&c, rule)) return 0;
    return head() + n + 3 * dm_curve_unknowns(&c, m) + 2 * n + n + 4 * n + memory_size(&c, m) +
           2 * n + n * n + n + scratch_size(&c, m) + dm_curve_tie_work(m) + choice_size(rule, n) +
           dm_segment_work(&c, m);
}

static dm_status open_choice(dm_curve_step *e, const dm_stepper *s) {
    const dm_curve *own = s->rule->data;
    return dm_curve_choice_build(&e->chooses, own->choice, s->model);
}

/* The matrix of the last step lives in the memory, so that a run goes on with it. */
static dm_status open(dm_stepper *s) {
    dm_curve_step *e = (dm_curve_step *)(void *)s->work;
    const size_t n = s->model->n;
    *e = (dm_curve_step){.n = n, .mass = s->work + head()};
    if (!read_curve(&e->curve, s->rule)) return DM_NO_MEMORY;
    e->unknowns = dm_curve_unknowns(&e->curve, s->model);
    e->columns = e->curve.centred ? 0 : s->model->n;
    e->z = e->mass + n;
    e->y = e->z + 3 * e->unknowns;
    e->p1 = e->y + 2 * n;
    e->next = e->p1 + n;
    e->memory = e->next + 4 * n;
    e->slope = e->memory + memory_size(&e->curve, s->model);
    memset(e->memory, 0, memory_size(&e->curve, s->model) * sizeof *e->memory);
    e->scratch = e->slope + 2 * n + n * n + n;
    double *rest = e->scratch + scratch_size(&e->curve, s->model);
    dm_kernel_prepare(&s->model->slope, e->slope);
    dm_curve_tie_open(&e->tie, s->model, rest);
    e->share = rest + dm_curve_tie_work(s->model);
    const size_t choice = choice_size(s->rule, n);
    memset(e->share, 0, choice * sizeof *e->share);
    const dm_status status = choice ? open_choice(e, s) : DM_OK;
    if (status != DM_OK) return status;
    return dm_segment_open(&e->segment, &e->curve, s->model, e->share + choice);
}

/* Forget the last segment and its matrix. */
static dm_status start(dm_stepper *s, double *state, double t, double h) {
    dm_curve_step *e = (dm_curve_step *)(void *)s->work;
    (void)state, (void)t, (void)h;
    memset(e->memory, 0, memory_size(&e->curve, s->model) * sizeof *e->memory);
    return DM_OK;
}

static size_t memory(dm_stepper *s, double **place) {
    dm_curve_step *e = (dm_curve_step *)(void *)s->work;
    *place = e->memory;
    return memory_size(&e->curve, s->model);
}

/* Of the last step, with constraints. */
static void impulses(const dm_stepper *s, double *out) {
    const dm_curve_tie *c = &((const dm_curve_step *)(const void *)s->work)->tie;
    memcpy(out, c->impulse, 2 * c->m * sizeof *out);
}

/* ---- the step ---- */

/* d+ - q0 and v of the next segment at the root: from the segment there, or, when the last
 * increment was at round-off, from the one before it, with d+ = q + bias h v to leading order */
static dm_status find_end(dm_curve_step *e, double *end, double *v) {
    const size_t n = e->n;
    const double *dv = e->scratch;
    const dm_status status = e->settled ? DM_OK : dm_curve_place(e, e->z);
    for (size_t k = 0; k < n; k++) {
        const double shift = e->curve.centred ? e->h * e->z[2 * n + k] : 0.0;
        const double last = e->settled ? dv[k] : 0.0;
        end[k] = shift + (e->segment.plus[k] + e->curve.bias * e->h * last);
        v[k] = e->segment.next[k] + last;
    }
    return status;
}

/* what constraints at the end add to the momentum, and the velocity there */
static dm_status hide_end(dm_curve_step *e, const dm_stepper *s, double *v) {
    const size_t n = e->n;
    dm_curve_tie_keep(e, e->z);
    for (size_t k = 0; k < n; k++) e->p1[k] = e->next[n + k] + e->mass[k] * e->z[n + k];
    const double t1 = e->t + e->curve.bias * e->h;
    const dm_status status = dm_curve_tie_hide(e, s, v, e->p1, e->next, t1);
    if (status == DM_OK) dm_curve_tie_end(e);
    return status;
}

/* q1 = d+(y) and p1, summed with compensation; and what the next step starts from. */
static dm_status finish(dm_curve_step *e, const dm_stepper *s) {
    const size_t n = e->n;
    double *next = e->next, *end = e->p1, *v = e->slope;
    dm_status status = find_end(e, end, v);
    if (status != DM_OK) return status;
    memcpy(next, e->state, 4 * n * sizeof *next);
    for (size_t k = 0; k < n; k++) dm_sum_add(next + k, next + 2 * n + k, end[k]);
    if (e->tie.m) status = hide_end(e, s, v);
    if (status != DM_OK) return status;
    for (size_t k = 0; k < n; k++) {
        double dp = e->mass[k] * e->z[n + k];
        if (e->tie.m) dp += e->tie.reaction[k];
        dm_sum_add(next + n + k, next + 3 * n + k, dp);
    }
    for (size_t k = 0; k < 4 * n; k++)
        if (!isfinite(next[k])) return DM_NOT_FINITE;
    e->memory[0] = e->h;
    memcpy(e->memory + 1, next, 4 * n * sizeof *next);
    memcpy(e->memory + 1 + 4 * n, v, n * sizeof *v);
    return DM_OK;
}

/* NaN where there is one. */
static double norm(const double *x, size_t n) {
    double largest = 0.0;
    for (size_t i = 0; i < n; i++) largest = dm_largest(largest, x[i]);
    return largest;
}

/* g and phi at the end, where `hide` looked last */
static void report_constraints(const dm_curve_step *e, dm_report *report) {
    const dm_curve_tie *c = &e->tie;
    if (c->k) report->constraint = fmax(report->constraint, norm(c->start, c->k));
    if (c->l) report->rolling = fmax(report->rolling, norm(c->roll_start, c->l));
}

/* The state is overwritten last. */
static dm_status step(dm_stepper *s, double *state, double t, double h) {
    dm_curve_step *e = (dm_curve_step *)(void *)s->work;
    dm_status status = dm_curve_solve(s, state, t, h);
    if (status == DM_OK) status = finish(e, s);
    double *watched = e->memory + memory_size(&e->curve, s->model) - DM_CROSSING_WATCHED;
    if (status == DM_OK) status = dm_curve_tie_look(e, watched, t, &s->report.trouble);
    s->report.evaluations += e->evaluations;
    if (status == DM_OK) report_constraints(e, &s->report);
    if (status == DM_OK) memcpy(state, e->next, 4 * e->n * sizeof *state);
    return status;
}

const dm_engine dm_engine_curve = {
    .fits = fits,
    .wants = wants,
    .work = work,
    .open = open,
    .start = start,
    .step = step,
    .memory = memory,
    .impulses = impulses,
    .tangent_work = dm_curve_tangent_work,
    .tangent = dm_curve_tangent,
};

const dm_method dm_method_curve = {
    .name = "curve",
    .signature = "curve(method, bias)",
    .doc =
        "An explicit one-step method of any order made variational: curve(rk4) is symplectic and "
        "has order 4, without the drift of rk4 itself. The method gives the curves along which the "
        "action is summed; bias (1 unless given) is the part of a step behind the point (q, v) it "
        "starts from, 1/2 makes the rule symmetric; curve(euler, 1/2) is the midpoint rule. 2 n "
        "unknowns a step, 3 n with a bias other than 1, and the multipliers. Forces and rolling "
        "constraints work along the curves, at the same order (Cuell-Patrick 2008, 2009; "
        "Leok-Shingel 2012).",
    .orders = "that of the method",
    .stages = "those of the method",
    .cost = "2 n unknowns",
    .instances =
        "curve(euler):1:0; curve(heun):2:0; curve(kutta3):3:0; curve(rk4):4:0; curve(dopri5):6:0; "
        "curve(butcher6):7:0; curve(fehlberg7):11:0; curve(dop853):12:0",
    .traits = DM_SYMPLECTIC | DM_CONSTRAINTS,
    .engine = &dm_engine_curve,
    .check = check,
    .order = order,
};
