/* stage_lanes_one_point.h - a step of one stage by push.h for W members, as stage_push.c makes it for
 * one, operation by operation; a text for the files of stage_lanes.h. */
#ifndef DM_STAGE_LANES_PUSH_H
#define DM_STAGE_LANES_PUSH_H

#include "integ/stage/lanes/one_point.h"
#include "integ/stage/lanes/stage_lanes_one_point_keep.h"
#include "linalg/solve/newton_limits.h"

#include <math.h>

/* out = M^-1 (x - shift); shift NULL: none */
INLINE void divide_lanes(const dm_model *m, double *out, const double *x, const double *shift,
                         uint32_t n) {
    const double *c = m->inverse_mass;
    if (m->structure & DM_DIAGONAL_MASS) {
#pragma GCC unroll 4
        for (uint32_t i = 0; i < n; i++) store(out + i * W, c[i] * load(x + i * W));
        return;
    }
#pragma GCC unroll 4
    for (uint32_t i = 0; i < n; i++) {
        V sum = {0};
#pragma GCC unroll 4
        for (uint32_t j = 0; j < n; j++) {
            const V from = load(x + j * W);
            sum += c[i * n + j] * (shift ? from - shift[j] : from);
        }
        store(out + i * W, sum);
    }
}

INLINE I is_root(V first, V second, V small) {
    const I slow = (I)(second <= DM_NEWTON_SLOW * first) | (I)(first <= small);
    return (I)(second * second <= DM_NEWTON_NEGLIGIBLE * small * first) |
           ((I)(second <= small) & slow);
}

INLINE V weighted(lanes_weight c, V x) {
    return c.top * x + c.rest * x;
}

/* v0 and the arguments of the kernel */
INLINE void place_members(const dm_stage_lanes *w, uint32_t n) {
    const dm_stage *g = w->g;
    const double *low = w->state + 2 * n * W;
    const double *guess = w->memory + (DM_PUSHED_END + 4 * n) * W;
    double *numbers = w->in + 3 * n * W;
    divide_lanes(g->m, w->v0, w->state + n * W, g->m->momentum_shift, n);
#pragma GCC unroll 4
    for (uint32_t k = 0; k < n; k++) {
        const V v = load(w->v0 + k * W);
        const V reach = weighted(weight_of(w, g->hreach), v);
        store(w->in + k * W, load(w->state + k * W));
        store(w->in + (n + k) * W, load(low + k * W) + reach);
        store(w->in + (2 * n + k) * W, load(guess + k * W));
    }
    const lanes_weight hA = weight_of(w, g->hA), hc = weight_of(w, g->hc);
    store(numbers + DM_PUSH_WEIGHT * W, hA.top + hA.rest);
    store(numbers + DM_PUSH_OVER * W, 1.0 / (hA.top + hA.rest));
    store(numbers + DM_PUSH_TIME * W, w->t + (hc.top + hc.rest));
}

/* forces, u and Z of the lanes that end, in end_f, end_u and root */
INLINE I iterate_members(const dm_stage_lanes *w, I todo, uint32_t n) {
    const V c = load(w->in + (3 * n + DM_PUSH_WEIGHT) * W);
    const double *base = w->in + n * W;
    double *Z = w->in + 2 * n * W;
    const V small = w->tolerance * (largest_of_lanes(w->in, n) + largest_of_lanes(Z, n));
    I ended = {0};
    for (int i = 0; i < DM_PUSHED_CALLS && bits_of(todo); i++) {
        dm_kernel_eval(&w->stage, w->in, w->out);
        const V first = magnitude(c) * largest_of_lanes(w->out + n * W, n);
        const V second = magnitude(c) * largest_of_lanes(w->out + 2 * n * W, n);
        const I now = todo & is_root(first, second, small);
        divide_lanes(w->g->m, w->u, w->out, NULL, n);
#pragma GCC unroll 4
        for (uint32_t k = 0; k < n; k++) {
            const V u = load(w->u + k * W), shift = load(base + k * W) + c * u;
            store(Z + k * W, shift);
            put_where(now, w->end_u + k * W, u);
            put_where(now, w->end_f + k * W, load(w->out + k * W));
            put_where(now, w->root + k * W, shift);
        }
        ended |= now;
        todo &= ~now & (I)(second <= DM_NEWTON_SLOW * first);
    }
    return ended;
}

/* lanes whose end, in next, is finite */
INLINE I finish_members(const dm_stage_lanes *w, uint32_t n) {
    const dm_stage *g = w->g;
    I fine = mask_of((1u << W) - 1);
#pragma GCC unroll 4
    for (uint32_t k = 0; k < n; k++) {
        const V u = load(w->end_u + k * W), f = load(w->end_f + k * W);
        const V drift = load(w->h) * load(w->v0 + k * W);
        fine &= add_to_state(w, n, k, drift + weighted(weight_of(w, g->hmean), u));
        fine &= add_to_state(w, n, n + k, weighted(weight_of(w, g->hb), f));
    }
    return fine;
}

INLINE uint32_t push_members(const dm_stage_lanes *w, uint32_t asked, uint32_t n) {
    const I todo = mask_of(asked) & pushed_before(w, n);
    if (!bits_of(todo)) return 0;
    place_members(w, n);
    I ended = iterate_members(w, todo, n);
    ended &= finish_members(w, n);
    keep_pushes(w, ended, w->root, n);
    return bits_of(ended);
}

HOW static uint32_t step_by_push(const dm_stage_lanes *w, uint32_t asked) {
    switch (w->g->n) {
    case 1:
        return push_members(w, asked, 1);
    case 2:
        return push_members(w, asked, 2);
    case 3:
        return push_members(w, asked, 3);
    default:
        return push_members(w, asked, 4);
    }
}

#endif
