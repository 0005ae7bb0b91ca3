#include "run/ensemble/ensemble.h"

#include "run/ensemble/ensemble_block.h"
#include "run/run.h"

#include <math.h>
#include <pthread.h>
#include <stdatomic.h>

enum { BLOCK = 16 }; /* members that a thread takes at a time */

typedef struct {
    const dm_ensemble *e;
    atomic_long next; /* member that no thread has taken */
    atomic_long done; /* steps of all members, those that a failed one will not make among them */
    long share;       /* members that a thread takes at a time */
} shared;

typedef struct {
    shared *common;
    dm_stepper *stepper;
    dm_block *block;            /* NULL: members one by one */
    dm_observer *watch, *aside; /* of this thread */
    dm_inertia *inertia;        /* NULL: it cannot change */
    int first;                  /* this thread tells the progress */
    long counted;               /* steps told of the members in hand */
    long of_run;                /* of the member that runs alone */
} worker;

/* members have made so many steps more */
static void count_steps(void *ud, long steps) {
    worker *w = ud;
    const dm_ensemble *e = w->common->e;
    w->counted += steps;
    const long done = atomic_fetch_add(&w->common->done, steps) + steps;
    if (w->first && e->progress) e->progress(e->ud, done);
}

/* a member that runs alone has made `done` steps */
static void count_run(void *ud, long done, long steps) {
    worker *w = ud;
    (void)steps;
    count_steps(w, done - w->of_run);
    w->of_run = done;
}

/* steps that members from .. to - 1 are to make */
static long steps_of(const dm_ensemble *e, long from, long to) {
    long steps = e->pace ? 0 : e->steps * (to - from);
    for (long i = from; e->pace && i < to; i++) steps += e->pace[i].steps;
    return steps;
}

void dm_run_member(const dm_ensemble *e, const dm_member_run *run, long i) {
    dm_stepper *s = run->stepper;
    const uint32_t many = s->model->params;
    double *state = e->state + (size_t)i * dm_state_size(s->model->n);
    if (many) s->params = e->params + (size_t)i * many;
    if (many && run->watch) run->watch->params = s->params;
    if (many && run->aside) run->aside->params = s->params;
    const dm_run_plan plan = {.t0 = e->t0,
                              .h = e->h,
                              .steps = e->steps,
                              .every = e->rows    ? e->rows->every
                                       : e->steps ? e->steps
                                                  : 1,
                              .until = INFINITY,
                              .watch = run->watch,
                              .beside = e->rows && e->rows->beside,
                              .follow = e->follow ? e->follow + i : NULL,
                              .aside = run->aside,
                              .inertia = run->inertia,
                              .stop = e->stop,
                              .progress = run->progress,
                              .ud = run->ud};
    long rows = 0;
    e->member[i].status = dm_run(&plan, s, state, e->rows ? dm_ensemble_rows_of(e->rows, i) : NULL,
                                 &e->member[i].steps, &rows);
    if (e->member[i].status != DM_OK) {
        e->member[i].fading = run->inertia && dm_inertia_is_fading(run->inertia);
        dm_ensemble_note(e, i, &s->report.trouble);
    }
    if (e->rows) e->rows->count[i] = rows;
}

static void run_member(worker *w, const dm_ensemble *e, long i) {
    w->of_run = 0;
    dm_run_member(e,
                  &(dm_member_run){.stepper = w->stepper,
                                   .watch = w->watch,
                                   .aside = w->aside,
                                   .inertia = w->inertia,
                                   .progress = count_run,
                                   .ud = w},
                  i);
}

/* members of one pace; a single one costs less alone than in lanes */
static void run_alike(worker *w, const dm_ensemble *e, long from, long to) {
    if (w->block && (to - from > 1 || !e->pace))
        dm_block_run(e, w->block, from, to - from);
    else
        for (long i = from; i < to; i++) run_member(w, e, i);
}

/* Neighbours that can go side by side. */
static int is_same_pace(const dm_pace *a, const dm_pace *b) {
    return a->h == b->h && a->steps == b->steps && a->every == b->every;
}

/* Runs of neighbours with one pace, each as if it were an ensemble of its own; where lanes may have
 * steps of their own all together. */
static void run_members(worker *w, long from, long to) {
    dm_ensemble e = *w->common->e;
    dm_ensemble_rows rows;
    const int paced = w->block && dm_block_is_paced(w->block) && to - from > 1;
    if (!e.pace || paced) {
        run_alike(w, &e, from, to);
        return;
    }
    if (e.rows) rows = *e.rows, e.rows = &rows;
    for (long i = from; i < to; i = from) {
        const dm_pace *pace = e.pace + i;
        while (from < to && is_same_pace(e.pace + from, pace)) from++;
        e.h = pace->h;
        e.steps = pace->steps;
        rows.every = pace->every;
        run_alike(w, &e, i, from);
    }
}

/* members that a thread takes at a time: whole groups of lanes, no more than leave every thread
 * something to do */
static long choose_share(const dm_ensemble *e, const dm_block *b, int threads) {
    const long lanes = b ? b->lanes.lanes : 1, most = b ? b->most : BLOCK;
    const long each = (e->members + threads - 1) / threads;
    const long groups = (each + lanes - 1) / lanes;
    return lanes * (groups < most ? groups : most);
}

/* A thread takes members until there are none, or until it is told to stop. */
static void *work(void *arg) {
    worker *w = arg;
    const dm_ensemble *e = w->common->e;
    const long share = w->common->share;
    const int alike = !e->pace || (e->members > 1 && is_same_pace(e->pace, e->pace + 1));
    const long size = !alike && share > BLOCK ? BLOCK : share;
    for (;;) {
        const long from = atomic_fetch_add(&w->common->next, size);
        if (from >= e->members || (e->stop && *e->stop)) return NULL;
        const long to = from + size < e->members ? from + size : e->members;
        w->counted = 0;
        run_members(w, from, to);
        count_steps(w, steps_of(e, from, to) - w->counted);
    }
}

/* This thread works too; when no more threads can be had, those there are do it all. */
dm_status dm_ensemble_run(const dm_ensemble *e, dm_stepper *const *steppers, int threads) {
    shared common = {.e = e};
    worker workers[DM_ENSEMBLE_THREADS];
    dm_block blocks[DM_ENSEMBLE_THREADS];
    pthread_t thread[DM_ENSEMBLE_THREADS];
    int made = 0;
    for (int i = 0; i < threads; i++) {
        dm_inertia *inertia = e->inertia ? e->inertia + i : NULL;
        const int wide = dm_block_open(blocks + i, steppers[i], inertia);
        blocks[i].watch = e->watch ? e->watch + i : NULL;
        blocks[i].aside = e->aside ? e->aside + i : NULL;
        blocks[i].count = count_steps;
        blocks[i].ud = workers + i;
        workers[i] = (worker){.common = &common,
                              .stepper = steppers[i],
                              .block = wide ? blocks + i : NULL,
                              .watch = e->watch ? e->watch + i : NULL,
                              .aside = e->aside ? e->aside + i : NULL,
                              .inertia = inertia,
                              .first = i == 0};
        common.share = choose_share(e, wide ? blocks + i : NULL, threads);
    }
    if (e->lanes) *e->lanes = workers[0].block ? workers[0].block->lanes.lanes : 1;
    /* this thread works too; when no more threads can be had, those there are do it all */
    while (made + 1 < threads && pthread_create(thread + made, NULL, work, workers + made + 1) == 0)
        made++;
    work(workers);
    for (int i = 0; i < made; i++) pthread_join(thread[i], NULL);
    return e->stop && *e->stop ? DM_STOPPED : DM_OK;
}
