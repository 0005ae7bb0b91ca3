/* stage_lanes_text.h - what steps of W members by sweeps and by Newton's method have in common;
 * a text. */
#ifndef DM_STAGE_LANES_TEXT_H
#define DM_STAGE_LANES_TEXT_H

#include "integ/stage/lanes/stage_lanes.h"
#include "numbers/lanes_text.h"

typedef struct {
    V top, rest;
} lanes_weight;

/* a coefficient of the stepper's for every lane */
INLINE V scaled(const dm_stage_lanes *w, const double *one) {
    return load(w->scaled + (one - w->one) * W);
}

INLINE lanes_weight weight_of(const dm_stage_lanes *w, const dm_weight *one) {
    return (lanes_weight){scaled(w, &one->top), scaled(w, &one->rest)};
}

/* max |a| of every lane */
INLINE V largest_of_lanes(const double *a, size_t size) {
    V largest = {0};
#pragma GCC unroll 4
    for (size_t k = 0; k < size; k++) largest = larger_of(magnitude(load(a + k * W)), largest);
    return largest;
}

/* (high, low) + d in next; the lanes where that is finite */
INLINE I add_to_state(const dm_stage_lanes *w, uint32_t n, uint32_t k, V d) {
    const V old = load(w->state + k * W), e = load(w->state + (2 * n + k) * W) + d;
    const V sum = old + e, low = e + (old - sum);
    store(w->next + k * W, sum);
    store(w->next + (2 * n + k) * W, low);
    return is_finite(low);
}

#endif
