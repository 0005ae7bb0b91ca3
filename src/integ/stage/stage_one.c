/* stage_one.c - the step equation of stage.h with one velocity at one point, as of the midpoint
 * rule. The same operations in the same order as for more of them, with all loops over
 * coordinates written out where these are few: what a short step costs are otherwise loops of
 * three rounds and sums that go through memory. */
#include "base/written_out.h"
#include "integ/stage/stage_inside.h"

#include <math.h>

int dm_stage_is_one(const dm_stage *g) {
    const dm_stage_table *t = &g->table;
    return t->s == 1 && t->r == 1 && t->d->top == 1.0 && t->d->rest == 0.0;
}

/* arguments of the kernel at Q = q0 + h a V, Qdot = V */
DM_WRITTEN_OUT void place(dm_stage *g, const double *V, uint32_t n) {
    const dm_weight ha = *g->ha;
    const double *q0 = g->state, *low = q0 + 2 * n;
    double *x = g->x;
#pragma GCC unroll 4
    for (uint32_t k = 0; k < n; k++) {
        const double v = V[k];
        x[k] = q0[k] + (low[k] + dm_weighted(ha, v));
        x[n + k] = v;
    }
    x[2 * n] = g->t + dm_weight_double(*g->hc);
}

/* R = h b (a - beta) L_q + b L_v - beta p0 */
DM_WRITTEN_OUT void residual(dm_stage *g, double *R, const double *slope, uint32_t n) {
    const double *p0 = g->state + n, *low = g->state + 3 * n;
    const dm_weight beta = *g->table.beta, wq = *g->wq, wv = *g->wv;
    double largest = 0.0;
#pragma GCC unroll 4
    for (uint32_t k = 0; k < n; k++) {
        const double term = dm_weighted(wq, slope[k]) + dm_weighted(wv, slope[n + k]);
        const double size = fabs(term);
        largest = size > largest ? size : largest;
        R[k] = (term - dm_weighted(beta, p0[k])) - beta.top * low[k];
    }
    g->size = largest;
}

/* dR/dV = h b (a - beta) (h a L_qq + L_qv) + b (h a L_vq + L_vv) */
DM_WRITTEN_OUT void jacobian(const dm_stage *g, double *J, uint32_t n) {
    const double wq = dm_weight_double(*g->wq), wv = dm_weight_double(*g->wv);
    const double ha = dm_weight_double(*g->ha);
    const double *A = g->curve + 2 * n, *B = A + n * n, *C = B + n * n;
#pragma GCC unroll 4
    for (uint32_t i = 0; i < n; i++)
#pragma GCC unroll 4
        for (uint32_t j = 0; j < n; j++) {
            const uint32_t at = i * n + j, across = j * n + i;
            const double mixed = wq * B[at] + (wv * ha) * B[across];
            J[at] = ((wq * ha) * A[at] + wv * C[at]) + mixed;
        }
}

DM_WRITTEN_OUT void equation(dm_stage *g, double *R, double *J, const double *V, uint32_t n) {
    place(g, V, n);
    dm_kernel_eval(J ? g->stage : &g->m->slope, g->x, J ? g->curve : g->slope);
    g->evaluations++;
    residual(g, R, J ? g->curve : g->slope, n);
    g->newest = J ? g->curve : g->slope;
    if (J) jacobian(g, J, n);
}

dm_status dm_stage_one(void *ctx, double *R, double *J, const double *V) {
    dm_stage *g = ctx;
    switch (g->n) {
    case 1:
        equation(g, R, J, V, 1);
        break;
    case 2:
        equation(g, R, J, V, 2);
        break;
    case 3:
        equation(g, R, J, V, 3);
        break;
    case 4:
        equation(g, R, J, V, 4);
        break;
    default:
        equation(g, R, J, V, g->n);
    }
    return DM_OK;
}

/* dq = h beta V, dp = h b (L_q + L_qq h a dV + L_qv dV) */
DM_WRITTEN_OUT dm_status finish(dm_stage *g, const double *dV, uint32_t n) {
    const double *qq = g->curve + 2 * n, *qv = qq + n * n, *force = g->newest;
    double *dq = g->v0, *dp = g->a0;
    const double ha = g->ha->top;
#pragma GCC unroll 4
    for (uint32_t k = 0; k < n; k++) {
        double sum = force[k];
#pragma GCC unroll 4
        for (uint32_t l = 0; l < n; l++)
            sum += qq[k * n + l] * (ha * dV[l]) + qv[k * n + l] * dV[l];
        dp[k] = dm_weighted(*g->hb, sum);
        dq[k] = dm_weighted(*g->hbeta, g->root[k]);
    }
    return dm_stage_update(g, dq, dp);
}

dm_status dm_stage_one_finish(dm_stage *g, const double *dV) {
    switch (g->n) {
    case 1:
        return finish(g, dV, 1);
    case 2:
        return finish(g, dV, 2);
    case 3:
        return finish(g, dV, 3);
    case 4:
        return finish(g, dV, 4);
    default:
        return finish(g, dV, g->n);
    }
}
