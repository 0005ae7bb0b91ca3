/* stage_lanes_evaluate.h - arguments and kernels of the stages of W members, sweep by sweep; a
 * text, see stage_lanes_sweep.h. */
#ifndef DM_STAGE_LANES_EVALUATE_H
#define DM_STAGE_LANES_EVALUATE_H

#include "integ/stage/lanes/stage_lanes_walk.h"
#include "integ/stage/workspace/stage_limits.h"

/* u = M^-1 out, M full */
INLINE void divide_lanes_by_mass(const lanes_sweeps *it) {
    const uint32_t n = it->n;
    for (uint32_t m = 0; m < it->r; m++) {
        const double *factor = it->w->g->m->inverse_mass;
        for (uint32_t i = 0; i < n; i++) {
            V sum = {0};
            for (uint32_t j = 0; j < n; j++, factor++)
                sum += *factor * load(it->w->sweeps.out + m * given(it) + j * W);
            store(it->w->sweeps.u + (m * n + i) * W, sum);
        }
    }
}

/* forces at the stages, and the velocities that follow from them */
INLINE void evaluate_stages(lanes_sweeps *it) {
    const dm_stage_lanes *w = it->w;
    const uint32_t n = it->n;
    for (uint32_t m = 0; m < it->r; m++)
        dm_kernel_eval(&w->sweeps.force, w->sweeps.in + m * taken(it),
                       w->sweeps.out + m * given(it));
    if (is_full_mass(w->g)) divide_lanes_by_mass(it);
    if (w->g->separable) return;
    for (uint32_t m = 0; m < it->r; m++)
        dm_kernel_eval(&w->sweeps.factors, w->sweeps.out + m * given(it) + n * W,
                       w->sweeps.factored + m * factored(it));
    const lanes_walk p = walk_of_p(it);
    if (it->measured)
        it->moved[1] = move(it, &p);
    else
        put(it, &p);
    for (uint32_t m = 0; m < it->r; m++)
        dm_kernel_eval(&w->sweeps.velocity, w->sweeps.factored + m * factored(it) + n * W,
                       w->sweeps.in + m * taken(it) + n * W);
}

INLINE V relative_change(const lanes_sweeps *it) {
    V largest = {0};
    for (int k = 0; k < (it->w->g->separable ? 1 : 2); k++) {
        const V change = it->moved[k], ratio = change * it->scale[k];
        const V x = magnitude(pick(WHERE(change > (V){0}), ratio, change));
        largest = pick(WHERE(x <= largest) | WHERE(largest != largest), largest, x);
    }
    return largest;
}

/* what the coefficients lack, into the bases of the lanes of `where` */
INLINE void settle_lanes(lanes_sweeps *it, I where) {
    lanes_walk q = walk_of_q(it), p = walk_of_p(it);
    q.x = it->w->sweeps.base;
    p.x = it->w->sweeps.lift;
    q.x_stage = p.x_stage = it->n * W;
    q.column = p.column = columns_of(it->w, it->w->g->sweeps->rest);
    q.start = p.start = it->w->sweeps.zeros;
    put_some(it, &q, where);
    if (!it->w->g->separable) put_some(it, &p, where);
    it->settled |= where;
}

/* base[stage][n][W] = low + c v, with the roundings that line in sweep_row.h has */
INLINE void draw_line(const lanes_sweeps *it, double *base, const double *low, const double *v) {
    const dm_parts *c = &it->w->g->sweeps->line;
    for (uint32_t m = 0; m < it->r; m++)
        for (uint32_t k = 0; k < it->n; k++) {
            const V x = v ? load(v + k * W) : (V){0};
            const V rest = scaled(&it->w->group, c->rest + m) * x + load(low + k * W);
            store(base + (m * it->n + k) * W, scaled(&it->w->group, c->top + m) * x + rest);
        }
}

/* v and h v at the start; the lanes where they are finite */
INLINE I find_velocities(const lanes_sweeps *it) {
    const dm_stage_lanes *w = it->w;
    const dm_model *m = w->g->m;
    const uint32_t n = it->n;
    const double *p = w->group.state + n * W, *row = m->inverse_mass;
    const dm_parts *c = &w->g->sweeps->flight;
    const V top = scaled(&w->group, c->top), rest = scaled(&w->group, c->rest);
    I fine = all_lanes();
    for (uint32_t i = 0; i < n; i++) {
        V v = {0};
        if (m->structure & DM_DIAGONAL_MASS) {
            v = row[i] * load(p + i * W);
        } else {
            for (uint32_t j = 0; j < n; j++)
                v += row[i * n + j] * (load(p + j * W) - m->momentum_shift[j]);
            fine &= is_finite(v);
        }
        store(w->sweeps.v0 + i * W, v);
        store(w->sweeps.drift + i * W, top * v + rest * v);
    }
    return fine;
}

/* bases, times and first arguments, from u of the step before */
INLINE I prepare_sweeps(lanes_sweeps *it) {
    const dm_stage_lanes *w = it->w;
    const dm_stage *g = w->g;
    const uint32_t n = it->n;
    const double *low = w->group.state + 2 * n * W;
    const I fine = g->separable ? find_velocities(it) : all_lanes();
    lanes_walk ahead = walk_of_q(it);
    if (!(g->m->structure & DM_AUTONOMOUS))
        for (uint32_t m = 0; m < it->r; m++)
            store(w->sweeps.in + m * taken(it) + 2 * n * W,
                  w->group.t + scaled(&w->group, g->sweeps->after + m));
    draw_line(it, w->sweeps.base, low, g->separable ? w->sweeps.v0 : NULL);
    ahead.column = columns_of(w, g->sweeps->further);
    ahead.u = w->group.memory + (DM_SWEPT_END + 4 * n) * W;
    ahead.u_stage = W;
    ahead.u_row = (size_t)it->width * W;
    put(it, &ahead);
    it->rate = 4.0 * load(w->group.memory + DM_SWEPT_RATE * W);
    it->rate = pick(WHERE(it->rate > same(DM_SWEEP_LEAST)), it->rate, same(DM_SWEEP_LEAST));
    if (g->separable) return fine;
    draw_line(it, w->sweeps.lift, low + n * W, NULL);
    ahead.x = w->sweeps.in + n * W;
    ahead.base = ahead.start = it->w->sweeps.zeros;
    ahead.column = columns_of(w, g->sweeps->turning);
    ahead.factor = NULL;
    put(it, &ahead);
    return fine;
}

/* square of the start and of the last stage */
INLINE V square_of(const lanes_sweeps *it, const lanes_walk *a, uint32_t k) {
    const V x = load(a->start + k * W), y = load(a->x + (it->r - 1) * a->x_stage + k * W);
    return x * x + y * y;
}

/* the sum of these; units[n][W] where rows of some lane are far apart, in others all 1 */
INLINE V measure(const lanes_sweeps *it, const lanes_walk *a, double *units, int *has_units) {
    V size = {0}, least = same(INFINITY);
    for (uint32_t k = 0; k < it->n; k++) {
        const V row = square_of(it, a, k);
        size += row;
        least = pick(WHERE(row > (V){0}) & WHERE(row < least), row, least);
    }
    const I apart = WHERE(DM_SWEEP_APART * least < size);
    *has_units = some(apart);
    const V mean = size / (double)it->n, zero = DM_SWEEP_ZERO * size;
    for (uint32_t k = 0; k < it->n && *has_units; k++) {
        const V own = square_of(it, a, k);
        store(units + k * W, pick(apart & WHERE(own > zero), mean / own, same(1.0)));
    }
    return size;
}

INLINE void evaluate_first(lanes_sweeps *it) {
    const lanes_walk q = walk_of_q(it), p = walk_of_p(it);
    double *units = it->w->sweeps.unit;
    it->size[0] = measure(it, &q, units, it->has_units);
    evaluate_stages(it);
    it->scale[0] = 1.0 / it->size[0];
    if (it->w->g->separable) return;
    it->moved[1] = it->size[1] = measure(it, &p, units + it->n * W, it->has_units + 1);
    it->scale[1] = 1.0 / it->size[1];
}

/* one sweep, and what it tells of the contraction */
INLINE void sweep_lanes(lanes_sweeps *it) {
    const lanes_walk q = walk_of_q(it);
    const V before = it->change;
    if (it->measured) {
        it->moved[0] = move(it, &q);
        it->change = relative_change(it);
    } else {
        put(it, &q);
    }
    evaluate_stages(it);
    const I clean = WHERE(before <= DM_SWEEP_CLEAN) & WHERE(it->change <= 100.0 * DM_SWEEP_CLEAN);
    if (it->measured && it->count > 0) {
        it->rate = pick(clean, it->rate, it->change / before);
        it->rated |= ~clean;
    }
    it->change = pick(clean, it->rate * before, it->change);
    it->count++;
}

#endif
