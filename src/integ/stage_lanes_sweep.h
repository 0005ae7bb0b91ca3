/*
** stage_lanes_sweep.h - a step by sweeps for W members, as stage_sweep.c makes it for one; a text for the files of stage_lanes.h.
** Sums over stages have the order that sweep_row.h has for as many stages; stages that this fills up with are left out.
*/
#ifndef DM_STAGE_LANES_SWEEP_H
#define DM_STAGE_LANES_SWEEP_H

#include "base/lanes_text.h"
#include "integ/stage_lanes_text.h"
#include "integ/stage_limits.h"

/* x = start + (base + factor sum_m column_m u_m) at every stage; distances in doubles, from row to row where not W */
typedef struct {
    double *x;
    const double *base, *column, *u, *factor, *start; /* start [rows][W] */
    size_t x_stage, u_stage, u_row;
} lanes_walk;

typedef struct {
    const dm_stage_lanes *w;
    uint32_t n, r, width;
    int fused, measured, count;
    I settled, rated;
    V size[2], moved[2], change, rate;
} lanes_sweeps;

/* of terms[width], as lanes of one register are added up there: halves, then their halves */
INLINE V total_of(const V *t, uint32_t width) {
    if (width == 1) return t[0];
    if (width == 4) return (t[0] + t[2]) + (t[1] + t[3]);
    return ((t[0] + t[4]) + (t[1] + t[5])) + ((t[2] + t[6]) + (t[3] + t[7]));
}

INLINE V moved_of(const V *t, uint32_t width) {
    if (width == 1) return t[0];
    if (width == 4) return (t[0] + t[2]) + (t[1] + t[3]);
    return ((t[0] + t[4]) + (t[2] + t[6])) + ((t[1] + t[5]) + (t[3] + t[7]));
}

/* even and odd columns are summed apart */
INLINE V weigh(const double *column, uint32_t width, const V *u, uint32_t columns,
               int fused) {
    V even = column[0] * u[0], odd = columns > 1 ? column[width] * u[1] : (V){0};
    for (uint32_t m = 2; m < columns; m += 2) {
        even = madd(same(column[m * width]), u[m], even, fused);
        if (m + 1 < columns)
            odd = madd(same(column[(m + 1) * width]), u[m + 1], odd, fused);
    }
    return columns > 1 ? even + odd : even;
}

/* columns, fused and measured are constants where this is called; lanes that are not in `where` keep x */
INLINE V walk_columns(const lanes_sweeps *it, const lanes_walk *a, uint32_t columns,
                      int measured, const I *where) {
    V moved[8] = {{0}}, u[8];
    for (uint32_t k = 0; k < it->n; k++) {
        const V factor = same(a->factor[k]), start = load(a->start + k * W);
        for (uint32_t m = 0; m < columns; m++)
            u[m] = load(a->u + m * a->u_stage + k * a->u_row);
        for (uint32_t i = 0; i < columns; i++) {
            double *x = a->x + i * a->x_stage + k * W;
            const V sum = weigh(a->column + i, it->width, u, columns, it->fused);
            const V base = load(a->base + (i * it->n + k) * W);
            const V now = start + madd(factor, sum, base, it->fused);
            if (measured) {
                const V d = now - load(x);
                moved[i] = madd(d, d, moved[i], it->fused);
            }
            store(x, where ? pick(*where, now, load(x)) : now);
        }
    }
    return measured ? moved_of(moved, it->width) : (V){0};
}

INLINE V walk(const lanes_sweeps *it, const lanes_walk *a, int measured, const I *where) {
    if (it->r == 1) return walk_columns(it, a, 1, measured, where);
    if (it->r == 2) return walk_columns(it, a, 2, measured, where);
    if (it->r == 3) return walk_columns(it, a, 3, measured, where);
    if (it->r == 4) return walk_columns(it, a, 4, measured, where);
    return walk_columns(it, a, it->r, measured, where);
}

/* doubles from stage to stage of what kernels take and give */
INLINE size_t taken(const lanes_sweeps *it) {
    return (2 * (size_t)it->n + 1) * W;
}

INLINE size_t given(const lanes_sweeps *it) {
    const size_t n = it->n;
    return (it->w->g->separable ? n : 2 * n + n * (n + 1) / 2) * W;
}

INLINE size_t factored(const lanes_sweeps *it) {
    const size_t n = it->n;
    return (3 * n + n * (n + 1) / 2) * W;
}

INLINE int is_full_mass(const dm_stage *g) {
    return g->separable && !(g->m->structure & DM_DIAGONAL_MASS);
}

/* u, and what one finds it by */
INLINE const double *unknowns_of(const lanes_sweeps *it, size_t *from_stage) {
    const dm_stage_lanes *w = it->w;
    *from_stage = taken(it);
    if (!w->g->separable) return w->in + it->n * W;
    *from_stage = it->n * W;
    return is_full_mass(w->g) ? w->u : w->out;
}

INLINE lanes_walk walk_of_q(const lanes_sweeps *it) {
    const dm_stage_lanes *w = it->w;
    const dm_stage_sweeps *one = &w->g->sweeps;
    lanes_walk a = {.x = w->in,
                    .base = w->base,
                    .column = one->whole,
                    .factor = one->q.factor,
                    .start = w->state,
                    .x_stage = taken(it),
                    .u_row = W};
    a.u = unknowns_of(it, &a.u_stage);
    return a;
}

INLINE lanes_walk walk_of_p(const lanes_sweeps *it) {
    const dm_stage_lanes *w = it->w;
    const dm_stage_sweeps *one = &w->g->sweeps;
    return (lanes_walk){.x = w->factored + factored(it) - it->n * W,
                        .base = w->lift,
                        .column = one->whole,
                        .u = w->out,
                        .factor = one->one,
                        .start = w->state + it->n * W,
                        .x_stage = factored(it),
                        .u_stage = given(it),
                        .u_row = W};
}

/* u = M^-1 out, M full */
INLINE void divide_lanes_by_mass(const lanes_sweeps *it) {
    const uint32_t n = it->n;
    for (uint32_t m = 0; m < it->r; m++) {
        const double *factor = it->w->g->m->inverse_mass;
        for (uint32_t i = 0; i < n; i++) {
            V sum = {0};
            for (uint32_t j = 0; j < n; j++, factor++)
                sum += *factor * load(it->w->out + m * given(it) + j * W);
            store(it->w->u + (m * n + i) * W, sum);
        }
    }
}

/* forces at the stages, and the velocities that follow from them */
INLINE void evaluate_stages(lanes_sweeps *it) {
    const dm_stage_lanes *w = it->w;
    const uint32_t n = it->n;
    for (uint32_t m = 0; m < it->r; m++)
        dm_kernel_eval(&w->force, w->in + m * taken(it), w->out + m * given(it));
    if (is_full_mass(w->g)) divide_lanes_by_mass(it);
    if (w->g->separable) return;
    for (uint32_t m = 0; m < it->r; m++)
        dm_kernel_eval(&w->factors, w->out + m * given(it) + n * W,
                       w->factored + m * factored(it));
    const lanes_walk p = walk_of_p(it);
    it->moved[1] = it->measured ? walk(it, &p, 1, NULL) : walk(it, &p, 0, NULL);
    for (uint32_t m = 0; m < it->r; m++)
        dm_kernel_eval(&w->velocity, w->factored + m * factored(it) + n * W,
                       w->in + m * taken(it) + n * W);
}

INLINE V relative_change(const lanes_sweeps *it) {
    V largest = {0};
    for (int k = 0; k < 2; k++) {
        const V change = it->moved[k], ratio = change / it->size[k];
        const V x = magnitude(pick((I)(change > (V){0}), ratio, change));
        largest = pick((I)(x <= largest) | (I)(largest != largest), largest, x);
    }
    return square_root(largest);
}

/* what the coefficients lack, into the bases of the lanes of `where` */
INLINE void settle_lanes(lanes_sweeps *it, I where) {
    lanes_walk q = walk_of_q(it), p = walk_of_p(it);
    q.x = it->w->base;
    p.x = it->w->lift;
    q.x_stage = p.x_stage = it->n * W;
    q.column = p.column = it->w->g->sweeps.rest;
    q.start = p.start = it->w->zeros;
    walk(it, &q, 0, &where);
    if (!it->w->g->separable) walk(it, &p, 0, &where);
    it->settled |= where;
}

/* base[stage][n][W] = low + c v */
INLINE void draw_line(const lanes_sweeps *it, double *base, const double *low,
                      const double *v) {
    const dm_parts *c = &it->w->g->sweeps.line;
    for (uint32_t m = 0; m < it->r; m++)
        for (uint32_t k = 0; k < it->n; k++) {
            const V x = v ? load(v + k * W) : (V){0};
            const V sum = madd(same(c->rest[m]), x, load(low + k * W), it->fused);
            store(base + (m * it->n + k) * W, madd(same(c->top[m]), x, sum, it->fused));
        }
}

/* v and h v at the start; the lanes where they are finite */
INLINE I find_velocities(const lanes_sweeps *it) {
    const dm_stage_lanes *w = it->w;
    const dm_model *m = w->g->m;
    const uint32_t n = it->n;
    const double *p = w->state + n * W, *row = m->inverse_mass;
    I fine = mask_of((1u << W) - 1);
    for (uint32_t i = 0; i < n; i++) {
        V v = {0};
        if (m->structure & DM_DIAGONAL_MASS) {
            v = row[i] * load(p + i * W);
        } else {
            for (uint32_t j = 0; j < n; j++)
                v += row[i * n + j] * (load(p + j * W) - m->momentum_shift[j]);
            fine &= is_finite(v);
        }
        store(w->v0 + i * W, v);
        store(w->drift + i * W, w->g->h * v);
    }
    return fine;
}

/* bases, times and first arguments, from u of the step before */
INLINE I prepare_sweeps(lanes_sweeps *it) {
    const dm_stage_lanes *w = it->w;
    const dm_stage *g = w->g;
    const uint32_t n = it->n;
    const double *low = w->state + 2 * n * W;
    const I fine = g->separable ? find_velocities(it) : mask_of((1u << W) - 1);
    lanes_walk ahead = walk_of_q(it);
    if (!(g->m->structure & DM_AUTONOMOUS))
        for (uint32_t m = 0; m < it->r; m++)
            store(w->in + m * taken(it) + 2 * n * W, same(w->t + g->sweeps.after[m]));
    draw_line(it, w->base, low, g->separable ? w->v0 : NULL);
    ahead.column = g->sweeps.further;
    ahead.u = w->memory + (DM_SWEPT_END + 4 * n) * W;
    ahead.u_stage = W;
    ahead.u_row = (size_t)it->width * W;
    walk(it, &ahead, 0, NULL);
    it->rate = 2.0 * load(w->memory + DM_SWEPT_RATE * W);
    it->rate = pick((I)(it->rate > same(DM_SWEEP_LEAST)), it->rate, same(DM_SWEEP_LEAST));
    if (g->separable) return fine;
    draw_line(it, w->lift, low + n * W, NULL);
    ahead.x = w->in + n * W;
    ahead.base = ahead.start = it->w->zeros;
    ahead.column = g->sweeps.turning;
    ahead.factor = g->sweeps.one;
    walk(it, &ahead, 0, NULL);
    return fine;
}

/* sum of the squares of the start and of the last stage */
INLINE V square_of(const lanes_sweeps *it, const lanes_walk *a) {
    V size = {0};
    for (uint32_t k = 0; k < it->n; k++) {
        const V x = load(a->start + k * W),
                y = load(a->x + (it->r - 1) * a->x_stage + k * W);
        size += x * x + y * y;
    }
    return size;
}

INLINE void evaluate_first(lanes_sweeps *it) {
    const lanes_walk q = walk_of_q(it), p = walk_of_p(it);
    it->size[0] = square_of(it, &q);
    evaluate_stages(it);
    it->moved[1] = it->size[1] = it->w->g->separable ? (V){0} : square_of(it, &p);
}

/* one sweep, and what it tells of the contraction */
INLINE void sweep_lanes(lanes_sweeps *it) {
    const lanes_walk q = walk_of_q(it);
    const V before = it->change;
    it->moved[0] = it->measured ? walk(it, &q, 1, NULL) : walk(it, &q, 0, NULL);
    if (it->measured) it->change = relative_change(it);
    evaluate_stages(it);
    const I clean =
        (I)(before <= DM_SWEEP_CLEAN) & (I)(it->change <= 10.0 * DM_SWEEP_CLEAN);
    if (it->measured && it->count > 0) {
        it->rate = pick(clean, it->rate, it->change / before);
        it->rated |= ~clean;
    }
    it->change = pick(clean, it->rate * before, it->change);
    it->count++;
}

/* lanes that have all pivots of the mass matrix positive */
INLINE I regular_lanes(const lanes_sweeps *it) {
    I fine = mask_of((1u << W) - 1);
    for (uint32_t m = 0; m < it->r && !it->w->g->separable; m++)
        for (uint32_t k = 0; k < it->n; k++)
            fine &= (I)(load(it->w->factored + m * factored(it) + k * W) > (V){0});
    return fine;
}

/* what the step ends with, of the lanes of `where` */
INLINE void leave_ends(const lanes_sweeps *it, I where, V *rate) {
    const dm_stage_lanes *w = it->w;
    size_t u_stage;
    const double *u = unknowns_of(it, &u_stage);
    for (uint32_t m = 0; m < it->r; m++)
        for (uint32_t k = 0; k < it->n; k++) {
            const size_t at = (m * it->n + k) * W;
            put_where(where, w->end_u + at, load(u + m * u_stage + k * W));
            put_where(where, w->end_f + at, load(w->out + m * given(it) + k * W));
        }
    const V kept = load(w->memory + DM_SWEPT_RATE * W);
    *rate = pick(where, pick(it->rated, it->rate, kept), *rate);
}

/* so many evaluations; the lanes that are regular */
INLINE I count_out_lanes(lanes_sweeps *it, I todo, V *rate) {
    const int fixed = it->w->g->sweeps.count;
    it->measured = 0;
    evaluate_first(it);
    for (int k = 1; k < fixed; k++) {
        it->measured = k == fixed - 1;
        sweep_lanes(it);
    }
    todo &= regular_lanes(it);
    leave_ends(it, todo, rate);
    return todo;
}

/* until all lanes are settled to round-off or need another way; those that are */
INLINE I iterate_lanes(lanes_sweeps *it, I todo, V *rate) {
    const double enough = DM_SWEEP_LEFT * it->w->tolerance;
    I ended = {0};
    it->measured = 1;
    evaluate_first(it);
    for (int k = 1; k < DM_STAGE_SWEEPS && bits_of(todo); k++) {
        const I settles = todo & ~it->settled & (I)(it->change < DM_SWEEP_SETTLED);
        if (bits_of(settles)) settle_lanes(it, settles);
        sweep_lanes(it);
        const double most = it->count > 5 ? DM_SWEEP_SLOW : 2.0;
        todo &= is_finite(it->change) & ~(it->rated & (I)(it->rate > most));
        const I now = todo & it->settled & (I)(it->rate * it->change <= enough);
        if (!bits_of(now)) continue;
        const I fine = now & regular_lanes(it);
        leave_ends(it, fine, rate);
        ended |= fine;
        todo &= ~now;
    }
    return ended;
}

INLINE I finish_sweeps(const lanes_sweeps *it) {
    const dm_stage_lanes *w = it->w;
    const dm_sweep_end *one = &w->g->sweeps.end;
    const uint32_t n = it->n, width = it->width;
    I fine = mask_of((1u << W) - 1);
    for (uint32_t k = 0; k < n; k++) {
        V q[8] = {{0}}, p[8] = {{0}};
        for (uint32_t m = 0; m < it->r; m++) {
            const size_t at = (m * n + k) * W;
            const V u = load(w->end_u + at), f = load(w->end_f + at);
            q[m] = madd(same(one->b[0]->top[m]), u, one->b[0]->rest[m] * u, it->fused);
            p[m] = madd(same(one->b[1]->top[m]), f, one->b[1]->rest[m] * f, it->fused);
        }
        const V drift = w->g->separable ? load(w->drift + k * W) : (V){0};
        const V dq = total_of(q, width) * one->factor[k] + drift;
        fine &= add_to_state(w, k, dq);
        fine &= add_to_state(w, n + k, total_of(p, width) + (V){0});
    }
    return fine;
}

/* lanes whose memory is that of the step that ended here */
INLINE I swept_before(const dm_stage_lanes *w) {
    const uint32_t n = w->g->n;
    I fits = (I)(load(w->memory + DM_SWEPT_STEP * W) == w->g->h) &
             (I)(load(w->memory + DM_SWEPT_MARK * W) == (double)DM_SWEPT_FULL);
    for (uint32_t k = 0; k < 4 * n; k++)
        fits &=
            (I)((I)load(w->memory + (DM_SWEPT_END + k) * W) == (I)load(w->state + k * W));
    return fits;
}

/* the new state, and what is left to the next step */
INLINE void keep_sweeps(const lanes_sweeps *it, I where, V rate) {
    const dm_stage_lanes *w = it->w;
    const uint32_t n = it->n;
    double *u = w->memory + (DM_SWEPT_END + 4 * n) * W;
    put_where(where, w->memory + DM_SWEPT_RATE * W, rate);
    for (uint32_t k = 0; k < 4 * n; k++) {
        put_where(where, w->state + k * W, load(w->next + k * W));
        put_where(where, w->memory + (DM_SWEPT_END + k) * W, load(w->next + k * W));
    }
    for (uint32_t k = 0; k < n; k++)
        for (uint32_t m = 0; m < it->r; m++)
            put_where(where, u + (k * it->width + m) * W,
                      load(w->end_u + (m * n + k) * W));
}

INLINE uint32_t step_by_sweeps(const dm_stage_lanes *w, uint32_t asked, int fused) {
    const dm_stage *g = w->g;
    lanes_sweeps it = {.w = w,
                       .n = g->n,
                       .r = g->table.r,
                       .width = g->sweeps.row->width,
                       .fused = fused,
                       .change = same(1.0)};
    I todo = mask_of(asked) & swept_before(w);
    V rate = {0};
    if (!bits_of(todo)) return 0;
    todo &= prepare_sweeps(&it);
    todo = g->sweeps.count ? count_out_lanes(&it, todo, &rate)
                           : iterate_lanes(&it, todo, &rate);
    todo &= finish_sweeps(&it);
    keep_sweeps(&it, todo, rate);
    return bits_of(todo);
}

#endif
