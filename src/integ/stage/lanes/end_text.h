/* end_text.h - the end of a step by the equation of equation_text.h, from its root; a text for
 * files that have numbers/lanes_text.h. */
#ifndef DM_END_TEXT_H
#define DM_END_TEXT_H

#include "integ/stage/lanes/equation_text.h"

/* L_q(i) at the root from its value one increment before: + L_qq dQ_i + L_qv dQdot_i */
INLINE void correct_force(const step_equation *e, const double *increment, uint32_t i) {
    const uint32_t n = e->n, s = e->s;
    const dm_weight *ha = e->g->weights.ha + i * s, *d = e->g->table.d + i * s;
    const double *qq = e->at->curve + (i * curve_size(n) + 2 * n) * W, *qv = qq + n * n * W;
    double *dq = e->at->x, *dv = dq + n * W; /* not needed any more */
#pragma GCC unroll 4
    for (uint32_t k = 0; k < n; k++) {
        V v = load(increment + k * W), q = scaled(e->group, &ha->top) * v;
        if (s > 1) v *= d->top;
#pragma GCC unroll 4
        for (uint32_t j = 1; j < s; j++) {
            const V more = load(increment + (j * n + k) * W);
            q += scaled(e->group, &ha[j].top) * more;
            v += d[j].top * more;
        }
        store(dq + k * W, q);
        store(dv + k * W, v);
    }
#pragma GCC unroll 4
    for (uint32_t k = 0; k < n; k++) {
        double *force = e->at->slopes + (i * 2 * n + k) * W;
        V sum = load(force);
#pragma GCC unroll 4
        for (uint32_t l = 0; l < n; l++) {
            const size_t at = (k * n + l) * W;
            sum += load(qq + at) * load(dq + l * W) + load(qv + at) * load(dv + l * W);
        }
        store(force, sum);
    }
}

/* q1 = q0 + h sum_j beta_j V_j, p1 = p0 + h sum_i b_i L_q(i), into next; the lanes where that is
 * finite */
INLINE I find_end(const step_equation *e, const double *velocities, const double *increment) {
    const dm_stage_weights *w = &e->g->weights;
    const dm_stage_group *x = e->group;
    const uint32_t n = e->n;
    I fine = all_lanes();
#pragma GCC unroll 4
    for (uint32_t i = 0; i < e->r; i++) correct_force(e, increment, i);
#pragma GCC unroll 4
    for (uint32_t k = 0; k < n; k++) {
        const double *force = e->at->slopes + k * W, *v = velocities + k * W;
        V dq = weighted(weight_of(x, w->hbeta), load(v)),
          dp = weighted(weight_of(x, w->hb), load(force));
#pragma GCC unroll 4
        for (uint32_t j = 1; j < e->s; j++)
            dq += weighted(weight_of(x, w->hbeta + j), load(v + j * n * W));
#pragma GCC unroll 4
        for (uint32_t i = 1; i < e->r; i++)
            dp += weighted(weight_of(x, w->hb + i), load(force + i * 2 * n * W));
        fine &= add_to_next(x, n, k, dq);
        fine &= add_to_next(x, n, n + k, dp);
    }
    return fine;
}

#endif
