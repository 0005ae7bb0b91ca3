/* stage_lanes_guess.h - where Newton's method of W members begins, as in stage_warm.c; a text,
 * see stage_lanes_newton.h. */
#ifndef DM_STAGE_LANES_GUESS_H
#define DM_STAGE_LANES_GUESS_H

#include "integ/stage/lanes/stage_lanes_text.h"

typedef struct {
    const dm_stage_lanes *w;
    uint32_t n, s, r, m; /* m = s n unknowns */
} lanes_newton;

/* to[s][n] = V of the next step by the polynomial of the last one */
INLINE void continue_lanes(const lanes_newton *it, double *to, const double *before) {
    const uint32_t n = it->n, s = it->s;
#pragma GCC unroll 4
    for (uint32_t i = 0; i < s; i++)
#pragma GCC unroll 4
        for (uint32_t k = 0; k < n; k++) {
            V sum = s == 1 ? load(before + k * W) : (V){0};
#pragma GCC unroll 4
            for (uint32_t j = 0; j < s && s > 1; j++)
                sum += it->w->g->ahead[i * s + j] * load(before + (j * n + k) * W);
            store(to + (i * n + k) * W, sum);
        }
}

/* to += differences, as many as each lane has and wants */
INLINE void add_missed_lanes(double *to, const double *D, V count, double at_least, size_t size) {
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
#pragma GCC unroll 4
        for (size_t k = 0; k < size; k++) {
            const V x = load(to + k * W);
            store(to + k * W, pick(wants, x + load(D + k * W), x));
        }
        missing = left;
    }
}

/* root[s][n] from the steps before; the lanes that have some */
INLINE I guess_lanes(const lanes_newton *it) {
    const dm_stage_lanes *w = it->w;
    const uint32_t n = it->n, size = it->m;
    const double *end = w->memory + DM_WARM_END * W, *before = end + 4 * n * W;
    const V count = load(w->memory + DM_WARM_COUNT * W);
    I has = (I)(load(w->memory + DM_WARM_STEP * W) == load(w->h)) & (I)(count > (V){0});
#pragma GCC unroll 4
    for (uint32_t k = 0; k < 4 * n; k++) has &= (I)(load(end + k * W) == load(w->state + k * W));
    if (!bits_of(has)) return has;
    continue_lanes(it, w->root, before);
    add_missed_lanes(w->root, before + size * W, count - 1.0, it->s == 1 ? DM_WARM_PARABOLA : 0,
                     size);
    return has;
}

#endif
