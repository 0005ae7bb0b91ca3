/* lanes.h - what methods that step members side by side have in common: memory, packing. */
#ifndef DM_LANES_H
#define DM_LANES_H

#include "integ/method/method.h"

enum { DM_LANES_GROUPS = 8 };

/* Choose lanes, and the number of groups for `size` carried numbers a member, and take x->state.
 * 0: there are no lanes, or no memory. A method that leaves its loops to the model leaves *x
 * too. */
int dm_lanes_open(dm_lanes *x, const dm_model *m, uint32_t size);

/* The same for a method that tells what has become of members, and that leaves them `memory_size`
 * numbers each: memory and failures too. */
int dm_lanes_open_told(dm_lanes *x, const dm_model *m, uint32_t size, size_t memory_size);

/* One step from t of the lanes of a group that are asked; the bits of those whose step is done:
 * their state and memory are new, those of the others as they were. */
typedef uint32_t dm_lanes_step(void *method, uint32_t asked, double t);

/* `count` steps of the members of a group that have not failed, h by lane: by `step`, and where
 * that leaves a lane out by the stepper alone. t counts where the model sees it, and the steps of
 * all are the same then. */
void dm_lanes_advance_group(dm_stepper *s, dm_lanes *x, uint32_t group, double t, const double *h,
                            long count, dm_lanes_step *step, void *method);

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
