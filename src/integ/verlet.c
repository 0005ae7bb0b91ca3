/* verlet.c - Stoermer-Verlet: explicit when L = T(v) - V(q, t), else Lobatto IIIA-IIIB of 2 stages. */
#include "base/sum.h"
#include "integ/stage.h"

#include <math.h>
#include <string.h>

static const unsigned SIMPLE = DM_SEPARABLE | DM_CONSTANT_MASS;

static int is_explicit(const dm_model *m) {
    return (m->structure & SIMPLE) == SIMPLE;
}

static const char *check(const dm_rule *rule) {
    return rule->count ? "verlet takes no argument" : NULL;
}

static int order(const dm_rule *rule) {
    (void)rule;
    return 2;
}

static unsigned wants(const dm_rule *rule, const dm_model *m) {
    return is_explicit(m) ? DM_WANT_FORCE : dm_stage_wants(rule, m);
}

/* explicit: x = (q, v, t), two forces times h/2, velocity, h M^-1, the start of a burst */
static size_t work(const dm_rule *rule, const dm_model *m) {
    const size_t n = m->n;
    (void)rule;
    return is_explicit(m) ? 2 * n + 1 + 3 * n + n * n + dm_state_size(m->n)
                          : dm_stage_work(2, 2, m);
}

typedef struct {
    const dm_kernel *force;
    uint32_t n;
    int diagonal;
    double half; /* h/2 */
    const double *shift;
    double *x, *old, *new, *p_half, *hw, *start;
} loop;

static loop lay_out(const dm_stepper *s) {
    const dm_model *m = s->model;
    const size_t n = m->n;
    loop l = {
        .force = &m->force, .n = m->n, .half = 0.5 * s->h, .shift = m->momentum_shift};
    l.diagonal = (m->structure & DM_DIAGONAL_MASS) != 0;
    l.x = s->work;
    l.old = l.x + 2 * n + 1;
    l.new = l.old + n;
    l.p_half = l.new + n;
    l.hw = l.p_half + n;
    l.start = l.hw + n * n;
    return l;
}

static dm_status open(dm_stepper *s) {
    const dm_model *m = s->model;
    if (!is_explicit(m)) {
        dm_galerkin g;
        dm_quadrature q;
        dm_quadrature_lobatto(&q, 2);
        dm_galerkin_collocation(&g, &q);
        return dm_stage_open(s, &g);
    }
    const loop l = lay_out(s);
    const size_t n = m->n, count = l.diagonal ? n : n * n;
    memset(l.x, 0, (2 * n + 1) * sizeof *l.x);
    for (size_t i = 0; i < count; i++) l.hw[i] = s->h * m->inverse_mass[i];
    dm_kernel_prepare(l.force, l.old);
    dm_kernel_prepare(l.force, l.new);
    return DM_OK;
}

/* p_half = p + h/2 L_q, q += h M^-1 (p_half - shift) */
static inline void drift(const loop *l, double *state) {
    const uint32_t n = l->n;
    double *q = state, *low = state + 2 * n;
    const double *p = state + n;
    if (l->diagonal) {
        for (uint32_t i = 0; i < n; i++)
            dm_sum_add(q + i, low + i, l->hw[i] * (p[i] + l->half * l->old[i]));
        return;
    }
    for (uint32_t i = 0; i < n; i++)
        l->p_half[i] = p[i] + l->half * l->old[i] - l->shift[i];
    for (uint32_t i = 0; i < n; i++) {
        double dq = 0.0;
        for (uint32_t j = 0; j < n; j++) dq += l->hw[i * (size_t)n + j] * l->p_half[j];
        dm_sum_add(q + i, low + i, dq);
    }
}

static int is_finite(const double *state, size_t count) {
    double sum = 0.0; /* NaN or NaN from infinities when one is not */
    for (size_t i = 0; i < count; i++) sum += state[i] * 0.0;
    return sum == 0.0;
}

/* p += h/2 (L_q(q0) + L_q(q1)); the first half is added to the low part while L_q(q1) is awaited */
static inline void kick(const loop *l, double *state) {
    const uint32_t n = l->n;
    double *p = state + n, *low = state + 3 * n;
    for (uint32_t i = 0; i < n; i++) {
        low[i] += l->half * l->old[i];
        dm_sum_add(p + i, low + i, l->half * l->new[i]);
    }
}

/* count steps with no check; the force at the end of a step serves the next one */
static void run(loop *l, double *state, double t, double h, long count) {
    const uint32_t n = l->n;
    memcpy(l->x, state, n * sizeof *state);
    l->x[2 * n] = t;
    dm_kernel_eval(l->force, l->x, l->old);
    for (long k = 1; k <= count; k++) {
        drift(l, state);
        memcpy(l->x, state, n * sizeof *state);
        l->x[2 * n] = t + (double)k * h;
        dm_kernel_eval(l->force, l->x, l->new);
        kick(l, state);
        double *swap = l->old;
        l->old = l->new;
        l->new = swap;
    }
}

static dm_status step_explicit(dm_stepper *s, double *state, double t) {
    loop l = lay_out(s);
    const size_t size = dm_state_size(l.n);
    memcpy(l.start, state, size * sizeof *state);
    run(&l, state, t, s->h, 1);
    s->report.evaluations += 2;
    if (is_finite(state, size)) return DM_OK;
    memcpy(state, l.start, size * sizeof *state);
    return DM_NOT_FINITE;
}

static dm_status step(dm_stepper *s, double *state, double t) {
    return is_explicit(s->model) ? step_explicit(s, state, t)
                                 : dm_stage_step(s, state, t);
}

static dm_status step_by_step(dm_stepper *s, double *state, double t, long count,
                              long *done) {
    for (*done = 0; *done < count; ++*done) {
        const dm_status status = step(s, state, t + (double)*done * s->h);
        if (status != DM_OK) return status;
    }
    return DM_OK;
}

/* what is not finite stays so, hence one look at the end; then the burst is done again to find
** the step */
static dm_status advance(dm_stepper *s, double *state, double t, long count, long *done) {
    if (!is_explicit(s->model)) return step_by_step(s, state, t, count, done);
    loop l = lay_out(s);
    const size_t size = dm_state_size(l.n);
    memcpy(l.start, state, size * sizeof *state);
    run(&l, state, t, s->h, count);
    s->report.evaluations += count + 1;
    *done = count;
    if (is_finite(state, size)) return DM_OK;
    memcpy(state, l.start, size * sizeof *state);
    return step_by_step(s, state, t, count, done);
}

const dm_method dm_method_verlet = {
    .name = "verlet",
    .signature = "verlet",
    .doc = "Stoermer-Verlet, kick-drift-kick, order 2; explicit, one force a step, when "
           "L = T(v) - V(q, t) with constant mass, else the implicit Lobatto IIIA-IIIB "
           "pair of 2 "
           "stages (HLW I.1.4, VI.6.2).",
    .traits = DM_SYMMETRIC | DM_SYMPLECTIC,
    .check = check,
    .order = order,
    .wants = wants,
    .work = work,
    .open = open,
    .step = step,
    .advance = advance,
};
