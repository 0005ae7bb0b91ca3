/* ensemble.h - many runs of one system side by side: members in blocks, blocks shared out to
 * threads. */
#ifndef DM_ENSEMBLE_H
#define DM_ENSEMBLE_H

#include "integ/method/method.h"
#include "run/departure.h"
#include "run/ensemble/ensemble_rows.h"
#include "run/inertia/inertia.h"

#include <signal.h>

enum { DM_ENSEMBLE_THREADS = 256 };

/* What becomes of one member. Small, as all are written: ensembles.lua, start, one step, end. */
typedef struct {
    dm_status status;      /* DM_STOPPED also for members that were not reached */
    unsigned char fading;  /* it failed where d2L/dv2 was about to lose a value */
    unsigned char trouble; /* there is one: that of the step that failed */
    long steps;            /* finished */
} dm_member;

/* A step of its own for a member, how many of them, and how often a row is kept. */
typedef struct {
    double h;
    long steps, every;
} dm_pace;

typedef struct {
    long members, steps;
    double t0, h;
    const dm_pace *pace;  /* [members]; NULL: h, `steps`, the rows' `every` for all */
    const double *params; /* [members][params of the model] */
    double *state; /* [members] x dm_state_size: start, then end (failed: the last good state) */
    dm_member *member;            /* [members]; DM_STOPPED each, before they run */
    dm_trouble *trouble;          /* [members] of those that have one; may be NULL */
    const dm_ensemble_rows *rows; /* NULL: only the ends are kept */
    dm_observer *watch;           /* [threads] what the rows hold; NULL: q, p */
    dm_follow *follow;            /* [members] beside their flows; NULL: not looked at */
    dm_observer *aside;           /* [threads] what is looked at there */
    dm_inertia *inertia;          /* [threads]; NULL: it cannot change */
    uint32_t *lanes;              /* members that went side by side, 1: one by one; may be NULL */
    const volatile sig_atomic_t *stop;
    /* steps of all members that are done; called by the first thread only, every few
     * milliseconds; may be NULL */
    void (*progress)(void *ud, long done);
    void *ud;
} dm_ensemble;

/* Member i failed in a step: what is known of that. */
static inline void dm_ensemble_note(const dm_ensemble *e, long i, const dm_trouble *of_step) {
    if (!e->trouble) return;
    e->trouble[i] = *of_step;
    e->member[i].trouble = 1;
}

/* Run all members with one opened stepper per thread (steppers[threads], each with workspace and
 * kernels of its own). Every member is what dm_run would make of it alone, bit for bit, whatever
 * the number of threads; one that fails stops alone. DM_STOPPED when the flag was seen, else
 * DM_OK. */
dm_status dm_ensemble_run(const dm_ensemble *e, dm_stepper *const *steppers, int threads);

#endif
