/* lie_joints_end.c - from the root of the step equation to the state at the end: the element, the
 * momentum that is carried there, and the impulses that put it onto the hidden constraints. */
#include "integ/lie/lie_joints_inside.h"

#include <math.h>
#include <string.h>

void dm_lie_joints_carry(dm_lie_joints *e, double *out, const double *xi, const double *mu,
                         double sign) {
    memcpy(e->in, e->state, e->n * sizeof *e->in);
    for (uint32_t k = 0; k < e->d; k++) e->in[e->n + k] = sign * xi[k];
    memcpy(e->in + e->n + e->d, mu, e->d * sizeof *e->in);
    dm_kernel_eval(&e->joints->finish, e->in, out);
}

/* g1 and Ad* w */
static void carry(dm_lie_joints *e) {
    memset(e->xi, 0, e->d * sizeof *e->xi);
    for (uint32_t j = 0; j < e->s; j++)
        for (uint32_t k = 0; k < e->d; k++) e->xi[k] += e->h * e->beta[j] * e->z[j * e->d + k];
    dm_lie_joints_carry(e, e->end, e->xi, e->w, 1.0);
}

/* NaN and infinity. */
static int is_finite(const double *x, uint32_t count) {
    for (uint32_t i = 0; i < count; i++)
        if (!isfinite(x[i])) return 0;
    return 1;
}

double dm_lie_joints_arc(const dm_lie_joints *e) {
    double most = 0.0;
    for (uint32_t i = 0; i < e->joints->arcs; i++) most = fmax(most, e->end[e->n + e->d + i]);
    return sqrt(most);
}

/* past half a turn the chart is not that of the step: log would not find xi again */
static dm_status check_turn(dm_lie_joints *e) {
    e->turn = dm_lie_joints_arc(e);
    if (e->turn >= dm_lie_reach(e->joints->tau)) return DM_NO_CONVERGENCE;
    e->turn = 0.0;
    return is_finite(e->end, e->n + e->d) ? DM_OK : DM_NOT_FINITE;
}

/* ---- the hidden constraints: unknowns v1[d], multipliers[m] ---- */

/* units of row (or column) i of their matrix */
static double row_unit(const dm_lie_joints *e, uint32_t i) {
    return i < e->d ? 1.0 : e->row_unit[i - e->d];
}

/* The gap of the inputs is t. */
static double column_unit(const dm_lie_joints *e, uint32_t i) {
    return i <= e->d ? 1.0 : e->impulse_unit[i - e->d - 1];
}

static void add_matrix(const dm_lie_joints *e, double *J) {
    const dm_group_entries *f = &e->joints->hidden;
    for (uint32_t i = 0; i < f->count; i++) {
        const uint32_t column = f->column[i] - (f->column[i] > e->d);
        J[e->closing.row[f->row[i]] + e->closing.column[column]] =
            row_unit(e, f->row[i]) * column_unit(e, f->column[i]) * e->hidden[f->values + i];
    }
}

/* For dm_newton. */
static dm_status closing_equation(void *joints, double *R, double *J, const double *z) {
    dm_lie_joints *e = joints;
    const uint32_t n = e->n, d = e->d;
    memcpy(e->in + n, z, d * sizeof *z);
    for (uint32_t c = 0; c < e->m; c++) e->in[n + d + 1 + c] = z[d + c] * e->impulse_unit[c];
    dm_group_entries_eval(&e->joints->hidden, e->in, e->hidden, J != NULL);
    e->size = 0.0;
    for (uint32_t i = 0; i < d; i++)
        e->size = fmax(e->size, fmax(fabs(e->end[n + i]), e->mass * fabs(z[i])));
    for (uint32_t i = 0; i < d + e->m; i++) R[i] = row_unit(e, i) * e->hidden[i];
    if (J) dm_step_matrix_zero(J, &e->closing);
    if (J) add_matrix(e, J);
    return DM_OK;
}

void dm_lie_joints_closing_pattern(dm_lie_joints *e, double *J) {
    const dm_group_entries *f = &e->joints->hidden;
    for (uint32_t i = 0; i < f->count; i++) e->hidden[f->values + i] = 1.5 + sin(1.0 + i);
    for (uint32_t c = 0; c < e->m; c++) e->row_unit[c] = e->impulse_unit[c] = 1.0;
    memset(J, 0, (size_t)(e->d + e->m) * (e->d + e->m) * sizeof *J);
    add_matrix(e, J);
}

/* v1 and multipliers from those of the last velocity of the curve */
static dm_status close(dm_lie_joints *e, const dm_stepper *s) {
    dm_newton_report report = {0};
    static const double angle = 1.0; /* of this size are displacements in a chart */
    const dm_newton_problem problem = {.m = e->d + e->m,
                                       .equation = closing_equation,
                                       .ctx = e,
                                       .size = &e->size,
                                       .band = dm_step_matrix_band(&e->closing),
                                       .place = &angle,
                                       .places = 1,
                                       .exact = 1,
                                       .shared = e->m,
                                       .over = e->h,
                                       .tolerance = s->tolerance,
                                       .max_iterations = s->max_iterations};
    memcpy(e->in, e->end, e->n * sizeof *e->in);
    e->in[e->n + e->d] = e->t + e->h;
    memcpy(e->in + e->n + e->d + 1 + e->m, e->end + e->n, e->d * sizeof *e->in);
    memcpy(e->last, e->z + (e->s - 1) * e->d, e->d * sizeof *e->last);
    memset(e->last + e->d, 0, e->m * sizeof *e->last);
    return dm_newton(e->last, &problem, e->work, &report);
}

/* p1 += I_K, of a chart about g1 that has not begun to move */
static void add_impulse(dm_lie_joints *e) {
    const uint32_t n = e->n, d = e->d;
    memcpy(e->x, e->end, n * sizeof *e->x);
    memset(e->x + n, 0, 2 * d * sizeof *e->x);
    memcpy(e->x + n + 2 * d + 1 + e->m, e->last, d * sizeof *e->x);
    e->x[n + 2 * d] = e->t + e->h;
    for (uint32_t c = 0; c < e->m; c++)
        e->x[n + 2 * d + 1 + c] = e->last[d + c] * e->impulse_unit[c];
    dm_group_entries_eval(&e->joints->reaction, e->x, e->reaction, 0);
    for (uint32_t i = 0; i < d; i++) e->end[n + i] += e->reaction[e->k + i];
}

void dm_lie_joints_look(dm_lie_joints *e, const double *q, const double *v, double t) {
    const uint32_t n = e->n;
    double *x = e->end_x;
    memset(x, 0, (2 * (size_t)n + 1 + e->m) * sizeof *x);
    memcpy(x, q, n * sizeof *x);
    if (v) memcpy(x + n, v, e->d * sizeof *x);
    x[2 * n] = t;
    if (e->k) dm_kernel_eval(&e->constraints->holonomic_kernel, x, e->holonomic);
    if (e->l) dm_kernel_eval(&e->constraints->rolling_kernel, x, e->rolling);
}

/* multipliers of the step, in units of momentum */
static void keep_multipliers(dm_lie_joints *e) {
    const double *inner = e->z + e->s * e->d;
    for (uint32_t i = 0; i <= e->K; i++)
        for (uint32_t c = 0; c < e->m; c++)
            e->momenta[i * e->m + c] =
                (i < e->K ? inner[i * e->m + c] : e->last[e->d + c]) * e->impulse_unit[c];
}

dm_status dm_lie_joints_finish(dm_lie_joints *e, const dm_stepper *s) {
    carry(e);
    dm_status status = check_turn(e);
    if (status != DM_OK || !e->m) return status;
    status = close(e, s);
    if (status != DM_OK) return status;
    add_impulse(e);
    keep_multipliers(e);
    dm_lie_joints_look(e, e->end, e->last, e->t + e->h);
    return is_finite(e->end, e->n + e->d) ? DM_OK : DM_NOT_FINITE;
}
