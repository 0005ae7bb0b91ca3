/* ensemble_block.h - the members that one thread steps side by side. */
#ifndef DM_ENSEMBLE_BLOCK_H
#define DM_ENSEMBLE_BLOCK_H

#include "integ/method/lanes.h"
#include "run/ensemble/ensemble.h"
#include "run/inertia/mass_lanes.h"

typedef struct {
    dm_stepper *stepper;
    dm_lanes lanes;      /* as many groups as the members in hand need */
    uint32_t most;       /* groups */
    long burst;          /* steps between looks at the stop flag, from block to block */
    dm_observer *watch;  /* what rows hold; NULL: q, p */
    dm_observer *aside;  /* what is looked at beside flows; NULL: nothing */
    dm_inertia *inertia; /* NULL: it cannot change */
    dm_mass_lanes *mass; /* what is looked at there; NULL: members are looked at one by one */
    dm_stencil at;       /* of the last look beside a flow */
    void (*count)(void *ud, long steps); /* told of steps that members have made */
    void *ud;
    double h[DM_LANES_GROUPS * 8]; /* steps of the members */
} dm_block;

/* Kernels for an opened stepper, in the arena of its model; inertia: NULL, or what looks at that.
 * 0: members go one by one. */
int dm_block_open(dm_block *b, dm_stepper *s, dm_inertia *inertia);

/* May members with steps of their own go side by side? */
int dm_block_is_paced(const dm_block *b);

/* Keep the states, as they are before a step. */
void dm_block_keep(dm_block *b);

/* The step of member i from the kept state to the time t, before which a value of d2L/dv2 fell
 * steeply, or which may hide one (`open`): does it vanish inside? Not known of steps that choose
 * their own length. */
int dm_block_vanishes(dm_block *b, uint32_t i, double t, int steep, int open);

/* Who runs a member alone, and who is told of its steps (may be NULL). */
typedef struct {
    dm_stepper *stepper;
    dm_observer *watch, *aside;
    dm_inertia *inertia;
    void (*progress)(void *ud, long done, long steps);
    void *ud;
} dm_member_run;

/* What dm_run would make of member i alone; its rows lie at its place. */
void dm_run_member(const dm_ensemble *e, const dm_member_run *run, long i);

/* Members first .. first + count - 1, at most lanes x most, to the end, to their failures or to
 * the stop flag; e->pace: that of the first, or that of each where the block is paced. */
void dm_block_run(const dm_ensemble *e, dm_block *b, long first, long count);

#endif
