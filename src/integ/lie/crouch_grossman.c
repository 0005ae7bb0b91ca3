/* crouch_grossman.c - Crouch and Grossman's method of order 3 (1993; HLW IV.8.1): stages and end
 * are products of exponentials of the velocities found so far,
 *   g_i = g0 exp(h a_i1 xi_1) exp(h a_i2 xi_2) ...,
 *   g1 = g0 exp(h b_1 xi_1) exp(h b_2 xi_2) exp(h b_3 xi_3). */
#include "base/doubles.h"
#include "integ/lie/group_field.h"

#include <math.h>
#include <string.h>

enum { STAGES = 3 };

/* the tableau, its last row b, and the times of the stages */
static const double a[STAGES + 1][STAGES] = {{0},
                                             {-1.0 / 24},
                                             {161.0 / 24, -6.0},
                                             {1.0, -2.0 / 3, 2.0 / 3}};
static const double c[STAGES] = {0.0, -1.0 / 24, 17.0 / 24};

/* at the head of the workspace */
typedef struct {
    dm_group_field field;
    double *xi;     /* [STAGES][d] velocities at the stages */
    double *slope;  /* [STAGES][d] torques, carried back to the start */
    double *factor; /* [d] h a_ij xi_j */
    double *q, *mu; /* [n], [d] a stage on the group */
} layout;

static size_t head(void) {
    return dm_doubles(sizeof(layout));
}

static layout *layout_of(const dm_stepper *s) {
    return (layout *)(void *)s->work;
}

static size_t work(const dm_rule *rule, const dm_model *m) {
    (void)rule;
    return head() + m->n + (2 * STAGES + 2) * (size_t)m->group->momenta + dm_group_field_size(m);
}

static dm_status open(dm_stepper *s) {
    layout *l = layout_of(s);
    const size_t d = s->model->group->momenta;
    l->xi = s->work + head();
    l->slope = l->xi + STAGES * d;
    l->factor = l->slope + STAGES * d;
    l->mu = l->factor + d;
    l->q = l->mu + d;
    dm_group_field_open(&l->field, s->model, l->q + s->model->n);
    s->report.operations = s->model->group->point.plain.operations;
    return DM_OK;
}

/* h a_ij xi_j */
static const double *factor(layout *l, int i, int j, double h) {
    const size_t d = l->field.d;
    for (size_t k = 0; k < d; k++) l->factor[k] = h * a[i][j] * l->xi[(size_t)j * d + k];
    return l->factor;
}

/* element and momentum of row i, STAGES: the end */
static dm_status place(layout *l, const double *state, int i, double h) {
    const size_t n = l->field.n, d = l->field.d;
    memcpy(l->q, state, n * sizeof *state);
    for (size_t k = 0; k < d; k++) {
        double sum = 0.0;
        for (int j = 0; j < i; j++) sum += a[i][j] * l->slope[(size_t)j * d + k];
        l->mu[k] = state[n + k] + h * sum;
    }
    dm_status status = DM_OK;
    for (int j = 0; j < i && status == DM_OK; j++)
        status = dm_group_field_move(&l->field, l->q, l->mu, factor(l, i, j, h), fabs(a[i][j]));
    return status;
}

/* velocity and torque at stage i, the torque carried back factor by factor */
static dm_status stage(layout *l, const double *state, int i, double t, double h) {
    const size_t d = l->field.d, row = (size_t)i * d;
    dm_status status = place(l, state, i, h);
    if (status == DM_OK)
        status =
            dm_group_field_at(&l->field, l->xi + row, l->slope + row, l->q, l->mu, t + c[i] * h);
    for (int j = i - 1; j >= 0 && status == DM_OK; j--)
        dm_group_field_carry_back(&l->field, l->slope + row, factor(l, i, j, h));
    return status;
}

/* The state is changed at the end alone. */
static dm_status step(dm_stepper *s, double *state, double t, double h) {
    layout *l = layout_of(s);
    dm_status status = DM_OK;
    for (int i = 0; i < STAGES && status == DM_OK; i++) status = stage(l, state, i, t, h);
    s->report.evaluations += STAGES;
    if (status == DM_OK) status = place(l, state, STAGES, h);
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

const dm_method dm_method_crouch_grossman3 = {
    .name = "crouch-grossman3",
    .signature = "crouch-grossman3",
    .doc = "Crouch and Grossman's method of order 3 on any group: products of exponentials, no "
           "differential of exp. Explicit; not symplectic, energy drifts: for comparison (1993; "
           "HLW IV.8.1).",
    .orders = "3",
    .stages = "3",
    .cost = "3 torques, 6 exponentials",
    .instances = "",
    .traits = DM_EXPLICIT | DM_FORCED | DM_ON_GROUPS,
    .engine = &engine,
};
