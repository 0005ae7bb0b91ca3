/* lie_step_text.h - where a step in the natural chart of W members begins, its end and what it
 * leaves to the next one; a text for files that have numbers/lanes_text.h, which for one member is
 * lie.c. */
#ifndef DM_LIE_STEP_TEXT_H
#define DM_LIE_STEP_TEXT_H

#include "integ/lie/lie_text.h"

/* V, 2 V - V', 3 V - 3 V' + V'' ...: weights of the last steps in the polynomial through them */
static const double DM_LIE_AHEAD[DM_LIE_KEPT][DM_LIE_KEPT] = {{1},
                                                              {2, -1},
                                                              {3, -3, 1},
                                                              {4, -6, 4, -1},
                                                              {5, -10, 10, -5, 1}};

/* that of step k before the last one in lanes that have `count`; 0 where that is no such number */
INLINE V ahead_of(V count, int k) {
    V w = {0};
    for (int c = k; c < DM_LIE_KEPT; c++)
        w = pick(WHERE(count == (double)(c + 1)), same(DM_LIE_AHEAD[c][k]), w);
    return w;
}

/* V[i] of step k before the last one */
INLINE const double *kept_of(const dm_lie *e, int k, uint32_t i) {
    return e->memory + (2 + (size_t)k * e->m + i) * W;
}

/* V by the polynomial through all the steps that are kept, of every lane */
INLINE void extend_all(const dm_lie *e) {
    for (uint32_t i = 0; i < e->m; i++) {
        V x = {0};
        for (int k = 0; k < DM_LIE_KEPT; k++)
            x += DM_LIE_AHEAD[DM_LIE_KEPT - 1][k] * load(kept_of(e, k, i));
        store(e->V + i * W, x);
    }
}

/* Lanes that the polynomial does not lead much further than their last two steps went. Where an
 * oscillation takes few steps it does, 31 times as far as what alternates, and Newton's method
 * would find a root from there that turns the body elsewhere. */
INLINE I is_near(const dm_lie *e) {
    V most = {0}, ahead = {0};
    for (uint32_t i = 0; i < e->m; i++) {
        most = larger_of(magnitude(load(kept_of(e, 0, i))), most);
        most = larger_of(magnitude(load(kept_of(e, 1, i))), most);
        ahead = larger_of(magnitude(load(e->V + i * W)), ahead);
    }
    return WHERE(ahead <= 4.0 * most);
}

/* V by the polynomial through the last steps, node by node; the lanes that have some near */
INLINE I guess_ahead(const dm_lie *e) {
    const V count = load(e->memory);
    const I has = WHERE(count > (V){0}) & WHERE(load(e->memory + W) == load(e->h));
    if (!some(has)) return has;
    if (!some(not_of(has & WHERE(count == (double)DM_LIE_KEPT)))) {
        extend_all(e);
        return has & is_near(e);
    }
    for (uint32_t i = 0; i < e->m; i++) {
        V x = {0};
        for (int k = 0; k < DM_LIE_KEPT; k++) {
            const V y = x + ahead_of(count, k) * load(kept_of(e, k, i));
            x = pick(has & WHERE(count > (double)k), y, x);
        }
        store(e->V + i * W, x);
    }
    return has & is_near(e);
}

/* Steps of another length tell nothing of the next one. */
INLINE void keep_step(const dm_lie *e, I where) {
    double *last = e->memory + 2 * W;
    const V h = load(e->h), known = load(e->memory);
    const V count = pick(WHERE(load(e->memory + W) == h), known, (V){0});
    for (uint32_t i = DM_LIE_KEPT * e->m; i-- > e->m;)
        put_where(where, last + i * W, load(last + (i - e->m) * W));
    for (uint32_t i = 0; i < e->m; i++) put_where(where, last + i * W, load(e->V + i * W));
    put_where(where, e->memory, pick(WHERE(count < (double)DM_LIE_KEPT), count + 1.0, count));
    put_where(where, e->memory + W, h);
}

/* P and p0 + P at V from those of the last evaluation, at V - dx, to first order: what dx moves
 * them by is of one sign for many steps, and the energy would drift
 * (tests/lua/lie/test_lie_drift.lua) */
INLINE void correct_momenta(const dm_lie *e, const double *dx) {
    const uint32_t d = e->is_free ? 0 : e->d, m = e->m;
    for (uint32_t k = 0; k < d; k++) {
        const double *row = e->mu_V + (size_t)k * m * W;
        V sum = {0};
        for (uint32_t c = 0; c < m; c++) sum += load(row + c * W) * load(dx + c * W);
        add_to(e->gain + k * W, sum);
        add_to(e->mu + k * W, sum);
    }
}

/* g1 and p1, or their changes, into `end`, at V and its p0 + P */
INLINE void find_end(const dm_lie *e) {
    combine(e->xi, e, e->beta, load(e->h), e->V);
    copy_lanes(e->in, e->state, e->n);
    copy_lanes(e->in + e->n * W, e->xi, e->d);
    copy_lanes(e->in + (e->n + e->d) * W, e->mu, e->d);
    dm_kernel_eval(e->last, e->in, e->end);
}

/* the square of the largest angle of the end of the step */
INLINE V arc_of(const dm_lie *e) {
    V most = {0};
    for (uint32_t i = 0; i < e->group->arcs; i++)
        most = larger_of(load(e->end + (e->n + e->d + i) * W), most);
    return most;
}

/* lanes whose end is numbers */
INLINE I has_finite_end(const dm_lie *e) {
    I fine = all_lanes();
    for (uint32_t i = 0; i < e->n + e->d; i++) fine &= is_finite(load(e->end + i * W));
    return fine;
}

/* high + low += x */
INLINE void add_where(I where, double *high, double *low, V x) {
    const V a = load(high), e = load(low) + x, sum = a + e;
    put_where(where, low, e + (a - sum));
    put_where(where, high, sum);
}

/* from `end` into the state, q[n], p[n] and their low parts behind them; what the element gains in
 * a step is of size h */
INLINE void leave_end(const dm_lie *e, I where) {
    const uint32_t n = e->n, d = e->d;
    double *low = e->state + 2 * (size_t)n * W;
    for (uint32_t k = 0; k < n + d; k++) {
        const V x = load(e->end + k * W);
        if (e->last != &e->group->change)
            put_where(where, e->state + k * W, x);
        else
            add_where(where, e->state + k * W, low + k * W,
                      k < n ? x : load(e->gain + (k - n) * W) + x);
    }
}

#endif
