/* avi_limits.c - how long the step of a cell may be, and which cells disturb each other. */
#include "field/avi/avi_inside.h"
#include "linalg/sparse/symmetric_eigen.h"

#include <math.h>
#include <string.h>

/* how many cells read every entry: share[n] */
static void count_shares(const dm_avi *a, double *share) {
    memset(share, 0, a->n * sizeof *share);
    for (uint32_t k = 0; k < a->sums; k++) {
        const dm_avi_sum *s = a->sum + k;
        for (uint32_t i = 0; i < s->sum->bodies; i++)
            for (uint32_t j = 0; j < s->kicks; j++)
                share[s->entry[(size_t)i * s->reads + s->kick[j].entry]]++;
    }
}

/* the largest eigenvalue of M^-1 H of one cell, whose second derivatives are y[outputs] */
static dm_status stiffest(const dm_avi *a, const dm_curvature_sum *c, double factor,
                          const double *share, uint32_t i, const double *y, double *work,
                          double *out) {
    const dm_sum *s = c->loop.sum;
    const uint32_t m = s->columns;
    double *A = work, *value = A + (size_t)m * m, *scratch = value + m;
    memset(A, 0, (size_t)m * m * sizeof *A);
    for (uint32_t o = 0; o < c->loop.outputs; o++) {
        const uint32_t p = c->pair[o][0], q = c->pair[o][1];
        const size_t ep = dm_sum_entry(s, s->column + p, i, 0);
        const size_t eq = dm_sum_entry(s, s->column + q, i, 0);
        const double scale = sqrt(a->w[ep] * share[ep]) * sqrt(a->w[eq] * share[eq]);
        A[p * m + q] = A[q * m + p] = -factor * y[o] * scale;
    }
    const dm_status status = dm_symmetric_eigen(A, value, scratch, m, NULL);
    *out = status == DM_OK ? value[m - 1] : 0.0;
    return status;
}

/* the sum of the potential that the sum s is, or NULL */
static const dm_avi_sum *find(const dm_avi *a, const dm_sum *s) {
    for (uint32_t k = 0; k < a->sums; k++)
        if (a->sum[k].sum == s) return a->sum + k;
    return NULL;
}

dm_status dm_avi_limits(const dm_avi *a, const dm_curvature *c, double *limit, dm_arena *arena) {
    const size_t widest = DM_SUM_COLUMNS;
    double *share = dm_arena_take(arena, ((size_t)a->n + 1) * sizeof *share);
    double *work = dm_arena_take(arena, (widest * widest + 2 * widest) * sizeof *work);
    if (!share || !work) return DM_NO_MEMORY;
    count_shares(a, share);
    for (uint32_t k = 0; k < a->cells; k++) limit[k] = INFINITY;
    for (uint32_t k = 0; k < c->sums; k++) {
        const dm_curvature_sum *s = c->sum + k;
        const dm_avi_sum *own = find(a, s->loop.sum);
        if (!own || !s->loop.outputs) continue;
        for (uint32_t i = 0; i < s->loop.sum->bodies; i++) {
            double lambda, *y = c->work;
            dm_cell_loop_run(&s->loop, y, 1, a->x, i, 1, y + s->loop.outputs);
            const dm_status status = stiffest(a, s, own->factor, share, i, y, work, &lambda);
            if (status != DM_OK) return status;
            if (lambda > 0.0) limit[own->first + i] = 2.0 / sqrt(lambda);
        }
    }
    return DM_OK;
}

/* is omega_K h_L near a multiple of pi? */
static int is_near(double limit, double h, double margin) {
    const double x = 2.0 / limit * h / 3.14159265358979323846, k = floor(x + 0.5);
    return k >= 1.0 && fabs(x - k) < margin;
}

double dm_avi_resonances(const dm_avi *a, const double *limit, double margin) {
    double pairs = 0.0;
    for (uint32_t k = 0; k < a->cells; k++)
        for (uint32_t j = a->near_start[k]; j < a->near_start[k + 1]; j++) {
            const uint32_t l = a->near[j];
            if (l >= k || a->h[k] == a->h[l]) continue;
            pairs += is_near(limit[k], a->h[l], margin) || is_near(limit[l], a->h[k], margin);
        }
    return pairs;
}
