/*
** stage_lanes_newton.h - a step of the general form by chord iterations for W members, as stage.c, stage_warm.c and
** solve/newton.c make it for one; a text for the files of stage_lanes.h.
*/
#ifndef DM_STAGE_LANES_NEWTON_H
#define DM_STAGE_LANES_NEWTON_H

#include "base/lanes_text.h"
#include "integ/stage_lanes_text.h"
#include "linalg/lu_lanes_text.h"
#include "solve/newton_limits.h"

#include <math.h>

typedef struct {
    const dm_stage_lanes *w;
    uint32_t n, s, r, m; /* m = s n unknowns */
    I todo, fresh;       /* lanes that go on, that renew their matrix */
    V step, last, rate, residual, terms;
} lanes_newton;

INLINE size_t curve_size(uint32_t n) {
    return (2 * (size_t)n + 3 * (size_t)n * n) * W;
}

/* sum += w x */
INLINE V add_weighted(V sum, dm_weight w, V x) {
    return sum + (w.top * x + w.rest * x);
}

/* max |a|, NaN where there is one or an infinity */
INLINE V norm_of(const double *a, uint32_t m) {
    V largest = {0}, bad = {0};
    for (uint32_t i = 0; i < m; i++) {
        const V size = magnitude(load(a + i * W));
        largest = larger_of(size, largest);
        bad += 0.0 * size;
    }
    return largest + bad;
}

/* ---- the guess ---- */

/* to[s][n] = V of the next step by the polynomial of the last one */
INLINE void continue_lanes(const dm_stage_lanes *w, double *to, const double *before) {
    const uint32_t n = w->g->n, s = w->g->table.s;
    for (uint32_t i = 0; i < s; i++)
        for (uint32_t k = 0; k < n; k++) {
            V sum = s == 1 ? load(before + k * W) : (V){0};
            for (uint32_t j = 0; j < s && s > 1; j++)
                sum += w->g->ahead[i * s + j] * load(before + (j * n + k) * W);
            store(to + (i * n + k) * W, sum);
        }
}

INLINE V largest_of_lanes(const double *a, size_t size) {
    V largest = {0};
    for (size_t k = 0; k < size; k++)
        largest = larger_of(magnitude(load(a + k * W)), largest);
    return largest;
}

/* to += differences, as many as each lane has and wants */
INLINE void add_missed_lanes(double *to, const double *D, V count, double at_least,
                             size_t size) {
    I wants = (I)(count > (V){0});
    V missing = largest_of_lanes(D, size);
    for (int i = 0; i < DM_WARM_TERMS; i++, D += size * W) {
        const I is_inner = (I)(count > (double)(i + 1));
        V left = missing;
        if (i + 1 < DM_WARM_TERMS)
            left = pick(is_inner, largest_of_lanes(D + size * W, size), missing);
        wants &= (I)(count > (double)i);
        if (i >= at_least) wants &= (I)(left <= DM_WARM_NEARER * missing);
        if (!bits_of(wants)) return;
        for (size_t k = 0; k < size; k++) {
            const V x = load(to + k * W);
            store(to + k * W, pick(wants, x + load(D + k * W), x));
        }
        missing = left;
    }
}

/* root[s][n] from the steps before; the lanes that have some */
INLINE I guess_lanes(const dm_stage_lanes *w) {
    const dm_stage *g = w->g;
    const uint32_t n = g->n, size = g->table.s * n;
    const double *end = w->memory + DM_WARM_END * W, *before = end + 4 * n * W;
    const V count = load(w->memory + DM_WARM_COUNT * W);
    I has = (I)(load(w->memory + DM_WARM_STEP * W) == g->h) & (I)(count > (V){0});
    for (uint32_t k = 0; k < 4 * n; k++)
        has &= (I)(load(end + k * W) == load(w->state + k * W));
    if (!bits_of(has)) return has;
    continue_lanes(w, w->root, before);
    add_missed_lanes(w->root, before + size * W, count - 1.0,
                     g->table.s == 1 ? DM_WARM_PARABOLA : 0, size);
    return has;
}

/* ---- the equation ---- */

/* arguments of the kernels at point i */
INLINE void place_lanes(const lanes_newton *it, uint32_t i) {
    const dm_stage_lanes *w = it->w;
    const dm_stage *g = w->g;
    const uint32_t n = it->n, s = it->s;
    for (uint32_t k = 0; k < n; k++) {
        V shift = {0}, v = {0};
        for (uint32_t j = 0; j < s; j++) {
            const V root = load(w->root + (j * n + k) * W);
            shift = add_weighted(shift, g->ha[i * s + j], root);
            if (g->table.d[i * s + j].top != 0.0)
                v = add_weighted(v, g->table.d[i * s + j], root);
        }
        store(w->x + k * W,
              load(w->state + k * W) + (load(w->state + (2 * n + k) * W) + shift));
        store(w->x + (n + k) * W, v);
    }
    store(w->x + 2 * n * W, same(w->t + dm_weight_double(g->hc[i])));
}

INLINE void copy_where(I yes, double *to, const double *from, size_t count) {
    for (size_t k = 0; k < count; k++) put_where(yes, to + k * W, load(from + k * W));
}

/* slopes of the lanes that go on, second derivatives of those that renew their matrix; all: these are all lanes */
INLINE void evaluate_lanes(const lanes_newton *it, int all) {
    const dm_stage_lanes *w = it->w;
    const I chord = it->todo & ~it->fresh;
    const size_t curve = curve_size(it->n), slope = 2 * (size_t)it->n;
    const uint32_t renews = bits_of(it->fresh), keeps = bits_of(chord);
    for (uint32_t i = 0; i < it->r; i++) {
        double *own = w->curve + i * curve, *slopes = w->slopes + i * slope * W;
        place_lanes(it, i);
        if (renews) dm_kernel_eval(&w->stage, w->x, all ? own : w->other);
        if (renews && !all) copy_where(it->fresh, own, w->other, curve / W);
        if (renews) copy_where(it->fresh, slopes, own, slope);
        if (keeps) dm_kernel_eval(&w->slope, w->x, w->other + curve);
        if (keeps) copy_where(chord, slopes, w->other + curve, slope);
    }
}

/* R_j = sum_i b_i [h (a_ij - beta_j) L_q(i) + d_ij L_v(i)] - beta_j p0 */
INLINE void find_residual(lanes_newton *it) {
    const dm_stage_lanes *w = it->w;
    const dm_stage *g = w->g;
    const uint32_t n = it->n, s = it->s;
    it->terms = (V){0};
    for (uint32_t j = 0; j < s; j++)
        for (uint32_t k = 0; k < n; k++) {
            const dm_weight beta = g->table.beta[j];
            const V p0 = load(w->state + (n + k) * W),
                    low = load(w->state + (3 * n + k) * W);
            V sum = {0};
            for (uint32_t i = 0; i < it->r; i++) {
                const double *slope = w->slopes + (i * 2 * n + k) * W;
                const dm_weight wq = g->wq[i * s + j], wv = g->wv[i * s + j];
                const V q = load(slope), v = load(slope + n * W);
                const V term = (wq.top * q + wq.rest * q) + (wv.top * v + wv.rest * v);
                sum += term;
                it->terms = larger_of(magnitude(term), it->terms);
            }
            sum = (sum - (beta.top * p0 + beta.rest * p0)) - beta.top * low;
            store(w->r + (j * n + k) * W, sum);
        }
    it->residual = norm_of(w->r, it->m);
}

/* a block of the matrix += its part from point i */
INLINE void add_block_lanes(const lanes_newton *it, double *block, const double c[4],
                            int half, const double *A) {
    const uint32_t n = it->n;
    const double *B = A + n * n * W, *C = B + n * n * W;
    for (uint32_t i = 0; i < n; i++)
        for (uint32_t j = 0; j < n; j++) {
            const size_t at = (i * n + j) * W;
            double *to = block + (i * (size_t)it->m + j) * W;
            if (half) {
                store(to, load(to) +
                              (c[0] * load(A + at) + c[2] * load(B + (j * n + i) * W)));
                continue;
            }
            const V mixed = c[1] * load(B + at) + c[2] * load(B + (j * n + i) * W);
            store(to, load(to) + ((c[0] * load(A + at) + c[3] * load(C + at)) + mixed));
        }
}

/* dR_j/dV_k, as in stage.c */
INLINE void find_matrix(const lanes_newton *it, double *J) {
    const dm_stage *g = it->w->g;
    const uint32_t n = it->n, s = it->s;
    for (size_t k = 0; k < (size_t)it->m * it->m; k++) store(J + k * W, (V){0});
    for (uint32_t i = 0; i < it->r; i++) {
        const double *second = it->w->curve + i * curve_size(n) + 2 * n * W;
        for (uint32_t j = 0; j < s; j++)
            for (uint32_t k = 0; k < s; k++) {
                const double wq = dm_weight_double(g->wq[i * s + j]);
                const double wv = dm_weight_double(g->wv[i * s + j]);
                const double ha = dm_weight_double(g->ha[i * s + k]);
                const double d = dm_weight_double(g->table.d[i * s + k]);
                const double c[4] = {wq * ha, wq * d, wv * ha, wv * d};
                if (d == 0.0 && c[0] == 0.0 && c[2] == 0.0) continue;
                add_block_lanes(it, J + (j * n * (size_t)it->m + k * n) * W, c, d == 0.0,
                                second);
            }
    }
}

/* residual, and matrix and factors of the lanes that renew them; lanes where that does not go well leave */
INLINE void evaluate_equation(lanes_newton *it, int all) {
    const dm_stage_lanes *w = it->w;
    evaluate_lanes(it, all);
    find_residual(it);
    it->todo &= is_finite(it->residual);
    it->fresh &= it->todo;
    if (!bits_of(it->fresh)) return;
    double *J = all ? w->J : w->J2;
    lanes_pivot *pivot = all ? w->pivot : w->pivot2;
    find_matrix(it, J);
    it->todo &= factor_lanes(J, pivot, it->m) | ~it->fresh;
    it->fresh &= it->todo;
    if (!all) take_factors(it->fresh, w->J, w->pivot, J, pivot, it->m);
}

/* ---- the iteration ---- */

/* dx = -J^-1 r of the lanes that go on; leaves the rate of the iteration before */
INLINE void find_increments(lanes_newton *it) {
    const dm_stage_lanes *w = it->w;
    for (uint32_t k = 0; k < it->m; k++) store(w->r + k * W, -load(w->r + k * W));
    solve_lanes(w->r, w->J, w->pivot, it->m);
    copy_where(it->todo, w->dx, w->r, it->m);
    const I known = (I)(it->step < INFINITY) & (I)(it->last < INFINITY);
    it->rate = pick(known, it->step / it->last, same(1.0));
    it->last = it->step;
    it->step = norm_of(w->dx, it->m);
}

/* lanes whose root is x + dx to round-off */
INLINE I last_increments(const lanes_newton *it) {
    const double tol = it->w->tolerance;
    const V size = norm_of(it->w->root, it->m) + it->step, step = it->step;
    const V rate = pick((I)(it->last < INFINITY), step / it->last, same(DM_NEWTON_SLOW));
    const V twice = 2.0 * it->rate, enough = DM_NEWTON_NEGLIGIBLE * tol * size;
    const I small = (I)(step <= DM_NEWTON_ROUND_OFF * size);
    I last = (I)(step == (V){0}) | (I)(step <= tol * size);
    last |= (I)(twice < DM_NEWTON_SLOW) & small & (I)(twice * twice * it->last <= enough);
    last |= (I)(rate < DM_NEWTON_SLOW) & (I)(rate * step <= enough);
    last |= (I)(rate > 0.5) & (small | (I)(it->residual <= DM_NEWTON_NOISE * it->terms));
    return last;
}

/* chord iterations; the lanes that end at a root */
INLINE I chord_lanes(lanes_newton *it) {
    const dm_stage_lanes *w = it->w;
    I ended = {0};
    it->fresh = it->todo;
    evaluate_equation(it, 1);
    for (int k = 0; k < w->max_iterations && bits_of(it->todo); k++) {
        find_increments(it);
        it->todo &= is_finite(it->step);
        const I last = it->todo & last_increments(it);
        for (uint32_t i = 0; i < it->m; i++) {
            const V x = load(w->root + i * W);
            store(w->root + i * W, pick(it->todo, x + load(w->dx + i * W), x));
        }
        ended |= last;
        it->todo &= ~last;
        const I slow = it->todo & (I)(it->step > DM_NEWTON_SLOW * it->last);
        it->todo &= ~(it->fresh & slow & (I)(it->step > it->last));
        it->fresh = slow & it->todo;
        if (bits_of(it->todo)) evaluate_equation(it, 0);
    }
    return ended;
}

/* ---- the end ---- */

/* L_q(i) at the root from its value one increment before */
INLINE void correct_lanes(const lanes_newton *it, uint32_t i) {
    const dm_stage_lanes *w = it->w;
    const dm_stage *g = w->g;
    const uint32_t n = it->n, s = it->s;
    const double *qq = w->curve + i * curve_size(n) + 2 * n * W, *qv = qq + n * n * W;
    double *dq = w->x, *dv = dq + n * W; /* not needed any more */
    for (uint32_t k = 0; k < n; k++) {
        V to_q = {0}, to_v = {0};
        for (uint32_t j = 0; j < s; j++) {
            const V d = load(w->dx + (j * n + k) * W);
            to_q += g->ha[i * s + j].top * d;
            to_v += g->table.d[i * s + j].top * d;
        }
        store(dq + k * W, to_q);
        store(dv + k * W, to_v);
    }
    for (uint32_t k = 0; k < n; k++) {
        double *force = w->slopes + (i * 2 * n + k) * W;
        V sum = load(force);
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
    for (uint32_t i = 0; i < it->r; i++) correct_lanes(it, i);
    for (uint32_t k = 0; k < n; k++) {
        V dq = {0}, dp = {0};
        for (uint32_t j = 0; j < it->s; j++)
            dq = add_weighted(dq, w->g->hbeta[j], load(w->root + (j * n + k) * W));
        for (uint32_t i = 0; i < it->r; i++)
            dp = add_weighted(dp, w->g->hb[i], load(w->slopes + (i * 2 * n + k) * W));
        fine &= add_to_state(w, k, dq);
        fine &= add_to_state(w, n + k, dp);
    }
    return fine;
}

/* the new state, and what is left to the next step. Differences behind those that a lane has yet are numbers that
** no step reads before they are renewed. */
INLINE void keep_newton(const lanes_newton *it, I where) {
    const dm_stage_lanes *w = it->w;
    double *end = w->memory + DM_WARM_END * W, *before = end + 4 * it->n * W;
    double *D = before + it->m * W, *count = w->memory + DM_WARM_COUNT * W;
    continue_lanes(w, w->missed, before);
    for (uint32_t k = 0; k < it->m; k++) {
        V missed = load(w->root + k * W) - load(w->missed + k * W);
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

INLINE uint32_t step_by_newton(const dm_stage_lanes *w, uint32_t asked) {
    const dm_stage *g = w->g;
    lanes_newton it = {.w = w,
                       .n = g->n,
                       .s = g->table.s,
                       .r = g->table.r,
                       .m = g->table.s * g->n,
                       .step = same(INFINITY),
                       .last = same(INFINITY)};
    it.todo = mask_of(asked) & guess_lanes(w);
    if (!bits_of(it.todo)) return 0;
    I ended = chord_lanes(&it);
    ended &= finish_newton(&it);
    keep_newton(&it, ended);
    return bits_of(ended);
}

#endif
