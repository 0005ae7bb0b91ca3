#include "run/run.h"

#include <math.h>
#include <string.h>
#include <time.h>

static const double LOOK = 5e-4;    /* s between looks at the clock and the stop flag */
static const double PROGRESS = 0.1; /* s between calls of progress */
enum { LONGEST = 1 << 20 };         /* steps between looks at the clock */

typedef struct {
    const dm_run_plan *plan;
    dm_stepper *s;
    double *state, *rows;
    long done, rows_done;
    long burst, until;   /* steps between looks at the clock, step of the next one */
    double looked, told; /* s, time of the last look and of the last call of progress */
} loop;

long dm_run_rows(const dm_run_plan *plan) {
    return 1 + plan->steps / plan->every + (plan->steps % plan->every != 0);
}

static double now(void) {
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

/* time of a step is computed from its number, never summed */
static double time_at(const loop *l, long step) {
    return l->plan->t0 + (double)step * l->s->h;
}

static void record(loop *l) {
    if (!l->rows) return;
    const size_t width = 1 + 2 * (size_t)l->s->model->n;
    double *row = l->rows + width * (size_t)l->rows_done++;
    row[0] = time_at(l, l->done);
    memcpy(row + 1, l->state, (width - 1) * sizeof *row);
}

static int is_recorded(const loop *l) {
    return l->done % l->plan->every == 0;
}

static int is_finite(const loop *l) {
    const size_t size = dm_state_size(l->s->model->n);
    for (size_t i = 0; i < size; i++)
        if (!isfinite(l->state[i])) return 0;
    return 1;
}

/* steps up to `end`; one by one when L depends on t, so that the time of a step, and with it
** every bit of the result, does not depend on where bursts happen to end */
static dm_status advance(loop *l, long end) {
    const int autonomous =
        (l->s->model->structure & DM_AUTONOMOUS) || (l->s->method->traits & DM_FOR_PAIRS);
    while (l->done < end) {
        long finished = 0;
        const dm_status status = dm_advance(l->s, l->state, time_at(l, l->done),
                                            autonomous ? end - l->done : 1, &finished);
        l->done += finished;
        if (status != DM_OK) return status;
    }
    return DM_OK;
}

/* look at the clock: tell the progress, fit the burst to LOOK */
static void look(loop *l) {
    const double t = now(), took = t - l->looked;
    if (l->plan->progress && t - l->told >= PROGRESS) {
        l->plan->progress(l->plan->ud, l->done, l->plan->steps);
        l->told = t;
    }
    if (took < 0.5 * LOOK && l->burst < LONGEST) l->burst *= 2;
    if (took > LOOK && l->burst > 1) l->burst /= 2;
    l->looked = t;
    l->until = l->done + l->burst;
}

/* the next row, the next look or the end, whichever comes first */
static long next_stop(const loop *l) {
    const long left = l->plan->steps - l->done;
    const long row = l->plan->every - l->done % l->plan->every, tick = l->until - l->done;
    const long nearer = row < tick ? row : tick;
    return l->done + (nearer < left ? nearer : left);
}

static dm_status run(loop *l) {
    while (l->done < l->plan->steps) {
        if (l->plan->stop && *l->plan->stop) return DM_STOPPED;
        const dm_status status = advance(l, next_stop(l));
        if (status != DM_OK) return status;
        if (is_recorded(l)) record(l);
        if (l->done >= l->until) look(l);
    }
    return DM_OK;
}

dm_status dm_run(const dm_run_plan *plan, dm_stepper *s, double *state, double *rows,
                 long *done, long *rows_done) {
    loop l = {.plan = plan, .s = s, .state = state, .rows = rows, .burst = 1, .until = 1};
    l.looked = l.told = now();
    record(&l);
    const dm_status status = is_finite(&l) ? run(&l) : DM_NOT_FINITE;
    if (!is_recorded(&l)) record(&l); /* the end, or the last good state */
    *done = l.done;
    *rows_done = l.rows_done;
    return status;
}

dm_status dm_run_end(const dm_run_plan *plan, dm_stepper *s, double *state, long *done) {
    long rows;
    return dm_run(plan, s, state, NULL, done, &rows);
}
