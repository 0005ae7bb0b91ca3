/* stage_lanes_one_point_keep.h - what steps by push.h of W members leave to the next ones, as in
 * stage_push.c; a text, see stage_lanes_push.h. */
#ifndef DM_STAGE_LANES_PUSH_KEEP_H
#define DM_STAGE_LANES_PUSH_KEEP_H

#include "integ/stage/lanes/stage_lanes_text.h"

/* lanes whose last step ended where this one begins, and was as long */
INLINE I pushed_before(const dm_stage_lanes *w, uint32_t n) {
    const double *memory = w->memory, *end = memory + DM_PUSHED_END * W;
    I fits = (I)(load(memory + DM_PUSHED_STEP * W) == load(w->h)) &
             (I)(load(memory + DM_PUSHED_COUNT * W) > (V){0});
#pragma GCC unroll 16
    for (uint32_t k = 0; k < 4 * n; k++) fits &= (I)(load(end + k * W) == load(w->state + k * W));
    return fits;
}

/* differences that each lane takes: -1 where it takes the one of that degree */
INLINE void choose_terms(I *takes, const V *size, V count) {
    I wants = (I)(count > (V){0});
#pragma GCC unroll 6
    for (int j = 0; j < DM_PUSHED_TERMS; j++) {
        V left = size[j];
        if (j + 1 < DM_PUSHED_TERMS)
            left = pick((I)(count > (double)(j + 1)), size[j + 1], size[j]);
        wants &= (I)(count > (double)j);
        if (j >= DM_WARM_PARABOLA) wants &= (I)(left <= DM_WARM_NEARER * size[j]);
        takes[j] = wants;
    }
}

/* P, the next guess and the new end, in the lanes of `where` */
INLINE void keep_pushes(const dm_stage_lanes *w, I where, const double *Z, uint32_t n) {
    double *end = w->memory + DM_PUSHED_END * W, *guess = end + 4 * n * W;
    double *P = guess + n * W, *number = w->memory + DM_PUSHED_COUNT * W;
    const V count = load(number), most = same(DM_PUSHED_TERMS);
    V size[DM_PUSHED_TERMS];
    I takes[DM_PUSHED_TERMS];
#pragma GCC unroll 6
    for (uint32_t j = 0; j < DM_PUSHED_TERMS; j++) {
        size[j] = (V){0};
#pragma GCC unroll 4
        for (uint32_t k = 0; k < n; k++)
            size[j] = larger_of(magnitude(load(Z + k * W) - load(P + (j * n + k) * W)), size[j]);
    }
    choose_terms(takes, size, count);
#pragma GCC unroll 4
    for (uint32_t k = 0; k < n; k++) {
        const V now = load(Z + k * W);
        V sum = {0}, times = same(1.0), next = now;
#pragma GCC unroll 6
        for (uint32_t j = 0; j < DM_PUSHED_TERMS; j++) {
            double *place = P + (j * n + k) * W;
            const V before = load(place);
            sum = pick(takes[j], sum + before, sum);
            times = pick(takes[j], times + 1.0, times);
            put_where(where, place, next);
            next += now - before;
        }
        put_where(where, guess + k * W, times * now - sum);
    }
    put_where(where, number, pick((I)(count < most), count + 1.0, most));
#pragma GCC unroll 16
    for (uint32_t k = 0; k < 4 * n; k++) {
        put_where(where, end + k * W, load(w->next + k * W));
        put_where(where, w->state + k * W, load(w->next + k * W));
    }
}

#endif
