/*
** log_hamiltonian.c - time-transformed splitting for close encounters and eccentric orbits.
** With U = -V > 0 and B = -E the function ln(T + B) - ln U has the orbits of energy E in a fictitious time s:
**   drift  dt/ds = 1/(T + B), dq/ds = v/(T + B);   kick  dp/ds = L_q/U
** (Mikkola & Tanikawa 1999; Preto & Tremaine 1999). The motion near a centre takes small steps of t by
** itself, and the orbit of two bodies is exact but for its timing. h is the step of s.
*/
#include "integ/splitting.h"

#include "base/sum.h"
#include "integ/lanes.h"

#include <math.h>
#include <string.h>

/* workspace: this, then x = (q, v, t), the well U, L_q[n], v[n], the state to go back to */
typedef struct {
    dm_splitting table;
    dm_fused fused;         /* the whole state, own time included */
    dm_kernel drift, stage; /* h a_k; h b_k, h a_k: kick, drift */
    dm_fused wide[DM_LANES_GROUPS];
    dm_kernel many_drift, many_stage, many_look; /* of lanes; a look at the well */
} layout;

static size_t table_size(void) {
    return (sizeof(layout) + sizeof(double) - 1) / sizeof(double);
}

static const dm_rule *inner(const dm_rule *rule) {
    static const dm_rule verlet = {.name = "verlet"};
    return rule->count ? rule->arg[0].rule : &verlet;
}

static const char *check(const dm_rule *rule) {
    dm_splitting table;
    if (rule->count > 1 || (rule->count == 1 && !rule->arg[0].rule) ||
        !dm_splitting_named(&table, inner(rule)))
        return "the composition must be verlet, yoshida, suzuki, mclachlan, kahan-li, "
               "suzuki-umeno or "
               "sofroniou-spaletta with its order";
    return NULL;
}

static const char *fits(const dm_rule *rule, const dm_model *m) {
    (void)rule;
    if (!dm_splitting_fits(m))
        return "it needs a separable L = T(v) - V(q) with constant mass";
    if (!(m->structure & DM_AUTONOMOUS))
        return "it needs a Lagrangian that does not depend on time";
    return NULL;
}

static int order(const dm_rule *rule) {
    const char *nearest;
    return dm_method_find(inner(rule)->name, &nearest)->order(inner(rule));
}

static unsigned wants(const dm_rule *rule, const dm_model *m) {
    (void)rule, (void)m;
    return DM_WANT_WELL | DM_WANT_ENERGY;
}

static size_t work(const dm_rule *rule, const dm_model *m) {
    (void)rule;
    return table_size() + 4 * (size_t)m->n + 2 + dm_state_size(m->n);
}

/* kicks and drifts change places: with a drift at both ends the two-body orbit is kept exactly */
static void drift_first(dm_splitting *out, const dm_splitting *in) {
    out->stages = in->stages + 1;
    out->b[0] = out->b[out->stages] = 0.0;
    for (int k = 0; k <= in->stages; k++) out->a[k] = in->b[k];
    for (int k = 0; k < in->stages; k++) out->b[k + 1] = in->a[k];
}

/* ---- stages as kernels ---- */

/* x where c > 0, else NaN, which stops the run */
static dm_node guarded(dm_fusion *b, dm_node c, dm_node x) {
    const dm_node nan = dm_constant(b->graph, NAN);
    return dm_apply(b->graph, DM_OP_WHERE, c, x, nan);
}

/* T + B with T = v . (p - shift)/2 */
static dm_node fuse_speed(dm_fusion *b, const dm_node *v, const dm_node *moved,
                          dm_node B) {
    dm_node twice = dm_mul(b->graph, v[0], moved[0]);
    for (uint32_t i = 1; i < b->model->n; i++) {
        const dm_node term = dm_mul(b->graph, v[i], moved[i]);
        twice = dm_add(b->graph, twice, term);
    }
    const dm_node half = dm_constant(b->graph, 0.5);
    const dm_node T = dm_mul(b->graph, half, twice);
    return dm_add(b->graph, T, B);
}

/* t += ha/(T + B), q += ha v/(T + B) */
static void fuse_drift(dm_fusion *b, dm_node *state, dm_node *v, dm_node ha) {
    const uint32_t n = b->model->n;
    dm_node *own = state + 4 * (size_t)n;
    dm_fusion_velocity(b, v, v + n, state + n);
    const dm_node speed = fuse_speed(b, v, v + n, own[2]);
    const dm_node quotient = dm_div(b->graph, ha, speed);
    const dm_node dt = guarded(b, speed, quotient);
    for (uint32_t i = 0; i < n; i++) {
        const dm_node dq = dm_mul(b->graph, dt, v[i]);
        dm_fusion_add(b, state + i, state + 2 * n + i, dq);
    }
    dm_fusion_add(b, own, own + 1, dt);
}

/* p += hb L_q/U, by way of pull[n] */
static void fuse_kick(dm_fusion *b, dm_node *state, dm_node *pull, dm_node hb) {
    const uint32_t n = b->model->n;
    dm_fusion_evaluate(b, pull, state, 0);
    for (uint32_t i = 0; i < n; i++) {
        const dm_node dp = dm_mul(b->graph, hb, pull[i]);
        dm_fusion_add(b, state + n + i, state + 3 * n + i, dp);
    }
}

/* L_q/U in the graph of the model, where it simplifies: -q/r^2 for Kepler */
static int pulls(const dm_model *m, dm_node *out) {
    const dm_source *s = &m->source;
    for (uint32_t i = 0; i < m->n; i++)
        out[i] = dm_div(s->graph, s->gradient[i], s->well);
    return dm_graph_status(s->graph) == DM_OK;
}

static int fuse_stage(const dm_model *m, dm_kernel *out, int with_kick, uint32_t lanes) {
    const uint32_t n = m->n, size = 4 * n + DM_STATE_OWN;
    dm_fusion b;
    dm_node *state =
        dm_arena_take(m->source.arena, (size + 3 * (size_t)n) * sizeof *state);
    if (!state) return 0;
    dm_node *pull = state + size, *v = pull + n;
    if (!pulls(m, pull) || !dm_fusion_begin(&b, m, pull, size)) return 0;
    b.lanes = lanes;
    dm_fusion_state(&b, state);
    if (with_kick) fuse_kick(&b, state, pull, dm_fusion_coefficient(&b, 0));
    fuse_drift(&b, state, v, dm_fusion_coefficient(&b, with_kick ? 1 : 0));
    return dm_fusion_end(&b, out, state, size);
}

/* t's low part becomes NaN where the well is not attracting */
static int fuse_look(const dm_model *m, dm_kernel *out, uint32_t lanes) {
    const uint32_t n = m->n, size = 4 * n + DM_STATE_OWN;
    dm_fusion b;
    dm_node *state =
        dm_arena_take(m->source.arena, (size + 2 * (size_t)n) * sizeof *state);
    if (!state) return 0;
    dm_node *own = state + 4 * (size_t)n, *well = state + size;
    for (uint32_t i = 0; i < n; i++) well[i] = m->source.well;
    if (!dm_fusion_begin(&b, m, well, size)) return 0;
    b.lanes = lanes;
    dm_fusion_state(&b, state);
    dm_fusion_evaluate(&b, well, state, 0);
    own[1] = guarded(&b, well[0], own[1]);
    return dm_fusion_end(&b, out, state, size);
}

static void fuse(const dm_model *m, layout *l) {
    if (!dm_fused_open(&l->fused, m, 4 * m->n + DM_STATE_OWN, 1) ||
        !fuse_stage(m, &l->drift, 0, 1) || !fuse_stage(m, &l->stage, 1, 1))
        l->fused.size = 0;
}

static int widen(dm_stepper *s, dm_lanes *x) {
    const dm_model *m = s->model;
    layout *l = (layout *)(void *)s->work;
    return l->fused.size &&
           dm_lanes_open(x, l->wide, m, 4 * m->n + DM_STATE_OWN, &l->stage) &&
           fuse_stage(m, &l->many_drift, 0, x->lanes) &&
           fuse_stage(m, &l->many_stage, 1, x->lanes) &&
           fuse_look(m, &l->many_look, x->lanes);
}

/* ---- the step ---- */

static dm_status open(dm_stepper *s) {
    dm_splitting named, table;
    dm_splitting_named(&named, inner(s->rule));
    drift_first(&table, &named);
    layout *l = (layout *)(void *)s->work;
    *l = (layout){.table = table};
    if (s->model->source.graph) fuse(s->model, l);
    memset(s->work + table_size(), 0, (4 * (size_t)s->model->n + 2) * sizeof(double));
    dm_kernel_prepare(&s->model->well, s->work + table_size() + 2 * s->model->n + 1);
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

static dm_status start(dm_stepper *s, double *state, double t) {
    const dm_model *m = s->model;
    const uint32_t n = m->n;
    double *x = s->work + table_size(), *own = state + 4 * (size_t)n, E;
    memcpy(x, state, n * sizeof *x);
    velocity(m, x + n, state + n);
    dm_kernel_prepare(&m->energy, &E);
    dm_kernel_eval(&m->energy, x, &E);
    own[0] = t, own[1] = 0.0, own[2] = -E;
    memset(x + n, 0, n * sizeof *x);
    return isfinite(E) ? DM_OK : DM_NOT_FINITE;
}

/* p += b L_q/U; the well must be attracting */
static int kick(const dm_model *m, double *state, const double *x, double *well,
                double b) {
    dm_kernel_eval(&m->well, x, well);
    if (!(well[0] > 0.0)) return 0;
    for (uint32_t i = 0; i < m->n; i++)
        dm_sum_add(state + m->n + i, state + 3 * (size_t)m->n + i,
                   b / well[0] * well[1 + i]);
    return 1;
}

/* t += a/(T + B), q += a v/(T + B) */
static int drift(const dm_model *m, double *state, double *v, double a) {
    const uint32_t n = m->n;
    double *own = state + 4 * (size_t)n;
    const double speed = 0.5 * velocity(m, v, state + n) + own[2], dt = a / speed;
    if (!(speed > 0.0)) return 0;
    for (uint32_t i = 0; i < n; i++)
        dm_sum_add(state + i, state + 2 * (size_t)n + i, dt * v[i]);
    dm_sum_add(own, own + 1, dt);
    return 1;
}

static int try_step(dm_stepper *s, double *state) {
    const dm_model *m = s->model;
    const dm_splitting *table = &((const layout *)(const void *)s->work)->table;
    double *x = s->work + table_size(), *well = x + 2 * m->n + 1, *v = well + m->n + 1;
    for (int k = 0;; k++) {
        memcpy(x, state, m->n * sizeof *x);
        if (table->b[k] != 0.0 && !kick(m, state, x, well, s->h * table->b[k])) return 0;
        if (k == table->stages) break;
        if (!drift(m, state, v, s->h * table->a[k])) return 0;
    }
    s->report.evaluations += table->stages - 1;
    return dm_state_is_finite(state, m->n);
}

/* through the fused kernel; the well must be attracting at the end too */
static int try_fused(dm_stepper *s, layout *l, double *state, long count) {
    const dm_model *m = s->model;
    double *x = s->work + table_size(), *well = x + 2 * m->n + 1;
    const size_t bytes = dm_state_size(m->n) * sizeof *state;
    dm_kernel_prepare(&l->stage, l->fused.now);
    dm_kernel_prepare(&l->stage, l->fused.next);
    memcpy(l->fused.now, state, bytes);
    for (long i = 0; i < count; i++) {
        for (int k = 0; k < l->table.stages; k++) {
            const double c[2] = {s->h * l->table.b[k], s->h * l->table.a[k]};
            if (l->table.b[k] == 0.0)
                dm_fused_stage(&l->fused, &l->drift, c + 1, 1);
            else
                dm_fused_stage(&l->fused, &l->stage, c, 2);
        }
    }
    memcpy(state, l->fused.now, bytes);
    memcpy(x, state, m->n * sizeof *x);
    dm_kernel_eval(&m->well, x, well);
    s->report.evaluations += count * (l->table.stages - 1);
    return well[0] > 0.0 && dm_state_is_finite(state, m->n);
}

/* the stages, and a look at the well after them */
static void step_lanes(layout *l, uint32_t groups, double h) {
    const dm_splitting *table = &l->table;
    for (int k = 0; k < table->stages; k++) {
        const double c[2] = {h * table->b[k], h * table->a[k]};
        const int drifts = table->b[k] == 0.0;
        const dm_kernel *kernel = drifts ? &l->many_drift : &l->many_stage;
        dm_fused_groups(l->wide, groups, kernel, c + drifts, 2 - drifts);
    }
    dm_fused_groups(l->wide, groups, &l->many_look, NULL, 0);
}

static void advance_lanes(dm_stepper *s, dm_lanes *x, double t, long count) {
    layout *l = (layout *)(void *)s->work;
    const size_t size = dm_state_size(s->model->n) * x->lanes;
    (void)t;
    for (uint32_t g = 0; g < x->groups; g++) {
        dm_lanes_prepare(l->wide + g, &l->many_stage);
        memcpy(l->wide[g].now, x->state + g * size, size * sizeof *x->state);
    }
    dm_fused_forget(l->wide);
    for (long k = 0; k < count; k++) step_lanes(l, x->groups, s->h);
    for (uint32_t g = 0; g < x->groups; g++)
        memcpy(x->state + g * size, l->wide[g].now, size * sizeof *x->state);
}

/* `count` steps or none */
static dm_status steps(dm_stepper *s, double *state, long count) {
    layout *l = (layout *)(void *)s->work;
    const size_t bytes = dm_state_size(s->model->n) * sizeof *state;
    double *kept = s->work + table_size() + 4 * (size_t)s->model->n + 2;
    const int fused = l->fused.size != 0;
    memcpy(kept, state, bytes);
    if (fused ? try_fused(s, l, state, count) : try_step(s, state)) return DM_OK;
    memcpy(state, kept, bytes);
    return DM_NOT_FINITE;
}

static dm_status step(dm_stepper *s, double *state, double t) {
    (void)t;
    return steps(s, state, 1);
}

static dm_status advance(dm_stepper *s, double *state, double t, long count, long *done) {
    const layout *l = (const layout *)(const void *)s->work;
    if (l->fused.size && count > 1 && steps(s, state, count) == DM_OK)
        return *done = count, DM_OK;
    return dm_advance_by_step(s, state, t, count, done);
}

const dm_method dm_method_log_hamiltonian = {
    .name = "log-hamiltonian",
    .signature = "log-hamiltonian(composition)",
    .doc = "Splitting of the logarithmic Hamiltonian in a fictitious time s, for "
           "attracting V < 0: small steps of t "
           "near a centre, the two-body orbit exact but for its timing. h is the step of "
           "s; dt is about h/|V|. "
           "composition: verlet (the default), kahan-li(8) ... Mikkola & Tanikawa 1999; "
           "Preto & Tremaine 1999.",
    .traits = DM_SYMMETRIC | DM_EXPLICIT | DM_OWN_TIME,
    .check = check,
    .fits = fits,
    .order = order,
    .wants = wants,
    .work = work,
    .open = open,
    .start = start,
    .step = step,
    .advance = advance,
    .widen = widen,
    .advance_lanes = advance_lanes,
};
