/* ensemble_inertia.c - looks into the last step of a member in lanes. */
#include "run/ensemble/ensemble_block.h"

#include <string.h>

void dm_block_keep(dm_block *b) {
    const dm_lanes *lanes = &b->lanes;
    const size_t all = (size_t)lanes->groups * lanes->lanes;
    memcpy(lanes->kept, lanes->state, all * dm_state_size(b->stepper->model->n) * sizeof(double));
}

int dm_block_vanishes(dm_block *b, uint32_t i, double t) {
    dm_lanes kept = b->lanes;
    if (b->stepper->rule->method->traits & DM_OWN_TIME) return 0;
    kept.state = kept.kept;
    dm_lanes_get(&kept, b->stepper->model->n, i, kept.alone);
    return dm_inertia_vanishes_anew(b->inertia, b->stepper, kept.alone, t - b->h[i], b->h[i]);
}
