/* ensemble_lanes.c - a block of members side by side; who fails is stepped again alone and leaves.
 * Speed: ensembles, J2 satellite by gauss(3): 4.0x, against a run of its own. */
#include "base/largest.h"
#include "run/ensemble/ensemble_block.h"

#include <string.h>
#include <time.h>

static const double LOOK = 5e-4;        /* s between looks at the stop flag */
enum { FIRST = 16, LONGEST = 1 << 16 }; /* steps between them */

typedef struct {
    const dm_ensemble *e;
    dm_block *b;
    long first, count;                         /* members of the block */
    long done;                                 /* steps */
    long alive;                                /* members that still run */
    char ended[DM_LANES_GROUPS * 8];           /* members that have done all of their steps */
    dm_inertia_seen seen[DM_LANES_GROUPS * 8]; /* of members, where the inertia may change */
} block;

/* s of a clock that never goes back. */
static double now(void) {
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static uint32_t dim(const block *x) {
    return x->b->stepper->model->n;
}

static double *state_of(const block *x, long i) {
    return x->e->state + (size_t)(x->first + i) * dm_state_size(dim(x));
}

static dm_member *member_of(const block *x, long i) {
    return x->e->member + x->first + i;
}

/* member i still runs */
static int runs(const block *x, long i) {
    return member_of(x, i)->status == DM_OK && !x->ended[i];
}

/* Lanes have steps of their own, by member. */
static int has_paces(const block *x) {
    return x->e->pace && dm_block_is_paced(x->b);
}

/* its steps, and how many of them from row to row */
static long steps_of(const block *x, long i) {
    return has_paces(x) ? x->e->pace[x->first + i].steps : x->e->steps;
}

static long every_of(const block *x, long i) {
    return has_paces(x) ? x->e->pace[x->first + i].every : x->e->rows->every;
}

/* those of member i of the block */
static const double *params_of(const block *x, long i) {
    return x->e->params + (size_t)(x->first + i) * x->b->stepper->model->params;
}

/* parameters of member i of the block to the place of lane `to` */
static void put_params(const block *x, long i, uint32_t to) {
    const uint32_t many = x->b->stepper->model->params;
    if (many)
        memcpy(x->b->lanes.params + (size_t)to * many, params_of(x, i), many * sizeof(double));
}

/* what is computed for member i alone has its parameters */
static void choose_member(const block *x, long i) {
    if (!x->b->stepper->model->params) return;
    x->b->stepper->params = params_of(x, i);
    if (x->b->watch) x->b->watch->params = x->b->stepper->params;
    if (x->b->aside) x->b->aside->params = x->b->stepper->params;
}

/* what member i of the block leaves to its next step, which `start` has made */
static void put_memory(const block *x, uint32_t i) {
    const dm_lanes *lanes = &x->b->lanes;
    double *place;
    if (!lanes->memory) return;
    dm_stepper_memory(x->b->stepper, &place);
    for (size_t k = 0; k < lanes->memory_size; k++)
        dm_lanes_memory(lanes, i)[k * lanes->lanes] = place[k];
}

/* a lane without a member of its own runs along with another's numbers, or is left alone */
static void pad(block *x) {
    const uint32_t all = x->b->lanes.lanes * x->b->lanes.groups, n = dim(x);
    long whole = 0;
    while (whole < x->count && !runs(x, whole)) whole++;
    if (whole == x->count) return;
    dm_lanes_get(&x->b->lanes, n, (uint32_t)whole, x->b->lanes.alone);
    for (uint32_t i = 0; i < all; i++)
        if (i >= x->count || !runs(x, i)) {
            dm_lanes_put(&x->b->lanes, n, i, x->b->lanes.alone);
            put_params(x, whole, i);
            if (x->b->lanes.failed) x->b->lanes.failed[i] = DM_STOPPED;
        }
}

/* Of member i after so many steps, or as its state has it. */
static double time_of(const block *x, long i, const double *state, long steps) {
    if (x->b->stepper->rule->method->traits & DM_OWN_TIME) return state[4 * (size_t)dim(x)];
    return x->e->t0 + (double)steps * x->b->h[i];
}

/* the row of a state of member i; one that cannot be watched fails */
static void keep_row(block *x, long i, const double *state, long steps) {
    const dm_ensemble_rows *rows = x->e->rows;
    dm_member *m = member_of(x, i);
    const double t = time_of(x, i, state, steps);
    choose_member(x, i);
    const dm_status status = dm_ensemble_rows_add(rows, x->b->watch, x->first + i, state, t);
    if (status == DM_OK || m->status != DM_OK) return;
    *m = (dm_member){.status = status, .steps = steps};
    memcpy(state_of(x, i), state, dm_state_size(dim(x)) * sizeof *state);
    x->alive--;
}

/* beside its flow: member i, whose state this is after so many steps */
static void look_beside(const block *x, long i, const double *state, long steps) {
    if (!x->e->follow) return;
    dm_follow *f = x->e->follow + x->first + i;
    choose_member(x, i);
    dm_follow_state(f, x->b->aside, state, time_of(x, i, state, steps), steps, &x->b->at);
}

/* a row of every member that still runs, a look at those that are due */
static void keep_rows(block *x) {
    const long before = x->alive;
    const dm_follow *f = x->e->follow ? x->e->follow + x->first : NULL;
    if (!x->e->rows && !f) return;
    for (long i = 0; i < x->count; i++) {
        const int row = x->e->rows && x->done % every_of(x, i) == 0;
        const int due = f && f[i].due <= x->done;
        if (!(row || due) || !runs(x, i)) continue;
        dm_lanes_get(&x->b->lanes, dim(x), (uint32_t)i, x->b->lanes.alone);
        if (due) look_beside(x, i, x->b->lanes.alone, x->done);
        if (row) keep_row(x, i, x->b->lanes.alone, x->done);
    }
    if (x->alive < before) pad(x);
}

/* the last state, or the last good one, if it is not a row yet */
static void keep_last_row(block *x, long i) {
    const dm_ensemble_rows *rows = x->e->rows;
    const long steps = member_of(x, i)->steps;
    if (rows && (steps % every_of(x, i) != 0 || !rows->count[x->first + i]))
        keep_row(x, i, state_of(x, i), steps);
}

/* at most `most` steps to the next row or the end of a member */
static long to_event(const block *x, long most) {
    const int rows = x->e->rows != NULL;
    const dm_follow *f = x->e->follow ? x->e->follow + x->first : NULL;
    for (long i = 0; i < x->count && (f || x->b->inertia); i++) {
        if (!runs(x, i)) continue;
        if (f) most = dm_lesser(most, f[i].due - x->done);
        if (x->b->inertia) most = dm_lesser(most, x->seen[i].due - x->done);
    }
    if (!has_paces(x)) {
        most = dm_lesser(most, x->e->steps - x->done);
        return rows ? dm_lesser(most, every_of(x, 0) - x->done % every_of(x, 0)) : most;
    }
    for (long i = 0; i < x->count; i++) {
        if (!runs(x, i)) continue;
        most = dm_lesser(most, steps_of(x, i) - x->done);
        if (rows) most = dm_lesser(most, every_of(x, i) - x->done % every_of(x, i));
    }
    return most;
}

/* steps of the members, and any for lanes without one */
static void set_steps(block *x) {
    const dm_pace *own = has_paces(x) ? x->e->pace + x->first : NULL;
    for (long i = 0; i < DM_LANES_GROUPS * 8; i++)
        x->b->h[i] = own ? own[i < x->count ? i : 0].h : x->e->h;
}

/* It looks at member i from here on. */
static dm_inertia *inertia_of(const block *x, long i) {
    if (x->b->inertia) dm_inertia_choose(x->b->inertia, (size_t)i, &x->seen[i]);
    return x->b->inertia;
}

/* Members that cannot start have failed already; the others lie in their lanes from here on. */
static void begin(block *x) {
    dm_stepper *s = x->b->stepper;
    for (long i = 0; i < x->count; i++) {
        dm_member *m = member_of(x, i);
        choose_member(x, i);
        if (x->e->follow) dm_follow_begin(x->e->follow + x->first + i);
        *m = (dm_member){.status = dm_stepper_start(s, state_of(x, i), x->e->t0, x->b->h[i])};
        if (m->status != DM_OK) continue;
        if (x->b->inertia) {
            dm_inertia_begin(inertia_of(x, i), state_of(x, i), x->e->t0, x->b->h[i]);
            x->seen[i] = x->b->inertia->seen;
        }
        dm_lanes_put(&x->b->lanes, dim(x), (uint32_t)i, state_of(x, i));
        put_params(x, i, (uint32_t)i);
        put_memory(x, (uint32_t)i);
        if (x->b->lanes.failed) x->b->lanes.failed[i] = DM_OK;
        x->alive++;
    }
    pad(x);
}

/* Member i from its start, which its place still holds, as a run of its own. */
static void run_alone(block *x, long i) {
    dm_ensemble e = *x->e;
    dm_ensemble_rows rows;
    if (e.rows) rows = *e.rows, rows.every = every_of(x, i), e.rows = &rows;
    e.h = x->b->h[i];
    e.steps = steps_of(x, i);
    dm_run_member(&e,
                  &(dm_member_run){.stepper = x->b->stepper,
                                   .watch = x->b->watch,
                                   .aside = x->b->aside,
                                   .inertia = inertia_of(x, i)},
                  x->first + i);
    x->ended[i] = 1;
}

/* Has member i gone over a change of inertia? Then it runs again alone, up to that step. */
static int has_crossed(block *x, long i) {
    dm_inertia *inertia = inertia_of(x, i);
    const double *now = x->b->lanes.alone;
    if (!inertia || x->done == 0) return 0;
    const int steep = dm_inertia_is_steep(inertia) && x->done == inertia->seen.looked + 1;
    dm_lanes_get(&x->b->lanes, dim(x), (uint32_t)i, x->b->lanes.alone);
    const double t = time_of(x, i, now, x->done);
    const int crossed = dm_inertia_look(inertia, now, t, x->done);
    x->seen[i] = inertia->seen;
    choose_member(x, i);
    if (!crossed && !(steep && dm_block_vanishes(x->b, (uint32_t)i, t))) return 0;
    run_alone(x, i);
    return 1;
}

/* member i is not finite after `count` steps: from the kept state alone, to the step that fails */
static void repeat_alone(block *x, long i, double t, long count) {
    dm_lanes kept = x->b->lanes; /* but for the states */
    dm_stepper *s = x->b->stepper;
    dm_member *m = member_of(x, i);
    double *state = state_of(x, i);
    long done = 0;
    if (x->b->inertia) {
        run_alone(x, i);
        x->alive--;
        return;
    }
    choose_member(x, i);
    kept.state = x->b->lanes.kept;
    dm_lanes_get(&kept, dim(x), (uint32_t)i, state);
    m->status = dm_advance(s, state, t, x->b->h[i], count, &done);
    m->steps = x->done + done;
    if (m->status == DM_OK) {
        dm_lanes_put(&x->b->lanes, dim(x), (uint32_t)i, state);
        return;
    }
    x->alive--;
    keep_last_row(x, i);
}

/* member i failed, as the method says, in the step after those that it has done of a burst */
static void leave(block *x, long i) {
    const dm_lanes *lanes = &x->b->lanes;
    if (has_crossed(x, i)) {
        x->alive--;
        return;
    }
    *member_of(x, i) = (dm_member){.status = lanes->failed[i], .steps = x->done + lanes->done[i]};
    dm_lanes_get(lanes, dim(x), (uint32_t)i, state_of(x, i));
    x->alive--;
    choose_member(x, i);
    keep_last_row(x, i);
}

/* a burst of a method that tells who failed */
static void advance_told(block *x, double t, long count) {
    dm_lanes *lanes = &x->b->lanes;
    dm_stepper *s = x->b->stepper;
    if (x->b->inertia && count == 1) dm_block_keep(x->b);
    s->engine->advance_lanes(s, lanes, t, x->b->h, count);
    for (long i = 0; i < x->count; i++)
        if (runs(x, i) && lanes->failed[i] != DM_OK) leave(x, i);
}

/* a burst of one whose members that failed have a state that is not finite */
static void advance_seen(block *x, double t, long count) {
    dm_lanes *lanes = &x->b->lanes;
    dm_stepper *s = x->b->stepper;
    dm_block_keep(x->b);
    s->engine->advance_lanes(s, lanes, t, x->b->h, count);
    if (dm_lanes_are_finite(lanes, dim(x))) return;
    for (long i = 0; i < x->count; i++)
        if (runs(x, i) && !dm_lanes_is_finite(lanes, dim(x), (uint32_t)i))
            repeat_alone(x, i, t, count);
}

/* t is that of the members without a pace; those that have one see no time. */
static void advance(block *x, long count) {
    const double t = x->e->t0 + (double)x->done * x->b->h[0];
    const long before = x->alive;
    if (x->b->lanes.failed)
        advance_told(x, t, count);
    else
        advance_seen(x, t, count);
    x->done += count;
    if (x->alive < before) pad(x);
}

/* member i goes no further */
static void end(block *x, long i, dm_status status) {
    if (status == DM_OK && has_crossed(x, i)) return;
    dm_lanes_get(&x->b->lanes, dim(x), (uint32_t)i, state_of(x, i));
    *member_of(x, i) = (dm_member){.status = status, .steps = x->done};
    if (status == DM_OK) look_beside(x, i, state_of(x, i), x->done);
    keep_last_row(x, i);
}

/* members that have gone over a change of inertia leave */
static void end_crossed(block *x) {
    const long before = x->alive;
    for (long i = 0; i < x->count && x->b->inertia; i++)
        if (runs(x, i) && x->done >= x->seen[i].due && has_crossed(x, i)) x->alive--;
    if (x->alive < before) pad(x);
}

/* members that have done all of their steps leave */
static void end_some(block *x) {
    const long before = x->alive;
    for (long i = 0; i < x->count; i++) {
        if (!runs(x, i) || x->done < steps_of(x, i)) continue;
        end(x, i, DM_OK);
        x->ended[i] = 1;
        x->alive--;
    }
    if (x->alive < before) pad(x);
}

/* steps up to the end or the stop flag; where L depends on t one by one, as a run alone does */
static dm_status run(block *x) {
    const dm_stepper *s = x->b->stepper;
    const int autonomous = (s->model->structure & DM_AUTONOMOUS) != 0;
    double looked = now();
    long burst = x->b->burst, since = 0, told = 0; /* steps, and of all members, since a look */
    end_some(x);
    while (x->alive) {
        const long goal = to_event(x, burst - since), before = x->done;
        if (x->e->stop && *x->e->stop) return DM_STOPPED;
        for (long k = 0; k < goal && x->alive; k += autonomous ? goal : 1)
            advance(x, autonomous ? goal : 1);
        since += x->done - before;
        told += (x->done - before) * x->alive;
        end_crossed(x);
        keep_rows(x);
        end_some(x);
        if (since < burst && x->alive) continue;
        x->b->count(x->b->ud, told);
        since = told = 0;
        const double took = now() - looked;
        looked += took;
        if (took < 0.5 * LOOK && burst < LONGEST) burst *= took < 0.125 * LOOK ? 4 : 2;
        if (took > LOOK && burst > 1) burst /= 2;
        x->b->burst = burst;
    }
    return DM_OK;
}

/* As many groups as the members in hand need, rounded up to what is stepped together. */
void dm_block_run(const dm_ensemble *e, dm_block *b, long first, long count) {
    block x = {.e = e, .b = b, .first = first, .count = count};
    const uint32_t together = b->lanes.together ? b->lanes.together : 1;
    const long pass = (long)b->lanes.lanes * together;
    b->lanes.groups = (uint32_t)((count - 1) / pass + 1) * together;
    set_steps(&x);
    begin(&x);
    keep_rows(&x);
    const dm_status status = run(&x);
    for (long i = 0; i < count; i++)
        if (runs(&x, i)) end(&x, i, status);
}

int dm_block_is_paced(const dm_block *b) {
    return b->lanes.paced && (b->stepper->model->structure & DM_AUTONOMOUS);
}

/* Bursts begin short: how long a step takes is not known yet. */
int dm_block_open(dm_block *b, dm_stepper *s) {
    *b = (dm_block){.stepper = s, .burst = FIRST};
    if (!s->engine->widen || !s->engine->widen(s, &b->lanes)) return 0;
    b->most = b->lanes.groups;
    return 1;
}
