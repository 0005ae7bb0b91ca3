/* wave_run.h - the loop over time of a wave. */
#ifndef DM_WAVE_RUN_H
#define DM_WAVE_RUN_H

#include "wave/wave_stepper.h"

/* A row: t, norm, energy, x, momentum, noether, tail and edge (wave.h), then values psi, re and im
 * in turn. */
enum { DM_WAVE_T, DM_WAVE_NOETHER = 5, DM_WAVE_TAIL, DM_WAVE_EDGE, DM_WAVE_COLUMNS };

typedef struct {
    double t0;
    long steps, every; /* a row for so many steps, and the last step */
    long first;        /* number of the step before: t = t0 + (first + i) h */
    double seconds;    /* of CPU, then DM_OUT_OF_TIME; 0: as long as it takes */
    volatile const int *stop;
    void (*progress)(void *ud, long done, long steps); /* about ten times a second, or NULL */
    void *ud;
} dm_wave_plan;

/* Rows of a run that comes to its end. */
long dm_wave_rows(const dm_wave_plan *plan);

/* Steps the state of s, which is set, and fills rows[][DM_WAVE_COLUMNS + 2 n], the first one with
 * the state as it is. *done steps, *kept rows, also of a run that ends early, which then keeps the
 * state that it has come to as its last row. psi[2 n] and a[2 n] are scratch, aligned to 64.
 * DM_NOT_FINITE, DM_STOPPED, DM_OUT_OF_TIME and what a step may say. */
dm_status dm_wave_run(const dm_wave_plan *plan, dm_wave_stepper *s, double *rows, double *a,
                      double *psi, long *done, long *kept);

#endif
