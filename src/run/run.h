/* run.h - the step loop: the only loop over time in the program. */
#ifndef DM_RUN_H
#define DM_RUN_H

#include "integ/method/method.h"
#include "run/control.h"
#include "run/departure.h"
#include "run/events.h"
#include "run/inertia/inertia.h"
#include "run/observe.h"

#include <signal.h>

/* Rows that do not all stay in memory. */
typedef struct {
    long room; /* rows that the block of dm_run holds, and one more */
    /* takes the rows when the block is full and at the end; not DM_OK: it took none, they stay
     * in the block, and the run ends */
    dm_status (*flush)(void *ud, const double *rows, long count);
    void *ud;
} dm_outlet;

/* Columns of rows for the impulses of the constraints (dm_engine.impulses): those of the node
 * where a row is, of the step that ends there and of the one that begins there, and with `inner`
 * those of the constraint points inside the latter. */
typedef struct {
    uint32_t constraints, points; /* columns of a point; points of a step with both ends */
    int inner;
    double *step; /* [points*constraints] of the last step */
} dm_impulses;

static inline uint32_t dm_impulses_width(const dm_impulses *i) {
    return i->inner ? i->constraints * (i->points - 1) : i->constraints;
}

/* A run that goes on where another one was. */
typedef struct {
    long steps;           /* done before: t = t0 + (steps + k) h */
    const double *memory; /* what the engine left beside the state; NULL: nothing */
} dm_resumption;

typedef struct {
    double t0, h;     /* time of the start, length of the steps */
    long steps;       /* >= 0 */
    long every;       /* keep one state in `every`, >= 1; the last is kept too */
    const double *at; /* or, not NULL: keep the states at these times, growing, from t0 on */
    long at_count;
    double until;        /* methods with a time of their own: stop at the first step past it */
    dm_control *control; /* steps by their error, from h on, up to `until`; NULL: all are h long */
    double seconds;      /* of CPU, then it ends with DM_OUT_OF_TIME; 0: as long as it takes */
    double *between;     /* with `at`: room for two states */
    dm_observer *watch;  /* what a row holds beside t; NULL: q, p */
    int beside;          /* and q, p in front of what is watched */
    dm_follow *follow;   /* without `at` and events: beside a flow; NULL: not looked at */
    dm_observer *aside;  /* what is looked at there */
    dm_impulses *impulses; /* behind all that; without `at` and events; NULL: none */
    dm_outlet *outlet;     /* NULL: all rows fit */
    dm_events *events;     /* NULL: none is looked for */
    dm_inertia *inertia;   /* a step over a change of it ends the run; NULL: it cannot change */
    const dm_resumption *resume; /* NULL: a start */
    double save_every;           /* s of wall time between calls of save */
    /* between steps: the state can be kept; may be NULL; not DM_OK ends the run */
    dm_status (*save)(void *ud, long done);
    const volatile sig_atomic_t *stop; /* polled between bursts of steps; may be NULL */
    void (*progress)(void *ud, long done, long steps); /* about ten times a second; may be NULL */
    void *ud;
} dm_run_plan;

/* Rows that dm_run fills at most: the start, one per `every` steps, the end; or one per time
 * asked for. */
long dm_run_rows(const dm_run_plan *plan);

/* Run `plan` on state (dm_state_size doubles, in place), writing rows (NULL: none) of 1 + 2n
 * columns, t, q[n], p[n], or t and what is watched, or both. Rows at given times come from a
 * shorter step on the side (dm_interpolate), which does not touch the run itself. *done counts
 * finished steps and *rows_done rows, also on failure or stop, so that both are valid up to there
 * (the last row is then the last good state). */
dm_status dm_run(const dm_run_plan *plan, dm_stepper *s, double *state, double *rows, long *done,
                 long *rows_done);

#endif
