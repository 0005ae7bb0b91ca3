/* munthe_kaas.c - the classical Runge-Kutta method in the chart of exp about the start of a step
 * (Munthe-Kaas 1999; Iserles, Munthe-Kaas, Norsett & Zanna 2000, Algorithm 3.1):
 *   g = g0 exp(u),  u' = dexp^-1_(-u) xi,  dexp^-1 exact, not its series. */
#include "base/doubles.h"
#include "integ/lie/group_field.h"

#include <string.h>

enum { STAGES = 4 };

/* Stage i stands at u = h at[i] u'_(i-1); weights of the end. */
static const double at[STAGES] = {0.0, 0.5, 0.5, 1.0};
static const double weight[STAGES] = {1.0 / 6, 1.0 / 3, 1.0 / 3, 1.0 / 6};

/* at the head of the workspace */
typedef struct {
    dm_group_field field;
    double *u, *pi;       /* [d] the chart and the momentum carried back, of a stage */
    double *rate, *slope; /* [d] their derivatives there */
    double *sum;          /* [2d] of both, weighted */
    double *q, *mu;       /* [n], [d] the stage on the group */
} layout;

static size_t head(void) {
    return dm_doubles(sizeof(layout));
}

static layout *layout_of(const dm_stepper *s) {
    return (layout *)(void *)s->work;
}

static size_t work(const dm_rule *rule, const dm_model *m) {
    (void)rule;
    return head() + m->n + 7 * (size_t)m->group->momenta + dm_group_field_size(m);
}

static dm_status open(dm_stepper *s) {
    layout *l = layout_of(s);
    const size_t d = s->model->group->momenta;
    l->u = s->work + head();
    l->pi = l->u + d;
    l->rate = l->pi + d;
    l->slope = l->rate + d;
    l->sum = l->slope + d;
    l->mu = l->sum + 2 * d;
    l->q = l->mu + d;
    dm_group_field_open(&l->field, s->model, l->q + s->model->n);
    s->report.operations = s->model->group->point.plain.operations;
    return DM_OK;
}

/* (u, pi) on the group */
static dm_status place(layout *l, const double *state) {
    const dm_group_field *f = &l->field;
    memcpy(l->q, state, f->n * sizeof *state);
    memcpy(l->mu, l->pi, f->d * sizeof *state);
    return dm_group_field_move(&l->field, l->q, l->mu, l->u, 1.0);
}

/* u = h a u'_before, pi alike, and the derivatives there */
static dm_status stage(layout *l, const double *state, double t, double h, double a) {
    dm_group_field *f = &l->field;
    for (uint32_t k = 0; k < f->d; k++) {
        l->u[k] = h * a * l->rate[k];
        l->pi[k] = state[f->n + k] + h * a * l->slope[k];
    }
    dm_status status = place(l, state);
    if (status == DM_OK) status = dm_group_field_at(f, l->rate, l->slope, l->q, l->mu, t + a * h);
    if (status == DM_OK) status = dm_group_field_chart_rate(f, l->rate, l->u);
    dm_group_field_carry_back(f, l->slope, l->u);
    return status;
}

/* the weighted sums, from the start on */
static dm_status finish(layout *l, const double *state, double h) {
    const uint32_t n = l->field.n, d = l->field.d;
    for (uint32_t k = 0; k < d; k++) {
        l->u[k] = h * l->sum[k];
        l->pi[k] = state[n + k] + h * l->sum[d + k];
    }
    return place(l, state);
}

/* The state is changed at the end alone. */
static dm_status step(dm_stepper *s, double *state, double t, double h) {
    layout *l = layout_of(s);
    const size_t d = l->field.d;
    dm_status status = DM_OK;
    memset(l->rate, 0, 2 * d * sizeof *l->rate);
    memset(l->sum, 0, 2 * d * sizeof *l->sum);
    for (int i = 0; i < STAGES && status == DM_OK; i++) {
        status = stage(l, state, t, h, at[i]);
        for (size_t k = 0; k < 2 * d; k++) l->sum[k] += weight[i] * l->rate[k];
    }
    s->report.evaluations += STAGES;
    if (status == DM_OK) status = finish(l, state, h);
    s->report.trouble.turn = l->field.turn;
    if (status == DM_OK) dm_group_field_end(&l->field, state, l->q, l->mu);
    return status;
}

/* Of the last step. */
static const char *why(dm_stepper *s, const double *state, dm_status status) {
    (void)state, (void)status;
    return dm_group_field_why(&layout_of(s)->field, s->report.trouble.turn);
}

static const dm_engine engine = {
    .hamiltonian = 1,
    .fits = dm_group_field_fits,
    .wants = dm_group_field_wants,
    .work = work,
    .open = open,
    .step = step,
    .why = why,
};

const dm_method dm_method_rkmk4 = {
    .name = "rkmk4",
    .signature = "rkmk4",
    .doc = "Runge-Kutta-Munthe-Kaas of order 4 on any group: the classical Runge-Kutta method in "
           "the chart of exp about the start of a step. Explicit; not symplectic, energy drifts: "
           "for comparison (Munthe-Kaas 1999).",
    .orders = "4",
    .stages = "4",
    .cost = "4 torques, 4 differentials of exp",
    .instances = "",
    .traits = DM_EXPLICIT | DM_FORCED | DM_ON_GROUPS,
    .engine = &engine,
};
