/* stage_lanes_sweep.h - a step by sweeps for W members, as stage_sweep.c makes it for one; a
 * text for the files of stage_lanes.h. Sums over stages have the order that sweep_row.h has for
 * as many stages; stages that this fills up with are left out. */
#ifndef DM_STAGE_LANES_SWEEP_H
#define DM_STAGE_LANES_SWEEP_H

#include "integ/stage/lanes/stage_lanes_evaluate.h"

/* lanes that have all pivots of the mass matrix positive */
INLINE I regular_lanes(const lanes_sweeps *it) {
    I fine = all_lanes();
    for (uint32_t m = 0; m < it->r && !it->w->g->separable; m++)
        for (uint32_t k = 0; k < it->n; k++) {
            const V pivot = load(it->w->sweeps.factored + m * factored(it) + k * W);
            fine &= WHERE(pivot > DM_PIVOT_LEAST) & WHERE(pivot < DM_PIVOT_MOST);
        }
    return fine;
}

/* what the step ends with, of the lanes of `where` */
INLINE void leave_ends(const lanes_sweeps *it, I where, V *rate) {
    const dm_stage_lanes *w = it->w;
    size_t u_stage;
    const double *u = unknowns_of(it, &u_stage);
    for (uint32_t m = 0; m < it->r; m++)
        for (uint32_t k = 0; k < it->n; k++) {
            const size_t at = (m * it->n + k) * W;
            put_where(where, w->sweeps.end_u + at, load(u + m * u_stage + k * W));
            put_where(where, w->sweeps.end_f + at, load(w->sweeps.out + m * given(it) + k * W));
        }
    const V kept = load(w->group.memory + DM_SWEPT_RATE * W);
    *rate = pick(where, pick(it->rated, it->rate, kept), *rate);
}

/* so many evaluations; the lanes that are regular */
INLINE I count_out_lanes(lanes_sweeps *it, I todo, V *rate) {
    const int fixed = it->w->g->sweeps->count;
    it->measured = 0;
    evaluate_first(it);
    for (int k = 1; k < fixed; k++) {
        it->measured = k == fixed - 1;
        sweep_lanes(it);
    }
    todo &= regular_lanes(it);
    leave_ends(it, todo, rate);
    return todo;
}

/* until all lanes are settled to round-off or need another way; those that are */
INLINE I iterate_lanes(lanes_sweeps *it, I todo, V *rate) {
    const double enough = DM_SWEEP_LEFT * it->w->group.tolerance;
    I ended = {0};
    it->measured = 1;
    evaluate_first(it);
    for (int k = 1; k < DM_STAGE_SWEEPS && some(todo); k++) {
        const I settles = todo & not_of(it->settled) & WHERE(it->change < DM_SWEEP_SETTLED);
        if (some(settles)) settle_lanes(it, settles);
        sweep_lanes(it);
        const double most = it->count > 5 ? DM_SWEEP_SLOW : 4.0;
        todo &= is_finite(it->change) & ~(it->rated & WHERE(it->rate > most));
        const I now = todo & it->settled & WHERE(it->rate * it->change <= enough * enough);
        if (!some(now)) continue;
        const I fine = now & regular_lanes(it);
        leave_ends(it, fine, rate);
        ended |= fine;
        todo &= ~now;
    }
    return ended;
}

INLINE I finish_sweeps(const lanes_sweeps *it) {
    const dm_stage_lanes *w = it->w;
    const dm_sweep_end *one = &w->g->sweeps->end;
    const uint32_t n = it->n, width = it->width;
    I fine = all_lanes();
    for (uint32_t k = 0; k < n; k++) {
        V q[8], p[8];
#pragma GCC unroll 8
        for (uint32_t m = 0; m < 8; m++) q[m] = p[m] = (V){0};
#pragma GCC unroll 8
        for (uint32_t m = 0; m < it->r; m++) {
            const size_t at = (m * n + k) * W;
            const V u = load(w->sweeps.end_u + at), f = load(w->sweeps.end_f + at);
            q[m] = scaled(&w->group, one->b[0]->top + m) * u +
                   scaled(&w->group, one->b[0]->rest + m) * u;
            p[m] = scaled(&w->group, one->b[1]->top + m) * f +
                   scaled(&w->group, one->b[1]->rest + m) * f;
        }
        const V drift = w->g->separable ? load(w->sweeps.drift + k * W) : (V){0};
        const V dq = total_of(q, width) * one->factor[k] + drift;
        fine &= add_to_next(&w->group, n, k, dq);
        fine &= add_to_next(&w->group, n, n + k, total_of(p, width) + (V){0});
    }
    return fine;
}

/* lanes whose memory is that of the step that ended here */
INLINE I swept_before(const dm_stage_lanes *w) {
    const uint32_t n = w->g->n;
    I fits = WHERE(load(w->group.memory + DM_SWEPT_STEP * W) == load(w->group.h)) &
             WHERE(load(w->group.memory + DM_SWEPT_MARK * W) == (double)DM_SWEPT_FULL);
    for (uint32_t k = 0; k < 4 * n; k++)
        fits &= WHERE((I)load(w->group.memory + (DM_SWEPT_END + k) * W) ==
                      (I)load(w->group.state + k * W));
    return fits;
}

/* the new state, and what is left to the next step */
INLINE void keep_sweeps(const lanes_sweeps *it, I where, V rate) {
    const dm_stage_lanes *w = it->w;
    const uint32_t n = it->n;
    double *u = w->group.memory + (DM_SWEPT_END + 4 * n) * W;
    put_where(where, w->group.memory + DM_SWEPT_RATE * W, rate);
    for (uint32_t k = 0; k < 4 * n; k++) {
        put_where(where, w->group.state + k * W, load(w->group.next + k * W));
        put_where(where, w->group.memory + (DM_SWEPT_END + k) * W, load(w->group.next + k * W));
    }
    for (uint32_t k = 0; k < n; k++)
        for (uint32_t m = 0; m < it->r; m++)
            put_where(where, u + (k * it->width + m) * W, load(w->sweeps.end_u + (m * n + k) * W));
}

HOW static uint32_t step_by_sweeps(const dm_stage_lanes *w, uint32_t asked) {
    const dm_stage *g = w->g;
    lanes_sweeps it = {.w = w,
                       .n = g->n,
                       .r = g->table.r,
                       .width = g->sweeps->row->width,
                       .change = same(1.0)};
    I todo = mask_of(asked) & swept_before(w);
    V rate = {0};
    if (!some(todo)) return 0;
    todo &= prepare_sweeps(&it);
    todo = g->sweeps->count ? count_out_lanes(&it, todo, &rate) : iterate_lanes(&it, todo, &rate);
    todo &= finish_sweeps(&it);
    keep_sweeps(&it, todo, rate);
    return bits_of(todo);
}

#endif
