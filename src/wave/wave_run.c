#define _POSIX_C_SOURCE 200809L /* clock_gettime */
#include "wave/wave_run.h"

#include <math.h>
#include <string.h>
#include <time.h>

long dm_wave_rows(const dm_wave_plan *plan) {
    return 1 + plan->steps / plan->every + (plan->steps % plan->every != 0);
}

/* s of CPU */
static double cpu(void) {
    struct timespec t;
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

/* What the loop knows between two looks at the clock. */
typedef struct {
    const dm_wave_plan *plan;
    double began, shown; /* s */
    long burst;          /* steps that take a few milliseconds */
} loop;

/* Bursts grow to some 5 ms; how steps are cut does not matter to their bits. */
static void pace(loop *l, double taken) {
    if (taken < 2e-3 && l->burst < 1000000) l->burst *= 2;
    if (taken > 8e-3 && l->burst > 1) l->burst /= 2;
}

/* `count` steps, looked after */
static dm_status steps(loop *l, dm_wave_stepper *s, long count, long *done) {
    const long until = *done + count;
    dm_status status = DM_OK;
    while (status == DM_OK && *done < until) {
        const double before = cpu();
        const long left = until - *done;
        status = s->engine->advance(s, left < l->burst ? left : l->burst, done);
        const double now = cpu();
        pace(l, now - before);
        if (status != DM_OK) break;
        if (l->plan->progress && now - l->shown > 0.1) {
            l->shown = now;
            l->plan->progress(l->plan->ud, *done, l->plan->steps);
        }
        if (l->plan->seconds > 0.0 && now - l->began > l->plan->seconds) status = DM_OUT_OF_TIME;
        if (l->plan->stop && *l->plan->stop) status = DM_STOPPED;
    }
    return status;
}

/* 0: something is not finite */
static int record(double *row, const dm_wave_stepper *s, double t, double *a, double *psi) {
    const dm_wave *w = s->wave;
    dm_wave_observed o;
    s->engine->amplitudes(s, a);
    dm_wave_observe(&o, w, a);
    const double noether = s->engine->noether ? s->engine->noether(s) : w->hbar * o.norm;
    const double values[DM_WAVE_COLUMNS] = {t,          o.norm,  o.energy, o.x,
                                            o.momentum, noether, o.tail,   o.edge};
    for (int i = 0; i < DM_WAVE_COLUMNS; i++)
        if (!isfinite(values[i])) return 0;
    memcpy(row, values, sizeof values);
    dm_wave_values(psi, w, a);
    memcpy(row + DM_WAVE_COLUMNS, psi, 2 * (size_t)w->n * sizeof *psi);
    return 1;
}

dm_status dm_wave_run(const dm_wave_plan *plan, dm_wave_stepper *s, double *rows, double *a,
                      double *psi, long *done, long *kept) {
    const size_t width = DM_WAVE_COLUMNS + 2 * (size_t)s->wave->n;
    loop l = {.plan = plan, .began = cpu(), .shown = cpu(), .burst = 1};
    dm_status status = DM_OK;
    *done = 0;
    *kept = 0;
    /* a row for the start, for every step that is counted, and for the last one that was made */
    for (long at = 0;;) {
        const double t = plan->t0 + (double)(plan->first + *done) * s->h;
        if (*kept == 0 || *done > at) {
            if (!record(rows + (size_t)*kept * width, s, t, a, psi)) return DM_NOT_FINITE;
            ++*kept;
        }
        if (status != DM_OK || *done >= plan->steps) return status;
        at = *done;
        const long left = plan->steps - *done;
        status = steps(&l, s, left < plan->every ? left : plan->every, done);
    }
}
