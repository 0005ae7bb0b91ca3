/* lanes.h - what methods that step members side by side have in common: memory, packing. */
#ifndef DM_LANES_H
#define DM_LANES_H

#include "integ/method/method.h"

enum { DM_LANES_GROUPS = 8 };

/* Choose lanes, and the number of groups for `size` carried numbers a member, and take x->state.
 * 0: there are no lanes, or no memory. A method that leaves its loops to the model leaves *x
 * too. */
int dm_lanes_open(dm_lanes *x, const dm_model *m, uint32_t size);

/* Entry 0 of member i, counted through the groups; its entries are x->lanes apart. */
static inline double *dm_lanes_member(const dm_lanes *x, uint32_t n, uint32_t i) {
    return x->state + i / x->lanes * dm_state_size(n) * x->lanes + i % x->lanes;
}

/* Entry 0 of what member i leaves to its next step. */
static inline double *dm_lanes_memory(const dm_lanes *x, uint32_t i) {
    return x->memory + i / x->lanes * x->memory_size * x->lanes + i % x->lanes;
}

/* A member's state into its lane, and out of it. */
void dm_lanes_put(dm_lanes *x, uint32_t n, uint32_t i, const double *state);
void dm_lanes_get(const dm_lanes *x, uint32_t n, uint32_t i, double *state);

/* True only when no entry of any lane is NaN or infinite; 0 also where a sum of all would
 * overflow. */
int dm_lanes_are_finite(const dm_lanes *x, uint32_t n);

/* True when no entry of member i is NaN or infinite. */
int dm_lanes_is_finite(const dm_lanes *x, uint32_t n, uint32_t i);

#endif
