/* constrained_end.c - from the root to the state at the end: forces and impulses at the root,
 * compensated sums. */
#include "integ/constrained/constrained_inside.h"
#include "integ/method/method.h"

#include "numbers/compensated.h"
#include "numbers/small_copy.h"

#include <math.h>

/* what the last increment of V moves a point by */
static void moved(dm_constrained *g, const dm_weight *ha, const dm_weight *d, const double *dV) {
    const uint32_t n = g->n;
    dm_small_zero(g->shift, n);
    dm_small_zero(g->v, n);
    for (uint32_t j = 0; j < g->table.s; j++)
        for (uint32_t i = 0; i < n; i++) {
            g->shift[i] += ha[j].top * dV[j * (size_t)n + i];
            g->v[i] += d[j].top * dV[j * (size_t)n + i];
        }
}

/* forces at the root from those one increment before, to first order */
static void correct_forces(dm_constrained *g, const double *dV) {
    const uint32_t n = g->n, s = g->table.s;
    const size_t nn = (size_t)n * n;
    for (uint32_t i = 0; i < g->table.r; i++) {
        const double *qq = g->curve + i * (2 * n + 3 * nn) + 2 * n;
        const double *f_q = g->drag + i * (n + 2 * nn) + n;
        double *force = g->slope + i * 2 * (size_t)n;
        moved(g, g->ha + i * s, g->table.d + i * s, dV);
        dm_constrained_product(force, qq, g->shift, &g->qq);
        dm_constrained_product(force, qq + nn, g->v, &g->qv);
        if (!g->constraints->forced) continue;
        dm_constrained_product(force, f_q, g->shift, &g->f_q);
        dm_constrained_product(force, f_q + nn, g->v, &g->f_v);
    }
}

/* impulses at the root: linear in the multipliers, and to first order in what moves the rows */
static void correct_impulses(dm_constrained *g, const double *dV) {
    const uint32_t n = g->n, s = g->table.s, m = g->k + g->l;
    for (uint32_t k = 0; k < g->K && m; k++) {
        double *impulse = g->impulse + k * (size_t)n;
        const double *r_q = dm_constrained_curved(g, k) + n;
        dm_constrained_impulse(g, impulse, g->root + s * (size_t)n + k * m, k);
        if (k == 0) continue;
        moved(g, g->constraint_ha + k * s, g->constraint.d + k * s, dV);
        dm_constrained_product(impulse, r_q, g->shift, &g->r_q);
        if (!dm_constrained_turns(g))
            dm_constrained_product(impulse, r_q + (size_t)n * n, g->v, &g->r_v);
    }
}

/* q or p of the end, those from `first` on: state + d, compensated */
static dm_status update(dm_constrained *g, const double *d, size_t first) {
    const uint32_t n = g->n;
    double *next = g->next + first, *low = next + 2 * (size_t)n, none = 0.0;
    dm_small_copy(next, g->state + first, n);
    dm_small_copy(low, g->state + first + 2 * (size_t)n, n);
    dm_sum_add_n(next, low, d, n);
    for (uint32_t i = 0; i < n; i++) none += 0.0 * next[i] + 0.0 * low[i];
    return none == 0.0 ? DM_OK : DM_NOT_FINITE;
}

/* g->scratch has the last increment of Newton's method. The momentum without I_K is left in
 * g->before; then I_K is added and the sum is made once more from the state, so that the end is
 * rounded once. */
dm_status dm_constrained_finish(dm_constrained *g, const dm_stepper *stepper) {
    const uint32_t n = g->n, m = g->k + g->l;
    double *last = g->impulse + g->K * (size_t)n;
    correct_forces(g, g->scratch);
    correct_impulses(g, g->scratch);
    dm_small_zero(g->dq, n);
    dm_small_zero(g->dp, n);
    for (uint32_t j = 0; j < g->table.s; j++)
        dm_weighted_add(g->dq, g->hbeta[j], g->root + j * (size_t)n, n);
    for (uint32_t i = 0; i < g->table.r; i++)
        dm_weighted_add(g->dp, g->hb[i], g->slope + i * 2 * (size_t)n, n);
    for (uint32_t k = 0; k < g->K && m; k++)
        for (uint32_t i = 0; i < n; i++) g->dp[i] += g->impulse[k * n + i];
    dm_status status = update(g, g->dq, 0);
    if (status == DM_OK) status = update(g, g->dp, n);
    if (status != DM_OK || m == 0) return status;
    if (stepper->rule->method->traits & DM_LOOSE_MOMENTUM) { /* the next I_0 does all */
        dm_small_zero(g->end + n, m);
        return DM_OK;
    }
    dm_small_copy(g->before, g->next + n, n);
    status = dm_constrained_hidden(g, stepper);
    if (status != DM_OK) return status;
    dm_constrained_impulse(g, last, g->end + n, g->K);
    for (uint32_t i = 0; i < n; i++) g->dp[i] += last[i];
    return update(g, g->dp, n);
}
