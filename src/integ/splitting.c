#include "integ/splitting.h"

#include "base/sum.h"
#include "integ/fused.h"

#include <string.h>

/* workspace: the table, then x = (q, v, t), force[n], kicked[n], the state at the start of a burst */
typedef struct {
    dm_splitting table;
    double c[DM_SPLITTING_STAGES + 1]; /* time of kick k is t + c_k h */
    dm_fused fused;                    /* q, p, their low parts, the force */
} layout;

int dm_splitting_fits(const dm_model *m) {
    const unsigned simple = DM_SEPARABLE | DM_CONSTANT_MASS;
    return (m->structure & simple) == simple && m->inverse_mass;
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

/* p += h b_k force */
static void fuse_kick(dm_fusion *b, dm_node *state, const dm_node *force, double hb) {
    const uint32_t n = b->model->n;
    for (uint32_t i = 0; i < n; i++) {
        const dm_node dp = dm_fusion_scale(b, hb, force[i]);
        dm_fusion_add(b, state + n + i, state + 3 * n + i, dp);
    }
}

/* q += h a_k M^-1 (p - shift), by way of v[n] */
static void fuse_drift(dm_fusion *b, dm_node *state, dm_node *v, double ha) {
    const uint32_t n = b->model->n;
    dm_fusion_velocity(b, v, state + n, ha);
    for (uint32_t i = 0; i < n; i++) dm_fusion_add(b, state + i, state + 2 * n + i, v[i]);
}

/* the whole step as one kernel; without it the loop below serves */
static void fuse(dm_stepper *s, layout *l) {
    const dm_model *m = s->model;
    const dm_splitting *table = &l->table;
    const uint32_t n = m->n;
    dm_fusion b;
    l->fused.size = 0;
    if (!dm_fusion_begin(&b, m, m->source.gradient, n, evaluations(table), 5 * n)) return;
    dm_node *state = dm_arena_take(m->source.arena, 7 * (size_t)n * sizeof *state);
    if (!state) return;
    dm_node *force = state + 4 * n, *v = force + n, *first = v + n;
    for (uint32_t i = 0; i < 5 * n; i++) state[i] = dm_input(b.graph, i);
    dm_fusion_evaluate(&b, state, first);
    for (int k = 0; k <= table->stages; k++) {
        if (k && table->b[k] != 0.0) dm_fusion_evaluate(&b, state, force);
        if (table->b[k] != 0.0) fuse_kick(&b, state, force, s->h * table->b[k]);
        if (k < table->stages) fuse_drift(&b, state, v, s->h * table->a[k]);
    }
    dm_fusion_end(&b, &l->fused, state, 5 * n, first, n);
    l->fused.h = s->h;
}

void dm_splitting_open(dm_stepper *s, const dm_splitting *table) {
    layout *l = (layout *)(void *)s->work;
    l->table = *table;
    l->c[0] = 0.0;
    for (int k = 0; k < table->stages; k++) l->c[k + 1] = l->c[k] + table->a[k];
    l->c[table->stages] = 1.0;
    fuse(s, l);
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

/* the same through the fused kernel */
static void run_fused(dm_stepper *s, dm_fused *f, double *state, long count) {
    const size_t n = s->model->n;
    const layout *l = (const layout *)(const void *)s->work;
    memcpy(f->now, state, 4 * n * sizeof *state);
    dm_kernel_prepare(&f->first, f->next);
    dm_kernel_eval(&f->first, f->now, f->next);
    memcpy(f->now + 4 * n, f->next, n * sizeof *state);
    dm_kernel_prepare(&f->kernel, f->next);
    dm_fused_run(f, count);
    memcpy(state, f->now, 4 * n * sizeof *state);
    s->report.evaluations += 1 + count * evaluations(&l->table);
}

/* count steps with no look at what comes out */
static void run(dm_stepper *s, double *state, double t, long count) {
    const dm_model *m = s->model;
    const uint32_t n = m->n;
    layout *l = (layout *)(void *)s->work;
    if (l->fused.size && l->fused.h == s->h) {
        run_fused(s, &l->fused, state, count);
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

dm_status dm_splitting_step(dm_stepper *s, double *state, double t) {
    long done;
    return dm_splitting_advance(s, state, t, 1, &done);
}
