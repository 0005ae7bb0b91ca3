/*
** tied_end.c - from the root to the state at the end. What is left to find there are the impulses I_K that put p1
** onto the hidden constraint, together with v1:
**   L_v(q1, v1) = p + I_K,  G v1 + g_t = 0,  phi(q1, v1) = 0.
*/
#include "integ/tied_inside.h"

#include "base/sum.h"
#include "solve/newton.h"

#include <math.h>
#include <string.h>

/* y += w A x */
static void add_product(double *y, double w, const double *A, const double *x,
                        uint32_t n) {
    for (uint32_t i = 0; i < n; i++)
        for (uint32_t j = 0; j < n; j++) y[i] += w * A[i * (size_t)n + j] * x[j];
}

/* what the last increment of V moves a point by */
static void moved(dm_tied *g, const dm_weight *ha, const dm_weight *d, const double *dV) {
    const uint32_t n = g->n;
    memset(g->shift, 0, n * sizeof *g->shift);
    memset(g->v, 0, n * sizeof *g->v);
    for (uint32_t j = 0; j < g->table.s; j++)
        for (uint32_t i = 0; i < n; i++) {
            g->shift[i] += ha[j].top * dV[j * (size_t)n + i];
            g->v[i] += d[j].top * dV[j * (size_t)n + i];
        }
}

/* forces at the root from those one increment before, to first order */
static void correct_forces(dm_tied *g, const double *dV) {
    const uint32_t n = g->n, s = g->table.s;
    const size_t nn = (size_t)n * n;
    for (uint32_t i = 0; i < g->table.r; i++) {
        const double *qq = g->curve + i * (2 * n + 3 * nn) + 2 * n;
        const double *f_q = g->drag + i * (n + 2 * nn) + n;
        double *force = g->slope + i * 2 * (size_t)n;
        moved(g, g->ha + i * s, g->table.d + i * s, dV);
        add_product(force, 1.0, qq, g->shift, n);
        add_product(force, 1.0, qq + nn, g->v, n);
        if (!g->ties->forced) continue;
        add_product(force, 1.0, f_q, g->shift, n);
        add_product(force, 1.0, f_q + nn, g->v, n);
    }
}

/* impulses at the root: linear in the multipliers, and to first order in what moves the rows */
static void correct_impulses(dm_tied *g, const double *dV) {
    const uint32_t n = g->n, s = g->table.s, m = g->k + g->l;
    for (uint32_t k = 0; k < g->K && m; k++) {
        double *impulse = g->impulse + k * (size_t)n;
        const double *r_q = dm_tied_curved(g, k) + n;
        dm_tied_impulse(g, impulse, g->root + s * (size_t)n + k * m, k);
        if (k == 0) continue;
        moved(g, g->tie_ha + k * s, g->tie.d + k * s, dV);
        add_product(impulse, 1.0, r_q, g->shift, n);
        if (g->l) add_product(impulse, 1.0, r_q + (size_t)n * n, g->v, n);
    }
}

/* ---- the hidden constraint at the end: unknowns v1[n], impulses[m] ---- */

static void end_momentum(dm_tied *g, double *R, const double *v, const double *impulses) {
    const uint32_t n = g->n;
    double *impulse = g->impulse + g->K * (size_t)n;
    memcpy(g->x + n, v, n * sizeof *v);
    dm_kernel_eval(&g->m->mass, g->x, g->mass);
    if (g->l) dm_tied_rows(g, g->K);
    dm_tied_impulse(g, impulse, impulses, g->K);
    for (uint32_t i = 0; i < n; i++) {
        R[i] = (g->mass[i] - g->before[i]) - impulse[i];
        g->size = fmax(g->size, fmax(fabs(g->mass[i]), fabs(impulse[i])));
    }
}

static void end_ties(const dm_tied *g, double *R, const double *v) {
    const uint32_t n = g->n;
    const double *G = dm_tied_holonomic(g, g->K) + g->k, *g_t = G + g->k * n;
    const double *phi = dm_tied_rolling(g, g->K);
    for (uint32_t c = 0; c < g->k + g->l; c++) {
        double sum = c < g->k ? g_t[c] : phi[c - g->k];
        for (uint32_t i = 0; i < n && c < g->k; i++) sum += G[c * n + i] * v[i];
        R[c] = sum * (g->mass_size / g->row_size[c]);
    }
}

/* [L_vv - dI/dv, -rows^T; rows, 0] */
static void end_matrix(dm_tied *g, double *J, const double *impulses) {
    const uint32_t n = g->n, m = g->k + g->l;
    const size_t N = n + m, nn = (size_t)n * n;
    const double *G = dm_tied_holonomic(g, g->K) + g->k;
    const double *E = dm_tied_rolling(g, g->K) + g->l, *phi_v = E + g->l * n;
    const double *r_v = dm_tied_curved(g, g->K) + n + nn;
    memset(J, 0, N * N * sizeof *J);
    if (g->l) dm_tied_reaction(g, impulses, g->K);
    for (uint32_t i = 0; i < n; i++)
        for (uint32_t j = 0; j < n; j++)
            J[i * N + j] = g->mass[n + i * n + j] - (g->l ? r_v[i * n + j] : 0.0);
    for (uint32_t c = 0; c < m; c++) {
        const uint32_t at = (c < g->k ? c : c - g->k) * n;
        const double *across = (c < g->k ? G : E) + at,
                     *row = (c < g->k ? G : phi_v) + at;
        for (uint32_t i = 0; i < n; i++) {
            J[i * N + n + c] = -across[i] * (g->mass_size / g->impulse_size[c]);
            J[(n + c) * N + i] = row[i] * (g->mass_size / g->row_size[c]);
        }
    }
}

static dm_status end_equation(void *ctx, double *R, double *J, const double *z) {
    dm_tied *g = ctx;
    g->size = 0.0;
    end_momentum(g, R, z, z + g->n);
    end_ties(g, R + g->n, z);
    if (J) end_matrix(g, J, z + g->n);
    return DM_OK;
}

/* x = (q1, v of the curve's end, t1); rows of the holonomic ties there */
static void place_end(dm_tied *g) {
    const uint32_t n = g->n, s = g->table.s;
    memset(g->end, 0, n * sizeof *g->end);
    for (uint32_t j = 0; j < s; j++)
        dm_weighted_add(g->end, g->tie.d[g->K * s + j], g->root + j * (size_t)n, n);
    memcpy(g->x, g->next, n * sizeof *g->x);
    memcpy(g->x + n, g->end, n * sizeof *g->x);
    g->x[2 * n] = g->t + g->h;
    dm_tied_rows(g, g->K);
}

static dm_status find_end(dm_tied *g, const dm_stepper *stepper) {
    dm_newton_report report = {0};
    const dm_newton_problem problem = {.m = g->n + g->k + g->l,
                                       .equation = end_equation,
                                       .ctx = g,
                                       .size = &g->size,
                                       .tolerance = stepper->tolerance,
                                       .max_iterations = stepper->max_iterations};
    place_end(g);
    const dm_status status = dm_newton(g->end, &problem, g->scratch, &report);
    g->residual = status == DM_OK ? g->residual : report.residual;
    if (status != DM_OK || g->l == 0) return status;
    memcpy(g->x + g->n, g->end, g->n * sizeof *g->x);
    dm_tied_rows(g, g->K); /* E at v1 itself */
    return DM_OK;
}

/* next = state + (dq, dp), compensated */
static dm_status update(dm_tied *g) {
    const uint32_t n = g->n;
    memcpy(g->next, g->state, 4 * (size_t)n * sizeof *g->next);
    dm_sum_add_n(g->next, g->next + 2 * n, g->dq, n);
    dm_sum_add_n(g->next + n, g->next + 3 * n, g->dp, n);
    for (uint32_t i = 0; i < 4 * n; i++)
        if (!isfinite(g->next[i])) return DM_NOT_FINITE;
    return DM_OK;
}

dm_status dm_tied_finish(dm_tied *g, const dm_stepper *stepper) {
    const uint32_t n = g->n, m = g->k + g->l;
    double *last = g->impulse + g->K * (size_t)n;
    correct_forces(g, g->scratch);
    correct_impulses(g, g->scratch);
    memset(g->dq, 0, n * sizeof *g->dq);
    memset(g->dp, 0, n * sizeof *g->dp);
    for (uint32_t j = 0; j < g->table.s; j++)
        dm_weighted_add(g->dq, g->hbeta[j], g->root + j * (size_t)n, n);
    for (uint32_t i = 0; i < g->table.r; i++)
        dm_weighted_add(g->dp, g->hb[i], g->slope + i * 2 * (size_t)n, n);
    for (uint32_t k = 0; k < g->K && m; k++)
        for (uint32_t i = 0; i < n; i++) g->dp[i] += g->impulse[k * n + i];
    dm_status status = update(g);
    if (status != DM_OK || m == 0) return status;
    memcpy(g->before, g->next + n, n * sizeof *g->before);
    status = find_end(g, stepper);
    if (status != DM_OK) return status;
    dm_tied_impulse(g, last, g->end + n, g->K);
    for (uint32_t i = 0; i < n; i++) g->dp[i] += last[i];
    return update(g);
}
