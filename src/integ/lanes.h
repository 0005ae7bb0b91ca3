/* lanes.h - what methods that step members side by side have in common: memory, packing. */
#ifndef DM_LANES_H
#define DM_LANES_H

#include "integ/fused.h"

enum { DM_LANES_GROUPS = 8 };

/*
** Choose the number of groups for a stage of `size` numbers a member and take all memory: x->state and
** buffers for every group. `like`: a kernel of one member; where that is not native there are no lanes.
** 0: there are none, or no memory.
*/
int dm_lanes_open(dm_lanes *x, dm_fused *buffers, const dm_model *m, uint32_t size,
                  const dm_kernel *like);

/* Entry 0 of member i, counted through the groups; its entries are x->lanes apart. */
static inline double *dm_lanes_member(const dm_lanes *x, uint32_t n, uint32_t i) {
    return x->state + i / x->lanes * dm_state_size(n) * x->lanes + i % x->lanes;
}

/* A member's state into its lane, and out of it. */
void dm_lanes_put(dm_lanes *x, uint32_t n, uint32_t i, const double *state);
void dm_lanes_get(const dm_lanes *x, uint32_t n, uint32_t i, double *state);

/* True when no entry of member i is NaN or infinite. */
int dm_lanes_is_finite(const dm_lanes *x, uint32_t n, uint32_t i);

/* Constant outputs of the kernel into both buffers; its eval may be NULL. */
void dm_lanes_prepare(dm_fused *f, const dm_kernel *k);

#endif
