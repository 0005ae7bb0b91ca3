/* one_point_text.h - a step of one stage by one_point.h for W members: M u = L_q(Q, t + c h), Q =
 * q0 + h reach v0 + h^2 A u,  q1 = q0 + h v0 + h^2 mean u,  p1 = p0 + h b M u. It begins at the
 * displacements Z = Q - q0 of the steps before, continued. A text for files that have
 * numbers/lanes_text.h, which for one member is stage_one_point.c. Long because it is one step,
 * from its guess to what it leaves to the next one. */
#ifndef DM_ONE_POINT_TEXT_H
#define DM_ONE_POINT_TEXT_H

#include "integ/stage/lanes/group_text.h"
#include "integ/stage/lanes/one_point.h"
#include "linalg/solve/newton_limits.h"

/* a step on its way; n is a constant where this is called, so that all is in registers */
typedef struct {
    const dm_stage *g;
    const dm_stage_group *group;
    const dm_one_point *kernel;
    uint32_t n;
    V v0[DM_ONE_POINT_MOST]; /* velocity at the start */
    V Z[DM_ONE_POINT_MOST];  /* Q - q0, u and L_q there, of the lanes that have ended */
    V u[DM_ONE_POINT_MOST], force[DM_ONE_POINT_MOST];
    V end[4 * DM_ONE_POINT_MOST]; /* the new state */
    V left;                       /* the last increment of Z */
    int calls;                    /* of the kernel */
} one_point_step;

/* out = M^-1 (x - shift); shift NULL: none */
INLINE void divide_by_mass(const dm_model *m, V *out, const double *x, const double *shift,
                           uint32_t n) {
    const double *w = m->inverse_mass;
    if (m->structure & DM_DIAGONAL_MASS) {
#pragma GCC unroll 4
        for (uint32_t i = 0; i < n; i++) out[i] = w[i] * load(x + i * W);
        return;
    }
#pragma GCC unroll 4
    for (uint32_t i = 0; i < n; i++) {
        out[i] = (V){0};
#pragma GCC unroll 4
        for (uint32_t j = 0; j < n; j++) {
            const V from = load(x + j * W);
            out[i] += w[i * n + j] * (shift ? from - shift[j] : from);
        }
    }
}

/* v0 and the arguments of the kernel, but for the guess */
INLINE void place_start(one_point_step *a) {
    const dm_stage_weights *w = &a->g->weights;
    const dm_stage_group *x = a->group;
    const uint32_t n = a->n;
    const double *low = x->state + 2 * n * W;
    double *in = a->kernel->in, *numbers = in + 3 * n * W;
    divide_by_mass(a->g->m, a->v0, x->state + n * W, a->g->m->momentum_shift, n);
#pragma GCC unroll 4
    for (uint32_t k = 0; k < n; k++) {
        store(in + k * W, load(x->state + k * W));
        store(in + (n + k) * W, load(low + k * W) + weighted(weight_of(x, w->reach), a->v0[k]));
    }
    const V hA = weight_sum(x, w->hA);
    store(numbers + DM_ONE_POINT_WEIGHT * W, hA);
    store(numbers + DM_ONE_POINT_OVER * W, 1.0 / hA);
    store(numbers + DM_ONE_POINT_TIME * W, x->t + weight_sum(x, w->hc));
}

/* from the steps before */
INLINE void place_guess(one_point_step *a) {
    const uint32_t n = a->n;
    copy_where(all_lanes(), a->kernel->in + 2 * n * W, a->group->memory + (DM_WARM_END + 4 * n) * W,
               n);
}

/* By the rate from one increment to the next, what the second leaves does not count; or it is
 * the noise of Q. */
INLINE I is_root(V first, V second, V small) {
    const I slow = WHERE(second <= DM_NEWTON_SLOW * first) | WHERE(first <= small);
    return WHERE(second * second <= DM_NEWTON_NEGLIGIBLE * small * first) |
           (WHERE(second <= small) & slow);
}

/* Lanes of `where` with a coordinate much smaller than the largest: both increments of those count
 * by their own size |q_k| + |Z_k|, in units of what all of them were to. */
INLINE void judge_each(const one_point_step *a, I where, V w, V all, V *first, V *second) {
    const uint32_t n = a->n;
    const double *q = a->kernel->in, *Z = q + 2 * n * W, *du = a->kernel->out + n * W;
    V size[DM_ONE_POINT_MOST], least = all, one = {0}, two = {0};
    if (n == 1) return;
#pragma GCC unroll 4
    for (uint32_t k = 0; k < n; k++) {
        size[k] = magnitude(load(q + k * W)) + magnitude(load(Z + k * W));
        least = pick(WHERE(size[k] > (V){0}) & WHERE(size[k] < least), size[k], least);
    }
    const I apart = where & WHERE(DM_NEWTON_APART * least < all);
    if (!some(apart)) return;
#pragma GCC unroll 4
    for (uint32_t k = 0; k < n; k++) {
        const V unit = pick(WHERE(size[k] > (V){0}), all / size[k], same(1.0)) * magnitude(w);
        one = larger_of(unit * magnitude(load(du + k * W)), one);
        two = larger_of(unit * magnitude(load(du + (n + k) * W)), two);
    }
    *first = pick(apart, one, *first);
    *second = pick(apart, two, *second);
}

/* The lanes that find a root from the guess. Where increments do not shrink at once, from a poor
 * guess on rough motion, there may be another root than the one of a small step: such a step is
 * left to continuation in h (stage.c). */
INLINE I iterate(one_point_step *a, I todo) {
    const uint32_t n = a->n;
    const double *in = a->kernel->in, *base = in + n * W, *out = a->kernel->out;
    const V w = load(in + (3 * n + DM_ONE_POINT_WEIGHT) * W);
    double *Z = a->kernel->in + 2 * n * W;
    const V all = largest_of(in, n) + largest_of(Z, n), small = a->group->tolerance * all;
    I ended = mask_of(0);
    for (a->calls = 0; a->calls < DM_ONE_POINT_CALLS && some(todo);) {
        V u[DM_ONE_POINT_MOST];
        dm_kernel_eval(&a->kernel->kernel, in, a->kernel->out);
        a->calls++;
        V first = magnitude(w) * largest_of(out + n * W, n);
        V second = magnitude(w) * largest_of(out + 2 * n * W, n);
        I now = todo & is_root(first, second, small);
        a->left = second;
        if (some(now)) {
            judge_each(a, now, w, all, &first, &second);
            now &= is_root(first, second, small);
        }
        divide_by_mass(a->g->m, u, out, NULL, n);
#pragma GCC unroll 4
        for (uint32_t k = 0; k < n; k++) {
            const V shift = load(base + k * W) + w * u[k];
            store(Z + k * W, shift);
            if (!some(now)) continue;
            a->Z[k] = pick_some(now, shift, a->Z[k]);
            a->u[k] = pick_some(now, u[k], a->u[k]);
            a->force[k] = pick_some(now, load(out + k * W), a->force[k]);
        }
        ended |= now;
        todo &= not_of(now) & WHERE(second <= DM_NEWTON_SLOW * first);
    }
    return ended;
}

/* the new state; the lanes where it is finite */
INLINE I finish_one_point(one_point_step *a) {
    const dm_stage_weights *w = &a->g->weights;
    const dm_stage_group *x = a->group;
    const uint32_t n = a->n;
    V *end = a->end;
    I fine = all_lanes();
#pragma GCC unroll 4
    for (uint32_t k = 0; k < n; k++) {
        const V flown = weighted(weight_of(x, w->flight), a->v0[k]);
        const V dq = flown + weighted(weight_of(x, w->hmean), a->u[k]);
        const V dp = weighted(weight_of(x, w->hb), a->force[k]);
        fine &= add_to_state(x, n, k, dq, end + k, end + 2 * n + k);
        fine &= add_to_state(x, n, n + k, dp, end + n + k, end + 3 * n + k);
    }
    return fine;
}

/* ---- memory ---- */

/* the largest differences of the new Z */
INLINE void measure_differences(const one_point_step *a, V *size, const double *P) {
#pragma GCC unroll 6
    for (uint32_t j = 0; j < DM_WARM_TERMS; j++) {
        size[j] = (V){0};
#pragma GCC unroll 4
        for (uint32_t k = 0; k < a->n; k++)
            size[j] = larger_of(magnitude(a->Z[k] - load(P + (j * a->n + k) * W)), size[j]);
    }
}

/* the next guess, (K + 1) Z - sum of P_i, i < K, with the K that the differences of each lane ask
 * for */
INLINE void keep_guess(const one_point_step *a, I where, double *guess, const V *size, V count,
                       const double *P) {
    I wants = all_lanes();
    V times = same(1.0), sum[DM_ONE_POINT_MOST] = {(V){0}};
#pragma GCC unroll 6
    for (uint32_t j = 0; j < DM_WARM_TERMS; j++) {
        const I is_inner = WHERE(count > (double)(j + 1));
        const V left = j + 1 < DM_WARM_TERMS ? pick(is_inner, size[j + 1], size[j]) : size[j];
        wants &= WHERE(count > (double)j);
        if (j >= DM_WARM_PARABOLA) wants &= WHERE(left <= DM_WARM_NEARER * size[j]);
        if (!some(wants)) break;
        times = pick_some(wants, times + 1.0, times);
#pragma GCC unroll 4
        for (uint32_t k = 0; k < a->n; k++)
            sum[k] = pick_some(wants, sum[k] + load(P + (j * a->n + k) * W), sum[k]);
    }
#pragma GCC unroll 4
    for (uint32_t k = 0; k < a->n; k++) put_where(where, guess + k * W, times * a->Z[k] - sum[k]);
}

/* P, the next guess and the end of the step, in the lanes of `where`; known: P are those of the
 * step before it, else there are none */
INLINE void keep(const one_point_step *a, I where, I known) {
    const uint32_t n = a->n;
    double *number = a->group->memory + DM_WARM_COUNT * W,
           *end = a->group->memory + DM_WARM_END * W;
    double *Z = end + 4 * n * W, *P = Z + n * W;
    const V count = pick(known, load(number), (V){0}), most = same(DM_WARM_TERMS);
    V size[DM_WARM_TERMS];
    measure_differences(a, size, P);
    keep_guess(a, where, Z, size, count, P);
#pragma GCC unroll 4
    for (uint32_t k = 0; k < n; k++) {
        V next = a->Z[k];
#pragma GCC unroll 6
        for (uint32_t j = 0; j < DM_WARM_TERMS; j++) {
            double *place = P + (j * n + k) * W;
            const V D = a->Z[k] - load(place);
            put_where(where, place, next);
            next += D;
        }
    }
    put_where(where, number, pick(WHERE(count < most), count + 1.0, most));
#pragma GCC unroll 16
    for (uint32_t k = 0; k < 4 * n; k++) put_where(where, end + k * W, a->end[k]);
}

#endif
