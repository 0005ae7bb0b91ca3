/* newton_text.h - chord iterations of Newton's method for W systems side by side, x[unknown][lane];
 * a text for files that have numbers/lanes_text.h, which for one system is newton.c. A lane goes
 * on until its root is found or it needs another way; what it ended with stays as it is. */
#ifndef DM_NEWTON_TEXT_H
#define DM_NEWTON_TEXT_H

#include "linalg/solve/newton_limits.h"
#include "numbers/lanes_text.h"

typedef struct {
    double *x, *r;    /* [m][W] iterate, residual */
    double *dx;       /* [m][W] last increment of every lane */
    double tolerance; /* of it, relative */
    int factored;     /* a matrix was made; before that it is 1 */
    int count;        /* iterations */
    I todo;           /* lanes that go on */
    I fresh;          /* of them, those that take a new matrix */
    V residual;       /* max |r| */
    V terms;          /* size of the terms of r, to tell round-off; -1: not known */
    V step, last;     /* |dx| of this iteration and of the one before */
    V rate;           /* of the iteration before, 1 where it is not known */
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

/* dx = -(matrix)^-1 r */
INLINE void find_increment(chord *it, chord_solve *solve, void *ctx, uint32_t m) {
    double *dx = W == 1 ? it->dx : it->r; /* other lanes may have ended */
#pragma GCC unroll 4
    for (uint32_t i = 0; i < m; i++) store(dx + i * W, -load(it->r + i * W));
    solve(it, ctx, dx, m);
#pragma GCC unroll 4
    for (uint32_t i = 0; i < m && W > 1; i++) put_where(it->todo, it->dx + i * W, load(dx + i * W));
    const I known = WHERE(it->step < INFINITY) & WHERE(it->last < INFINITY);
    it->rate = pick(known, it->step / it->last, same(1.0));
    it->last = it->step;
    it->step = norm_of(it->dx, m);
    it->count++;
}

/* The lanes where x + dx is the root to round-off: the error that dx leaves, rate * |dx|, does
 * not count. A first-order correction of results needs a matrix; without one |dx| itself must
 * stall, or the residual be what rounding its terms leaves. By the rate so far, which one matrix
 * does not lose (from its first increment to the second it may double), what dx leaves may count
 * for nothing, too: what makes |dx| larger than foretold then is the noise of the residual, of
 * which the next one would be made as well. */
INLINE I is_last(const chord *it, uint32_t m) {
    const V step = it->step, size = norm_of(it->x, m) + step, twice = 2.0 * it->rate;
    const V enough = DM_NEWTON_NEGLIGIBLE * it->tolerance * size;
    const I small = WHERE(step <= DM_NEWTON_ROUND_OFF * size);
    I last = WHERE(step == (V){0});
    if (it->factored) last |= WHERE(step <= it->tolerance * size);
    if (!some(it->todo & not_of(last))) return last;
    if (it->factored)
        last |= WHERE(twice < DM_NEWTON_SLOW) & small & WHERE(twice * twice * it->last <= enough);
    if (!some(it->todo & not_of(last))) return last;
    const V rate = pick(WHERE(it->last < INFINITY), step / it->last, same(DM_NEWTON_SLOW));
    last |= WHERE(rate < DM_NEWTON_SLOW) & WHERE(rate * step <= enough);
    last |= WHERE(rate > 0.5) & (small | WHERE(it->residual <= DM_NEWTON_NOISE * it->terms));
    return last;
}

INLINE void advance_iterates(const chord *it, uint32_t m) {
#pragma GCC unroll 4
    for (uint32_t i = 0; i < m; i++) {
        const V x = load(it->x + i * W);
        store(it->x + i * W, pick_some(it->todo, x + load(it->dx + i * W), x));
    }
}

/* The lanes that end at a root; the others need damping. One matrix serves while increments
 * shrink by ten or more. start[m]: where x goes back to when a matrix of 1 leads away; NULL:
 * there is none such. */
INLINE I iterate_chord(chord *it, chord_evaluate *evaluate, chord_solve *solve, void *ctx,
                       uint32_t m, int most, const double *start) {
    I ended = mask_of(0);
    it->step = it->last = same(INFINITY);
    it->count = 0;
    evaluate(it, ctx, m, 1);
    while (it->count < most && some(it->todo)) {
        find_increment(it, solve, ctx, m);
        it->todo &= is_finite(it->step);
        if (!some(it->todo)) break;
        const I last = it->todo & is_last(it, m);
        advance_iterates(it, m);
        ended |= last;
        it->todo &= not_of(last);
        const I slow = it->todo & WHERE(it->step > DM_NEWTON_SLOW * it->last);
        const I worse = WHERE(it->step > it->last);
        it->todo &= not_of(it->fresh & slow & worse);
        it->fresh = slow & it->todo;
        if (!some(it->todo)) break;
        if (start && !it->factored && some(worse))
            for (uint32_t i = 0; i < m; i++) store(it->x + i * W, load(start + i * W));
        evaluate(it, ctx, m, 0);
    }
    return ended;
}

#endif
