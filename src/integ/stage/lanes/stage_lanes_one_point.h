/* stage_lanes_one_point.h - a step of one_point.h for W members; a text for the files of
 * stage_lanes.h. */
#ifndef DM_STAGE_LANES_ONE_POINT_H
#define DM_STAGE_LANES_ONE_POINT_H

#include "integ/stage/lanes/one_point_text.h"
#include "integ/stage/lanes/stage_lanes.h"

INLINE uint32_t one_point_of(const dm_stage_lanes *w, uint32_t asked, uint32_t n) {
    one_point_step a = {.g = w->g, .group = &w->group, .kernel = &w->one_point, .n = n};
    const I todo = mask_of(asked) & goes_on(&w->group, n);
    if (!some(todo)) return 0;
    place_start(&a);
    place_guess(&a);
    I ended = iterate(&a, todo);
    ended &= finish_one_point(&a);
    keep(&a, ended, all_lanes());
#pragma GCC unroll 16
    for (uint32_t k = 0; k < 4 * n; k++) put_where(ended, w->group.state + k * W, a.end[k]);
    return bits_of(ended);
}

HOW static uint32_t step_by_one_point(const dm_stage_lanes *w, uint32_t asked) {
    switch (w->g->n) {
    case 1:
        return one_point_of(w, asked, 1);
    case 2:
        return one_point_of(w, asked, 2);
    case 3:
        return one_point_of(w, asked, 3);
    default:
        return one_point_of(w, asked, 4);
    }
}

#endif
