/* stage_lanes_newton.h - a step of the general form by chord iterations for W members, as
 * stage.c, stage_warm.c and linalg/solve/newton.c make it for one; a text for the files of
 * stage_lanes.h. */
#ifndef DM_STAGE_LANES_NEWTON_H
#define DM_STAGE_LANES_NEWTON_H

#include "integ/stage/lanes/stage_lanes_equation.h"

/* ---- the end ---- */

/* L_q(i) at the root from its value one increment before */
INLINE void correct_lanes(const lanes_newton *it, uint32_t i) {
    const dm_stage_lanes *w = it->w;
    const dm_stage *g = w->g;
    const uint32_t n = it->n, s = it->s;
    const double *qq = w->curve + i * curve_size(n) + 2 * n * W, *qv = qq + n * n * W;
    double *dq = w->x, *dv = dq + n * W; /* not needed any more */
#pragma GCC unroll 4
    for (uint32_t k = 0; k < n; k++) {
        V to_q = {0}, to_v = {0};
#pragma GCC unroll 4
        for (uint32_t j = 0; j < s; j++) {
            const V d = load(w->dx + (j * n + k) * W);
            to_q += scaled(w, &g->ha[i * s + j].top) * d;
            to_v += g->table.d[i * s + j].top * d;
        }
        store(dq + k * W, to_q);
        store(dv + k * W, to_v);
    }
#pragma GCC unroll 4
    for (uint32_t k = 0; k < n; k++) {
        double *force = w->slopes + (i * 2 * n + k) * W;
        V sum = load(force);
#pragma GCC unroll 4
        for (uint32_t l = 0; l < n; l++) {
            const size_t at = (k * n + l) * W;
            sum += load(qq + at) * load(dq + l * W) + load(qv + at) * load(dv + l * W);
        }
        store(force, sum);
    }
}

INLINE I finish_newton(const lanes_newton *it) {
    const dm_stage_lanes *w = it->w;
    const uint32_t n = it->n;
    I fine = mask_of((1u << W) - 1);
#pragma GCC unroll 4
    for (uint32_t i = 0; i < it->r; i++) correct_lanes(it, i);
#pragma GCC unroll 4
    for (uint32_t k = 0; k < n; k++) {
        V dq = {0}, dp = {0};
#pragma GCC unroll 4
        for (uint32_t j = 0; j < it->s; j++)
            dq = add_weighted(dq, weight_of(w, w->g->hbeta + j), load(w->root + (j * n + k) * W));
#pragma GCC unroll 4
        for (uint32_t i = 0; i < it->r; i++)
            dp =
                add_weighted(dp, weight_of(w, w->g->hb + i), load(w->slopes + (i * 2 * n + k) * W));
        fine &= add_to_state(w, n, k, dq);
        fine &= add_to_state(w, n, n + k, dp);
    }
    return fine;
}

/* the new state, and what is left to the next step. Differences behind those that a lane has yet
 * are numbers that no step reads before they are renewed. */
INLINE void keep_newton(const lanes_newton *it, I where) {
    const dm_stage_lanes *w = it->w;
    double *end = w->memory + DM_WARM_END * W, *before = end + 4 * it->n * W;
    double *D = before + it->m * W, *count = w->memory + DM_WARM_COUNT * W;
    continue_lanes(it, w->missed, before);
#pragma GCC unroll 4
    for (uint32_t k = 0; k < it->m; k++) {
        V missed = load(w->root + k * W) - load(w->missed + k * W);
#pragma GCC unroll 4
        for (uint32_t i = 0; i < DM_WARM_TERMS; i++) {
            double *place = D + (i * it->m + k) * W;
            const V now = missed;
            missed -= load(place);
            put_where(where, place, now);
        }
        put_where(where, before + k * W, load(w->root + k * W));
    }
    const V one_more = load(count) + 1.0, most = same(DM_WARM_TERMS + 1);
    put_where(where, count, pick((I)(one_more <= most), one_more, most));
    copy_where(where, end, w->next, 4 * it->n);
    copy_where(where, w->state, w->next, 4 * it->n);
}

INLINE uint32_t step_of(const dm_stage_lanes *w, uint32_t asked, uint32_t n, uint32_t s,
                        uint32_t r) {
    lanes_newton it = {.w = w, .n = n, .s = s, .r = r, .m = s * n};
    chord c = {.x = w->root, .dx = w->dx, .r = w->r, .tolerance = w->tolerance, .factored = 1};
    c.todo = c.fresh = mask_of(asked) & guess_lanes(&it);
    if (!some(c.todo)) return 0;
    I ended =
        iterate_chord(&c, evaluate_equation, solve_equation, &it, s * n, w->max_iterations, NULL);
    ended &= finish_newton(&it);
    keep_newton(&it, ended);
    return bits_of(ended);
}

/* few coordinates and one stage are written out */
HOW static uint32_t step_by_newton(const dm_stage_lanes *w, uint32_t asked) {
    const dm_stage *g = w->g;
    const uint32_t n = g->n, s = g->table.s, r = g->table.r;
    const int one = s == 1 && r == 1;
    if (one && n == 1) return step_of(w, asked, 1, 1, 1);
    if (one && n == 2) return step_of(w, asked, 2, 1, 1);
    if (one && n == 3) return step_of(w, asked, 3, 1, 1);
    if (one && n == 4) return step_of(w, asked, 4, 1, 1);
    return step_of(w, asked, n, s, r);
}

#endif
