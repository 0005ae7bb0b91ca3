/* phase_lanes_step.h - a step by sweeps for W members, as phase_sweep.c makes it for one; a text
 * for the files of phase_lanes.h. */
#ifndef DM_PHASE_LANES_STEP_H
#define DM_PHASE_LANES_STEP_H

#include "integ/phase/phase_lanes.h"
#include "integ/stage/sweep/sums_text.h"

typedef struct {
    const dm_phase_lanes *w;
    uint32_t n, r, width;
    int count, measured; /* sweeps; is what they change looked at? */
    int has_units[2];
    I settled, rated;
    V known, change, rate, scale[2], moved[2];
} phase_sweeps;

/* ---- sums over stages ---- */

/* rows first .. first + n - 1 of x = start + (base + sum_m column_m u_m) at every stage; u of entry
 * k and stage m at k u_row + m u_stage */
typedef struct {
    double *x;
    const double *base, *column, *u, *start; /* start NULL: zero */
    size_t x_stage, u_row, u_stage;
    const double *unit; /* [n] by which moves count; NULL: all are 1 */
} phase_walk;

/* even and odd columns are summed apart, the even ones on to the base */
INLINE V weigh_stages(const double *column, uint32_t width, const V *u, V base, uint32_t r) {
    const int fused = DM_LANES_FUSED && r > 1;
    V even = madd(same(column[0]), u[0], base, fused), odd;
    if (r == 1) return even;
    odd = column[width] * u[1];
#pragma GCC unroll 8
    for (uint32_t m = 2; m < r; m += 2) {
        even = madd(same(column[m * width]), u[m], even, fused);
        if (m + 1 < r) odd = madd(same(column[(m + 1) * width]), u[m + 1], odd, fused);
    }
    return even + odd;
}

/* the sum of squares of the moves, r is a constant where this is called; lanes that are not in
 * `where` keep x */
INLINE V walk_rows(const phase_sweeps *it, const phase_walk *a, const I *where, uint32_t r) {
    const int fused = DM_LANES_FUSED && r > 1;
    const uint32_t n = it->n, width = it->width;
    const phase_walk at = *a; /* nothing of it changes by what is written */
    V moved[8], u[8];
#pragma GCC unroll 8
    for (uint32_t i = 0; i < 8; i++) moved[i] = u[i] = (V){0};
    for (uint32_t k = 0; k < n; k++) {
        const V start = at.start ? load(at.start + k * W) : (V){0};
#pragma GCC unroll 8
        for (uint32_t m = 0; m < r; m++) u[m] = load(at.u + k * at.u_row + m * at.u_stage);
#pragma GCC unroll 8
        for (uint32_t i = 0; i < r; i++) {
            double *x = at.x + i * at.x_stage + k * W;
            const V base = load(at.base + (i * 2 * n + k) * W), old = load(x);
            const V now = start + weigh_stages(at.column + i, width, u, base, r);
            V d = now - old;
            if (at.unit) d *= load(at.unit + k * W);
            moved[i] = madd(d, d, moved[i], fused);
            store(x, where ? pick(*where, now, old) : now);
        }
    }
    return moved_of(moved, width);
}

/* few stages are written out */
HOW static V walk(const phase_sweeps *it, const phase_walk *a, const I *where) {
    if (it->r == 1) return walk_rows(it, a, where, 1);
    if (it->r == 2) return walk_rows(it, a, where, 2);
    if (it->r == 3) return walk_rows(it, a, where, 3);
    if (it->r == 4) return walk_rows(it, a, where, 4);
    if (it->r == 8) return walk_rows(it, a, where, 8);
    return walk_rows(it, a, where, it->r);
}

/* of q (p = 0) or p in a sweep */
INLINE phase_walk walk_of(const phase_sweeps *it, int p) {
    const dm_phase_lanes *w = it->w;
    const size_t n = it->n, at = (size_t)p * n * W;
    return (phase_walk){.x = w->x + at,
                        .base = w->base + at,
                        .column = w->g->whole[p],
                        .u = w->u + at,
                        .start = w->state + at,
                        .x_stage = (2 * n + 1) * W,
                        .u_row = W,
                        .u_stage = 2 * n * W,
                        .unit = it->has_units[p] ? w->unit + at : NULL};
}

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
    it->rate = pick(again & not_of(clean), change / before, it->rate);
    it->rated |= again & not_of(clean);
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
        a.column = it->w->g->lacking[k];
        a.start = a.unit = NULL;
        walk(it, &a, &where);
    }
    it->settled |= where;
}

/* ---- where it begins ---- */

/* lanes whose memory is that of the step that ended here */
INLINE I has_swept(const dm_phase_lanes *w) {
    const uint32_t n = w->g->n;
    I fits = WHERE(load(w->memory + DM_SWEPT_STEP * W) == w->g->h) &
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
    for (uint32_t k = 0; k < it->n && it->has_units[p]; k++) {
        const V own = square_at(it, &a, k);
        for (uint32_t l = 0; l < W; l++)
            unit[k * W + l] = apart[l] ? dm_sweep_unit(size[l], own[l]) : 1.0;
    }
    return size;
}

/* times, bases, and the first stages from those of the step before */
INLINE void set_off_members(phase_sweeps *it) {
    const dm_phase_lanes *w = it->w;
    const size_t n = it->n;
    for (uint32_t i = 0; i < it->r; i++) {
        store(w->x + (i * (2 * n + 1) + 2 * n) * W, same(w->t + dm_weight_double(w->g->hc[i])));
        for (size_t k = 0; k < 2 * n; k++)
            store(w->base + (i * 2 * n + k) * W, (V){0} + load(w->state + (2 * n + k) * W));
    }
    it->has_units[0] = it->has_units[1] = 0;
    for (int p = 0; p < 2; p++) {
        phase_walk a = walk_of(it, p);
        a.column = w->g->further[p];
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
        todo &= not_of(it->rated & WHERE(it->rate > (it->count > 5 ? slow : 4.0)));
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
            term[m] = w->g->b.top[m] * u + w->g->b.rest[m] * u;
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
