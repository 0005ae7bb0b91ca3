/*
** log_hamiltonian.c - time-transformed splitting for close encounters and eccentric orbits.
** With U = -V > 0 and B = -E the function ln(T + B) - ln U has the orbits of energy E in a fictitious time s:
**   drift  dt/ds = 1/(T + B), dq/ds = v/(T + B);   kick  dp/ds = L_q/U
** (Mikkola & Tanikawa 1999; Preto & Tremaine 1999). The motion near a centre takes small steps of t by
** itself, and the orbit of two bodies is exact but for its timing. h is the step of s.
*/
#include "integ/splitting.h"

#include "base/sum.h"
#include "expr/compact.h"
#include "expr/derive.h"
#include "integ/fused.h"
#include "integ/kept.h"
#include "integ/lanes.h"

#include <math.h>
#include <string.h>

/* what a model keeps: it serves every composition and every h */
typedef struct {
    dm_kicks kicks; /* L_q/U */
    dm_node well;   /* U, compacted */
    dm_loop_part part[DM_LOOP_PARTS];
    dm_loop one, many; /* for one member, for lanes; what is carried is the state */
    double *spread;    /* lanes: coefficients */
} log_loop;

/* workspace: this, then x = (q, v, t), the well U, L_q[n], v[n], the state to go back to, coefficients */
typedef struct {
    dm_splitting table;
    log_loop *loop; /* NULL: none */
} layout;

enum { COEFFICIENTS = 4 * DM_SPLITTING_STAGES };

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
    return table_size() + 4 * (size_t)m->n + 2 + dm_state_size(m->n) + COEFFICIENTS;
}

/* kicks and drifts change places: with a drift at both ends the two-body orbit is kept exactly */
static void drift_first(dm_splitting *out, const dm_splitting *in) {
    out->stages = in->stages + 1;
    out->b[0] = out->b[out->stages] = 0.0;
    for (int k = 0; k <= in->stages; k++) out->a[k] = in->b[k];
    for (int k = 0; k < in->stages; k++) out->b[k + 1] = in->a[k];
}

/* ---- parts of the loop: head: drift; body: kick, drift; tail: a look at the well ---- */

/* x where c > 0, else NaN, which stops the run */
static dm_node guarded(dm_fusion *b, dm_node c, dm_node x) {
    const dm_node nan = dm_constant(b->graph, NAN);
    return dm_apply(b->graph, DM_OP_WHERE, c, x, nan);
}

/* start + v . moved, as two sums that do not wait for each other */
static dm_node fuse_product(dm_fusion *b, dm_node start, const dm_node *v,
                            const dm_node *moved) {
    dm_node even = dm_multiply_add(b->graph, v[0], moved[0], start), odd = 0;
    for (uint32_t i = 1; i < b->model->n; i++) {
        dm_node *sum = i % 2 ? &odd : &even;
        *sum = *sum ? dm_multiply_add(b->graph, v[i], moved[i], *sum)
                    : dm_mul(b->graph, v[i], moved[i]);
    }
    return odd ? dm_add(b->graph, even, odd) : even;
}

/* where every factor is a quotient over the same d: d; else 0 */
static dm_node denominator(const dm_fusion *b, const dm_node *factors) {
    dm_node d = 0;
    if (!(b->model->structure & DM_DIAGONAL_MASS)) return 0;
    for (uint32_t i = 0; i < b->model->n; i++) {
        const dm_expr *x = dm_graph_at(b->graph, factors[b->kicks->which[i]]);
        if (b->kicks->coordinate[i] < 0 || x->op != DM_OP_DIV) return 0;
        if (d && x->as.arg[1] != d) return 0;
        d = x->as.arg[1];
    }
    return d;
}

/* p += hb L_q/U; what the drift needs of it: d and y[n] = d p, made before the quotients are known; 0: p itself */
static dm_node fuse_kick(dm_fusion *b, dm_node *y, dm_node *factors) {
    const uint32_t n = b->model->n;
    const dm_node hb = dm_fusion_coefficient(b), minus = dm_fusion_coefficient(b);
    dm_fusion_factors(b, factors, 0, hb, minus);
    const dm_node d = denominator(b, factors);
    for (uint32_t i = 0; i < n && d; i++) {
        const dm_expr *x = dm_graph_at(b->graph, factors[b->kicks->which[i]]);
        const dm_node above = x->as.arg[0];
        const dm_node kick = dm_mul(b->graph, above, b->q[b->kicks->coordinate[i]]);
        y[i] = dm_multiply_add(b->graph, b->p[i], d, kick);
    }
    for (uint32_t i = 0; i < n; i++)
        dm_fusion_push(b, b->p + i, b->low_p + i, dm_fusion_kick(b, factors, i, hb));
    return d;
}

/*
** t += dt, q += dt v with dt = ha/(T + B) = 2 ha d^2 / (d v . d (p - shift) + 2 B d^2): so the division does not
** wait for the one of the kick. scratch[2 n]; d and y = d p as above.
*/
static void fuse_drift(dm_fusion *b, dm_node *scratch, dm_node d, const dm_node *y) {
    const uint32_t n = b->model->n;
    dm_node *v = scratch, *moved = v + n;
    dm_node above = dm_fusion_coefficient(b);
    dm_node start = dm_add(b->graph, b->more[2], b->more[2]);
    dm_fusion_velocity(b, v, moved, d ? y : b->p);
    if (d) {
        const dm_node d2 = dm_mul(b->graph, d, d);
        above = dm_mul(b->graph, above, d2);
        start = dm_mul(b->graph, start, d2);
    }
    const dm_node speed = fuse_product(b, start, v, moved);
    const dm_node dt = dm_div(b->graph, above, speed);
    dm_fusion_velocity(b, v, NULL, b->p);
    for (uint32_t i = 0; i < n; i++)
        dm_fusion_push(b, b->q + i, b->low_q + i, (dm_product){dt, v[i]});
    const dm_node z = dm_add(b->graph, b->more[1], dt);
    dm_fusion_sum(b, b->more, b->more + 1, z);
    dm_fusion_settle(b);
    b->more[1] = guarded(b, speed, b->more[1]);
}

/* t's low part becomes NaN where the well is not attracting */
static void fuse_look(dm_fusion *b, const log_loop *l) {
    dm_node well = 0;
    memcpy(b->with, b->q, b->model->n * sizeof *b->q);
    dm_transplant(b->graph, b->model->source.graph, &l->well, 1, b->with, &well);
    b->more[1] = guarded(b, well, b->more[1]);
}

static int fuse_part(const dm_model *m, const log_loop *l, dm_loop_kind kind,
                     dm_loop_part *out) {
    dm_fusion b;
    const size_t n = m->n;
    dm_node *scratch = dm_arena_take(m->source.arena, 4 * n * sizeof *scratch), d = 0;
    if (!scratch || !dm_fusion_begin(&b, m, &l->kicks, 4 * m->n + DM_STATE_OWN)) return 0;
    if (kind == DM_LOOP_BODY) d = fuse_kick(&b, scratch + 2 * n, scratch + 3 * n);
    if (kind == DM_LOOP_TAIL)
        fuse_look(&b, l);
    else
        fuse_drift(&b, scratch, d, scratch + 2 * n);
    return dm_fusion_end(&b, out);
}

static int fuse(const dm_model *m, log_loop *l) {
    for (int kind = DM_LOOP_HEAD; kind <= DM_LOOP_TAIL; kind++)
        if (!fuse_part(m, l, (dm_loop_kind)kind, l->part + kind)) return 0;
    return 1;
}

static int build(dm_loop *out, const dm_model *m, const log_loop *l, uint32_t lanes) {
    return dm_fused_build(out, m, l->part, 4 * m->n + DM_STATE_OWN, lanes);
}

/* L_q/U and U in the graph of the model, where they simplify: -q/r^2 for Kepler */
static int read_pulls(log_loop *l, const dm_model *m) {
    const dm_source *s = &m->source;
    dm_node *out = dm_arena_take(s->arena, m->n * sizeof *out);
    if (!out) return 0;
    for (uint32_t i = 0; i < m->n; i++)
        out[i] = dm_div(s->graph, s->gradient[i], s->well);
    if (!dm_kicks_read(&l->kicks, m, out, 1)) return 0;
    dm_compact(s->graph, &s->well, 1, &l->well);
    return dm_graph_status(s->graph) == DM_OK;
}

/* in the arena of the model, which keeps it */
static log_loop *open_loop(const dm_model *m) {
    static const char maker;
    dm_kernel kept;
    if (dm_kept_find(&kept, m, &maker, 0)) return (log_loop *)(uintptr_t)kept.pool;
    log_loop *l = m->source.graph ? dm_arena_take(m->source.arena, sizeof *l) : NULL;
    if (l) *l = (log_loop){0};
    if (!l || !read_pulls(l, m) || !fuse(m, l) || !build(&l->one, m, l, 1)) return NULL;
    dm_kept_add(m, &maker, 0, &(dm_kernel){.pool = l}, 1);
    return l;
}

static int widen(dm_stepper *s, dm_lanes *x) {
    const dm_model *m = s->model;
    log_loop *l = ((layout *)(void *)s->work)->loop;
    if (!l || !l->one.native || !dm_lanes_open(x, m, 4 * m->n + DM_STATE_OWN)) return 0;
    l->spread = dm_arena_take(m->source.arena,
                              COEFFICIENTS * (size_t)x->lanes * sizeof *l->spread);
    if (!l->spread || !build(&l->many, m, l, x->lanes)) return 0;
    x->together = l->many.together;
    return x->groups % x->together == 0;
}

/* ---- the step ---- */

static dm_status open(dm_stepper *s) {
    dm_splitting named, table;
    dm_splitting_named(&named, inner(s->rule));
    drift_first(&table, &named);
    layout *l = (layout *)(void *)s->work;
    *l = (layout){.table = table};
    l->loop = open_loop(s->model);
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

/* of a step: 2 h a_0, then h b_k, -h b_k, 2 h a_k; their number */
static uint32_t put_step(double *c, const dm_splitting *table, double h) {
    uint32_t i = 0;
    for (int k = 0; k < table->stages; k++) {
        if (k) c[i++] = h * table->b[k], c[i++] = -h * table->b[k];
        c[i++] = 2.0 * h * table->a[k];
    }
    return i;
}

static double *coefficients_of(const dm_stepper *s) {
    return s->work + table_size() + 4 * (size_t)s->model->n + 2 +
           dm_state_size(s->model->n);
}

static int try_fused(dm_stepper *s, const layout *l, double *state, long count) {
    double *c = coefficients_of(s);
    put_step(c, &l->table, s->h);
    dm_loop_call call = {.state = state,
                         .coefficients = c,
                         .groups = 1,
                         .repeats = l->table.stages - 1,
                         .steps = count};
    dm_loop_run(&l->loop->one, &call);
    s->report.evaluations += count * (l->table.stages - 1);
    return dm_state_is_finite(state, s->model->n);
}

static void advance_lanes(dm_stepper *s, dm_lanes *x, double t, long count) {
    layout *l = (layout *)(void *)s->work;
    double *c = coefficients_of(s);
    const uint32_t each = put_step(c, &l->table, s->h);
    (void)t;
    for (size_t i = 0; i < each; i++)
        for (uint32_t lane = 0; lane < x->lanes; lane++)
            l->loop->spread[i * x->lanes + lane] = c[i];
    dm_loop_call call = {.state = x->state,
                         .coefficients = l->loop->spread,
                         .groups = x->groups,
                         .repeats = l->table.stages - 1,
                         .steps = count};
    dm_loop_run(&l->loop->many, &call);
}

/* `count` steps or none */
static dm_status steps(dm_stepper *s, double *state, long count) {
    layout *l = (layout *)(void *)s->work;
    const size_t bytes = dm_state_size(s->model->n) * sizeof *state;
    double *kept = s->work + table_size() + 4 * (size_t)s->model->n + 2;
    memcpy(kept, state, bytes);
    if (l->loop ? try_fused(s, l, state, count) : try_step(s, state)) return DM_OK;
    memcpy(state, kept, bytes);
    return DM_NOT_FINITE;
}

static dm_status step(dm_stepper *s, double *state, double t) {
    (void)t;
    return steps(s, state, 1);
}

static dm_status advance(dm_stepper *s, double *state, double t, long count, long *done) {
    const layout *l = (const layout *)(const void *)s->work;
    if (l->loop && count > 1 && steps(s, state, count) == DM_OK)
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
    .traits = DM_SYMMETRIC | DM_EXPLICIT | DM_OWN_TIME | DM_KEEPS,
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
