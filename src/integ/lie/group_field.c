/* group_field.c - velocity and torque from the slopes of L in the chart at the element itself, ends
 * of charts from the kernels of mech/group.h. */
#include "integ/lie/group_field.h"

#include "linalg/lu.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* R^n has classical rules. */
const char *dm_group_field_fits(const dm_rule *rule, const dm_model *m) {
    (void)rule;
    if (!m->group) return "it steps systems on groups, such as dm.SO(3); rk4 and rk8 are for R^n";
    return m->source.graph ? NULL : "its L must be traced";
}

/* The chart of exp; the mass where the Legendre transform is no product. */
unsigned dm_group_field_wants(const dm_rule *rule, const dm_model *m) {
    const unsigned simple = DM_SEPARABLE | DM_CONSTANT_MASS;
    const int product = (m->structure & simple) == simple;
    (void)rule;
    return DM_WANT_CHART | (product || m->structure & DM_HAMILTONIAN ? 0u : DM_WANT_MASS);
}

/* squares of angles behind the end of a chart */
static size_t arcs_of(const dm_group *g) {
    return g->trace[DM_TAU_EXP].arcs;
}

/* In the order of the struct. */
size_t dm_group_field_size(const dm_model *m) {
    const size_t n = m->n, d = m->group->momenta;
    return n + 2 * d + 1 + 3 * d + 2 * n + n + 2 * d + n + d + arcs_of(m->group) + d * (2 * d + 1) +
           d * d + d + dm_group_map_room(5 * d) + dm_legendre_work(m);
}

/* The chart stays 0, the entries of p behind the momenta too. */
void dm_group_field_open(dm_group_field *f, const dm_model *m, double *memory) {
    const size_t n = m->n, d = m->group->momenta;
    memset(memory, 0, dm_group_field_size(m) * sizeof *memory);
    *f = (dm_group_field){.m = m, .group = m->group, .n = m->n, .d = m->group->momenta};
    f->x = memory;
    f->slope = f->x + n + 2 * d + 1;
    f->v = f->slope + 3 * d;
    f->p = f->v + n;
    f->in = f->p + n;
    f->end = f->in + n + 2 * d;
    f->pull = f->end + n + d + arcs_of(m->group);
    f->A = f->pull + d * (2 * d + 1);
    f->room = f->A + d * d + d;
    f->work = f->room + dm_group_map_room(5 * d);
    dm_kernel_prepare(&f->group->point.plain, f->slope);
    dm_kernel_prepare(&f->group->finish, f->end);
    dm_group_map_prepare(&f->group->pull, 1, f->pull);
}

/* the body velocity into x: Newton's method begins at rest, so that xi depends on the state alone;
 * of an H the momentum stands there */
static dm_status place_velocity(dm_group_field *f, const double *q, const double *mu, double t) {
    const size_t n = f->n, d = f->d;
    double *place = f->x + n + d;
    if (f->m->structure & DM_HAMILTONIAN) {
        memcpy(place, mu, d * sizeof *mu);
        return DM_OK;
    }
    memset(f->v, 0, n * sizeof *f->v);
    memcpy(f->p, mu, d * sizeof *mu);
    const dm_status status = dm_legendre_inverse(f->m, f->v, q, f->p, t, f->work);
    memcpy(place, f->v, d * sizeof *place);
    return status;
}

dm_status dm_group_field_at(dm_group_field *f, double *xi, double *torque, const double *q,
                            const double *mu, double t) {
    const size_t n = f->n, d = f->d;
    const int of_H = (f->m->structure & DM_HAMILTONIAN) != 0;
    const dm_status status = place_velocity(f, q, mu, t);
    if (status != DM_OK) return status;
    memcpy(f->x, q, n * sizeof *q);
    f->x[n + 2 * d] = t;
    dm_kernel_eval(&f->group->point.plain, f->x, f->slope);
    memcpy(xi, of_H ? f->slope + 2 * d : f->x + n + d, d * sizeof *xi);
    for (size_t a = 0; a < d; a++) torque[a] = of_H ? -f->slope[a] : f->slope[a];
    return DM_OK;
}

/* (q, xi, mu) -> f->end */
static void find_end(dm_group_field *f, const double *q, const double *xi, double sign,
                     const double *mu) {
    const size_t n = f->n, d = f->d;
    memcpy(f->in, q, n * sizeof *q);
    for (size_t a = 0; a < d; a++) f->in[n + a] = sign * xi[a];
    memcpy(f->in + n + d, mu, d * sizeof *mu);
    dm_kernel_eval(&f->group->finish, f->in, f->end);
}

/* the largest angle of an exponential */
static double turn_of(const dm_group_field *f) {
    double most = 0.0;
    for (uint32_t i = 0; i < f->group->arcs; i++) most = fmax(most, f->end[f->n + f->d + i]);
    return sqrt(most);
}

static const double pi = 3.14159265358979323846;

/* of how many equal parts exp(xi), which is in f->end, is made, each within its chart */
static int parts_of(const dm_group_field *f) {
    const double turn = turn_of(f);
    return turn < 1e3 ? 1 + (int)(turn / pi) : 1;
}

/* (q, mu) taken along exp(sign xi), which is in f->end */
static void take(dm_group_field *f, double *q, double *mu, const double *xi, double sign) {
    const int parts = parts_of(f);
    for (int i = 0; i < parts; i++) {
        if (parts > 1) find_end(f, q, xi, sign / parts, mu);
        memcpy(q, f->end, f->n * sizeof *q);
        memcpy(mu, f->end + f->n, f->d * sizeof *mu);
    }
}

dm_status dm_group_field_move(dm_group_field *f, double *q, double *mu, const double *xi,
                              double share) {
    double bad = 0.0; /* 0 * infinity is NaN */
    find_end(f, q, xi, 1.0, mu);
    const double turn = turn_of(f) / share;
    f->turn = turn >= pi ? turn : 0.0;
    if (f->turn > 0.0) return DM_NO_CONVERGENCE;
    for (uint32_t i = 0; i < f->n + f->d; i++) bad += 0.0 * f->end[i];
    if (bad != 0.0) return DM_NOT_FINITE;
    take(f, q, mu, xi, 1.0);
    return DM_OK;
}

/* The element that goes with it does not matter: that of x, which is set anew at every stage. */
void dm_group_field_carry_back(dm_group_field *f, double *mu, const double *xi) {
    find_end(f, f->x, xi, -1.0, mu);
    take(f, f->x, mu, xi, -1.0);
}

/* xi = D u' with D = dtau_L(u) = dtau_R(-u), whose transpose is the derivative of `pull` by mu */
dm_status dm_group_field_chart_rate(dm_group_field *f, double *xi, const double *u) {
    const size_t d = f->d;
    uint32_t *pivot = (uint32_t *)(void *)(f->A + d * d);
    for (size_t a = 0; a < d; a++) f->in[a] = -u[a], f->in[d + a] = 0.0;
    dm_group_map_eval(&f->group->pull, f->in, f->pull, 1, f->room);
    for (size_t a = 0; a < d; a++)
        for (size_t b = 0; b < d; b++) f->A[b * d + a] = f->pull[d + a * 2 * d + d + b];
    const dm_status status = dm_lu_factor(f->A, pivot, f->d);
    if (status == DM_OK) dm_lu_solve(xi, f->A, pivot, f->d);
    return status;
}

void dm_group_field_end(const dm_group_field *f, double *state, const double *q, const double *mu) {
    memcpy(state, q, f->n * sizeof *state);
    memcpy(state + f->n, mu, f->d * sizeof *state);
    memset(state + 2 * (size_t)f->n, 0, 2 * (size_t)f->n * sizeof *state);
}

const char *dm_group_field_why(dm_group_field *f, double turn) {
    if (!(turn > 0.0)) return NULL;
    snprintf(f->text, sizeof f->text,
             "h turns the body by %.2g rad; the chart ends at pi: take a smaller step", turn);
    return f->text;
}
