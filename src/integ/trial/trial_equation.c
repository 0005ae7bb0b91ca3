/* trial_equation.c - the step equation of curves in any space. */
#include "integ/trial/trial_inside.h"

#include <math.h>
#include <string.h>

/* r += w (q_z^T L_q + v_z^T L_v); the size of its terms */
static void add_values(dm_trial *e, double *R, const dm_trial_point *c, double w) {
    const uint32_t n = e->n, K = e->K;
    for (uint32_t i = 0; i < n; i++) {
        const double f = w * e->stage[i], p = w * e->stage[n + i];
        for (uint32_t a = 0; a < K; a++) {
            const double by_q = f * c->q_z[i * K + a], by_v = p * c->v_z[i * K + a];
            R[a] += by_q + by_v;
            e->size = fmax(e->size, fabs(by_q) + fabs(by_v));
        }
    }
}

/* A[2n][K] = w L'' (q_z, v_z), L'' the matrix of second derivatives */
static void find_products(dm_trial *e, const dm_trial_point *c, double w) {
    const uint32_t n = e->n, K = e->K;
    const double *qq = e->stage + 2 * (size_t)n, *qv = qq + (size_t)n * n, *vv = qv + (size_t)n * n;
    memset(e->A, 0, 2 * (size_t)n * K * sizeof *e->A);
    for (uint32_t i = 0; i < n; i++)
        for (uint32_t j = 0; j < n; j++) {
            const double a = w * qq[i * (size_t)n + j], b = w * qv[i * (size_t)n + j];
            const double d = w * qv[j * (size_t)n + i], f = w * vv[i * (size_t)n + j];
            double *row = e->A + i * (size_t)K, *below = e->A + (n + i) * (size_t)K;
            for (uint32_t k = 0; k < K; k++) {
                const double x = c->q_z[j * (size_t)K + k], y = c->v_z[j * (size_t)K + k];
                row[k] += a * x + b * y;
                below[k] += d * x + f * y;
            }
        }
}

/* J += (q_z, v_z)^T A, and where the curve is not linear w times its second derivatives */
static void add_slopes(dm_trial *e, double *J, const dm_trial_point *c, double w) {
    const uint32_t n = e->n, K = e->K, m = e->unknowns;
    find_products(e, c, w);
    for (uint32_t i = 0; i < n; i++)
        for (uint32_t a = 0; a < K; a++) {
            const double x = c->q_z[i * (size_t)K + a], y = c->v_z[i * (size_t)K + a];
            const double *row = e->A + i * (size_t)K, *below = e->A + (n + i) * (size_t)K;
            if (x == 0.0 && y == 0.0) continue;
            for (uint32_t b = 0; b < K; b++) J[a * (size_t)m + b] += x * row[b] + y * below[b];
        }
    for (uint32_t a = 0; c->second && a < K; a++)
        for (uint32_t b = 0; b < K; b++) J[a * (size_t)m + b] += w * c->second[a * (size_t)K + b];
}

/* L and its derivatives at a point, l = (L_q, L_v) for the second derivatives of the curve */
static void add_point(dm_trial *e, double *R, double *J, const double *z, uint32_t j) {
    const uint32_t n = e->n;
    dm_trial_point c = dm_trial_at(e, j, z, NULL);
    memcpy(e->x, c.q, n * sizeof *e->x);
    memcpy(e->x + n, c.v, n * sizeof *e->x);
    e->x[2 * n] = e->t + e->at[j];
    dm_kernel_eval(&e->m->stage, e->x, e->stage);
    e->evaluations++;
    if (J && !e->k->linear) c = dm_trial_at(e, j, z, e->stage);
    add_values(e, R, &c, e->weight[j]);
    if (J) add_slopes(e, J, &c, e->weight[j]);
}

/* sign p . de/dz, and its derivatives by z, at an end */
static void add_momentum(dm_trial *e, double *R, double *J, const dm_trial_point *c,
                         const double *p, double sign) {
    const uint32_t n = e->n, K = e->K, m = e->unknowns;
    for (uint32_t i = 0; i < n; i++)
        for (uint32_t a = 0; a < K; a++) {
            const double term = sign * p[i] * c->q_z[i * (size_t)K + a];
            R[a] += term;
            e->size = fmax(e->size, fabs(term));
        }
    for (uint32_t a = 0; J && c->second && a < K; a++)
        for (uint32_t b = 0; b < K; b++)
            J[a * (size_t)m + b] += sign * c->second[a * (size_t)K + b];
}

/* p0 . de0/dz - p1 . de1/dz and e0 - q0 */
static void add_ends(dm_trial *e, double *R, double *J, const double *x) {
    const uint32_t n = e->n, K = e->K, m = e->unknowns;
    const double *p1 = x + K;
    double *l = e->A; /* (p, 0) */
    memset(l, 0, 2 * (size_t)n * sizeof *l);
    memcpy(l, e->p0, n * sizeof *l);
    dm_trial_point c = dm_trial_at(e, e->points, x, l);
    add_momentum(e, R, J, &c, e->p0, 1.0);
    for (uint32_t i = 0; i < n; i++) {
        R[K + i] = c.q[i] - e->q0[i];
        for (uint32_t a = 0; J && a < K; a++) J[(K + i) * (size_t)m + a] = c.q_z[i * (size_t)K + a];
    }
    memcpy(l, p1, n * sizeof *l);
    c = dm_trial_at(e, e->points + 1, x, l);
    add_momentum(e, R, J, &c, p1, -1.0);
    for (uint32_t i = 0; J && i < n; i++)
        for (uint32_t a = 0; a < K; a++) J[a * (size_t)m + K + i] = -c.q_z[i * (size_t)K + a];
}

/* Rows are those of z, then of e0(z) = q0; columns those of z, then of p1. The matrix is symmetric
 * but for the sign of the last columns. */
dm_status dm_trial_equation(void *ctx, double *R, double *J, const double *x) {
    dm_trial *e = ctx;
    e->size = 0.0;
    memset(R, 0, e->unknowns * sizeof *R);
    if (J) memset(J, 0, (size_t)e->unknowns * e->unknowns * sizeof *J);
    for (uint32_t j = 0; j < e->points; j++) add_point(e, R, J, x, j);
    add_ends(e, R, J, x);
    return DM_OK;
}
