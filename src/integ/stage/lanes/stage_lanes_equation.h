/* stage_lanes_equation.h - the step equation of W members, as in stage.c; a text, see
 * stage_lanes_newton.h. */
#ifndef DM_STAGE_LANES_EQUATION_H
#define DM_STAGE_LANES_EQUATION_H

#include "integ/stage/lanes/stage_lanes_guess.h"
#include "linalg/lu_text.h"
#include "linalg/solve/newton_text.h"

INLINE size_t curve_size(uint32_t n) {
    return (2 * (size_t)n + 3 * (size_t)n * n) * W;
}

/* sum += w x */
INLINE V add_weighted(V sum, lanes_weight w, V x) {
    return sum + (w.top * x + w.rest * x);
}

/* a coefficient that is the same for all steps */
INLINE lanes_weight fixed_weight(dm_weight w) {
    return (lanes_weight){same(w.top), same(w.rest)};
}

/* arguments of the kernels at point i */
INLINE void place_lanes(const lanes_newton *it, uint32_t i) {
    const dm_stage_lanes *w = it->w;
    const dm_stage *g = w->g;
    const uint32_t n = it->n, s = it->s;
#pragma GCC unroll 4
    for (uint32_t k = 0; k < n; k++) {
        V shift = {0}, v = {0};
#pragma GCC unroll 4
        for (uint32_t j = 0; j < s; j++) {
            const V root = load(w->root + (j * n + k) * W);
            shift = add_weighted(shift, weight_of(w, g->ha + i * s + j), root);
            if (g->table.d[i * s + j].top != 0.0)
                v = add_weighted(v, fixed_weight(g->table.d[i * s + j]), root);
        }
        store(w->x + k * W, load(w->state + k * W) + (load(w->state + (2 * n + k) * W) + shift));
        store(w->x + (n + k) * W, v);
    }
    const lanes_weight hc = weight_of(w, g->hc + i);
    store(w->x + 2 * n * W, w->t + (hc.top + hc.rest));
}

INLINE void copy_where(I yes, double *to, const double *from, size_t count) {
    for (size_t k = 0; k < count; k++) put_where(yes, to + k * W, load(from + k * W));
}

/* slopes of the lanes that go on, second derivatives of those that renew their matrix; all:
 * these are all lanes */
INLINE void evaluate_lanes(const lanes_newton *it, I fresh, I old, int all) {
    const dm_stage_lanes *w = it->w;
    const size_t curve = curve_size(it->n), slope = 2 * (size_t)it->n;
    const uint32_t renews = bits_of(fresh), keeps = bits_of(old);
#pragma GCC unroll 4
    for (uint32_t i = 0; i < it->r; i++) {
        double *own = w->curve + i * curve, *slopes = w->slopes + i * slope * W;
        place_lanes(it, i);
        if (renews) dm_kernel_eval(&w->stage, w->x, all ? own : w->other);
        if (renews && !all) copy_where(fresh, own, w->other, curve / W);
        if (renews) copy_where(fresh, slopes, own, slope);
        if (keeps) dm_kernel_eval(&w->slope, w->x, w->other + curve);
        if (keeps) copy_where(old, slopes, w->other + curve, slope);
    }
}

/* R_j = sum_i b_i [h (a_ij - beta_j) L_q(i) + d_ij L_v(i)] - beta_j p0 */
INLINE V find_residual(const lanes_newton *it) {
    const dm_stage_lanes *w = it->w;
    const dm_stage *g = w->g;
    const uint32_t n = it->n, s = it->s;
    V terms = {0};
#pragma GCC unroll 4
    for (uint32_t j = 0; j < s; j++)
#pragma GCC unroll 4
        for (uint32_t k = 0; k < n; k++) {
            const dm_weight beta = g->table.beta[j];
            const V p0 = load(w->state + (n + k) * W), low = load(w->state + (3 * n + k) * W);
            V sum = {0};
#pragma GCC unroll 4
            for (uint32_t i = 0; i < it->r; i++) {
                const double *slope = w->slopes + (i * 2 * n + k) * W;
                const lanes_weight wq = weight_of(w, g->wq + i * s + j),
                                   wv = weight_of(w, g->wv + i * s + j);
                const V q = load(slope), v = load(slope + n * W);
                const V term = (wq.top * q + wq.rest * q) + (wv.top * v + wv.rest * v);
                sum += term;
                terms = larger_of(magnitude(term), terms);
            }
            sum = (sum - (beta.top * p0 + beta.rest * p0)) - beta.top * low;
            store(w->r + (j * n + k) * W, sum);
        }
    return terms;
}

/* a block of the matrix += its part from point i */
INLINE void add_block_lanes(const lanes_newton *it, double *block, const V c[4], int half,
                            const double *A) {
    const uint32_t n = it->n;
    const double *B = A + n * n * W, *C = B + n * n * W;
#pragma GCC unroll 4
    for (uint32_t i = 0; i < n; i++)
#pragma GCC unroll 4
        for (uint32_t j = 0; j < n; j++) {
            const size_t at = (i * n + j) * W;
            double *to = block + (i * (size_t)it->m + j) * W;
            if (half) {
                store(to, load(to) + (c[0] * load(A + at) + c[2] * load(B + (j * n + i) * W)));
                continue;
            }
            const V mixed = c[1] * load(B + at) + c[2] * load(B + (j * n + i) * W);
            store(to, load(to) + ((c[0] * load(A + at) + c[3] * load(C + at)) + mixed));
        }
}

/* its value */
INLINE V weight_sum(const dm_stage_lanes *w, const dm_weight *one) {
    const lanes_weight x = weight_of(w, one);
    return x.top + x.rest;
}

/* dR_j/dV_k, as in stage.c */
INLINE void find_matrix(const lanes_newton *it, double *J) {
    const dm_stage_lanes *w = it->w;
    const dm_stage *g = w->g;
    const uint32_t n = it->n, s = it->s;
    for (size_t k = 0; k < (size_t)it->m * it->m; k++) store(J + k * W, (V){0});
    for (uint32_t i = 0; i < it->r; i++) {
        const double *second = w->curve + i * curve_size(n) + 2 * n * W;
        for (uint32_t j = 0; j < s; j++)
#pragma GCC unroll 4
            for (uint32_t k = 0; k < s; k++) {
                const V wq = weight_sum(w, g->wq + i * s + j);
                const V wv = weight_sum(w, g->wv + i * s + j);
                const V ha = weight_sum(w, g->ha + i * s + k);
                const double d = dm_weight_double(g->table.d[i * s + k]);
                const V c[4] = {wq * ha, wq * d, wv * ha, wv * d};
                if (d == 0.0 && !bits_of((I)(c[0] != (V){0}) | (I)(c[2] != (V){0}))) continue;
                add_block_lanes(it, J + (j * n * (size_t)it->m + k * n) * W, c, d == 0.0, second);
            }
    }
}

/* factors and pivots of the lanes of `yes` from another matrix */
INLINE void take_factors(I yes, double *to, I *pivot, const double *from, const I *other,
                         uint32_t n) {
    copy_where(yes, to, from, (size_t)n * n);
    for (uint32_t k = 0; k < n; k++) pivot[k] = pick_number(yes, other[k], pivot[k]);
}

/* residual, and matrix and factors of the lanes that renew them; lanes where that does not go
 * well leave */
INLINE void evaluate_equation(chord *c, void *ctx, uint32_t m, int all) {
    const lanes_newton *it = ctx;
    const dm_stage_lanes *w = it->w;
    evaluate_lanes(it, c->fresh, c->todo & not_of(c->fresh), all);
    c->terms = find_residual(it);
    c->residual = norm_of(w->r, m);
    c->todo &= is_finite(c->residual);
    c->fresh &= c->todo;
    if (!some(c->fresh)) return;
    double *J = all ? w->J : w->J2;
    I *pivot = all ? w->pivot : w->pivot2, numbers;
    find_matrix(it, J);
    c->todo &= factor_matrix(J, pivot, m, &numbers) | not_of(c->fresh);
    c->fresh &= c->todo;
    if (!all) take_factors(c->fresh, w->J, w->pivot, J, pivot, m);
}

INLINE void solve_equation(const chord *c, void *ctx, double *x, uint32_t m) {
    const lanes_newton *it = ctx;
    (void)c;
    solve_factored(x, it->w->J, it->w->pivot, m);
}

#endif
