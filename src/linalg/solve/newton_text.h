/* newton_text.h - chord iterations of Newton's method for W systems side by side, x[unknown][lane];
 * a text for files that have numbers/lanes_text.h, which for one system is newton.c. A lane goes
 * on until its root is found or it needs another way; what it ended with stays as it is.
 * Long because when to end is one decision, by the largest unknown and then by smaller ones. */
#ifndef DM_NEWTON_TEXT_H
#define DM_NEWTON_TEXT_H

#include "linalg/solve/newton_limits.h"
#include "numbers/lanes_text.h"

enum { NEW = 2 }; /* iterations with a matrix that is no worse than that of the iterate */

/* how increments shrink, absolute or relative to what they are compared with */
typedef struct {
    V step, last; /* |dx| of this iteration and of the one before */
    V rate;       /* of the iteration before, 1 where it is not known */
} shrinking;

/* The own size of unknown i: |x_i|, which may pass through 0, and at least DM_NEWTON_BESIDE
 * |place[i % places]| / |over|. The last ones, `shared` of them, have none: the largest unknown is
 * their measure. */
typedef struct {
    const double *place; /* [places][W]; NULL: there is no other measure */
    uint32_t places;
    V over;
    uint32_t shared;
} own_sizes;

/* lanes that have settled by the largest unknown and wait for smaller ones */
typedef struct {
    int begun;      /* some lane has waited; before that the rest is not set */
    V waited;       /* iterations */
    shrinking each; /* the largest |dx_i| over the own size of unknown i */
} waiting;

typedef struct {
    double *x, *r;    /* [m][W] iterate, residual */
    double *dx;       /* [m][W] last increment of every lane */
    double tolerance; /* of it, relative */
    int factored;     /* a matrix was made; before that it is 1 */
    int count;        /* iterations */
    int exact, age;   /* is the matrix exact? Iterations with it */
    I todo;           /* lanes that go on */
    I fresh;          /* of them, those that take a new matrix */
    V residual;       /* max |r| */
    V terms;          /* size of the terms of r, to tell round-off; -1: not known */
    own_sizes own;
    shrinking all; /* |dx| of the largest unknown */
    int waited;    /* some lane has settled by the largest unknown before the smaller ones */
} chord;

/* r, residual and terms at x, and the matrix and its factors of the lanes that are fresh (`all`:
 * of all lanes); what does not go well leaves todo and fresh. The second: x = (matrix)^-1 x. Both
 * are constants where they are handed on, so that they are inlined. */
typedef void chord_evaluate(chord *it, void *ctx, uint32_t m, int all);
typedef void chord_solve(const chord *it, void *ctx, double *x, uint32_t m);

/* max |a|, NaN when there is one or an infinity; which is the largest cannot be foreseen, so
 * there are no branches */
INLINE V norm_of(const double *a, uint32_t m) {
    V largest = {0}, bad = {0};
#pragma GCC unroll 4
    for (uint32_t i = 0; i < m; i++) {
        const V size = magnitude(load(a + i * W));
        largest = larger_of(size, largest);
        bad += 0.0 * size;
    }
    return largest + bad;
}

/* the next |dx| */
INLINE void note_step(shrinking *a, V step) {
    const I known = WHERE(a->step < INFINITY) & WHERE(a->last < INFINITY);
    a->rate = pick(known, a->step / a->last, same(1.0));
    a->last = a->step;
    a->step = step;
}

/* dx = -(matrix)^-1 r */
INLINE void find_increment(chord *it, chord_solve *solve, void *ctx, uint32_t m) {
    double *dx = W == 1 ? it->dx : it->r; /* other lanes may have ended */
#pragma GCC unroll 4
    for (uint32_t i = 0; i < m; i++) store(dx + i * W, -load(it->r + i * W));
    solve(it, ctx, dx, m);
#pragma GCC unroll 4
    for (uint32_t i = 0; i < m && W > 1; i++) put_where(it->todo, it->dx + i * W, load(dx + i * W));
    note_step(&it->all, norm_of(it->dx, m));
    it->count++;
    it->age++;
}

/* The lanes where x + dx is the root to round-off: the error that dx leaves, rate * |dx|, does
 * not count. A first-order correction of results needs a matrix; without one |dx| itself must
 * stall, where it is `noise` at whatever size. By the rate so far, which one matrix does not lose
 * (from its first increment to the second it may double), what dx leaves may count for nothing,
 * too: what makes |dx| larger than foretold then is the noise of the residual, of which the next
 * one would be made as well. Of an exact matrix increments that small shrink fast while they are
 * more than noise: a new matrix would not help. */
INLINE I has_settled(const chord *it, const shrinking *a, V size, V left, V noise) {
    const V step = a->step, twice = 2.0 * a->rate;
    const V enough = DM_NEWTON_NEGLIGIBLE * it->tolerance * size;
    const I small = WHERE(step <= DM_NEWTON_ROUND_OFF * size);
    I last = WHERE(step == (V){0});
    if (it->factored) last |= WHERE(step <= it->tolerance * size);
    if (!some(it->todo & not_of(last))) return last;
    if (it->factored)
        last |= WHERE(twice < DM_NEWTON_SLOW) & small & WHERE(twice * twice * a->last <= enough);
    if (!some(it->todo & not_of(last))) return last;
    const V rate = pick(WHERE(a->last < INFINITY), step / a->last, same(DM_NEWTON_SLOW));
    last |= WHERE(rate < DM_NEWTON_SLOW) & WHERE(rate * step <= enough);
    last |= WHERE(rate > 0.5) & (small | WHERE(left <= noise));
    if (it->exact) last |= WHERE(rate > DM_NEWTON_SLOW) & WHERE(step <= DM_NEWTON_FLOOR * size);
    return last;
}

/* The lanes where some unknown is much smaller than the largest, `size`, and is not zero. */
INLINE I has_small_unknowns(const chord *it, uint32_t m, V size) {
    I some_are = mask_of(0);
    if (m == 1) return some_are;
#pragma GCC unroll 4
    for (uint32_t i = 0; i + it->own.shared < m; i++) {
        const V own = magnitude(load(it->x + i * W));
        some_are |= WHERE(DM_NEWTON_APART * own < size) & WHERE(own > (V){0});
    }
    return some_are;
}

/* max_i |dx_i| / (own size of unknown i) */
INLINE V own_step(const chord *it, uint32_t m) {
    const own_sizes *own = &it->own;
    const V share = DM_NEWTON_BESIDE / magnitude(own->over);
    V step = {0};
    for (uint32_t i = 0; i + own->shared < m; i++) {
        const V dx = magnitude(load(it->dx + i * W));
        V size = magnitude(load(it->x + i * W)) + dx;
        if (own->place) size += share * magnitude(load(own->place + i % own->places * W));
        step = larger_of(pick(WHERE(size > (V){0}), dx / size, (V){0}), step);
    }
    return step;
}

/* Of the lanes that have settled by the largest unknown and are `apart`, those that wait for a
 * smaller one, each judged by its own size. One that is the noise of larger ones never settles so:
 * lanes wait no longer than DM_NEWTON_PATIENCE, and not at all for what a new exact matrix leaves
 * as large as it was. The iteration is a copy, so that it itself may stay
 * in registers. */
HOW static __attribute__((noinline)) I find_waiting(chord it, waiting *w, uint32_t m, I apart) {
    if (!w->begun) *w = (waiting){1, (V){0}, {same(INFINITY), same(INFINITY), same(1.0)}};
    shrinking now = w->each;
    note_step(&now, own_step(&it, m));
    V left = DM_NEWTON_PATIENCE - w->waited; /* iterations */
    if (it.exact && it.age <= NEW) left = (V){0};
    const I waits = apart & not_of(has_settled(&it, &now, same(1.0), left, (V){0}));
    w->waited += pick(waits, same(1.0), (V){0});
    w->each.step = pick(waits, now.step, w->each.step);
    w->each.last = pick(waits, now.last, w->each.last);
    w->each.rate = pick(waits, now.rate, w->each.rate);
    return waits;
}

/* The lanes where all unknowns have settled; waits: where the largest has. */
INLINE I is_last(chord *it, waiting *w, uint32_t m, I *waits) {
    const V size = norm_of(it->x, m) + it->all.step;
    const V noise = DM_NEWTON_NOISE * it->terms;
    const I last = it->todo & has_settled(it, &it->all, size, it->residual, noise);
    *waits = mask_of(0);
    if (!some(last)) return last;
    const I apart = last & has_small_unknowns(it, m, size);
    if (!some(apart)) return last;
    *waits = find_waiting(*it, w, m, apart);
    it->waited |= some(*waits);
    return last & not_of(*waits);
}

INLINE void advance_iterates(const chord *it, uint32_t m) {
#pragma GCC unroll 4
    for (uint32_t i = 0; i < m; i++) {
        const V x = load(it->x + i * W);
        store(it->x + i * W, pick_some(it->todo, x + load(it->dx + i * W), x));
    }
}

/* Back to where it began, of which no increment is known: those of a matrix of 1 that led away,
 * without bound, would make the next one look like fast convergence. */
INLINE void begin_again(chord *it, waiting *w, uint32_t m, const double *start) {
    for (uint32_t i = 0; i < m; i++) store(it->x + i * W, load(start + i * W));
    it->all = (shrinking){same(INFINITY), same(INFINITY), same(1.0)};
    w->begun = 0;
}

/* The lanes that end at a root; the others need damping. One matrix serves while increments
 * shrink by ten or more. start[m]: where x goes back to when a matrix of 1 leads away; NULL:
 * there is none such. */
INLINE I iterate_chord(chord *it, chord_evaluate *evaluate, chord_solve *solve, void *ctx,
                       uint32_t m, int most, const double *start) {
    I ended = mask_of(0);
    waiting w;
    w.begun = 0;
    it->all = (shrinking){same(INFINITY), same(INFINITY), same(1.0)};
    it->count = 0;
    evaluate(it, ctx, m, 1);
    while (it->count < most && some(it->todo)) {
        find_increment(it, solve, ctx, m);
        it->todo &= is_finite(it->all.step);
        if (!some(it->todo)) break;
        I waits;
        const I last = is_last(it, &w, m, &waits);
        advance_iterates(it, m);
        ended |= last;
        it->todo &= not_of(last);
        I slow = it->todo & WHERE(it->all.step > DM_NEWTON_SLOW * it->all.last);
        I worse = WHERE(it->all.step > it->all.last);
        if (some(waits)) {
            slow = (slow & not_of(waits)) |
                   (waits & WHERE(w.each.step > DM_NEWTON_SLOW * w.each.last));
            worse &= not_of(waits);
        }
        it->todo &= not_of(it->fresh & slow & worse);
        it->fresh = slow & it->todo;
        if (!some(it->todo)) break;
        if (start && !it->factored && some(worse)) begin_again(it, &w, m, start);
        evaluate(it, ctx, m, 0);
    }
    return ended;
}

#endif
