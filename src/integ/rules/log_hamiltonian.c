/* log_hamiltonian.c - time-transformed splitting for close encounters and eccentric orbits. With
 * U = -V > 0 and B = -E the function ln(T + B) - ln U has the orbits of energy E in a fictitious
 * time s: drift  dt/ds = 1/(T + B), dq/ds = v/(T + B);   kick  dp/ds = L_q/U (Mikkola & Tanikawa
 * 1999; Preto & Tremaine 1999). The motion near a centre takes small steps of t by itself, and
 * the orbit of two bodies is exact but for its timing. h is the step of s. */
#include "base/doubles.h"
#include "base/times.h"
#include "integ/rules/verlet.h"
#include "integ/split/log_loop.h"
#include "numbers/compensated.h"

#include <math.h>
#include <string.h>

/* workspace: this, then x = (q, v, t), the well U, L_q[n], v[n], the state to go back to,
 * coefficients */
typedef struct {
    dm_splitting table;
    dm_log_loop *loop; /* NULL: none */
} layout;

/* The struct at the head of the workspace, in doubles. */
static size_t table_size(void) {
    return dm_doubles(sizeof(layout));
}

/* The composition, verlet where none is named. */
static const dm_rule *inner(const dm_rule *rule) {
    return rule->count ? rule->arg[0].rule : &dm_rule_verlet;
}

/* of multiples of a symmetric step, right for any T and V: a splitting that is no step of a general
 * L is not */
static int is_composition(const dm_rule *rule) {
    const dm_method *m = rule->method;
    return m && m->splitting && m->traits & DM_SYMMETRIC && m->engine != &dm_engine_splitting &&
           !dm_rule_check(rule) && m->splitting(NULL, rule);
}

static const char *check(const dm_rule *rule) {
    if (rule->count > 1 || (rule->count == 1 && !rule->arg[0].rule) || !is_composition(inner(rule)))
        return "the composition must be verlet, yoshida, suzuki, mclachlan, kahan-li, suzuki-umeno "
               "or sofroniou-spaletta with its order";
    return NULL;
}

static const char *fits(const dm_rule *rule, const dm_model *m) {
    (void)rule;
    if (!dm_splitting_fits(m)) return "it needs a separable L = T(v) - V(q) with constant mass";
    if (!(m->structure & DM_AUTONOMOUS))
        return "it needs a Lagrangian that does not depend on time";
    return NULL;
}

static int order(const dm_rule *rule) {
    return dm_rule_order(inner(rule));
}

/* U and L_q at once, and the energy of the start. */
static unsigned wants(const dm_rule *rule, const dm_model *m) {
    (void)rule, (void)m;
    return DM_WANT_POTENTIAL | DM_WANT_ENERGY;
}

/* Arguments, outputs and a state for plain C; coefficients for the loop. */
static size_t work(const dm_rule *rule, const dm_model *m) {
    (void)rule;
    return table_size() + 4 * (size_t)m->n + 2 + dm_state_size(m->n) + DM_LOG_LOOP_WORK;
}

/* kicks and drifts change places: with a drift at both ends the two-body orbit is kept exactly */
static void drift_first(dm_splitting *out, const dm_splitting *in) {
    out->stages = in->stages + 1;
    out->b[0] = out->b[out->stages] = 0.0;
    for (int k = 0; k <= in->stages; k++) out->a[k] = in->b[k];
    for (int k = 0; k < in->stages; k++) out->b[k + 1] = in->a[k];
}

static double *loop_work(const dm_stepper *s) {
    return s->work + table_size() + 4 * (size_t)s->model->n + 2 + dm_state_size(s->model->n);
}

static int widen(dm_stepper *s, dm_lanes *x) {
    layout *l = (layout *)(void *)s->work;
    return l->loop && dm_log_loop_widen(l->loop, s->model, x);
}

/* ---- the step ---- */

static dm_status open(dm_stepper *s) {
    dm_splitting named, table;
    inner(s->rule)->method->splitting(&named, inner(s->rule));
    drift_first(&table, &named);
    layout *l = (layout *)(void *)s->work;
    *l = (layout){.table = table};
    l->loop = dm_log_loop_open(s->model);
    memset(s->work + table_size(), 0, (4 * (size_t)s->model->n + 2) * sizeof(double));
    memset(loop_work(s), 0, DM_LOG_LOOP_WORK * sizeof(double));
    dm_kernel_prepare(&s->model->potential, s->work + table_size() + 2 * s->model->n + 1);
    return DM_OK;
}

/* v = M^-1 (p - shift); returns twice the kinetic energy of it */
static double velocity(const dm_model *m, double *v, const double *p) {
    const uint32_t n = m->n;
    const int diagonal = (m->structure & DM_DIAGONAL_MASS) != 0;
    double twice = 0.0;
    for (uint32_t i = 0; i < n; i++) {
        double sum = diagonal ? m->inverse_mass[i] * p[i] : 0.0;
        for (uint32_t j = 0; j < n && !diagonal; j++)
            sum += m->inverse_mass[i * n + j] * (p[j] - m->momentum_shift[j]);
        v[i] = sum;
        twice += sum * (p[i] - (diagonal ? 0.0 : m->momentum_shift[i]));
    }
    return twice;
}

/* 1/(T + B) */
static double pace(const dm_stepper *s, const double *state) {
    const uint32_t n = s->model->n;
    double *v = s->work + table_size() + 3 * (size_t)n + 2;
    return 1.0 / (0.5 * velocity(s->model, v, state + n) + state[4 * (size_t)n + 2]);
}

/* t and the binding energy become part of the state; the velocities that the energy needed are not.
 */
static dm_status start(dm_stepper *s, double *state, double t, double h) {
    const dm_model *m = s->model;
    const uint32_t n = m->n;
    double *x = s->work + table_size(), *own = state + 4 * (size_t)n, E;
    memcpy(x, state, n * sizeof *x);
    velocity(m, x + n, state + n);
    dm_kernel_prepare(&m->energy, &E);
    dm_kernel_eval(&m->energy, x, &E);
    own[0] = t, own[1] = 0.0, own[2] = -E;
    memset(x + n, 0, n * sizeof *x);
    if (!isfinite(E)) return DM_NOT_FINITE;
    return dm_times_differ(t, h * pace(s, state)) ? DM_OK : DM_NO_START;
}

/* p += b L_q/U; the well must be attracting */
static int kick(const dm_model *m, double *state, const double *x, double *well, double b) {
    dm_kernel_eval(&m->potential, x, well);
    if (!(well[0] > 0.0)) return 0;
    for (uint32_t i = 0; i < m->n; i++)
        dm_sum_add(state + m->n + i, state + 3 * (size_t)m->n + i, b / well[0] * well[1 + i]);
    return 1;
}

/* t += a/(T + B), q += a v/(T + B) */
static int drift(const dm_model *m, double *state, double *v, double a) {
    const uint32_t n = m->n;
    double *own = state + 4 * (size_t)n;
    const double speed = 0.5 * velocity(m, v, state + n) + own[2], dt = a / speed;
    if (!(speed > 0.0)) return 0;
    for (uint32_t i = 0; i < n; i++) dm_sum_add(state + i, state + 2 * (size_t)n + i, dt * v[i]);
    dm_sum_add(own, own + 1, dt);
    return 1;
}

/* 0 where the well or the speed fails: the state is then of no use. */
static int try_step(dm_stepper *s, double *state, double h) {
    const dm_model *m = s->model;
    const dm_splitting *table = &((const layout *)(const void *)s->work)->table;
    double *x = s->work + table_size(), *well = x + 2 * m->n + 1, *v = well + m->n + 1;
    for (int k = 0;; k++) {
        memcpy(x, state, m->n * sizeof *x);
        if (table->b[k] != 0.0 && !kick(m, state, x, well, h * table->b[k])) return 0;
        if (k == table->stages) break;
        if (!drift(m, state, v, h * table->a[k])) return 0;
    }
    s->report.evaluations += table->stages - 1;
    return dm_state_is_finite(state, m->n);
}

/* A state that is not finite tells of a failure anywhere in the burst. */
static int try_loop(dm_stepper *s, const layout *l, double *state, double h, long count) {
    const dm_log_burst burst = {&l->table, h, count};
    dm_log_loop_run(l->loop, state, &burst, loop_work(s));
    s->report.evaluations += count * (l->table.stages - 1);
    return dm_state_is_finite(state, s->model->n);
}

static void advance_lanes(dm_stepper *s, dm_lanes *x, double t, const double *h, long count) {
    const layout *l = (const layout *)(const void *)s->work;
    const dm_log_burst burst = {&l->table, *h, count};
    (void)t;
    dm_log_loop_run_lanes(l->loop, x, &burst, loop_work(s));
}

/* `count` steps or none */
static dm_status steps(dm_stepper *s, double *state, double h, long count) {
    layout *l = (layout *)(void *)s->work;
    const size_t bytes = dm_state_size(s->model->n) * sizeof *state;
    double *kept = s->work + table_size() + 4 * (size_t)s->model->n + 2;
    memcpy(kept, state, bytes);
    if (l->loop ? try_loop(s, l, state, h, count) : try_step(s, state, h)) return DM_OK;
    memcpy(state, kept, bytes);
    return DM_NOT_FINITE;
}

static dm_status step(dm_stepper *s, double *state, double t, double h) {
    (void)t;
    return steps(s, state, h, 1);
}

/* A burst, and where that fails step by step up to the one that does. */
static dm_status advance(dm_stepper *s, double *state, double t, double h, long count, long *done) {
    const layout *l = (const layout *)(const void *)s->work;
    if (l->loop && count > 1 && steps(s, state, h, count) == DM_OK) return *done = count, DM_OK;
    return dm_advance_by_step(s, state, t, h, count, done);
}

/* U = -V at the state of the step; T + B = U on the orbit's own energy, so that its fall is what
 * ends a step */
static const char *why(dm_stepper *s, const double *state, dm_status status) {
    const dm_model *m = s->model;
    double *x = s->work + table_size(), *well = x + 2 * m->n + 1;
    if (status == DM_NO_START)
        return "numbers near the time of the start, t0, are too far apart for its steps: count the "
               "time from a nearer origin";
    if (status != DM_NOT_FINITE) return NULL;
    memcpy(x, state, m->n * sizeof *x);
    dm_kernel_eval(&m->potential, x, well);
    if (well[0] <= 0.0)
        return "this rule needs an attracting well, V < 0 in L = T(v) - V(q), and there V >= 0: "
               "take another rule (verlet, gauss(s)), or, where V has a bound on the orbit, add a "
               "constant to L, which changes no motion";
    if (isfinite(well[0]))
        return "the potential V rises to 0 or beyond within the step, and this rule needs an "
               "attracting well, V < 0: try a smaller step, another rule, or add a constant to L, "
               "which changes no motion";
    return NULL;
}

static const dm_engine engine = {
    .fits = fits,
    .wants = wants,
    .work = work,
    .open = open,
    .start = start,
    .pace = pace,
    .step = step,
    .advance = advance,
    .widen = widen,
    .advance_lanes = advance_lanes,
    .why = why,
};

const dm_method dm_method_log_hamiltonian = {
    .name = "log-hamiltonian",
    .signature = "log-hamiltonian(composition)",
    .doc = "Splitting of the logarithmic Hamiltonian in a fictitious time s, for attracting V < 0 "
           "along the orbit: small steps of t near a centre (eccentric orbits, close encounters), "
           "the two-body orbit exact but for its timing. h is the step of s; dt is about h/|V|. "
           "composition: verlet (the default), kahan-li(8) ... Mikkola & Tanikawa 1999; Preto & "
           "Tremaine 1999.",
    .orders = "that of the composition",
    .stages = "those of the composition",
    .cost = "its forces",
    .instances = "",
    .traits = DM_SYMMETRIC | DM_EXPLICIT | DM_OWN_TIME,
    .engine = &engine,
    .check = check,
    .order = order,
};
