/* splitting_loop_run.c - coefficients of steps for such a loop, and its bursts.
 * Speed: steps, leapfrog ensemble of Kepler orbits: 19x, and 1.1x for a single member. */
#include "integ/split/splitting_loop_inside.h"

#include <string.h>

/* ---- coefficients ---- */

/* of a force at time `at` and of the kick by it */
static double *put_force(double *c, const dm_splitting_burst *x, double at, double hb) {
    c[0] = at, c[1] = hb, c[2] = -hb;
    if (x->many) memcpy(c + 3, x->params, x->many * sizeof *c);
    return c + 3 + x->many;
}

/* of a merged step: the last kick is also the first one of the next step */
static double *put_merged(double *c, const dm_splitting_burst *x) {
    const dm_splitting *table = x->table;
    for (int k = 0; k < table->stages; k++) {
        const double next = k + 1 < table->stages ? 0.0 : table->b[0];
        *c++ = x->h * table->a[k];
        c = put_force(c, x, 0.0, x->h * (table->b[k + 1] + next));
    }
    return c;
}

/* of the step that begins at t */
static double *put_step(double *c, unsigned shape, const dm_splitting_burst *x, double t) {
    const dm_splitting *table = x->table;
    if (shape & DM_LOOP_MERGED) return put_merged(c, x);
    const int kick_only_first = dm_splitting_loop_ends(shape) == DM_LOOP_KICK_FIRST;
    const int forces = table->stages - !dm_splitting_loop_ends(shape);
    if (dm_splitting_loop_ends(shape) == DM_LOOP_KICKS_AT_BOTH_ENDS) *c++ = x->h * table->b[0];
    for (int k = 0; k < table->stages; k++) {
        const int kick = kick_only_first ? k : k + 1;
        const double at = t + x->c[kick] * x->h, hb = x->h * table->b[kick];
        if (kick_only_first) c = put_force(c, x, at, hb);
        *c++ = x->h * table->a[k];
        if (!kick_only_first && k < forces) c = put_force(c, x, at, hb);
    }
    return c;
}

/* what a call has coefficients for */
typedef struct {
    long steps;
    int64_t stride; /* doubles from one step to the next */
    size_t count;
} coefficients;

/* of the steps from `done` on, as many as have room; where the force does not see the time one
 * is enough */
static coefficients put_steps(double *c, const dm_splitting_loop *l, const dm_model *m,
                              const dm_splitting_burst *x, long done) {
    const int timeless = (m->structure & DM_AUTONOMOUS) != 0;
    const long left = x->count - done, different = timeless ? 1 : left;
    double *to = c;
    coefficients put = {.steps = left};
    if (dm_splitting_loop_ends(l->shape) == DM_LOOP_KICKS_AT_BOTH_ENDS &&
        !(l->shape & DM_LOOP_MERGED))
        to = put_force(to, x, x->t + (double)done * x->h, x->h * x->table->b[x->table->stages]);
    const long of_step = DM_LOOP_OF_STEP + (DM_SPLITTING_STAGES + 1) * (long)x->many;
    for (long k = 0; k < different; k++) {
        if (to - c > DM_LOOP_COEFFICIENTS - of_step) {
            put.steps = k;
            break;
        }
        double *end = put_step(to, l->shape, x, timeless ? 0.0 : x->t + (double)(done + k) * x->h);
        put.stride = timeless ? 0 : end - to;
        to = end;
    }
    put.count = (size_t)(to - c);
    return put;
}

/* how often a step does its body */
static int64_t repeats(const dm_splitting_loop *l, const dm_splitting *table) {
    const int e = dm_splitting_loop_ends(l->shape);
    if (l->shape & DM_LOOP_MERGED) return table->stages;
    return table->stages - (e == DM_LOOP_KICKS_AT_BOTH_ENDS || e == 0);
}

/* ---- one member ---- */

/* p += share h force, for merged steps */
static void kick_alone(const dm_loop *l, double *state, double *c, const dm_splitting_burst *x,
                       double share) {
    put_force(c, x, 0.0, x->h * share);
    dm_loop_call call = {.state = state, .coefficients = c, .groups = 1, .repeats = 1, .steps = 1};
    dm_loop_run(l, &call);
}

/* the place of the momentum between two merged kicks, among the low parts that plain sums do not
 * have; behind it the h that it is for, where methods with a time of their own have -E; any
 * other value: it is to be made */
static double *staggered(double *state, uint32_t n) {
    return state + 3 * (size_t)n;
}
static double *staggered_by(double *state, uint32_t n) {
    return state + 4 * (size_t)n + 2;
}

/* Carried values from the state: of merged steps the momentum between two kicks, where the last
 * burst left it for this h, else made by the first kick alone. */
static void begin(const dm_splitting_loop *l, uint32_t n, double *state, double *work,
                  const dm_splitting_burst *x) {
    const size_t each = n * sizeof *work;
    const int merged = (l->shape & DM_LOOP_MERGED) != 0;
    const int made = merged && *staggered_by(state, n) == x->h;
    memcpy(work, state, merged ? 2 * each : 4 * each);
    if (made) memcpy(work + n, staggered(state, n), each);
    if (merged && !made)
        kick_alone(&l->one_kick, work, work + dm_splitting_loop_carried(n), x, x->table->b[0]);
}

/* And back; the momentum between two kicks stays in the state, beside the one that is shown. */
static void end(const dm_splitting_loop *l, uint32_t n, double *state, double *work,
                const dm_splitting_burst *x) {
    const size_t each = n * sizeof *work;
    const int merged = (l->shape & DM_LOOP_MERGED) != 0;
    if (merged) {
        memcpy(staggered(state, n), work + n, each);
        *staggered_by(state, n) = x->h;
        kick_alone(&l->one_kick, work, work + dm_splitting_loop_carried(n), x, -x->table->b[0]);
    }
    memcpy(state, work, merged ? 2 * each : 4 * each);
}

/* In calls of as many steps as have room for their coefficients. */
void dm_splitting_loop_run(const dm_splitting_loop *l, const dm_model *m, double *state,
                           const dm_splitting_burst *burst, double *work) {
    double *c = work + dm_splitting_loop_carried(m->n);
    begin(l, m->n, state, work, burst);
    for (long done = 0; done < burst->count;) {
        const coefficients put = put_steps(c, l, m, burst, done);
        dm_loop_call call = {.state = work,
                             .coefficients = c,
                             .groups = 1,
                             .repeats = repeats(l, burst->table),
                             .steps = put.steps,
                             .stride = put.stride * (int64_t)sizeof *c};
        dm_loop_run(&l->one, &call);
        done += put.steps;
    }
    end(l, m->n, state, work, burst);
}

/* ---- members side by side ---- */

/* every coefficient once for each lane */
static void spread(double *to, const double *c, size_t count, uint32_t lanes) {
    for (size_t i = 0; i < count; i++)
        for (uint32_t lane = 0; lane < lanes; lane++) *to++ = c[i];
}

/* those of member i among members with their own: [pass][coefficient][group of the pass][lane] */
static void spread_own(const dm_splitting_wide *w, const double *c, size_t count, uint32_t i) {
    const uint32_t lanes = w->lanes.lanes, together = w->lanes.together;
    const uint32_t group = i / lanes, pass = group / together;
    double *to = w->spread + pass * count * together * lanes + (size_t)(group % together) * lanes +
                 i % lanes;
    for (size_t k = 0; k < count; k++) to[k * together * lanes] = c[k];
}

/* entries first .. first + count - 1 of all states to entries `at` .. of the carried values, or
 * back */
typedef struct {
    uint32_t first, count, at;
    int back;
} transfer;

/* One copy a group, since entries of all lanes lie together. */
static void move(const dm_splitting_wide *w, const dm_model *m, uint32_t size, const transfer *t) {
    const size_t lanes = w->lanes.lanes, bytes = t->count * lanes * sizeof(double);
    for (uint32_t g = 0; g < w->lanes.groups; g++) {
        double *state = w->lanes.state + (g * dm_state_size(m->n) + t->first) * lanes;
        double *carried = w->wide + (g * (size_t)size + t->at) * lanes;
        memcpy(t->back ? state : carried, t->back ? carried : state, bytes);
    }
}

/* what calls for members side by side share */
typedef struct {
    const dm_splitting_loop *l;
    const dm_model *m;
    const dm_splitting_wide *w;
    double *c;    /* coefficients of one member */
    size_t *told; /* how many of them are spread over the lanes already */
} band;

/* of steps from `done` on, or of a kick alone by a share of h */
static coefficients put_call(const band *b, const dm_splitting_burst *x, long done, double share) {
    if (share == 0.0) return put_steps(b->c, b->l, b->m, x, done);
    const double *end = put_force(b->c, x, 0.0, x->h * share);
    return (coefficients){.steps = 1, .count = (size_t)(end - b->c)};
}

/* the same for all lanes, or for every member with its parameters */
static coefficients put_all(const band *b, const dm_splitting_burst *burst, long done,
                            double share) {
    const dm_lanes *x = &b->w->lanes;
    dm_splitting_burst own = *burst;
    coefficients put = {0};
    if (!own.many) {
        put = put_call(b, burst, done, share);
        spread(b->w->spread, b->c, put.count, x->lanes);
    }
    for (uint32_t i = 0; own.many && i < x->groups * x->lanes; i++) {
        own.params = x->params + (size_t)i * own.many;
        put = put_call(b, &own, done, share);
        spread_own(b->w, b->c, put.count, i);
    }
    return put;
}

/* Those of the burst before, where they serve: the force does not see the time, and no kick alone
 * lies between the bursts. */
static coefficients put_or_keep(const band *b, const dm_splitting_burst *burst, long done,
                                double share) {
    const int stays = (b->m->structure & DM_AUTONOMOUS) && !(b->l->shape & DM_LOOP_MERGED);
    if (stays && *b->told) return (coefficients){.steps = burst->count - done, .count = *b->told};
    const coefficients put = put_all(b, burst, done, share);
    if (stays) *b->told = put.count;
    return put;
}

/* one call of machine code; the steps it made */
static long call_lanes(const band *b, const dm_splitting_burst *burst, long done, double share) {
    const dm_lanes *x = &b->w->lanes;
    const coefficients put = put_or_keep(b, burst, done, share);
    const int64_t each = (int64_t)(x->lanes * sizeof *b->c) * (burst->many ? x->together : 1);
    dm_loop_call call = {.state = b->w->wide,
                         .coefficients = b->w->spread,
                         .groups = x->groups,
                         .repeats = repeats(b->l, burst->table),
                         .steps = put.steps,
                         .stride = put.stride * each,
                         .group_stride = (int64_t)put.count * each};
    dm_loop_run(share == 0.0 ? &b->w->loop : &b->w->kick, &call);
    return put.steps;
}

/* momenta between kicks from where they were left; 0: there are none for this h */
static int begin_staggered(const dm_splitting_wide *w, const dm_model *m, double h) {
    const uint32_t n = m->n, all = w->lanes.groups * w->lanes.lanes;
    for (uint32_t i = 0; i < all; i++)
        if (dm_lanes_member(&w->lanes, n, i)[(4 * (size_t)n + 2) * w->lanes.lanes] != h) return 0;
    move(w, m, 2 * n, &(transfer){.first = 3 * n, .count = n, .at = n});
    return 1;
}

/* Left in the low parts, with the h that they are for. */
static void end_staggered(const dm_splitting_wide *w, const dm_model *m, double h) {
    const uint32_t n = m->n, all = w->lanes.groups * w->lanes.lanes;
    move(w, m, 2 * n, &(transfer){.first = 3 * n, .count = n, .at = n, .back = 1});
    for (uint32_t i = 0; i < all; i++)
        dm_lanes_member(&w->lanes, n, i)[(4 * (size_t)n + 2) * w->lanes.lanes] = h;
}

/* The same for all lanes in one call; a lane without a member runs along. */
void dm_splitting_loop_run_lanes(const dm_splitting_loop *l, const dm_model *m, dm_lanes *x,
                                 const dm_splitting_burst *burst, double *work) {
    dm_splitting_wide w = l->many;
    const band b = {l, m, &w, work, &x->told};
    const int merged = (l->shape & DM_LOOP_MERGED) != 0;
    const transfer main = {.count = merged ? 2 * m->n : 4 * m->n};
    const double first = burst->table->b[0];
    w.lanes = *x;
    move(&w, m, l->size, &main);
    if (merged && !begin_staggered(&w, m, burst->h)) call_lanes(&b, burst, 0, first);
    for (long done = 0; done < burst->count;) done += call_lanes(&b, burst, done, 0.0);
    if (merged) {
        end_staggered(&w, m, burst->h);
        call_lanes(&b, burst, 0, -first);
    }
    move(&w, m, l->size, &(transfer){.count = main.count, .back = 1});
}
