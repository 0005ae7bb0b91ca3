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

static size_t mass_size(const dm_model *m) {
    const size_t n = m->n;
    return m->structure & DM_DIAGONAL_MASS ? n : n * n;
}

/* explicit: x = (q, v, t), two forces, p_half, h M^-1, the start of a burst */
static size_t work(const dm_rule *rule, const dm_model *m) {
    const size_t n = m->n;
    (void)rule;
    if (!is_explicit(m)) return dm_stage_work(2, 2, m);
    return 2 * n + 1 + 3 * n + mass_size(m) + dm_state_size(m->n);
}

typedef struct {
    const dm_kernel *force;
    uint32_t n;
    int diagonal;
    double half; /* h/2 */
    const double *shift;
    double *x, *old, *new, *p_half, *hw, *start;
} loop;

/* pointers into the workspace, and what depends on h, which a composition changes */
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
    l.start = l.hw + mass_size(m);
    for (size_t i = 0; i < mass_size(m); i++) l.hw[i] = s->h * m->inverse_mass[i];
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
    memset(l.x, 0, (2 * (size_t)l.n + 1) * sizeof *l.x);
    dm_kernel_prepare(l.force, l.old);
    dm_kernel_prepare(l.force, l.new);
    return DM_OK;
}

/* p_half = p + h/2 L_q, q += h M^-1 (p_half - shift); q is kept in x */
static inline void drift(const loop *l, const double *p, double *low) {
    const uint32_t n = l->n;
    const double half = l->half, *hw = l->hw, *force = l->old;
    double *q = l->x, *p_half = l->p_half;
    if (l->diagonal) {
        for (uint32_t i = 0; i < n; i++)
            dm_sum_add(q + i, low + i, hw[i] * (p[i] + half * force[i]));
        return;
    }
    for (uint32_t i = 0; i < n; i++) p_half[i] = p[i] + half * force[i] - l->shift[i];
    for (uint32_t i = 0; i < n; i++, hw += n) {
        double dq = 0.0;
        for (uint32_t j = 0; j < n; j++) dq += hw[j] * p_half[j];
        dm_sum_add(q + i, low + i, dq);
    }
}

/* p += h/2 (L_q(q0) + L_q(q1)); the first half goes to the low part, which is not waited for */
static inline void kick(const loop *l, double *p, double *low) {
    const double half = l->half, *old = l->old, *new = l->new;
    for (uint32_t i = 0; i < l->n; i++) {
        low[i] += half * old[i];
        dm_sum_add(p + i, low + i, half * new[i]);
    }
}

/* count steps with no check; the force at the end of a step serves the next one */
static void run(loop *l, double *state, double t, double h, long count) {
    const uint32_t n = l->n;
    double *p = state + n, *low_q = state + 2 * n, *low_p = state + 3 * n;
    memcpy(l->x, state, n * sizeof *state);
    l->x[2 * n] = t;
    dm_kernel_eval(l->force, l->x, l->old);
    for (long k = 1; k <= count; k++) {
        drift(l, p, low_q);
        l->x[2 * n] = t + (double)k * h;
        dm_kernel_eval(l->force, l->x, l->new);
        kick(l, p, low_p);
        double *swap = l->old;
        l->old = l->new;
        l->new = swap;
    }
    memcpy(state, l->x, n * sizeof *state);
}

static dm_status step_explicit(dm_stepper *s, double *state, double t) {
    loop l = lay_out(s);
    const size_t size = dm_state_size(l.n);
    memcpy(l.start, state, size * sizeof *state);
    run(&l, state, t, s->h, 1);
    s->report.evaluations += 2;
    if (dm_state_is_finite(state, l.n)) return DM_OK;
    memcpy(state, l.start, size * sizeof *state);
    return DM_NOT_FINITE;
}

static dm_status step(dm_stepper *s, double *state, double t) {
    return is_explicit(s->model) ? step_explicit(s, state, t)
                                 : dm_stage_step(s, state, t);
}

/* what is not finite stays so, hence one look at the end; then the burst is done again to find
** the step */
static dm_status advance(dm_stepper *s, double *state, double t, long count, long *done) {
    if (!is_explicit(s->model)) return dm_advance_by_step(s, state, t, count, done);
    loop l = lay_out(s);
    const size_t size = dm_state_size(l.n);
    memcpy(l.start, state, size * sizeof *state);
    run(&l, state, t, s->h, count);
    s->report.evaluations += count + 1;
    *done = count;
    if (dm_state_is_finite(state, l.n)) return DM_OK;
    memcpy(state, l.start, size * sizeof *state);
    return dm_advance_by_step(s, state, t, count, done);
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
