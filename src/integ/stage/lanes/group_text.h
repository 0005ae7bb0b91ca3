/* group_text.h - what all steps of W members do with their coefficients, states and memories; a
 * text for files that have numbers/lanes_text.h. */
#ifndef DM_GROUP_TEXT_H
#define DM_GROUP_TEXT_H

#include "integ/stage/workspace/stage_warm.h"
#include "numbers/lanes_text.h"

typedef struct {
    V top, rest;
} lanes_weight;

/* a coefficient of the stepper's, of every lane's own step */
INLINE V scaled(const dm_stage_group *x, const double *one) {
    return W == 1 ? load(one) : load(x->scaled + (one - x->one) * W);
}

INLINE lanes_weight weight_of(const dm_stage_group *x, const dm_weight *one) {
    return (lanes_weight){scaled(x, &one->top), scaled(x, &one->rest)};
}

/* one that is the same for all steps */
INLINE lanes_weight fixed_weight(dm_weight w) {
    return (lanes_weight){same(w.top), same(w.rest)};
}

INLINE V weighted(lanes_weight w, V x) {
    return w.top * x + w.rest * x;
}

/* its value */
INLINE V weight_sum(const dm_stage_group *x, const dm_weight *one) {
    const lanes_weight w = weight_of(x, one);
    return w.top + w.rest;
}

/* max |a| of every lane; a NaN is passed over */
INLINE V largest_of(const double *a, size_t size) {
    V largest = {0};
#pragma GCC unroll 4
    for (size_t k = 0; k < size; k++) largest = larger_of(magnitude(load(a + k * W)), largest);
    return largest;
}

/* entry k and its low-order part at the end: the start + d; the lanes where they are finite */
INLINE I add_to_state(const dm_stage_group *x, uint32_t n, uint32_t k, V d, V *high, V *low) {
    const V old = load(x->state + k * W), e = load(x->state + (2 * n + k) * W) + d;
    *high = old + e;
    *low = e + (old - *high);
    return is_finite(*low);
}

/* the same into next */
INLINE I add_to_next(const dm_stage_group *x, uint32_t n, uint32_t k, V d) {
    V high, low;
    const I fine = add_to_state(x, n, k, d, &high, &low);
    store(x->next + k * W, high);
    store(x->next + (2 * n + k) * W, low);
    return fine;
}

/* few entries of the lanes of `yes`; of one member one by one, see dm_stage_copy */
INLINE void copy_where(I yes, double *to, const double *from, uint32_t count) {
#if W == 1
    (void)yes;
    dm_stage_copy(to, from, count);
#else
    for (uint32_t k = 0; k < count; k++) put_where(yes, to + k * W, load(from + k * W));
#endif
}

/* lanes whose last step, of which stage_warm.h keeps the end, was as long and ended here. The count
 * may be any number, from a checkpoint of another's making: no loop goes by it alone. */
INLINE I goes_on(const dm_stage_group *x, uint32_t n) {
    const double *memory = x->memory, *end = memory + DM_WARM_END * W;
    I fits = WHERE(load(memory + DM_WARM_STEP * W) == load(x->h)) &
             WHERE(load(memory + DM_WARM_COUNT * W) > (V){0});
#pragma GCC unroll 16
    for (uint32_t k = 0; k < 4 * n; k++) fits &= WHERE(load(end + k * W) == load(x->state + k * W));
    return fits;
}

#endif
