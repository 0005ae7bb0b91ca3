#include "integ/splitting.h"

#include "base/sum.h"
#include "integ/chain.h"
#include "integ/lanes.h"

#include <string.h>

/* stages as kernels; the state is q, p, their low parts, the force */
typedef struct {
    dm_kernel both;  /* stage h b_0, h a_0, t_1, h b_1: kick, drift, kick */
    dm_kernel later; /* stage h a_k, t_(k+1), h b_(k+1): drift, kick */
    dm_kernel drift; /* stage h a_k */
    dm_kernel force; /* of the state, at time coefficient 0 */
} kernels;

/* workspace: the table, then x = (q, v, t), force[n], kicked[n], the state at the start of a burst */
typedef struct {
    dm_splitting table;
    double c[DM_SPLITTING_STAGES + 1]; /* time of kick k is t + c_k h */
    kernels one, many;                 /* for one member, for lanes */
    dm_fused fused, wide[DM_LANES_GROUPS];
    dm_chain *chain; /* NULL: no loops along arrays */
} layout;

int dm_splitting_fits(const dm_model *m) {
    const unsigned simple = DM_SEPARABLE | DM_CONSTANT_MASS;
    return (m->structure & simple) == simple && m->inverse_mass && !m->ties;
}

void dm_splitting_compose(dm_splitting *out, const double *gamma, int s) {
    out->stages = s;
    for (int k = 0; k <= s; k++) {
        const double before = k > 0 ? gamma[k - 1] : 0.0, after = k < s ? gamma[k] : 0.0;
        out->b[k] = 0.5 * (before + after);
        if (k < s) out->a[k] = gamma[k];
    }
}

static size_t layout_size(void) {
    return (sizeof(layout) + sizeof(double) - 1) / sizeof(double);
}

size_t dm_splitting_work(uint32_t n) {
    return layout_size() + 4 * (size_t)n + 1 + dm_state_size(n);
}

/* forces a step: one for every kick but the first, which has that of the step before */
static uint32_t evaluations(const dm_splitting *table) {
    return (uint32_t)(table->stages - (table->b[table->stages] == 0.0));
}

/* ---- stages as kernels ---- */

/* p += hb force */
static void fuse_kick(dm_fusion *b, dm_node *state, dm_node hb) {
    const uint32_t n = b->model->n;
    const dm_node *force = state + 4 * n;
    for (uint32_t i = 0; i < n; i++) {
        const dm_node dp = dm_mul(b->graph, hb, force[i]);
        dm_fusion_add(b, state + n + i, state + 3 * n + i, dp);
    }
}

/* q += ha M^-1 (p - shift), by way of the place of the force */
static void fuse_drift(dm_fusion *b, dm_node *state, dm_node ha) {
    const uint32_t n = b->model->n;
    dm_node *v = state + 4 * n;
    dm_fusion_velocity(b, v, NULL, state + n);
    for (uint32_t i = 0; i < n; i++) {
        const dm_node dq = dm_mul(b->graph, ha, v[i]);
        dm_fusion_add(b, state + i, state + 2 * n + i, dq);
    }
}

/* kinds of stages: what they do, and where their coefficients are */
typedef struct {
    int kick_first, drift, force, kick_last;
} stage;

static int fuse_stage(const dm_model *m, dm_kernel *out, stage what, uint32_t lanes) {
    const uint32_t n = m->n;
    uint32_t next = 0;
    dm_fusion b;
    if (!dm_fusion_begin(&b, m, m->source.gradient, 5 * n)) return 0;
    b.lanes = lanes;
    dm_node *state = dm_arena_take(m->source.arena, 5 * (size_t)n * sizeof *state);
    if (!state) return 0;
    dm_fusion_state(&b, state);
    if (what.kick_first) fuse_kick(&b, state, dm_fusion_coefficient(&b, next++));
    if (what.drift) fuse_drift(&b, state, dm_fusion_coefficient(&b, next++));
    if (what.force)
        dm_fusion_evaluate(&b, state + 4 * n, state, dm_fusion_coefficient(&b, next++));
    if (what.kick_last) fuse_kick(&b, state, dm_fusion_coefficient(&b, next++));
    return dm_fusion_end(&b, out, state, 5 * n);
}

/* the kinds that the table needs; 0 when one cannot be had */
static int fuse(const dm_model *m, kernels *k, const dm_splitting *table,
                uint32_t lanes) {
    const int drift_first = table->b[0] == 0.0, s = table->stages;
    int there = fuse_stage(m, &k->force, (stage){.force = 1}, lanes);
    if (there && !drift_first)
        there = fuse_stage(m, &k->both, (stage){1, 1, 1, 1}, lanes);
    if (there && (s > 1 || drift_first))
        there = fuse_stage(m, &k->later, (stage){0, 1, 1, 1}, lanes);
    if (there && table->b[s] == 0.0)
        there = fuse_stage(m, &k->drift, (stage){.drift = 1}, lanes);
    return there;
}

void dm_splitting_open(dm_stepper *s, const dm_splitting *table) {
    layout *l = (layout *)(void *)s->work;
    *l = (layout){.table = *table};
    for (int k = 0; k < table->stages; k++) l->c[k + 1] = l->c[k] + table->a[k];
    l->c[table->stages] = 1.0;
    if (s->model->structure & DM_LOOPS) l->chain = dm_chain_open(s->model, table);
    if (!s->model->source.graph) return;
    /* without them the loop below serves */
    if (!dm_fused_open(&l->fused, s->model, 5 * s->model->n, 1) ||
        !fuse(s->model, &l->one, table, 1))
        l->fused.size = 0;
}

int dm_splitting_widen(dm_stepper *s, dm_lanes *x) {
    layout *l = (layout *)(void *)s->work;
    return l->fused.size &&
           dm_lanes_open(x, l->wide, s->model, 5 * s->model->n, &l->one.force) &&
           fuse(s->model, &l->many, &l->table, x->lanes);
}

static inline void kick(uint32_t n, double *p, double *low, double hb,
                        const double *force) {
    for (uint32_t i = 0; i < n; i++) dm_sum_add(p + i, low + i, hb * force[i]);
}

/* The kick that begins a step, with the force that ended the last one: p + hb force is what the
** first drift sees; p itself gets it with the next kick, by way of the low part, so that the drift
** does not wait for two sums. */
static inline void begin(uint32_t n, double *kicked, double *p, double hb,
                         const double *force) {
    double *low = p + 2 * n; /* behind p in the state */
    for (uint32_t i = 0; i < n; i++) {
        kicked[i] = p[i] + hb * force[i];
        low[i] += hb * force[i];
    }
}

/* q += h a M^-1 (p - shift) */
static inline void drift(const dm_model *m, double *q, double *low, double ha,
                         const double *p) {
    const uint32_t n = m->n;
    const double *w = m->inverse_mass, *shift = m->momentum_shift;
    if (m->structure & DM_DIAGONAL_MASS) {
        for (uint32_t i = 0; i < n; i++) dm_sum_add(q + i, low + i, (ha * w[i]) * p[i]);
        return;
    }
    for (uint32_t i = 0; i < n; i++) {
        double v = 0.0;
        for (uint32_t j = 0; j < n; j++) v += w[i * n + j] * (p[j] - shift[j]);
        dm_sum_add(q + i, low + i, ha * v);
    }
}

/* a stage about to be done */
typedef struct {
    const dm_kernel *kernel;
    int first, count; /* of the coefficients below */
    double c[DM_FUSED_COEFFICIENTS];
} call;

/* stage k of a step that begins at t */
static inline call stage_of(const layout *l, const kernels *these, int k, double h,
                            double t) {
    const dm_splitting *table = &l->table;
    const double at = t + l->c[k + 1] * h;
    call x = {.c = {h * table->b[k], h * table->a[k], at, h * table->b[k + 1]}};
    if (table->b[k + 1] == 0.0)
        x.kernel = &these->drift, x.first = 1, x.count = 1;
    else if (k == 0 && table->b[0] != 0.0)
        x.kernel = &these->both, x.count = 4;
    else
        x.kernel = &these->later, x.first = 1, x.count = 3;
    return x;
}

/* one step, the force of its start being in the state */
static void fused_step(layout *l, double h, double t) {
    for (int k = 0; k < l->table.stages; k++) {
        const call x = stage_of(l, &l->one, k, h, t);
        dm_fused_stage(&l->fused, x.kernel, x.c + x.first, x.count);
    }
}

/* kernels write only what varies */
static void prepare_buffers(layout *l) {
    const dm_kernel *those[] = {&l->one.both, &l->one.later, &l->one.force};
    for (int i = 0; i < 3; i++) {
        if (!those[i]->eval) continue;
        dm_kernel_prepare(those[i], l->fused.now);
        dm_kernel_prepare(those[i], l->fused.next);
    }
}

static void run_fused(dm_stepper *s, layout *l, double *state, double t, long count) {
    const size_t n = s->model->n;
    prepare_buffers(l);
    memcpy(l->fused.now, state, 4 * n * sizeof *state);
    dm_fused_stage(&l->fused, &l->one.force, &t, 1);
    for (long k = 0; k < count; k++) fused_step(l, s->h, t + (double)k * s->h);
    memcpy(state, l->fused.now, 4 * n * sizeof *state);
    s->report.evaluations += 1 + count * evaluations(&l->table);
}

/* count steps with no look at what comes out */
static void run(dm_stepper *s, double *state, double t, long count) {
    const dm_model *m = s->model;
    const uint32_t n = m->n;
    layout *l = (layout *)(void *)s->work;
    if (l->chain) {
        s->report.evaluations += dm_chain_run(l->chain, state, s->h, t, count);
        return;
    }
    if (l->fused.size) {
        run_fused(s, l, state, t, count);
        return;
    }
    const dm_splitting *table = &l->table;
    double *x = s->work + layout_size(), *force = x + 2 * n + 1, *kicked = force + n;
    double *p = state + n, *low_q = state + 2 * n, *low_p = state + 3 * n;
    memcpy(x, state, n * sizeof *x);
    x[2 * n] = t;
    dm_kernel_prepare(&m->force, force);
    if (table->b[0] != 0.0) dm_kernel_eval(&m->force, x, force);
    for (long step = 0; step < count; step++) {
        const double now = t + (double)step * s->h;
        const int kicks = table->b[0] != 0.0;
        if (kicks) begin(n, kicked, p, s->h * table->b[0], force);
        for (int k = 0; k < table->stages; k++) {
            drift(m, x, low_q, s->h * table->a[k], kicks && k == 0 ? kicked : p);
            x[2 * n] = now + l->c[k + 1] * s->h;
            if (table->b[k + 1] == 0.0) continue; /* ends with a drift */
            dm_kernel_eval(&m->force, x, force);
            kick(n, p, low_p, s->h * table->b[k + 1], force);
        }
    }
    memcpy(state, x, n * sizeof *x);
    s->report.evaluations += (table->b[0] != 0.0) + count * evaluations(table);
}

/* what is not finite stays so, hence one look at the end; then the burst is done again to find
** the step */
dm_status dm_splitting_advance(dm_stepper *s, double *state, double t, long count,
                               long *done) {
    const uint32_t n = s->model->n;
    const size_t bytes = dm_state_size(n) * sizeof *state;
    double *start = s->work + layout_size() + 4 * (size_t)n + 1;
    memcpy(start, state, bytes);
    run(s, state, t, count);
    *done = count;
    if (dm_state_is_finite(state, n)) return DM_OK;
    memcpy(state, start, bytes);
    *done = 0;
    return count > 1 ? dm_advance_by_step(s, state, t, count, done) : DM_NOT_FINITE;
}

/* ---- members in lanes ---- */

/* into the buffers of a group */
static void load_group(layout *l, dm_fused *f, const double *state, size_t bytes) {
    dm_lanes_prepare(f, &l->many.both);
    dm_lanes_prepare(f, &l->many.later);
    dm_lanes_prepare(f, &l->many.force);
    memcpy(f->now, state, bytes);
}

/* one step; a time that the force does not see (timeless) stays 0 and is not written */
static void step_lanes(layout *l, uint32_t groups, double h, double t, int timeless) {
    for (int k = 0; k < l->table.stages; k++) {
        call x = stage_of(l, &l->many, k, h, t);
        if (timeless) x.c[2] = 0.0;
        dm_fused_groups(l->wide, groups, x.kernel, x.c + x.first, x.count);
    }
}

void dm_splitting_advance_lanes(dm_stepper *s, dm_lanes *x, double t, long count) {
    layout *l = (layout *)(void *)s->work;
    const uint32_t n = s->model->n;
    const int timeless = (s->model->structure & DM_AUTONOMOUS) != 0;
    const size_t size = dm_state_size(n) * x->lanes;
    const size_t bytes = 4 * (size_t)n * x->lanes * sizeof(double);
    for (uint32_t g = 0; g < x->groups; g++)
        load_group(l, l->wide + g, x->state + g * size, bytes);
    dm_fused_forget(l->wide);
    dm_fused_groups(l->wide, x->groups, &l->many.force, &t, 1);
    for (long k = 0; k < count; k++)
        step_lanes(l, x->groups, s->h, t + (double)k * s->h, timeless);
    for (uint32_t g = 0; g < x->groups; g++)
        memcpy(x->state + g * size, l->wide[g].now, bytes);
}

dm_status dm_splitting_step(dm_stepper *s, double *state, double t) {
    long done;
    return dm_splitting_advance(s, state, t, 1, &done);
}
