/* ensemble_inertia.c - looks at the inertia of members in lanes, and into their last steps. */
#include "run/ensemble/ensemble_hand.h"
#include "run/inertia/inertia_look.h"

#include <math.h>
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
    if (!dm_hand_runs(x, i)) return 0;
    const dm_inertia_seen *s = &x->seen[i];
    return (x->done >= s->due || x->done >= dm_hand_steps(x, i)) && x->done > s->looked;
}

/* Times of the members of a group, where M may depend on them. */
static void find_times(const dm_hand *x, uint32_t first, double *t) {
    const uint32_t lanes = x->b->lanes.lanes, n = dm_hand_dim(x);
    const int own = (x->b->stepper->rule->method->traits & DM_OWN_TIME) != 0;
    const double *now = dm_lanes_member(&x->b->lanes, n, first) + 4 * (size_t)n * lanes;
    for (uint32_t l = 0; l < lanes; l++)
        t[l] = own ? now[l] : x->e->t0 + (double)x->done * x->b->h[first + l];
}

/* The lanes of those that are told that are not done with. */
static uint32_t leave_quiet(dm_hand *x, const dm_mass_lanes *w, uint32_t first,
                            const dm_mass_found *f, uint32_t told) {
    const double *q = dm_lanes_member(&x->b->lanes, w->n, first);
    const uint32_t quiet = w->quiet(w, x->seen + first, f, x->done, told);
    dm_inertia_keep_places(x->b->inertia, first, q, w->lanes, quiet);
    return told & ~quiet;
}

/* The same when the middles of the lines from their last looks are looked at. */
static uint32_t look_at_lines(dm_hand *x, dm_mass_lanes *w, uint32_t first, dm_mass_found *f,
                              uint32_t told) {
    const uint32_t lanes = w->lanes;
    for (uint32_t l = 0; l < lanes; l++) {
        if (!(told >> l & 1)) continue;
        const double *from = dm_inertia_place_of(x->b->inertia, first + l);
        const double at = x->seen[first + l].at;
        for (uint32_t k = 0; k < w->n; k++) {
            double *q = w->in + k * lanes + l;
            *q = from[k] + 0.5 * (*q - from[k]);
        }
        w->t[l] = at + 0.5 * (f->t[l] - at);
    }
    const uint32_t found = dm_mass_lanes_look(w, first / lanes, told);
    f->between = w->all;
    return (told & ~found) | leave_quiet(x, w, first, f, found);
}

/* What was found of member i, a lane of what lanes found. */
static void tell(dm_hand *x, const dm_mass_lanes *w, uint32_t i, const dm_mass_found *f) {
    const uint32_t lane = i % w->lanes, blocks = w->blocks.count;
    dm_inertia_value *of = w->told + (size_t)i * blocks;
    dm_inertia_there *out = &x->there[i];
    *out = (dm_inertia_there){.least = INFINITY, .of = of};
    for (uint32_t b = 0; b < blocks; b++) {
        of[b].least = f->least[b * w->lanes + lane], of[b].all = f->all[b * w->lanes + lane];
        out->least = fmin(out->least, of[b].least);
    }
}

/* The lanes of a group that are asked; those that are not done with. */
static uint32_t look_at_group(dm_hand *x, dm_mass_lanes *w, uint32_t first, uint32_t asked) {
    const uint32_t lanes = w->lanes, n = w->n;
    const size_t found = (size_t)w->blocks.count * lanes;
    double t[8];
    find_times(x, first, w->t);
    memcpy(w->in, dm_lanes_member(&x->b->lanes, n, first), (size_t)n * lanes * sizeof *w->in);
    const uint32_t told = dm_mass_lanes_look(w, first / lanes, asked);
    memcpy(w->kept, w->least, 2 * found * sizeof *w->kept); /* and w->all behind it */
    memcpy(t, w->t, lanes * sizeof *w->t);
    dm_mass_found f = {.least = w->kept, .all = w->kept + found, .t = t};
    f.course = dm_inertia_courses_of(x->b->inertia, first, &f.apart);
    uint32_t left = told;
    if (!x->b->stepper->model->mass_bounds) {
        left = leave_quiet(x, w, first, &f, told);
        if (left) left = look_at_lines(x, w, first, &f, left);
    }
    for (uint32_t l = 0; l < lanes; l++)
        if (left >> l & 1) tell(x, w, first + l, &f);
    x->told |= (uint64_t)left << first;
    return (asked & ~told) | left;
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
