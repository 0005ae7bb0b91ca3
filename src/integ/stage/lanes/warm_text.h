/* warm_text.h - where Newton's method of W members begins, and what it leaves to the next step, as
 * stage_warm.h says; a text for files that have numbers/lanes_text.h, which for one member is
 * stage_newton.c. */
#ifndef DM_WARM_TEXT_H
#define DM_WARM_TEXT_H

#include "integ/stage/lanes/equation_text.h"

/* to[s][n] = V of the next step by the polynomial of the last one */
INLINE void continue_polynomial(const step_equation *e, double *to, const double *before) {
    const uint32_t n = e->n, s = e->s;
#pragma GCC unroll 4
    for (uint32_t i = 0; i < s; i++)
#pragma GCC unroll 4
        for (uint32_t k = 0; k < n; k++) {
            V sum = s == 1 ? load(before + k * W) : (V){0};
#pragma GCC unroll 4
            for (uint32_t j = 0; j < s && s > 1; j++)
                sum += e->g->ahead[i * s + j] * load(before + (j * n + k) * W);
            store(to + (i * n + k) * W, sum);
        }
}

/* to += D of differences [TERMS][size], of which every lane has `count`: so many in any case, then
 * as long as adding one would have brought the last step much nearer. What was missing then is the
 * difference behind it */
INLINE void add_missed(double *to, const double *D, V count, int at_least, size_t size) {
    I wants = WHERE(count > (V){0});
    V missing = largest_of(D, size);
    for (int i = 0; i < DM_WARM_TERMS; i++, D += size * W) {
        const I is_inner = WHERE(count > (double)(i + 1));
        V left = missing;
        if (i + 1 < DM_WARM_TERMS) left = pick(is_inner, largest_of(D + size * W, size), missing);
        wants &= WHERE(count > (double)i);
        if (i >= at_least) wants &= WHERE(left <= DM_WARM_NEARER * missing);
        if (!some(wants)) return;
#pragma GCC unroll 4
        for (size_t k = 0; k < size; k++) {
            const V x = load(to + k * W);
            store(to + k * W, pick_some(wants, x + load(D + k * W), x));
        }
        missing = left;
    }
}

/* root[s][n] from the steps before; the lanes that have some */
INLINE I guess_velocities(const step_equation *e) {
    const double *memory = e->group->memory, *before = memory + (DM_WARM_END + 4 * e->n) * W;
    const size_t size = (size_t)e->s * e->n;
    const I has = goes_on(e->group, e->n);
    if (!some(has)) return has;
    continue_polynomial(e, e->at->root, before);
    add_missed(e->at->root, before + size * W, load(memory + DM_WARM_COUNT * W) - 1.0,
               e->s == 1 ? DM_WARM_PARABOLA : 0, size);
    return has;
}

/* the differences of a step more. Behind those that a lane has yet are numbers that no step reads
 * before they are renewed. */
INLINE void renew_differences(const step_equation *e, I where, double *before) {
    const size_t size = (size_t)e->s * e->n;
    const double *guess = e->at->missed;
    continue_polynomial(e, e->at->missed, before);
#pragma GCC unroll 4
    for (size_t k = 0; k < size; k++) {
        double *D = before + (size + k) * W;
        V missed = load(e->at->root + k * W) - load(guess + k * W);
#pragma GCC unroll 4
        for (int i = 0; i < DM_WARM_TERMS; i++, D += size * W) {
            const V now = missed;
            missed -= load(D);
            put_where(where, D, now);
        }
    }
}

/* what is left to the next step by a step from the memory, in the lanes of `where`; known: its
 * memory is of the step before it, else it is the first */
INLINE void keep_velocities(const step_equation *e, I where, I known) {
    const dm_stage_group *x = e->group;
    double *count = x->memory + DM_WARM_COUNT * W, *end = x->memory + DM_WARM_END * W;
    double *before = end + 4 * e->n * W;
    const V number = pick(known, load(count), (V){0}), most = same(DM_WARM_TERMS);
    if (some(known)) renew_differences(e, where, before);
    put_where(where, count, pick(WHERE(number <= most), number, most) + 1.0);
    copy_where(where, before, e->at->root, e->s * e->n);
    copy_where(where, end, x->next, 4 * e->n);
}

#endif
