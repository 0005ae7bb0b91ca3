/* ensemble_lanes.c - a block of members side by side; who fails is stepped again alone and leaves.
 * Speed: ensembles, J2 satellite by gauss(3): 4.0x, against a run of its own. */
#include "base/largest.h"
#include "run/ensemble/ensemble_hand.h"
#include "run/inertia/inertia_look.h"

#include <math.h>
#include <stddef.h>
#include <string.h>
#include <time.h>

static const double LOOK = 5e-4;        /* s between looks at the stop flag */
enum { FIRST = 16, LONGEST = 1 << 16 }; /* steps between them */

/* s of a clock that never goes back. */
static double now(void) {
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

/* those of member i */
static const double *params_of(const dm_hand *x, long i) {
    return x->e->params + (size_t)(x->first + i) * x->b->stepper->model->params;
}

/* parameters of member i of the block to the place of lane `to` */
static void put_params(const dm_hand *x, long i, uint32_t to) {
    const uint32_t many = x->b->stepper->model->params;
    if (many)
        memcpy(x->b->lanes.params + (size_t)to * many, params_of(x, i), many * sizeof(double));
}

/* what member i of the block leaves to its next step, which `start` has made */
static void put_memory(const dm_hand *x, uint32_t i) {
    const dm_lanes *lanes = &x->b->lanes;
    double *place;
    if (!lanes->memory) return;
    dm_stepper_memory(x->b->stepper, &place);
    for (size_t k = 0; k < lanes->memory_size; k++)
        dm_lanes_memory(lanes, i)[k * lanes->lanes] = place[k];
}

void dm_hand_pad(dm_hand *x) {
    const uint32_t all = x->b->lanes.lanes * x->b->lanes.groups, n = dm_hand_dim(x);
    long whole = 0;
    if (!x->alive) return;
    while (!dm_hand_runs(x, whole)) whole++;
    dm_lanes_get(&x->b->lanes, n, (uint32_t)whole, x->b->lanes.alone);
    for (uint32_t i = 0; i < all; i++)
        if (i >= x->count || !dm_hand_runs(x, i)) {
            dm_lanes_put(&x->b->lanes, n, i, x->b->lanes.alone);
            put_params(x, whole, i);
            x->b->lanes.told = 0;
            if (x->b->lanes.failed) x->b->lanes.failed[i] = DM_STOPPED;
        }
}

/* steps of the members, and any for lanes without one */
static void set_steps(dm_hand *x) {
    const dm_pace *own = dm_hand_has_paces(x) ? x->e->pace + x->first : NULL;
    for (long i = 0; i < DM_HAND_MOST; i++) x->b->h[i] = x->e->h;
    for (long i = 0; own && i < DM_HAND_MOST; i++) x->b->h[i] = own[i < x->count ? i : 0].h;
}

/* It looks at member i from here on. */
static dm_inertia *inertia_of(const dm_hand *x, long i) {
    if (x->b->inertia) dm_inertia_choose(x->b->inertia, (size_t)i, &x->seen[i]);
    return x->b->inertia;
}

/* Members that cannot start have failed already; the others lie in their lanes from here on. */
static void begin(dm_hand *x) {
    dm_stepper *s = x->b->stepper;
    const int has_params = s->model->params > 0;
    for (long i = 0; i < x->count; i++) {
        dm_member *m = dm_hand_member(x, i);
        if (has_params) dm_hand_choose(x, i);
        if (x->e->follow) dm_follow_begin(x->e->follow + x->first + i);
        m->status = dm_stepper_start(s, dm_hand_state(x, i), x->e->t0, x->b->h[i]);
        if (m->status != DM_OK) continue;
        if (x->b->inertia) {
            m->status =
                dm_inertia_begin(inertia_of(x, i), dm_hand_state(x, i), x->e->t0, x->b->h[i]);
            x->seen[i] = x->b->inertia->seen;
            m->fading = m->status != DM_OK;
            if (m->fading) continue;
            if (x->b->mass) dm_mass_lanes_put_scale(x->b->mass, (uint32_t)i, x->b->inertia->scale);
        }
        dm_lanes_put(&x->b->lanes, dm_hand_dim(x), (uint32_t)i, dm_hand_state(x, i));
        if (has_params) put_params(x, i, (uint32_t)i);
        put_memory(x, (uint32_t)i);
        if (x->b->lanes.failed) x->b->lanes.failed[i] = DM_OK;
        x->alive++;
    }
    dm_hand_pad(x);
}

/* Member i from its start, which its place still holds, as a run of its own. */
static void run_alone(dm_hand *x, long i) {
    dm_ensemble e = *x->e;
    dm_ensemble_rows rows;
    if (e.rows) rows = *e.rows, rows.every = dm_hand_every(x, i), e.rows = &rows;
    e.h = x->b->h[i];
    e.steps = dm_hand_steps(x, i);
    dm_run_member(&e,
                  &(dm_member_run){.stepper = x->b->stepper,
                                   .watch = x->b->watch,
                                   .aside = x->b->aside,
                                   .inertia = inertia_of(x, i)},
                  x->first + i);
    x->ended |= (uint64_t)1 << i;
}

/* Member i goes on from a look. */
static void go_on(dm_hand *x, long i, double t) {
    dm_lanes_get(&x->b->lanes, dm_hand_dim(x), (uint32_t)i, x->b->lanes.alone);
    dm_inertia_go_on(x->b->inertia, x->b->lanes.alone, t);
}

/* Has member i gone over a change of inertia in the steps that are done, in lanes still, or may it
 * have? Then it runs again alone, up to that step. `failed`: in the one after these. */
static int has_crossed(dm_hand *x, long i, long done, int failed) {
    dm_inertia *inertia = inertia_of(x, i);
    double *now = x->b->lanes.alone;
    if (!inertia || done == 0) return 0;
    const int one = !failed && done == inertia->seen.looked + 1;
    const int open = one && inertia->seen.open;
    int steep = one && dm_inertia_is_steep(&inertia->seen);
    dm_lanes_get(&x->b->lanes, dm_hand_dim(x), (uint32_t)i, now);
    const double t = dm_hand_time(x, i, now, done);
    const int told = !failed && (x->told >> i & 1);
    const int seen = dm_inertia_look(inertia, now, t, done, told ? &x->there[i] : NULL);
    int over = seen == DM_INERTIA_CHANGED || (seen && !one); /* as a run goes back to see */
    steep |= one && seen == DM_INERTIA_TURNED;
    dm_hand_choose(x, i);
    over = over || ((steep || open) && dm_block_vanishes(x->b, (uint32_t)i, t, steep, open));
    if (!over && !failed) go_on(x, i, t);
    x->seen[i] = inertia->seen;
    if (x->b->mass) dm_mass_lanes_put_scale(x->b->mass, (uint32_t)i, inertia->scale);
    if (over) run_alone(x, i);
    return over;
}

/* member i is not finite after `count` steps: from the kept state alone, to the step that fails; if
 * it was looked at meanwhile from its start */
static void repeat_alone(dm_hand *x, long i, double t, long count) {
    dm_lanes kept = x->b->lanes; /* but for the states */
    dm_stepper *s = x->b->stepper;
    dm_member *m = dm_hand_member(x, i);
    double *state = dm_hand_state(x, i);
    long done = 0;
    if (x->b->inertia || dm_hand_has_seen(x, i, x->kept)) {
        run_alone(x, i);
        x->alive--;
        return;
    }
    dm_hand_choose(x, i);
    kept.state = x->b->lanes.kept;
    dm_lanes_get(&kept, dm_hand_dim(x), (uint32_t)i, state);
    m->status = dm_advance(s, state, t, x->b->h[i], count, &done);
    m->steps = x->kept + done;
    if (m->status == DM_OK) {
        dm_lanes_put(&x->b->lanes, dm_hand_dim(x), (uint32_t)i, state);
        return;
    }
    dm_ensemble_note(x->e, x->first + i, &s->report.trouble);
    x->alive--;
    dm_hand_look_beside(x, i, state, m->steps);
    dm_hand_keep_last_row(x, i);
}

/* member i failed, as the method says, in the step after those that it has done of a burst */
static void leave(dm_hand *x, long i) {
    const dm_lanes *lanes = &x->b->lanes;
    const long done = x->done + lanes->done[i];
    if (has_crossed(x, i, done, 1)) {
        x->alive--;
        return;
    }
    const dm_inertia *inertia = inertia_of(x, i);
    *dm_hand_member(x, i) = (dm_member){.status = lanes->failed[i],
                                        .steps = done,
                                        .fading = inertia && dm_inertia_is_fading(inertia)};
    dm_ensemble_note(x->e, x->first + i, lanes->trouble + i);
    dm_lanes_get(lanes, dm_hand_dim(x), (uint32_t)i, dm_hand_state(x, i));
    x->alive--;
    dm_hand_choose(x, i);
    dm_hand_look_beside(x, i, dm_hand_state(x, i), dm_hand_member(x, i)->steps);
    dm_hand_keep_last_row(x, i);
}

/* a burst of a method that tells who failed */
static void advance_told(dm_hand *x, double t, long count) {
    dm_lanes *lanes = &x->b->lanes;
    dm_stepper *s = x->b->stepper;
    if (count == 1 && x->b->inertia) dm_block_keep(x->b); /* a look may ask for it */
    s->engine->advance_lanes(s, lanes, t, x->b->h, count);
    for (long i = 0; i < x->count; i++)
        if (dm_hand_runs(x, i) && lanes->failed[i] != DM_OK) leave(x, i);
}

/* Members that have failed since states were kept have one that is not finite: t and `count` steps
 * since then. */
static void settle(dm_hand *x, double t, long count) {
    dm_lanes *lanes = &x->b->lanes;
    const long before = x->alive;
    if (x->kept < 0) return;
    if (!dm_lanes_are_finite(lanes, dm_hand_dim(x)))
        for (long i = 0; i < x->count; i++)
            if (dm_hand_runs(x, i) && !dm_lanes_is_finite(lanes, dm_hand_dim(x), (uint32_t)i))
                repeat_alone(x, i, t, count);
    x->kept = -1;
    if (x->alive < before) dm_hand_pad(x);
}

/* a burst of a method that does not tell; `last`: failures are looked for at its end */
static void advance_seen(dm_hand *x, double t, long count, int last) {
    dm_stepper *s = x->b->stepper;
    if (x->kept < 0) {
        dm_block_keep(x->b);
        x->kept = x->done;
    }
    s->engine->advance_lanes(s, &x->b->lanes, t, x->b->h, count);
    if (last) settle(x, t, x->done + count - x->kept);
}

/* t is that of the members without a pace; those that have one see no time. */
static void advance(dm_hand *x, long count, int last) {
    const double t = x->e->t0 + (double)x->done * x->b->h[0];
    const long before = x->alive;
    if (x->b->lanes.failed)
        advance_told(x, t, count);
    else
        advance_seen(x, t, count, last);
    x->done += count;
    if (x->alive < before) dm_hand_pad(x);
}

/* member i goes no further */
static void end(dm_hand *x, long i, dm_status status) {
    dm_lanes_get(&x->b->lanes, dm_hand_dim(x), (uint32_t)i, dm_hand_state(x, i));
    dm_hand_member(x, i)->status = status, dm_hand_member(x, i)->steps = x->done;
    if (status == DM_OK && x->e->follow) dm_hand_look_beside(x, i, dm_hand_state(x, i), x->done);
    if (x->e->rows) dm_hand_keep_last_row(x, i);
}

/* members that have gone over a change of inertia leave */
static void end_crossed(dm_hand *x) {
    const long before = x->alive;
    if (!x->b->inertia) return;
    const uint64_t seen = dm_hand_find_inertia(x);
    for (long i = 0; i < x->count && seen >> i; i++)
        if ((seen >> i & 1) && has_crossed(x, i, x->done, 0)) x->alive--;
    x->told = 0;
    if (x->alive < before) dm_hand_pad(x);
}

/* members that have done all of their steps leave */
static void end_some(dm_hand *x) {
    const long before = x->alive;
    const int paces = dm_hand_has_paces(x); /* else all of them */
    if (x->done < (paces ? x->next_end : x->e->steps)) return;
    for (long i = 0; i < x->count; i++) {
        if (!dm_hand_runs(x, i) || (paces && x->done < dm_hand_steps(x, i))) continue;
        end(x, i, DM_OK);
        if (!dm_hand_runs(x, i)) continue; /* its last row has no value */
        x->ended |= (uint64_t)1 << i;
        x->alive--;
    }
    if (x->alive < before) dm_hand_pad(x);
}

/* Steps to what comes next, `burst` at most; where L depends on t one by one, as a run alone does.
 * Between rows a failure waits: what a look sees of it does not count. */
static void advance_some(dm_hand *x, long burst) {
    const int autonomous = (x->b->stepper->model->structure & DM_AUTONOMOUS) != 0;
    const long goal = dm_lesser(burst, x->next - x->done);
    const int waits = autonomous && !x->b->inertia && goal < burst && x->next < x->next_row;
    for (long k = 0; k < goal && x->alive; k += autonomous ? goal : 1)
        advance(x, autonomous ? goal : 1, !waits);
}

/* to the end or the stop flag */
static dm_status run(dm_hand *x) {
    double looked = now();
    long burst = x->b->burst, since = 0, told = 0; /* steps, and of all members, since a look */
    end_some(x);
    while (x->alive) {
        const long before = x->done;
        if (x->e->stop && *x->e->stop) return settle(x, NAN, x->done - x->kept), DM_STOPPED;
        dm_hand_find_next(x);
        advance_some(x, burst - since);
        since += x->done - before;
        told += (x->done - before) * x->alive;
        end_crossed(x);
        dm_hand_keep_rows(x);
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
    dm_hand x;
    memset(&x, 0,
           b->inertia ? sizeof x
           : e->rows  ? offsetof(dm_hand, seen)
                      : offsetof(dm_hand, row));
    x.e = e, x.b = b, x.first = first, x.count = count, x.kept = -1;
    const uint32_t together = b->lanes.together ? b->lanes.together : 1;
    const long pass = (long)b->lanes.lanes * together;
    b->lanes.groups = (uint32_t)((count - 1) / pass + 1) * together;
    set_steps(&x);
    begin(&x);
    b->lanes.told = 0;
    dm_hand_keep_rows(&x);
    const dm_status status = run(&x);
    for (long i = 0; i < count && x.alive; i++)
        if (dm_hand_runs(&x, i)) end(&x, i, status);
}

int dm_block_is_paced(const dm_block *b) {
    return b->lanes.paced && (b->stepper->model->structure & DM_AUTONOMOUS);
}

/* Bursts begin short: how long a step takes is not known yet. */
int dm_block_open(dm_block *b, dm_stepper *s, dm_inertia *inertia) {
    *b = (dm_block){.stepper = s, .burst = FIRST, .inertia = inertia};
    if (inertia) inertia->next = NULL, inertia->own = (s->rule->method->traits & DM_OWN_TIME) != 0;
    if (!s->engine->widen || !s->engine->widen(s, &b->lanes)) return 0;
    b->mass = inertia ? dm_mass_lanes_open(s->model, &b->lanes) : NULL;
    if (inertia) inertia->wide = b->mass;
    b->most = b->lanes.groups;
    return 1;
}
