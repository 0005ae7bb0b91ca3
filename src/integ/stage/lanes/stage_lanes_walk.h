/* stage_lanes_walk.h - sums over stages of W members, and where what they add up lies; a text,
 * see stage_lanes_sweep.h. */
#ifndef DM_STAGE_LANES_WALK_H
#define DM_STAGE_LANES_WALK_H

#include "integ/stage/lanes/group_text.h"
#include "integ/stage/lanes/stage_lanes.h"
#include "integ/stage/sweep/sums_text.h"

/* x = start + (base + factor sum_m column_m u_m) at every stage, column [r][width][W]; distances
 * in doubles, from row to row where not W */
typedef struct {
    double *x;
    const double *base, *column, *u, *factor, *start; /* start [rows][W] */
    const double *unit; /* [rows][W] by which squares of moves count; NULL: all are 1 */
    size_t x_stage, u_stage, u_row;
} lanes_walk;

typedef struct {
    const dm_stage_lanes *w;
    uint32_t n, r, width;
    int measured, count;
    int has_units[2]; /* of positions, momenta */
    I settled, rated;
    V size[2], scale[2], moved[2], change, rate;
} lanes_sweeps;

/* even and odd columns are summed apart, the even ones on to a base unless that is NULL */
INLINE V weigh(const double *column, uint32_t width, const V *base, const V *u, uint32_t columns,
               int fused) {
    V even = load(column) * u[0], odd;
    if (base) even = madd(load(column), u[0], *base, fused);
    if (columns == 1) return even;
    odd = load(column + width * W) * u[1];
#pragma GCC unroll 8
    for (uint32_t m = 2; m < columns; m += 2) {
        even = madd(load(column + m * width * W), u[m], even, fused);
        if (m + 1 < columns) odd = madd(load(column + (m + 1) * width * W), u[m + 1], odd, fused);
    }
    return even + odd;
}

/* stages and measured (2: by units) are constants where this is called; lanes that are not in
 * `where` keep x */
INLINE V walk_stages(const lanes_sweeps *it, const lanes_walk *a, uint32_t r, int measured,
                     const I *where) {
    const uint32_t n = it->n, width = r == 1 ? 1 : r <= 4 ? 4 : 8;
    const int fused = DM_LANES_FUSED && r > 1;
    const lanes_walk at = *a; /* nothing of it changes by what is written */
    V moved[8], u[8];
#pragma GCC unroll 8
    for (uint32_t i = 0; i < 8; i++) moved[i] = u[i] = (V){0};
    for (uint32_t k = 0; k < n; k++) {
        const V start = load(at.start + k * W);
#pragma GCC unroll 8
        for (uint32_t m = 0; m < r; m++) u[m] = load(at.u + m * at.u_stage + k * at.u_row);
#pragma GCC unroll 8
        for (uint32_t i = 0; i < r; i++) {
            double *x = at.x + i * at.x_stage + k * W;
            const V base = load(at.base + (i * n + k) * W);
            V sum = weigh(at.column + i * W, width, at.factor ? NULL : &base, u, r, fused);
            if (at.factor) sum = madd(same(at.factor[k]), sum, base, fused);
            const V now = start + sum;
            if (measured) {
                const V d = now - load(x);
                const V counts = measured > 1 ? d * load(at.unit + k * W) : d;
                moved[i] = madd(counts, d, moved[i], fused);
            }
            store(x, where ? pick(*where, now, load(x)) : now);
        }
    }
    return measured ? moved_of(moved, width) : (V){0};
}

/* few stages, and those of the highest orders, are written out. Speed: P3, members by gauss(1) to
 * gauss(8) */
INLINE V walk(const lanes_sweeps *it, const lanes_walk *a, int measured, const I *where) {
    switch (it->r) {
    case 1:
        return walk_stages(it, a, 1, measured, where);
    case 2:
        return walk_stages(it, a, 2, measured, where);
    case 3:
        return walk_stages(it, a, 3, measured, where);
    case 4:
        return walk_stages(it, a, 4, measured, where);
    case 6:
        return walk_stages(it, a, 6, measured, where);
    case 8:
        return walk_stages(it, a, 8, measured, where);
    default:
        return walk_stages(it, a, it->r, measured, where);
    }
}

HOW static __attribute__((noinline)) V move_by_units(const lanes_sweeps *it, const lanes_walk *a) {
    return walk(it, a, 2, NULL);
}

HOW static V move(const lanes_sweeps *it, const lanes_walk *a) {
    return a->unit ? move_by_units(it, a) : walk(it, a, 1, NULL);
}

HOW static void put(const lanes_sweeps *it, const lanes_walk *a) {
    walk(it, a, 0, NULL);
}

HOW static void put_some(const lanes_sweeps *it, const lanes_walk *a, I where) {
    walk(it, a, 0, &where);
}

/* doubles from stage to stage of what kernels take and give */
INLINE size_t taken(const lanes_sweeps *it) {
    return (2 * (size_t)it->n + 1) * W;
}

INLINE size_t given(const lanes_sweeps *it) {
    return it->w->g->sweeps->force.outputs * (size_t)W;
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
    if (!w->g->separable) return w->sweeps.in + it->n * W;
    *from_stage = it->n * W;
    return is_full_mass(w->g) ? w->sweeps.u : w->sweeps.out;
}

/* columns of the stepper's for every lane */
INLINE const double *columns_of(const dm_stage_lanes *w, const double *one) {
    return w->group.scaled + (one - w->group.one) * W;
}

INLINE lanes_walk walk_of_q(const lanes_sweeps *it) {
    const dm_stage_lanes *w = it->w;
    const dm_stage_sweeps *one = w->g->sweeps;
    lanes_walk a = {.x = w->sweeps.in,
                    .base = w->sweeps.base,
                    .column = columns_of(w, one->whole),
                    .factor = one->q.factor,
                    .start = w->group.state,
                    .unit = it->has_units[0] ? w->sweeps.unit : NULL,
                    .x_stage = taken(it),
                    .u_row = W};
    a.u = unknowns_of(it, &a.u_stage);
    return a;
}

INLINE lanes_walk walk_of_p(const lanes_sweeps *it) {
    const dm_stage_lanes *w = it->w;
    const dm_stage_sweeps *one = w->g->sweeps;
    return (lanes_walk){.x = w->sweeps.factored + factored(it) - it->n * W,
                        .base = w->sweeps.lift,
                        .column = columns_of(w, one->whole),
                        .u = w->sweeps.out,
                        .start = w->group.state + it->n * W,
                        .unit = it->has_units[1] ? w->sweeps.unit + it->n * W : NULL,
                        .x_stage = factored(it),
                        .u_stage = given(it),
                        .u_row = W};
}

#endif
