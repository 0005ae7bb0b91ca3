/* phase_split.c - kicks and drifts for H = T(p) + V(q, t) with any T: p -= b h V_q(q), q += a h
 * T_p(p), each the exact flow of its part (HLW II.5, VI.3.1). */
#include "base/doubles.h"
#include "integ/phase/phase.h"
#include "integ/split/splitting.h"
#include "numbers/compensated.h"

#include <string.h>

/* at the head of the workspace */
typedef struct {
    const dm_model *m;
    dm_splitting table;
    double *x, *out; /* (q, p, t); the field there */
    double *before;  /* [4n] the state at the start of the step */
} layout;

static layout *layout_of(const dm_stepper *s) {
    return (layout *)(void *)s->work;
}

static size_t head(void) {
    return dm_doubles(sizeof(layout));
}

static unsigned wants(const dm_rule *rule, const dm_model *m) {
    (void)rule, (void)m;
    return DM_WANT_FIELD;
}

static size_t work(const dm_rule *rule, const dm_model *m) {
    (void)rule;
    return head() + 8 * (size_t)m->n + 1;
}

/* The arguments, the field and a copy of the state behind the struct. */
static dm_status open(dm_stepper *s) {
    layout *l = layout_of(s);
    const size_t n = s->model->n;
    *l = (layout){.m = s->model, .x = s->work + head()};
    l->out = l->x + 2 * n + 1;
    l->before = l->out + 2 * n;
    s->rule->method->splitting(&l->table, s->rule);
    dm_kernel_prepare(&s->model->field, l->out);
    return DM_OK;
}

/* the field at (q, p, t), in which the part that is wanted depends on its own half alone */
static void evaluate(layout *l, const double *state, double t) {
    const size_t n = l->m->n;
    memcpy(l->x, state, 2 * n * sizeof *state);
    l->x[2 * n] = t;
    dm_kernel_eval(&l->m->field, l->x, l->out);
}

/* entries [first, first + n) of the state += w times those of the field */
static void move(const layout *l, double *state, size_t first, double w) {
    const size_t n = l->m->n;
    for (size_t i = first; i < first + n; i++)
        dm_sum_add(state + i, state + 2 * n + i, w * l->out[i]);
}

/* Kicks of length zero are passed over. */
static dm_status step(dm_stepper *s, double *state, double t, double h) {
    layout *l = layout_of(s);
    const size_t n = l->m->n;
    double c = 0.0, bad = 0.0;
    memcpy(l->before, state, 4 * n * sizeof *state);
    for (int k = 0; k <= l->table.stages; k++) {
        const double at = k == l->table.stages ? t + h : t + c * h;
        if (l->table.b[k] != 0.0) {
            evaluate(l, state, at);
            move(l, state, n, l->table.b[k] * h);
            s->report.evaluations++;
        }
        if (k == l->table.stages || l->table.a[k] == 0.0) continue;
        evaluate(l, state, at);
        move(l, state, 0, l->table.a[k] * h);
        c += l->table.a[k];
    }
    for (size_t i = 0; i < 2 * n; i++) bad += 0.0 * state[i];
    if (bad == 0.0) return DM_OK;
    memcpy(state, l->before, 4 * n * sizeof *state);
    return DM_NOT_FINITE;
}

const dm_engine dm_engine_phase_split = {
    .hamiltonian = 1,
    .wants = wants,
    .work = work,
    .open = open,
    .step = step,
};
