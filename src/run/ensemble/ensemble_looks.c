/* ensemble_looks.c - rows of members in lanes and looks at them beside their flows, and when these
 * are due.
 * Speed: stability maps, Henon-Heiles by verlet: 1.5x, against a state for every look. */
#include "base/largest.h"
#include "run/ensemble/ensemble_hand.h"

#include <limits.h>
#include <string.h>

void dm_hand_choose(const dm_hand *x, long i) {
    const uint32_t many = x->b->stepper->model->params;
    if (!many) return;
    x->b->stepper->params = x->e->params + (size_t)(x->first + i) * many;
    if (x->b->watch) x->b->watch->params = x->b->stepper->params;
    if (x->b->aside) x->b->aside->params = x->b->stepper->params;
}

static int has_own_time(const dm_hand *x) {
    return (x->b->stepper->rule->method->traits & DM_OWN_TIME) != 0;
}

double dm_hand_time(const dm_hand *x, long i, const double *state, long steps) {
    if (has_own_time(x)) return state[4 * (size_t)dm_hand_dim(x)];
    return x->e->t0 + (double)steps * x->b->h[i];
}

static dm_follow *follow_of(const dm_hand *x, long i) {
    return x->e->follow + x->first + i;
}

int dm_hand_has_seen(const dm_hand *x, long i, long steps) {
    return x->e->follow && follow_of(x, i)->seen > steps;
}

/* ---- rows ---- */

/* the row of a state of member i; one that cannot be watched fails */
static void keep_row(dm_hand *x, long i, const double *state, long steps) {
    const dm_ensemble_rows *rows = x->e->rows;
    dm_member *m = dm_hand_member(x, i);
    const double t = dm_hand_time(x, i, state, steps);
    dm_hand_choose(x, i);
    const dm_status status = dm_ensemble_rows_add(rows, x->b->watch, x->first + i, state, t);
    if (status == DM_OK || m->status != DM_OK) return;
    *m = (dm_member){.status = status, .steps = steps};
    memcpy(dm_hand_state(x, i), state, dm_state_size(dm_hand_dim(x)) * sizeof *state);
    x->alive--;
}

void dm_hand_keep_last_row(dm_hand *x, long i) {
    const dm_ensemble_rows *rows = x->e->rows;
    if (!rows) return;
    const long steps = dm_hand_member(x, i)->steps;
    if (steps % dm_hand_every(x, i) != 0 || !rows->count[x->first + i])
        keep_row(x, i, dm_hand_state(x, i), steps);
}

/* ---- looks ---- */

void dm_hand_look_beside(const dm_hand *x, long i, const double *state, long steps) {
    if (!x->e->follow) return;
    dm_hand_choose(x, i);
    dm_follow_state(follow_of(x, i), x->b->aside, state, dm_hand_time(x, i, state, steps), steps,
                    &x->b->at);
}

/* Member i as it lies in its lane, where what is looked at are entries of its state. */
static void look_at_entries(const dm_hand *x, long i) {
    const dm_lanes *lanes = &x->b->lanes;
    const dm_observer *o = x->b->aside;
    const double *state = dm_lanes_member(lanes, dm_hand_dim(x), (uint32_t)i);
    dm_follow *f = follow_of(x, i);
    double *numbers = f->largest + 3 * (size_t)f->count;
    if (f->seen == x->done) return;
    for (uint32_t k = 0; k < o->count; k++)
        numbers[k] = state[(size_t)o->list[k].entry * lanes->lanes];
    dm_follow_look(f, numbers, x->e->t0 + (double)x->done * x->b->h[i], x->done, &x->b->at);
}

/* are there nothing but entries to look at? */
static int looks_at_entries(const dm_hand *x) {
    const dm_observer *o = x->b->aside;
    for (uint32_t k = 0; k < o->count; k++)
        if (o->list[k].kernel || o->list[k].parts) return 0;
    return !has_own_time(x);
}

static void look(dm_hand *x, long i, int entries) {
    if (entries) {
        look_at_entries(x, i);
        return;
    }
    dm_lanes_get(&x->b->lanes, dm_hand_dim(x), (uint32_t)i, x->b->lanes.alone);
    dm_hand_look_beside(x, i, x->b->lanes.alone, x->done);
}

/* ---- what is due ---- */

void dm_hand_keep_rows(dm_hand *x) {
    const long before = x->alive;
    const int follows = x->e->follow != NULL, entries = follows && looks_at_entries(x);
    if (!x->e->rows && !follows) return;
    for (long i = 0; i < x->count; i++) {
        const int row = x->e->rows && x->row[i] <= x->done;
        const int due = follows && follow_of(x, i)->due <= x->done;
        if (!(row || due) || !dm_hand_runs(x, i)) continue;
        if (due) look(x, i, entries);
        if (!row) continue;
        dm_lanes_get(&x->b->lanes, dm_hand_dim(x), (uint32_t)i, x->b->lanes.alone);
        keep_row(x, i, x->b->lanes.alone, x->done);
        x->row[i] += dm_hand_every(x, i);
    }
    if (x->alive < before) dm_hand_pad(x);
}

void dm_hand_find_next(dm_hand *x) {
    const int rows = x->e->rows != NULL;
    const int alike = !rows && !x->e->follow && !x->b->inertia && !dm_hand_has_paces(x);
    long look = LONG_MAX, row = LONG_MAX, end = alike ? x->e->steps : LONG_MAX;
    for (long i = 0; i < x->count && !alike; i++) {
        if (!dm_hand_runs(x, i)) continue;
        if (x->e->follow) look = dm_lesser(look, follow_of(x, i)->due);
        if (x->b->inertia) look = dm_lesser(look, x->seen[i].due);
        if (rows) row = dm_lesser(row, x->row[i]);
        end = dm_lesser(end, dm_hand_steps(x, i));
    }
    x->next_end = end;
    x->next_row = dm_lesser(row, end);
    x->next = dm_lesser(look, x->next_row);
}
