/* phase_lanes_sweep.h - where sweeps of W members of H begin, and one of them; a text, see
 * phase_lanes_step.h. */
#ifndef DM_PHASE_LANES_SWEEP_H
#define DM_PHASE_LANES_SWEEP_H

#include "integ/phase/phase_lanes_walk.h"

/* ---- a sweep ---- */

INLINE void evaluate_field(const phase_sweeps *it) {
    const dm_phase_lanes *w = it->w;
    const size_t in = (2 * (size_t)it->n + 1) * W, out = 2 * (size_t)it->n * W;
    for (uint32_t m = 0; m < it->r; m++) dm_kernel_eval(&w->field, w->x + m * in, w->u + m * out);
}

INLINE V relative_move(const phase_sweeps *it) {
    V r[2];
    for (int k = 0; k < 2; k++)
        r[k] = pick(WHERE(it->moved[k] > (V){0}), it->moved[k] * it->scale[k], it->moved[k]);
    return pick(WHERE(r[0] > r[1]), r[0], r[1]) + 0.0 * (r[0] + r[1]);
}

/* what the moves were, and with those of the sweep before it the rate, of the lanes of `where` */
INLINE void look_at(phase_sweeps *it, I where) {
    const V before = it->change, change = relative_move(it), count = same(it->count);
    const I again = where & WHERE(it->known == count - 1.0) & WHERE(count > 1.0);
    const I clean = WHERE(before <= DM_SWEEP_CLEAN) & WHERE(change <= 100.0 * DM_SWEEP_CLEAN);
    const V foretold = pick(again & clean, it->rate * before, change);
    const I told = again & not_of(clean);
    const V last = it->ratio;
    it->ratio = pick(told, change / before, last);
    it->rate = pick(told, pick(WHERE(it->ratio > last), it->ratio, last), it->rate);
    it->rated |= told;
    it->change = pick(where, foretold, it->change);
    it->known = pick(where, count, it->known);
}

INLINE void sweep_members(phase_sweeps *it, I looked) {
    it->count++;
    for (int k = 0; k < 2; k++) {
        const phase_walk a = walk_of(it, k);
        it->moved[k] = walk(it, &a, NULL);
    }
    evaluate_field(it);
    if (some(looked)) look_at(it, looked);
}

/* what the coefficients lack, into the bases */
INLINE void settle_members(phase_sweeps *it, I where) {
    for (int k = 0; k < 2; k++) {
        phase_walk a = walk_of(it, k);
        a.x = (double *)(uintptr_t)a.base;
        a.x_stage = 2 * (size_t)it->n * W;
        a.column = scaled_of(it, it->w->g->lacking[k]);
        a.start = a.unit = NULL;
        walk(it, &a, &where);
    }
    it->settled |= where;
}

/* ---- where it begins ---- */

/* lanes whose memory is that of the step that ended here */
INLINE I has_swept(const dm_phase_lanes *w) {
    const uint32_t n = w->g->n;
    I fits = WHERE(load(w->memory + DM_SWEPT_STEP * W) == load(w->h)) &
             WHERE(load(w->memory + DM_SWEPT_MARK * W) == (double)DM_SWEPT_FULL);
    for (uint32_t k = 0; k < 4 * n; k++)
        fits &= WHERE((I)load(w->memory + (DM_SWEPT_END + k) * W) == (I)load(w->state + k * W));
    return fits;
}

INLINE V square_at(const phase_sweeps *it, const phase_walk *a, uint32_t k) {
    const V x = load(a->start + k * W), y = load(a->x + (it->r - 1) * a->x_stage + k * W);
    return x * x + y * y;
}

/* the sum of these; units where rows of some lane are far apart, in others all 1 */
INLINE V measure_size(phase_sweeps *it, int p) {
    const phase_walk a = walk_of(it, p);
    double *unit = it->w->unit + (size_t)p * it->n * W;
    V size = {0}, least = same(INFINITY);
    for (uint32_t k = 0; k < it->n; k++) {
        const V own = square_at(it, &a, k);
        size += own;
        least = pick(WHERE(own > (V){0}) & WHERE(own < least), own, least);
    }
    const I apart = WHERE(DM_SWEEP_APART * least < size);
    it->has_units[p] = some(apart);
    const V mean = size / (double)it->n, zero = DM_SWEEP_ZERO * size;
    for (uint32_t k = 0; k < it->n && it->has_units[p]; k++) {
        const V own = square_at(it, &a, k);
        store(unit + k * W, pick(apart & WHERE(own > zero), mean / own, same(1.0)));
    }
    return size;
}

/* times, bases, and the first stages from those of the step before */
INLINE void set_off_members(phase_sweeps *it) {
    const dm_phase_lanes *w = it->w;
    const size_t n = it->n;
    const V zero = {0};
    for (uint32_t i = 0; i < it->r; i++) {
        store(w->x + (i * (2 * n + 1) + 2 * n) * W, w->t + load(scaled_of(it, w->g->after + i)));
        for (size_t k = 0; k < 2 * n; k++)
            store(w->base + (i * 2 * n + k) * W, zero + load(w->state + (2 * n + k) * W));
    }
    it->has_units[0] = it->has_units[1] = 0;
    for (int p = 0; p < 2; p++) {
        phase_walk a = walk_of(it, p);
        a.column = scaled_of(it, w->g->further[p]);
        a.u = w->memory + (DM_SWEPT_END + 4 * n + (size_t)p * n * it->width) * W;
        a.u_row = (size_t)it->width * W;
        a.u_stage = W;
        walk(it, &a, NULL);
    }
    for (int p = 0; p < 2; p++) it->scale[p] = 1.0 / measure_size(it, p);
    const V rate = 4.0 * load(w->memory + DM_SWEPT_RATE * W);
    it->rate = pick(WHERE(rate > DM_SWEEP_LEAST), rate, same(DM_SWEEP_LEAST));
    evaluate_field(it);
}

#endif
