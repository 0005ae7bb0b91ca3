/* ensemble_inertia.c - looks at the inertia of members in lanes, and into their last steps. */
#include "run/ensemble/ensemble_hand.h"
#include "run/inertia/inertia_look.h"

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

/* Is member i to be looked at now, since that is due or since it ends here? */
static int is_looked_at(const dm_hand *x, long i) {
    const dm_inertia_seen *s = &x->seen[i];
    return (x->done >= s->due || x->done >= dm_hand_steps(x, i)) && x->done > s->looked &&
           dm_hand_runs(x, i);
}

/* Times of the members of a group, where M may depend on them. */
static void find_times(const dm_hand *x, uint32_t first, double *t) {
    const uint32_t lanes = x->b->lanes.lanes, n = dm_hand_dim(x);
    const int own = (x->b->stepper->rule->method->traits & DM_OWN_TIME) != 0;
    const double *now = dm_lanes_member(&x->b->lanes, n, first) + 4 * (size_t)n * lanes;
    for (uint32_t l = 0; l < lanes; l++)
        t[l] = own ? now[l] : x->e->t0 + (double)x->done * x->b->h[first + l];
}

/* Is member i done with, told what lanes found? */
static int is_quiet(dm_hand *x, uint32_t i, double t) {
    const dm_lanes *lanes = &x->b->lanes;
    const uint32_t n = dm_hand_dim(x);
    if (!dm_inertia_is_quiet(x->b->stepper->model, &x->seen[i], t, x->done, &x->there[i])) return 0;
    dm_inertia_keep_place_of(x->b->inertia, i, dm_lanes_member(lanes, n, i), lanes->lanes);
    return 1;
}

/* The lanes of a group that are asked; those that are not done with. */
static uint32_t look_at_group(dm_hand *x, dm_mass_lanes *w, uint32_t first, uint32_t asked) {
    const dm_lanes *lanes = &x->b->lanes;
    find_times(x, first, w->t);
    const double *q = dm_lanes_member(lanes, dm_hand_dim(x), first);
    const uint32_t told = dm_mass_lanes_look(w, first / lanes->lanes, q, asked);
    for (uint32_t l = 0; l < lanes->lanes; l++) {
        if (!(told >> l & 1)) continue;
        x->there[first + l] = (dm_inertia_there){.least = w->least[l], .all = w->all[l]};
        if (is_quiet(x, first + l, w->t[l])) asked &= ~(1u << l);
    }
    x->told |= (uint64_t)(told & asked) << first;
    return asked;
}

uint64_t dm_hand_find_inertia(dm_hand *x) {
    const uint32_t lanes = x->b->lanes.lanes;
    uint64_t out = 0;
    x->told = 0;
    for (uint32_t first = 0; first < x->count; first += lanes) {
        uint32_t asked = 0;
        for (uint32_t l = 0; l < lanes && first + l < x->count; l++)
            if (is_looked_at(x, first + l)) asked |= 1u << l;
        if (asked && x->b->mass) asked = look_at_group(x, x->b->mass, first, asked);
        out |= (uint64_t)asked << first;
    }
    return out;
}
