/* run.h - the step loop: the only loop over time in the program. */
#ifndef DM_RUN_H
#define DM_RUN_H

#include "integ/method.h"

#include <signal.h>

typedef struct {
    double t0;  /* time of the start */
    long steps; /* >= 0 */
    long every; /* keep one state in `every`, >= 1; the last is kept too */
    const double
        *at; /* or, not NULL: keep the states at these times, growing, from t0 on */
    long at_count;
    double until; /* methods with a time of their own: stop at the first step past it */
    double *landing;                   /* with `at`: room for a state */
    const volatile sig_atomic_t *stop; /* polled between bursts of steps; may be NULL */
    void (*progress)(void *ud, long done,
                     long steps); /* about ten times a second; may be NULL */
    void *ud;
} dm_run_plan;

/* Rows that dm_run fills at most: the start, one per `every` steps, the end; or one per time asked for. */
long dm_run_rows(const dm_run_plan *plan);

/*
** Run `plan` on state (dm_state_size doubles, in place), writing rows of 1 + 2n columns:
** t, q[n], p[n]. Rows at given times come from a shorter step on the side (dm_land), which does not touch the
** run itself. *done counts finished steps and *rows_done rows, also on failure or stop, so
** that both are valid up to there (the last row is then the last good state).
*/
dm_status dm_run(const dm_run_plan *plan, dm_stepper *s, double *state, double *rows,
                 long *done, long *rows_done);

/* The same without rows: only the end is kept, in `state`. */
dm_status dm_run_end(const dm_run_plan *plan, dm_stepper *s, double *state, long *done);

#endif
