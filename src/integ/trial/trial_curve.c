/* trial_curve.c - where the points of a step are, and the curve there. */
#include "integ/multiscale/filon.h"
#include "integ/trial/trial_inside.h"
#include "linalg/lu.h"

#include <math.h>
#include <string.h>

static const double TWO_PI = 6.283185307179586;

/* Doubles of a linear curve at a point. */
static size_t width(const dm_trial *e) {
    return 2 * (size_t)e->n + 2 * (size_t)e->n * e->K;
}

/* pieces of nodes, or nodes times phases */
static void lay_points(dm_trial *e, double h) {
    const dm_trial_row *row = e->row;
    const uint32_t r = (uint32_t)row->q.r;
    if (row->phases) dm_filon_two_scales(e->weight, &row->q, (int)row->phases, row->frequency, h);
    for (uint32_t j = 0; j < e->points; j++) {
        const uint32_t i = row->phases ? j / row->phases : j % r, piece = row->phases ? 0 : j / r;
        const long double part = 1.0L / row->pieces;
        e->at[j] = (double)(h * part * (piece + row->q.c[i]));
        if (!row->phases) e->weight[j] = (double)(h * part * row->q.b[i]);
    }
}

/* (t, phase, h) of point j, the ends behind the points */
static void place(dm_trial *e, uint32_t j) {
    const dm_trial_row *row = e->row;
    const double end = j > e->points ? e->h : 0.0;
    e->in[0] = j < e->points ? e->at[j] : end;
    e->in[1] = row->phases == 0 ? 0.0
               : j < e->points  ? TWO_PI * (j % row->phases) / row->phases
                                : row->frequency * end;
    e->in[2] = e->h;
}

/* q = q(0) + q_z z, and so qdot */
static dm_trial_point linear_at(dm_trial *e, uint32_t j, const double *z) {
    const uint32_t n = e->n, K = e->K;
    double *row = e->table + j * width(e);
    dm_trial_point c = {.q = e->q,
                        .v = e->v,
                        .q_z = row + 2 * n,
                        .v_z = row + 2 * n + n * (size_t)K};
    for (uint32_t i = 0; i < n; i++) {
        double q = row[i], v = row[n + i];
        for (uint32_t a = 0; a < K; a++) {
            q += c.q_z[i * (size_t)K + a] * z[a];
            v += c.v_z[i * (size_t)K + a] * z[a];
        }
        c.q[i] = q, c.v[i] = v;
    }
    return c;
}

/* Tables of linear curves are those of e->h; any other curve is evaluated anew, and what it gave
 * before is overwritten. */
dm_trial_point dm_trial_at(dm_trial *e, uint32_t j, const double *z, const double *l) {
    const uint32_t n = e->n, K = e->K;
    if (e->k->linear) return linear_at(e, j, z);
    place(e, j);
    memcpy(e->in + 3, z, K * sizeof *z);
    memset(e->in + 3 + K, 0, 2 * (size_t)n * sizeof *z);
    if (l) memcpy(e->in + 3 + K, l, 2 * (size_t)n * sizeof *z);
    dm_kernel_eval(&e->k->point, e->in, e->out);
    double *q_z = e->out + 2 * n;
    return (dm_trial_point){.q = e->out,
                            .v = e->out + n,
                            .q_z = q_z,
                            .v_z = q_z + n * (size_t)K,
                            .second = q_z + 2 * n * (size_t)K};
}

/* ---- the straight line ---- */

/* The z that makes sum_j |qdot_j - v|^2 least with e0(z) = q: of the unit vectors of q and v, by
 * the equations of a free particle. */
static dm_status find_lines(dm_trial *e) {
    const uint32_t n = e->n, K = e->K, m = e->unknowns;
    double *G = e->scratch, *right = G + (size_t)m * m;
    uint32_t *pivot = (uint32_t *)(void *)(right + m);
    memset(G, 0, (size_t)m * m * sizeof *G);
    for (uint32_t j = 0; j < e->points; j++) {
        const double *v_z = e->table + j * width(e) + 2 * n + n * (size_t)K;
        for (uint32_t i = 0; i < n; i++)
            for (uint32_t a = 0; a < K; a++)
                for (uint32_t b = 0; b < K; b++)
                    G[a * (size_t)m + b] += v_z[i * (size_t)K + a] * v_z[i * (size_t)K + b];
    }
    const double *e0 = e->table + e->points * width(e) + 2 * n;
    for (uint32_t i = 0; i < n; i++)
        for (uint32_t a = 0; a < K; a++)
            G[(K + i) * (size_t)m + a] = G[a * (size_t)m + K + i] = e0[i * (size_t)K + a];
    const dm_status status = dm_lu_factor(G, pivot, m);
    for (uint32_t c = 0; c < 2 * n && status == DM_OK; c++) {
        memset(right, 0, m * sizeof *right);
        if (c < n) right[K + c] = 1.0;
        for (uint32_t j = 0; c >= n && j < e->points; j++) {
            const double *v_z = e->table + j * width(e) + 2 * n + n * (size_t)K;
            for (uint32_t a = 0; a < K; a++) right[a] += v_z[(c - n) * (size_t)K + a];
        }
        dm_lu_solve(right, G, pivot, m);
        for (uint32_t a = 0; a < K; a++) e->line[a * 2 * (size_t)n + c] = right[a];
    }
    return status;
}

/* Tables of linear curves at z = 0. */
static void lay_tables(dm_trial *e) {
    memset(e->in + 3, 0, (e->K + 2 * (size_t)e->n) * sizeof *e->in);
    for (uint32_t j = 0; j < e->points + 2; j++) {
        place(e, j);
        dm_kernel_prepare(&e->k->point, e->table + j * width(e));
        dm_kernel_eval(&e->k->point, e->in, e->table + j * width(e));
    }
}

/* Nothing is done where the length is that of the step before. */
dm_status dm_trial_lay(dm_trial *e, double h) {
    if (h == e->h) return DM_OK;
    e->h = h;
    lay_points(e, h);
    if (!e->k->linear) return DM_OK;
    lay_tables(e);
    const dm_status status = e->k->start.outputs ? DM_OK : find_lines(e);
    if (status != DM_OK) e->h = 0.0;
    return status;
}

/* ---- inside a step ---- */

/* q[n] and L_v[n] at (t, w t) */
static void place_inside(dm_trial *e, double *q, double *p, double t) {
    const uint32_t n = e->n, K = e->K;
    double *out = e->k->linear ? e->table + (e->points + 2) * width(e) : e->out;
    e->in[0] = t, e->in[1] = e->row->frequency * t, e->in[2] = e->h;
    memcpy(e->in + 3, e->z, K * sizeof *e->in);
    memset(e->in + 3 + K, 0, 2 * (size_t)n * sizeof *e->in);
    dm_kernel_prepare(&e->k->point, out);
    dm_kernel_eval(&e->k->point, e->in, out);
    memcpy(q, out, n * sizeof *q);
    memcpy(e->x, out, 2 * (size_t)n * sizeof *q);
    e->x[2 * n] = e->t + t;
    dm_kernel_eval(&e->m->stage, e->x, e->stage);
    memcpy(p, e->stage + n, n * sizeof *p);
}

double dm_trial_kinetic(dm_trial *e) {
    static const double PLACES[] = {0.21, 0.4, 0.57, 0.79}; /* no two of them one phase */
    double largest = 0.0;
    for (int k = 0; k < 4; k++) {
        double sum = 0.0;
        place_inside(e, e->v, e->A, PLACES[k] * e->h);
        for (uint32_t i = 0; i < e->n; i++) sum += e->x[e->n + i] * e->A[i];
        largest = fmax(largest, fabs(sum));
    }
    return largest;
}

/* The momentum of the curve jumps at its ends by what the space has not of the motion: the jumps
 * are spread linearly, so that a row at the end of a step is the end of the step. */
void dm_trial_inside(dm_trial *e, double *q, double *p, double t) {
    const uint32_t n = e->n;
    double *first = e->A, *last = e->A + n;
    place_inside(e, q, first, 0.0);
    place_inside(e, q, last, e->h);
    place_inside(e, q, p, t);
    for (uint32_t i = 0; i < n; i++)
        p[i] += (1.0 - t / e->h) * (e->p0[i] - first[i]) + t / e->h * (e->z[e->K + i] - last[i]);
}

/* Coordinates with hardly any momentum are measured by a thousandth of the largest one. */
double dm_trial_defect(dm_trial *e) {
    const uint32_t n = e->n;
    double *size = e->A, *last = e->A + n, worst = 0.0, all = 0.0;
    memset(size, 0, n * sizeof *size);
    for (uint32_t j = 0; j < e->points; j++) {
        const dm_trial_point c = dm_trial_at(e, j, e->z, NULL);
        memcpy(e->x, c.q, n * sizeof *e->x);
        memcpy(e->x + n, c.v, n * sizeof *e->x);
        e->x[2 * n] = e->t + e->at[j];
        dm_kernel_eval(&e->m->stage, e->x, e->stage);
        for (uint32_t i = 0; i < n; i++) size[i] = fmax(size[i], fabs(e->stage[n + i]));
    }
    place_inside(e, e->v, last, e->h);
    for (uint32_t i = 0; i < n; i++) all = fmax(all, size[i]);
    for (uint32_t i = 0; i < n; i++)
        worst = fmax(worst, fabs(e->z[e->K + i] - last[i]) / fmax(size[i], 1e-3 * all));
    return worst;
}

/* |J| |J^-1|, the inverse column by column */
double dm_trial_condition(dm_trial *e) {
    const uint32_t m = e->unknowns;
    double *J = e->scratch, *R = J + (size_t)m * m, *sums = R + m, size = 0.0, inverse = 0.0;
    uint32_t *pivot = (uint32_t *)(void *)(sums + m);
    dm_trial_equation(e, R, J, e->z);
    for (uint32_t i = 0; i < m; i++) {
        double sum = 0.0;
        for (uint32_t j = 0; j < m; j++) sum += fabs(J[i * (size_t)m + j]);
        size = fmax(size, sum);
    }
    if (dm_lu_factor(J, pivot, m) != DM_OK) return INFINITY;
    memset(sums, 0, m * sizeof *sums);
    for (uint32_t c = 0; c < m; c++) {
        memset(R, 0, m * sizeof *R);
        R[c] = 1.0;
        dm_lu_solve(R, J, pivot, m);
        for (uint32_t i = 0; i < m; i++) sums[i] += fabs(R[i]);
    }
    for (uint32_t i = 0; i < m; i++) inverse = fmax(inverse, sums[i]);
    return size * inverse;
}
