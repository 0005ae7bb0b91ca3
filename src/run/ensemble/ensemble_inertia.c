/* ensemble_inertia.c - looks into the last step of a member in lanes. */
#include "run/ensemble/ensemble_block.h"

#include <string.h>

void dm_block_keep(dm_block *b) {
    const dm_lanes *lanes = &b->lanes;
    const size_t all = (size_t)lanes->groups * lanes->lanes;
    memcpy(lanes->kept, lanes->state, all * dm_state_size(b->stepper->model->n) * sizeof(double));
}

int dm_block_vanishes(dm_block *b, uint32_t i, double t, int steep, int open) {
    const uint32_t n = b->stepper->model->n;
    dm_lanes kept = b->lanes;
    double *to = b->inertia->end;
    if (b->stepper->rule->method->traits & DM_OWN_TIME) return 0;
    memcpy(to, b->lanes.alone, dm_state_size(n) * sizeof *to);
    kept.state = kept.kept;
    dm_lanes_get(&kept, n, i, kept.alone);
    return dm_inertia_vanishes_anew(b->inertia, b->stepper, kept.alone, to, t - b->h[i], b->h[i],
                                    steep, open);
}
