/* phase_lanes_step.h - a step by sweeps for W members, as phase_sweep.c makes it for one; a text
 * for the files of phase_lanes.h. */
#ifndef DM_PHASE_LANES_STEP_H
#define DM_PHASE_LANES_STEP_H

#include "integ/phase/phase_lanes_sweep.h"

/* ---- until it ends ---- */

INLINE void leave_end(const phase_sweeps *it, I where) {
    const size_t all = 2 * (size_t)it->n * it->r;
    for (size_t k = 0; k < all; k++) put_where(where, it->w->end + k * W, load(it->w->u + k * W));
}

/* so many sweeps; the lanes where that went well */
INLINE I count_sweeps(phase_sweeps *it, I todo) {
    const int fixed = it->w->g->count;
    for (int k = 1; k < fixed; k++) {
        const I settles = todo & not_of(it->settled) & WHERE(it->change < DM_SWEEP_SETTLED);
        if (some(settles)) settle_members(it, settles);
        sweep_members(it, k >= fixed - 2 ? todo : todo & not_of(it->settled));
        todo &= is_finite(it->change);
    }
    leave_end(it, todo);
    return todo;
}

/* until what is left is round-off; the lanes that need no other way */
INLINE I sweep_to_end(phase_sweeps *it, I todo) {
    const double enough = DM_SWEEP_LEFT * it->w->tolerance;
    const double slow = dm_phase_slow(it->w->g);
    I ended = {0};
    for (int k = 1; k < DM_PHASE_SWEEPS && some(todo); k++) {
        const I settles = todo & not_of(it->settled) & WHERE(it->change < DM_SWEEP_SETTLED);
        if (some(settles)) settle_members(it, settles);
        sweep_members(it, todo);
        todo &= is_finite(it->change);
        todo &= not_of(it->rated & WHERE(it->ratio > (it->count > 5 ? slow : 4.0)));
        const I now = todo & it->settled & WHERE(it->rate * it->change <= enough * enough);
        if (!some(now)) continue;
        leave_end(it, now);
        ended |= now;
        todo &= not_of(now);
    }
    return ended;
}

/* ---- the end ---- */

/* the state + h sum_j b_j u_j into next; the lanes where that is finite */
INLINE I finish_members(const phase_sweeps *it) {
    const dm_phase_lanes *w = it->w;
    const size_t n2 = 2 * (size_t)it->n;
    I fine = all_lanes();
    for (size_t k = 0; k < n2; k++) {
        V term[8];
        for (uint32_t m = 0; m < 8; m++) term[m] = (V){0};
        for (uint32_t m = 0; m < it->r; m++) {
            const V u = load(w->end + (m * n2 + k) * W);
            const V top = load(scaled_of(it, w->g->b.top + m));
            term[m] = top * u + load(scaled_of(it, w->g->b.rest + m)) * u;
        }
        V d = total_of(term, it->width);
        if (k < it->n || it->width > 1) d += (V){0};
        const V old = load(w->state + k * W), e = load(w->state + (n2 + k) * W) + d;
        const V sum = old + e, rest = e + (old - sum);
        store(w->next + k * W, sum);
        store(w->next + (n2 + k) * W, rest);
        fine &= is_finite(rest);
    }
    return fine;
}

/* the new state, and what is left to the next step */
INLINE void keep_members(const phase_sweeps *it, I where) {
    const dm_phase_lanes *w = it->w;
    const size_t n2 = 2 * (size_t)it->n;
    double *u = w->memory + (DM_SWEPT_END + 2 * n2) * W;
    put_where(where & it->rated, w->memory + DM_SWEPT_RATE * W, it->rate);
    for (size_t k = 0; k < 2 * n2; k++) {
        const V x = load(w->next + k * W);
        put_where(where, w->state + k * W, x);
        put_where(where, w->memory + (DM_SWEPT_END + k) * W, x);
    }
    for (size_t k = 0; k < n2; k++)
        for (uint32_t m = 0; m < it->r; m++)
            put_where(where, u + (k * it->width + m) * W, load(w->end + (m * n2 + k) * W));
}

HOW static uint32_t step_members(const dm_phase_lanes *w, uint32_t asked) {
    phase_sweeps it = {.w = w, .n = w->g->n, .r = w->g->r, .width = w->g->width};
    I todo = mask_of(asked) & has_swept(w);
    if (!some(todo)) return 0;
    it.settled = it.rated = mask_of(0);
    it.known = (V){0};
    it.change = same(1.0);
    set_off_members(&it);
    todo = w->g->count ? count_sweeps(&it, todo) : sweep_to_end(&it, todo);
    todo &= finish_members(&it);
    keep_members(&it, todo);
    return bits_of(todo);
}

#endif
