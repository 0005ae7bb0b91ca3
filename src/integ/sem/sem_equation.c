/* sem_equation.c - the equations of a symplectic-energy-momentum step and their derivatives. */
#include "integ/sem/sem_inside.h"

#include <math.h>
#include <string.h>

/* The parts of the stage kernel's outputs; qv: row q, column v. */
typedef struct {
    const double *q, *v, *qq, *qv, *vv;
} slopes;

/* At the last point that was placed. */
static slopes slopes_of(const dm_sem *e) {
    const size_t n = e->n;
    const double *at = e->at;
    return (slopes){at, at + n, at + 2 * n, at + 2 * n + n * n, at + 2 * n + 2 * n * n};
}

dm_status dm_sem_prepare(dm_sem *e) {
    if (e->stage) return DM_OK;
    const dm_status status = dm_model_stage(&e->stage, e->m);
    if (status != DM_OK) e->stage = NULL;
    if (status == DM_OK) dm_kernel_prepare(e->stage, e->at);
    return status;
}

/* w_i, Qdot_i and the kernels at point i; returns L_v . Qdot - L there */
static double place(dm_sem *e, const double *z, uint32_t i) {
    const uint32_t n = e->n, s = e->table.s;
    const double h = z[e->velocities], *low = e->state + 2 * (size_t)n;
    double energy = 0.0;
    memset(e->w, 0, n * sizeof *e->w);
    memset(e->x + n, 0, n * sizeof *e->x);
    for (uint32_t j = 0; j < s; j++) {
        dm_weighted_add(e->w, e->table.a[i * s + j], z + j * (size_t)n, n);
        dm_weighted_add(e->x + n, e->table.d[i * s + j], z + j * (size_t)n, n);
    }
    for (uint32_t k = 0; k < n; k++) e->x[k] = e->state[k] + (low[k] + h * e->w[k]);
    e->x[2 * n] = 0.0;
    dm_kernel_eval(e->stage, e->x, e->at);
    dm_kernel_eval(&e->m->energy, e->x, &energy);
    e->evaluations++;
    return energy;
}

/* E_d, its terms, h sum b L_q, and the momentum equations */
static void add_values(dm_sem *e, double *R, double h, double energy, uint32_t i) {
    const uint32_t n = e->n, s = e->table.s;
    const slopes L = slopes_of(e);
    const double b = dm_weight_double(e->table.b[i]);
    double twice = 0.0;
    for (uint32_t k = 0; k < n; k++) twice += L.v[k] * e->x[n + k];
    e->energy += b * energy;
    e->size_of += fabs(b) * (fabs(twice) + fabs(twice - energy));
    for (uint32_t k = 0; k < n; k++) e->end[k] += h * dm_weighted(e->table.b[i], L.q[k]);
    for (uint32_t j = 0; j < s; j++) {
        const double d = dm_weight_double(e->table.d[i * s + j]);
        const double c =
            h * (dm_weight_double(e->table.a[i * s + j]) - dm_weight_double(e->table.beta[j]));
        for (uint32_t k = 0; k < n; k++) {
            const double term = b * (c * L.q[k] + d * L.v[k]);
            R[j * (size_t)n + k] += term;
            e->size = fmax(e->size, fabs(term));
        }
    }
}

/* to += w B, or w B^T, in rows of `width` */
static void add(double *to, double w, const double *B, int transposed, uint32_t n, uint32_t width) {
    for (uint32_t i = 0; i < n && w != 0.0; i++)
        for (uint32_t j = 0; j < n; j++)
            to[i * (size_t)width + j] += w * B[transposed ? j * (size_t)n + i : i * (size_t)n + j];
}

/* dR_j/dV_k */
static void add_slopes(const dm_sem *e, double *J, double h, uint32_t i, uint32_t width) {
    const uint32_t n = e->n, s = e->table.s;
    const slopes L = slopes_of(e);
    const double b = dm_weight_double(e->table.b[i]);
    for (uint32_t j = 0; j < s; j++) {
        const double d = b * dm_weight_double(e->table.d[i * s + j]);
        const double c =
            b * h * (dm_weight_double(e->table.a[i * s + j]) - dm_weight_double(e->table.beta[j]));
        for (uint32_t k = 0; k < s; k++) {
            double *block = J + j * (size_t)n * width + k * (size_t)n;
            const double a = h * dm_weight_double(e->table.a[i * s + k]);
            const double dk = dm_weight_double(e->table.d[i * s + k]);
            add(block, c * a, L.qq, 0, n, width);
            add(block, c * dk, L.qv, 0, n, width);
            add(block, d * a, L.qv, 1, n, width);
            add(block, d * dk, L.vv, 0, n, width);
        }
    }
}

/* out = B x, or B^T x */
static void multiply(double *out, const double *B, const double *x, uint32_t n, int transposed) {
    for (uint32_t i = 0; i < n; i++) {
        out[i] = 0.0;
        for (uint32_t j = 0; j < n; j++)
            out[i] += B[transposed ? j * (size_t)n + i : i * (size_t)n + j] * x[j];
    }
}

/* dR/dh: the points move by w_i, and h stands before L_q */
static void add_column(const dm_sem *e, double *J, double h, uint32_t i) {
    const uint32_t n = e->n, s = e->table.s, width = e->unknowns;
    const slopes L = slopes_of(e);
    const double b = dm_weight_double(e->table.b[i]);
    double *moved = e->w + n, *other = e->w + 2 * n;
    multiply(moved, L.qq, e->w, n, 0);
    multiply(other, L.qv, e->w, n, 1);
    for (uint32_t j = 0; j < s; j++) {
        const double d = dm_weight_double(e->table.d[i * s + j]);
        const double c =
            dm_weight_double(e->table.a[i * s + j]) - dm_weight_double(e->table.beta[j]);
        for (uint32_t k = 0; k < n; k++)
            J[(j * (size_t)n + k) * width + e->velocities] +=
                b * (c * (L.q[k] + h * moved[k]) + d * other[k]);
    }
}

/* dE_d by V and h: (L_v . v - L)_q = L_qv v - L_q, (L_v . v - L)_v = L_vv v */
static void add_row(const dm_sem *e, double *J, double h, uint32_t i) {
    const uint32_t n = e->n, s = e->table.s;
    const slopes L = slopes_of(e);
    const double b = dm_weight_double(e->table.b[i]), *v = e->x + n;
    double *row = J + e->velocities * (size_t)e->unknowns;
    double *by_q = e->w + n, *by_v = e->w + 2 * n;
    multiply(by_q, L.qv, v, n, 0);
    multiply(by_v, L.vv, v, n, 0);
    for (uint32_t k = 0; k < n; k++) by_q[k] -= L.q[k];
    for (uint32_t j = 0; j < s; j++) {
        const double a = h * dm_weight_double(e->table.a[i * s + j]);
        const double d = dm_weight_double(e->table.d[i * s + j]);
        for (uint32_t k = 0; k < n; k++) row[j * (size_t)n + k] += b * (a * by_q[k] + d * by_v[k]);
    }
    for (uint32_t k = 0; k < n; k++) row[e->velocities] += b * by_q[k] * e->w[k];
}

/* One pass over the points: what the energy adds to the equations of a step of given length is its
 * own row, and the column of h. */
void dm_sem_equation(dm_sem *e, double *R, double *J, const double *z, uint32_t width) {
    const uint32_t n = e->n, s = e->table.s;
    const double h = z[e->velocities], *p0 = e->state + n;
    e->energy = e->size = e->size_of = 0.0;
    memset(e->end, 0, n * sizeof *e->end);
    memset(R, 0, width * sizeof *R);
    if (J) memset(J, 0, (size_t)width * width * sizeof *J);
    for (uint32_t i = 0; i < e->table.r; i++) {
        const double energy = place(e, z, i);
        add_values(e, R, h, energy, i);
        if (J) add_slopes(e, J, h, i, width);
        if (!J || width == e->velocities) continue;
        add_column(e, J, h, i);
        add_row(e, J, h, i);
    }
    for (uint32_t j = 0; j < s; j++)
        for (uint32_t k = 0; k < n; k++) {
            const double term = dm_weighted(e->table.beta[j], p0[k]);
            R[j * (size_t)n + k] -= term;
            e->size = fmax(e->size, fabs(term));
        }
    if (width != e->velocities) R[e->velocities] = e->energy - e->E;
}
