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

/* 2 / omega of one cell, omega^2 the largest eigenvalue of M^-1 H, whose second derivatives are
 * y[outputs]; share: among how many cells the mass of an entry is divided, or NULL for all of it */
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
        const double wp = a->w[ep] * (share ? share[ep] : 1.0);
        const double wq = a->w[eq] * (share ? share[eq] : 1.0);
        A[p * m + q] = A[q * m + p] = -factor * y[o] * (sqrt(wp) * sqrt(wq));
    }
    const dm_status status = dm_symmetric_eigen(A, value, scratch, m, NULL);
    if (status == DM_OK && value[m - 1] > 0.0) *out = 2.0 / sqrt(value[m - 1]);
    return status;
}

/* the sum of the potential that the sum s is, or NULL */
static const dm_avi_sum *find(const dm_avi *a, const dm_sum *s) {
    for (uint32_t k = 0; k < a->sums; k++)
        if (a->sum[k].sum == s) return a->sum + k;
    return NULL;
}

dm_status dm_avi_limits(const dm_avi *a, const dm_curvature *c, double *limit, double *alone,
                        dm_arena *arena) {
    const size_t widest = DM_SUM_COLUMNS;
    double *share = dm_arena_take(arena, ((size_t)a->n + 1) * sizeof *share);
    double *work = dm_arena_take(arena, (widest * widest + 2 * widest) * sizeof *work);
    if (!share || !work) return DM_NO_MEMORY;
    count_shares(a, share);
    for (uint32_t k = 0; k < a->cells; k++) limit[k] = alone[k] = INFINITY;
    for (uint32_t k = 0; k < c->sums; k++) {
        const dm_curvature_sum *s = c->sum + k;
        const dm_avi_sum *own = find(a, s->loop.sum);
        if (!own || !s->loop.outputs) continue;
        for (uint32_t i = 0; i < s->loop.sum->bodies; i++) {
            const uint32_t cell = own->first + i;
            double *y = c->work;
            dm_cell_loop_run(&s->loop, y, 1, a->x, i, 1, y + s->loop.outputs);
            dm_status status = stiffest(a, s, own->factor, share, i, y, work, limit + cell);
            if (status == DM_OK)
                status = stiffest(a, s, own->factor, NULL, i, y, work, alone + cell);
            if (status != DM_OK) return status;
        }
    }
    return DM_OK;
}

/* Is what the kicks of a cell each h turn its oscillation by in a time T near a multiple of pi? A
 * step turns it by 2 asin(omega h / 2), alone = 2 / omega. */
static int is_near(double alone, double h, double T, double margin) {
    if (!(h < alone)) return 0;
    const double x = 2.0 * asin(h / alone) * (T / h) / 3.14159265358979323846, k = floor(x + 0.5);
    return k >= 1.0 && fabs(x - k) < margin;
}

enum { MOST_STEPS = 256, MOST_PERIODS = 32 }; /* of a common period that is looked at */

/* p of T = (p / q) h with a small q, or 0 */
static int common_period(double h, double T, int *q) {
    for (*q = 1; *q <= MOST_PERIODS; ++*q) {
        const double x = *q * (T / h), p = floor(x + 0.5);
        if (p > MOST_STEPS) return 0;
        if (p >= 1.0 && fabs(x - p) < 1e-9 * x) return (int)p;
    }
    return 0;
}

/* Does one oscillator that both cells kick, as if they moved the same, grow round their common
 * period? The trace of all drifts and kicks is beyond 2 then. */
static int grows(double alone1, double h1, double alone2, double h2) {
    int q;
    const int p = h1 < alone1 && h2 < alone2 ? common_period(h1, h2, &q) : 0;
    if (!p) return 0;
    const double tick = h1 / q; /* h1 has q of them, h2 p */
    const double kick1 = 4.0 * h1 / (alone1 * alone1), kick2 = 4.0 * h2 / (alone2 * alone2);
    double x[2] = {1.0, 0.0}, v[2] = {0.0, 1.0};
    for (int i = q, j = p, now = 0; now < p * q;) {
        const int next = i < j ? i : j;
        const double by = (next == i ? kick1 : 0.0) + (next == j ? kick2 : 0.0);
        for (int c = 0; c < 2; c++) {
            x[c] += (next - now) * tick * v[c];
            v[c] -= by * x[c];
        }
        i += next == i ? q : 0;
        j += next == j ? p : 0;
        now = next;
    }
    return fabs(x[0] + v[1]) > 2.0 + 1e-9;
}

double dm_avi_resonances(const dm_avi *a, const double *alone, double margin) {
    const double *h = a->h;
    double pairs = 0.0;
    for (uint32_t k = 0; k < a->cells; k++)
        for (uint32_t j = a->near_start[k]; j < a->near_start[k + 1]; j++) {
            const uint32_t l = a->near[j];
            if (l >= k || h[k] == h[l]) continue;
            pairs += is_near(alone[k], h[k], h[l], margin) ||
                     is_near(alone[l], h[l], h[k], margin) || grows(alone[k], h[k], alone[l], h[l]);
        }
    return pairs;
}
