/* events.h - zeros of g(q, v, t, p) along a run, found between steps. */
#ifndef DM_EVENTS_H
#define DM_EVENTS_H

#include "integ/method/method.h"
#include "run/observe.h"

typedef struct {
    int direction; /* 1: g rises, -1: it falls, 0: both */
    int stop;      /* the run ends there */
} dm_event;

/* Where the zeros of the `count` observables of `observer` are looked for, one number each. */
typedef struct {
    dm_observer *observer;
    const dm_event *list;  /* [count] */
    double *before, *here; /* [count] g at the start of a step, and elsewhere */
    double *time;          /* [count] of the zeros inside a step */
    double *start, *place; /* dm_state_size: the state before the step; at a zero */
    double h;              /* of the steps of the run */
    /* takes every zero in the order of time; not DM_OK ends the run */
    dm_status (*found)(void *ud, uint32_t which, double t, const double *state);
    void *ud;
    int ended;  /* a zero with `stop` was met: the state is the one there */
    double end; /* its time */
} dm_events;

/* Doubles of before, here, time, start, place for n coordinates. */
size_t dm_events_size(uint32_t count, uint32_t n);
void dm_events_lay_out(dm_events *e, double *memory, uint32_t n);

/* g at the start of a run of steps h, or where nothing was looked for. */
dm_status dm_events_begin(dm_events *e, const double *state, double t, double h);

/* After a step of s from e->start at `from` to `state` at `to`: zeros in between, by steps of
 * fitting length (run/interpolate.h), so with the accuracy of the rule, to round-off in t. A
 * function that changes its sign twice within a step is not seen; its poles are no zeros. Where one
 * is NaN: DM_NO_VALUE, and observer->missing is its number. */
dm_status dm_events_look(dm_events *e, dm_stepper *s, double *state, double from, double to);

#endif
