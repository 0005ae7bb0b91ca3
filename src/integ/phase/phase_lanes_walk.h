/* phase_lanes_walk.h - sums over stages of W members of H; a text, see phase_lanes_step.h. */
#ifndef DM_PHASE_LANES_WALK_H
#define DM_PHASE_LANES_WALK_H

#include "integ/phase/phase_lanes.h"
#include "integ/stage/sweep/sums_text.h"

typedef struct {
    const dm_phase_lanes *w;
    uint32_t n, r, width;
    int count, measured; /* sweeps; is what they change looked at? */
    int has_units[2];
    I settled, rated;
    V known, change, ratio, rate, scale[2], moved[2]; /* of phase_sweep.c */
} phase_sweeps;

/* rows first .. first + n - 1 of x = start + (base + sum_m column_m u_m) at every stage; u of entry
 * k and stage m at k u_row + m u_stage */
typedef struct {
    double *x;
    const double *base, *column, *u, *start; /* start NULL: zero */
    size_t x_stage, u_row, u_stage;
    const double *unit; /* [n] by which squares of moves count; NULL: all are 1 */
} phase_walk;

/* where coefficients of the stepper's stand for the steps of the lanes */
INLINE const double *scaled_of(const phase_sweeps *it, const double *one) {
    return it->w->scaled + (one - it->w->one) * W;
}

/* even and odd columns are summed apart, the even ones on to the base */
INLINE V weigh_stages(const double *column, uint32_t width, const V *u, V base, uint32_t r) {
    const int fused = DM_LANES_FUSED && r > 1;
    V even = madd(load(column), u[0], base, fused), odd;
    if (r == 1) return even;
    odd = load(column + width * W) * u[1];
#pragma GCC unroll 8
    for (uint32_t m = 2; m < r; m += 2) {
        even = madd(load(column + m * width * W), u[m], even, fused);
        if (m + 1 < r) odd = madd(load(column + (m + 1) * width * W), u[m + 1], odd, fused);
    }
    return even + odd;
}

/* the sum of squares of the moves, r is a constant where this is called; lanes that are not in
 * `where` keep x */
INLINE V walk_rows(const phase_sweeps *it, const phase_walk *a, const I *where, uint32_t r) {
    const int fused = DM_LANES_FUSED && r > 1;
    const uint32_t n = it->n, width = it->width;
    const phase_walk at = *a; /* nothing of it changes by what is written */
    V moved[8], u[8];
#pragma GCC unroll 8
    for (uint32_t i = 0; i < 8; i++) moved[i] = u[i] = (V){0};
    for (uint32_t k = 0; k < n; k++) {
        const V start = at.start ? load(at.start + k * W) : (V){0};
#pragma GCC unroll 8
        for (uint32_t m = 0; m < r; m++) u[m] = load(at.u + k * at.u_row + m * at.u_stage);
#pragma GCC unroll 8
        for (uint32_t i = 0; i < r; i++) {
            double *x = at.x + i * at.x_stage + k * W;
            const V base = load(at.base + (i * 2 * n + k) * W), old = load(x);
            const V now = start + weigh_stages(at.column + i * W, width, u, base, r);
            const V d = now - old, counts = at.unit ? d * load(at.unit + k * W) : d;
            moved[i] = madd(counts, d, moved[i], fused);
            store(x, where ? pick(*where, now, old) : now);
        }
    }
    return moved_of(moved, width);
}

/* few stages are written out */
HOW static V walk(const phase_sweeps *it, const phase_walk *a, const I *where) {
    if (it->r == 1) return walk_rows(it, a, where, 1);
    if (it->r == 2) return walk_rows(it, a, where, 2);
    if (it->r == 3) return walk_rows(it, a, where, 3);
    if (it->r == 4) return walk_rows(it, a, where, 4);
    if (it->r == 8) return walk_rows(it, a, where, 8);
    return walk_rows(it, a, where, it->r);
}

/* of q (p = 0) or p in a sweep */
INLINE phase_walk walk_of(const phase_sweeps *it, int p) {
    const dm_phase_lanes *w = it->w;
    const size_t n = it->n, at = (size_t)p * n * W;
    return (phase_walk){.x = w->x + at,
                        .base = w->base + at,
                        .column = scaled_of(it, w->g->whole[p]),
                        .u = w->u + at,
                        .start = w->state + at,
                        .x_stage = (2 * n + 1) * W,
                        .u_row = W,
                        .u_stage = 2 * n * W,
                        .unit = it->has_units[p] ? w->unit + at : NULL};
}

#endif
