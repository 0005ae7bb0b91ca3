/* run.c - the loop over time. Long because steps, rows and looks go by one state of the loop. */
#include "run/run.h"

#include "base/largest.h"
#include "mech/group.h"
#include "run/inertia/inertia_look.h"
#include "run/interpolate.h"

#include <limits.h>
#include <math.h>
#include <string.h>
#include <time.h>

/* s between looks at the clock and the stop flag, between calls of progress, between rows that wait
 * for a full block: a run that is killed loses no more of them */
static const double LOOK = 2e-2, PROGRESS = 0.1, SEND = 1.0;
enum { LONGEST = 1 << 20 }; /* steps between looks at the clock */

typedef struct {
    const dm_run_plan *plan;
    dm_stepper *s;
    double *state, *rows;
    int own;     /* only what has been stepped knows the time: the method's own, or control */
    int goes_on; /* nothing but whole steps has been made, and the state is what they left */
    long done, rows_done;
    long flushed;        /* rows that have left the block */
    double *open;        /* impulses of a row whose next step is not done yet; NULL: none */
    long burst, until;   /* steps between looks at the clock, step of the next one */
    double looked, told; /* s, time of the last look and of the last call of progress */
    double saved, sent;  /* s, times of the last call of save, and of send */
    double cpu;          /* s of CPU when it began */
    dm_control control;  /* as it was where the state was kept (plan->inertia) */
} loop;

long dm_run_rows(const dm_run_plan *plan) {
    if (plan->at) return plan->at_count;
    const long whole = plan->steps / plan->every;
    return whole > LONG_MAX - 2 ? LONG_MAX : 1 + whole + (plan->steps % plan->every != 0);
}

/* s of a clock: CLOCK_MONOTONIC never goes back, CLOCK_PROCESS_CPUTIME_ID is of the process */
static double seconds_of(clockid_t clock) {
    struct timespec t;
    clock_gettime(clock, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

/* the time of a step is computed from its number, never summed, unless the state carries it */
static double time_now(const loop *l) {
    const dm_run_plan *plan = l->plan;
    if (plan->events && plan->events->ended) return plan->events->end;
    if (plan->control) return plan->control->t;
    if (l->own) return l->state[4 * (size_t)l->s->model->n];
    return plan->t0 + (double)(l->done + (plan->resume ? plan->resume->steps : 0)) * l->plan->h;
}

/* ---- recording ---- */

static int is_ended(const loop *l) {
    return l->plan->events && l->plan->events->ended;
}

/* Columns of a row: t, the state unless others are watched alone, what is watched, impulses. */
static size_t width(const loop *l) {
    const dm_run_plan *plan = l->plan;
    const size_t states = l->s->model->n + (size_t)dm_momenta(l->s->model);
    return 1 + (plan->watch ? dm_observer_width(plan->watch) : 0) +
           (plan->watch && !plan->beside ? 0 : states) +
           (plan->impulses ? dm_impulses_width(plan->impulses) : 0);
}

/* Rows that have not left the block yet, if there are any. */
static dm_status flush(loop *l) {
    const dm_outlet *out = l->plan->outlet;
    const long held = l->rows_done - l->flushed;
    const dm_status status = held ? out->flush(out->ud, l->rows, held) : DM_OK;
    if (status == DM_OK) l->flushed = l->rows_done;
    return status;
}

/* what the step before gave the node of this row; the step behind it adds its part */
static void open_impulses(loop *l, double *row) {
    const dm_impulses *i = l->plan->impulses;
    const double *last = i->step + (size_t)(i->points - 1) * i->constraints;
    memset(row, 0, dm_impulses_width(i) * sizeof *row);
    if (l->done) memcpy(row, last, i->constraints * sizeof *row);
    l->open = row;
}

/* after a step: its impulses, the first of which belong to the row that it began at */
static void take_impulses(loop *l) {
    const dm_impulses *i = l->plan->impulses;
    l->s->engine->impulses(l->s, i->step);
    if (!l->open) return;
    for (uint32_t c = 0; c < i->constraints; c++) l->open[c] += i->step[c];
    for (uint32_t c = i->constraints; c < dm_impulses_width(i); c++) l->open[c] = i->step[c];
    l->open = NULL;
}

/* One row, behind those before it; a full block is sent away first. Where that cannot be done the
 * row, which is the last, is kept behind the block. */
static dm_status record(loop *l, const double *state, double t) {
    const dm_outlet *out = l->plan->outlet;
    const size_t states = l->s->model->n + (size_t)dm_momenta(l->s->model);
    dm_status status = DM_OK, sent = DM_OK;
    if (!l->rows) return DM_OK;
    if (out && l->rows_done - l->flushed >= out->room) sent = flush(l);
    if (sent != DM_OK && l->rows_done - l->flushed > out->room) return sent;
    double *row = l->rows + width(l) * (size_t)(l->rows_done - l->flushed);
    *row++ = t;
    if (!l->plan->watch || l->plan->beside) {
        memcpy(row, state, states * sizeof *row);
        row += states;
    }
    if (l->plan->watch) {
        status = dm_observe_row(l->plan->watch, row, state, t);
        row += dm_observer_width(l->plan->watch);
    }
    if (l->plan->impulses) open_impulses(l, row);
    if (status == DM_OK) l->rows_done++;
    return sent == DM_OK ? status : sent;
}

/* rows at the times asked for from `from`, where the state is `state`, up to `to` */
static dm_status record_times(loop *l, const double *state, double from, double to) {
    const dm_run_plan *plan = l->plan;
    const double slack = dm_time_slack(l->s, plan->h, from, to);
    while (l->rows_done < plan->at_count && plan->at[l->rows_done] < to - slack) {
        const double target = plan->at[l->rows_done];
        const double *here = state;
        if (target > from + slack) {
            dm_status status = dm_interpolate(l->s, plan->between, state, from, target, plan->h);
            if (status == DM_NO_CONVERGENCE && plan->control)
                status = dm_interpolate_finely(l->s, plan->between, state, from, target);
            if (status != DM_OK) return status;
            here = plan->between;
        }
        const dm_status status = record(l, here, target);
        if (status != DM_OK) return status;
    }
    return DM_OK;
}

/* times asked for lie ahead of a step that may be taken whole, behind one that events or a time
 * of its own may shorten */
static int looks_ahead(const loop *l) {
    return l->plan->at && !l->own && !l->plan->events;
}

/* beside its flow */
static void look_beside(const loop *l) {
    dm_stencil at = {0};
    dm_follow *f = l->plan->follow;
    if (f) dm_follow_state(f, l->plan->aside, l->state, time_now(l), l->done, &at);
}

/* what is due at this step: the row itself, or the times asked for up to the next step */
static dm_status record_due(loop *l) {
    const double t = time_now(l);
    if (l->plan->follow && l->plan->follow->due <= l->done) look_beside(l);
    if (looks_ahead(l)) return record_times(l, l->state, t, t + l->plan->h);
    return !l->plan->at && l->done % l->plan->every == 0 ? record(l, l->state, t) : DM_OK;
}

/* the end, or the last good state, if it is not a row yet */
static dm_status record_end(loop *l) {
    dm_status status = DM_OK;
    look_beside(l);
    if (!l->plan->at && (is_ended(l) || l->done % l->plan->every != 0))
        status = record(l, l->state, time_now(l));
    if (l->plan->at && l->done == 0 && !looks_ahead(l)) /* not a step was taken */
        status = record_times(l, l->state, time_now(l), time_now(l) + DM_TIME_SLACK * l->plan->h);
    return l->plan->outlet && status == DM_OK ? flush(l) : status;
}

/* ---- stepping ---- */

/* times asked for between `from`, where the state was `before`, and now; one that is this step's
 * to round-off belongs to it */
static dm_status record_behind(loop *l, const double *before, double from) {
    const dm_control *c = l->plan->events ? NULL : l->plan->control;
    dm_status status = DM_OK;
    if (!l->plan->at) return status;
    if (c) status = record_times(l, before, from, c->half);
    if (c) before = dm_control_middle(c, l->s->model->n), from = c->half; /* as exact as the end */
    const double now = time_now(l), slack = dm_time_slack(l->s, l->plan->h, from, now);
    return status == DM_OK ? record_times(l, before, from, now + 2.0 * slack) : status;
}

/* one step, the zeros inside it, the times asked for inside it */
static dm_status step_watched(loop *l, double from) {
    dm_events *events = l->plan->events;
    const size_t size = dm_state_size(l->s->model->n);
    double *before = events ? events->start : l->plan->between ? l->plan->between + size : NULL;
    long finished = 0;
    if (before) memcpy(before, l->state, size * sizeof *before);
    dm_status status = l->plan->control
                           ? dm_control_step(l->plan->control, l->s, l->state)
                           : dm_advance(l->s, l->state, from, l->plan->h, 1, &finished);
    l->done += l->plan->control ? status == DM_OK : finished;
    if (status == DM_OK && events)
        status = dm_events_look(events, l->s, l->state, from, time_now(l));
    return status == DM_OK ? record_behind(l, before, from) : status;
}

/* a step at a time, since only the state knows when it is */
static dm_status advance_own(loop *l, long end) {
    while (l->done < end && !is_ended(l) && !(time_now(l) >= l->plan->until)) {
        const dm_status status = step_watched(l, time_now(l));
        if (status != DM_OK) return status;
    }
    return DM_OK;
}

/* Does somebody look at a time of its own? */
static int looks_at_time(const loop *l, int timed) {
    const dm_run_plan *p = l->plan;
    return l->own && (timed || p->control || p->events || p->at || isfinite(p->until));
}

/* steps up to `end`, unlooked at; one by one when L depends on t, so that the time of a step, and
 * every bit of the result, does not depend on where bursts end; where impulses are wanted too */
static dm_status advance_plainly(loop *l, long end) {
    const int timed =
        !(l->s->model->structure & DM_AUTONOMOUS) && !(l->s->rule->method->traits & DM_FOR_PAIRS);
    const int by_one = timed || l->plan->impulses;
    if (looks_at_time(l, timed)) return advance_own(l, end);
    while (l->plan->events && l->done < end && !is_ended(l)) {
        const dm_status status = step_watched(l, time_now(l));
        if (status != DM_OK) return status;
    }
    while (!l->plan->events && l->done < end) {
        long finished = 0;
        l->s->goes_on = l->goes_on;
        const dm_status status = dm_advance(l->s, l->state, time_now(l), l->plan->h,
                                            by_one ? 1 : end - l->done, &finished);
        l->goes_on = status == DM_OK && !l->plan->at;
        l->done += finished;
        if (status == DM_OK && l->plan->impulses) take_impulses(l);
        if (status != DM_OK) return status;
    }
    return DM_OK;
}

/* Steps, a zero, or the end of a time of its own. */
static int is_finished(const loop *l) {
    return l->done >= l->plan->steps || is_ended(l) || (l->own && time_now(l) >= l->plan->until);
}

/* Do rows lie inside of steps? Then the inertia is looked at in every step. */
static int looks_at_steps(const loop *l) {
    const dm_run_plan *plan = l->plan;
    return plan->at || plan->events || plan->impulses;
}

/* Is it looked at here? Never by the clock, so that a run ends where another one does; before a
 * row that cannot be taken back. */
static int looks_here(const loop *l) {
    const dm_run_plan *plan = l->plan;
    return looks_at_steps(l) || l->done >= plan->steps || l->done >= plan->inertia->seen.due ||
           (plan->outlet && l->done % plan->every == 0);
}

static void keep(loop *l) {
    dm_inertia *x = l->plan->inertia;
    dm_inertia_keep(x, l->s, l->state);
    x->done = l->done, x->rows = l->rows_done, x->t = time_now(l);
    if (l->plan->control) l->control = *l->plan->control;
}

/* to the kept state */
static void go_back(loop *l) {
    dm_inertia *x = l->plan->inertia;
    dm_inertia_go_back(x, l->s, l->state);
    l->done = x->done;
    if (l->plan->control) *l->plan->control = l->control;
}

/* Does the value next to zero vanish inside the one step behind? Times of a run and of a member in
 * lanes differ by round-off; their h does not, and both go over the same parts to the last bit. */
static int vanishes_inside(loop *l, int steep, int open) {
    static const double ROUND_OFF = 1e-9;
    dm_inertia *x = l->plan->inertia;
    const double now = time_now(l), own = now - x->t, h = l->plan->h;
    const double by = fabs(own - h) <= ROUND_OFF * fabs(h) ? h : own;
    return dm_inertia_vanishes(x, l->s, l->state, now - by, by, steep, open);
}

/* Does the one step behind go over a place, or has one inside? What `seen` says is of its end. */
static int goes_over(loop *l, int seen, int steep, int open) {
    if (seen == DM_INERTIA_CHANGED) return 1;
    steep |= seen == DM_INERTIA_TURNED;
    if (!steep && !open) return 0;
    l->goes_on = 0;
    return vanishes_inside(l, steep, open);
}

/* The step that goes over is not taken, nor are rows at times inside of it. */
static dm_status end_before(loop *l) {
    const dm_run_plan *plan = l->plan;
    l->goes_on = 0;
    go_back(l);
    l->rows_done = plan->inertia->rows;
    const double now = time_now(l), slack = dm_time_slack(l->s, plan->h, now, now + plan->h);
    while (plan->at && l->rows_done > l->flushed && plan->at[l->rows_done - 1] > now + slack)
        l->rows_done--;
    return DM_INERTIA;
}

/* from the kept state again, step by step up to the one that goes over */
static dm_status stop_before(loop *l, long end) {
    dm_inertia *x = l->plan->inertia;
    dm_status status = DM_OK;
    l->goes_on = 0;
    go_back(l);
    l->rows_done = x->rows;
    dm_inertia_begin_closely(x);
    while (l->done < end && status == DM_OK) {
        int steep = 0;
        keep(l);
        status = advance_plainly(l, l->done + 1);
        const int open = x->model->mass_bounds != NULL;
        const int seen =
            status == DM_OK ? dm_inertia_look_closely(x, l->state, time_now(l), &steep) : 0;
        if (status == DM_OK && goes_over(l, seen, steep, open)) return end_before(l);
        if (status == DM_OK && l->done < end) status = record_due(l);
    }
    return status;
}

/* steps up to `end`, or to one that goes over a change of inertia, or has one inside */
static dm_status advance(loop *l, long end) {
    dm_inertia *x = l->plan->inertia;
    while (x && l->done < end && !is_finished(l)) {
        if (l->done == x->seen.looked) {
            dm_inertia_go_on(x, l->state, time_now(l));
            keep(l);
        }
        const int steep = dm_inertia_is_steep(&x->seen), open = x->seen.open;
        const long due = looks_at_steps(l) ? l->done + 1 : x->seen.due;
        const long next = due > l->done ? dm_lesser(due, end) : end;
        dm_status status = advance_plainly(l, next);
        const int looks = status == DM_OK ? looks_here(l) : status != DM_STOPPED;
        const int seen = looks ? dm_inertia_look(x, l->state, time_now(l), l->done, NULL) : 0;
        const int one = status == DM_OK && l->done == x->done + 1;
        if (one && goes_over(l, seen, steep, open)) return end_before(l);
        if (seen && !one) {
            const dm_status again = stop_before(l, next);
            if (status == DM_OK || again == DM_INERTIA) status = again;
        }
        if (status != DM_OK) return status;
    }
    return x ? DM_OK : advance_plainly(l, end);
}

/* How many of the rows in the block no step will change: not one that its next step has a part of,
 * nor those inside of the step ahead, which may not be taken. */
static long settled(const loop *l) {
    const long held = l->rows_done - l->flushed;
    const double now = time_now(l), slack = dm_time_slack(l->s, l->plan->h, now, now + l->plan->h);
    long out = l->open ? held - 1 : held;
    while (looks_ahead(l) && out > 0 && l->rows[width(l) * (size_t)(out - 1)] > now + slack) out--;
    return out;
}

/* Rows that wait leave the block, but for those that stay, first in it. */
static dm_status send(loop *l) {
    const dm_outlet *out = l->plan->outlet;
    const long held = l->rows_done - l->flushed, whole = out ? settled(l) : 0;
    if (whole > 0) {
        const dm_status status = out->flush(out->ud, l->rows, whole);
        if (status != DM_OK) return status;
        const size_t size = width(l) * (size_t)whole;
        memmove(l->rows, l->rows + size, width(l) * (size_t)(held - whole) * sizeof(double));
        if (l->open) l->open -= size;
        l->flushed += whole;
    }
    return DM_OK;
}

/* Rows before a state that is saved are in the file before it is, since a run that goes on from
 * there adds to them. */
static dm_status save(loop *l) {
    const dm_status status = send(l);
    return status == DM_OK ? l->plan->save(l->plan->ud, l->done) : status;
}

/* look at the clock: tell the progress, save, fit the burst to LOOK */
static dm_status look(loop *l) {
    dm_status status = DM_OK;
    const double t = seconds_of(CLOCK_MONOTONIC), took = t - l->looked;
    if (l->plan->progress && t - l->told >= PROGRESS) {
        l->plan->progress(l->plan->ud, l->done, l->plan->steps);
        l->told = t;
    }
    if (l->plan->save && t - l->saved >= l->plan->save_every) {
        status = save(l);
        l->saved = l->sent = t;
    }
    if (status == DM_OK && l->plan->outlet && t - l->sent >= SEND) {
        status = send(l);
        l->sent = t;
    }
    if (took < 0.5 * LOOK && l->burst < LONGEST) l->burst *= took < 0.05 * LOOK ? 8 : 2;
    if (took > LOOK && l->burst > 1) l->burst /= 2;
    if (l->plan->seconds > 0.0 && seconds_of(CLOCK_PROCESS_CPUTIME_ID) - l->cpu > l->plan->seconds)
        status = DM_OUT_OF_TIME;
    l->looked = t;
    l->until = l->done + l->burst;
    return status;
}

/* steps to the next row, or to the last whole step before the next time asked for */
static long steps_to_row(const loop *l) {
    const dm_run_plan *plan = l->plan;
    const long due = plan->follow ? plan->follow->due - l->done : LONG_MAX;
    if (!plan->at) return dm_lesser(plan->every - l->done % plan->every, due);
    if (l->own || l->rows_done >= plan->at_count) return plan->steps;
    const double before = plan->resume ? (double)plan->resume->steps : 0.0;
    const double ahead = (plan->at[l->rows_done] - plan->t0) / plan->h;
    const double step = floor(ahead + DM_TIME_SLACK) - before;
    return step > (double)l->done + 1.0 ? (long)step - l->done : 1;
}

/* the next row, the next look or the end, whichever comes first */
static long next_stop(const loop *l) {
    const long left = l->plan->steps - l->done;
    return l->done + dm_lesser(dm_lesser(steps_to_row(l), l->until - l->done), left);
}

/* In bursts, between which rows are kept, the clock and the stop flag looked at. */
static dm_status run(loop *l) {
    dm_status status = record_due(l);
    while (status == DM_OK && !is_finished(l)) {
        if (l->plan->stop && *l->plan->stop) return DM_STOPPED;
        status = advance(l, next_stop(l));
        if (status == DM_OK && !is_ended(l)) status = record_due(l);
        if (status == DM_OK && l->done >= l->until) status = look(l);
    }
    return status;
}

/* time_now before the first step, which a control does not know yet */
static double start_time(const loop *l) {
    const dm_run_plan *plan = l->plan;
    if (!plan->resume) return plan->t0;
    if (l->s->rule->method->traits & DM_OWN_TIME) return l->state[4 * (size_t)l->s->model->n];
    return plan->t0 + (double)plan->resume->steps * plan->h;
}

/* what the method keeps beside q and p: set for a start, or as it was left */
static dm_status begin(loop *l) {
    const dm_resumption *resume = l->plan->resume;
    double own[DM_STATE_OWN], *tail = l->state + 4 * (size_t)l->s->model->n, *place;
    dm_status status = DM_OK;
    memcpy(own, tail, sizeof own);
    const double from = start_time(l);
    status = dm_stepper_start(l->s, l->state, from, l->plan->h);
    if (resume) memcpy(tail, own, sizeof own);
    if (l->plan->follow) dm_follow_begin(l->plan->follow);
    if (status == DM_OK && resume && resume->memory) {
        const size_t size = dm_stepper_memory(l->s, &place);
        if (size) memcpy(place, resume->memory, size * sizeof *place);
    }
    if (status == DM_OK && l->plan->control)
        dm_control_begin(l->plan->control, l->s, l->state, from, l->plan->h);
    if (l->plan->inertia) {
        l->plan->inertia->own = l->own;
        l->plan->inertia->next = l->plan->control ? &l->plan->control->h : NULL;
    }
    if (status == DM_OK && l->plan->inertia)
        status = dm_inertia_begin(l->plan->inertia, l->state, time_now(l), l->plan->h);
    if (status == DM_OK && l->plan->events)
        status = dm_events_begin(l->plan->events, l->state, time_now(l), l->plan->h);
    return status;
}

/* The row of a start that fails is kept, unless rows are wanted at given times. */
dm_status dm_run(const dm_run_plan *plan, dm_stepper *s, double *state, double *rows, long *done,
                 long *rows_done) {
    loop l = {.plan = plan, .s = s, .state = state, .rows = rows, .burst = 1, .until = 1};
    l.own = plan->control || s->rule->method->traits & DM_OWN_TIME;
    l.cpu = seconds_of(CLOCK_PROCESS_CPUTIME_ID);
    l.looked = l.told = l.saved = l.sent = seconds_of(CLOCK_MONOTONIC);
    dm_status status = begin(&l);
    if (status == DM_OK && !dm_state_is_finite(state, s->model->n)) status = DM_NOT_FINITE;
    if (status == DM_OK)
        status = run(&l);
    else if (!plan->at)
        record(&l, state, plan->t0);
    if (status == DM_OK && l.own && isfinite(plan->until) && !is_ended(&l) &&
        time_now(&l) < plan->until)
        status = DM_OUT_OF_TIME;
    const dm_status end = record_end(&l);
    if (status == DM_OK) status = end;
    *done = l.done;
    *rows_done = l.rows_done;
    return status;
}
