/* avi_inside.h - what the files of avi.h share. */
#ifndef DM_AVI_INSIDE_H
#define DM_AVI_INSIDE_H

#include "field/avi/avi.h"

/* The sum that a cell belongs to. */
static inline dm_avi_sum *dm_avi_sum_of(const dm_avi *a, uint32_t cell) {
    dm_avi_sum *s = a->sum + a->sums - 1;
    while (cell < s->first) s--;
    return s;
}

/* Does cell k come before cell l? */
static inline int dm_avi_is_before(const dm_avi_cell *cell, uint32_t k, uint32_t l) {
    const double s = cell[k].time, t = cell[l].time;
    return s < t || (s == t && k < l);
}

/* What cells of one sum read and kick; s->loop is not made yet. No kicks: the sum is no part of the
 * potential. */
dm_status dm_avi_sum_open(dm_avi_sum *s, const dm_sum *sum, uint32_t n, dm_compile *compile,
                          dm_arena *arena);

/* The slopes of cell i at time t where its entries stand, in s->y. */
void dm_avi_slopes(const dm_avi *a, const dm_avi_sum *s, uint32_t i, double t);

/* Neighbours of all cells. DM_TOO_LARGE: more than 2^32. */
dm_status dm_avi_find_near(dm_avi *a, dm_arena *arena);

/* Who is blocked by whom, and who may fire, by the times of the cells. */
void dm_avi_order(dm_avi *a);

#endif
