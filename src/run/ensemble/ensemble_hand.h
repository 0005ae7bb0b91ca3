/* ensemble_hand.h - the members of a block while they are stepped: what the files of a block
 * ask of each other. */
#ifndef DM_ENSEMBLE_HAND_H
#define DM_ENSEMBLE_HAND_H

#include "run/ensemble/ensemble_block.h"

enum { DM_HAND_MOST = DM_LANES_GROUPS * 8 }; /* members */

typedef struct {
    const dm_ensemble *e;
    dm_block *b;
    long first, count; /* members of the block */
    long done;         /* steps */
    long alive;        /* members that still run */
    /* steps: the next row, look or end of one of them; row or end; end */
    long next, next_row, next_end;
    long kept;      /* steps of the states kept in the lanes; -1: none are */
    uint64_t told;  /* members whose mass lanes found to be positive, and that are not quiet */
    uint64_t ended; /* members that have done all of their steps */
    /* Steps of their next rows, where rows are kept; what is known where the inertia may change.
     * Elsewhere they are left as they are. Speed: ensembles.lua, start, one step, end: 1.1x. */
    long row[DM_HAND_MOST];
    dm_inertia_seen seen[DM_HAND_MOST];
    dm_inertia_there there[DM_HAND_MOST]; /* of those in told */
} dm_hand;

static inline uint32_t dm_hand_dim(const dm_hand *x) {
    return x->b->stepper->model->n;
}

static inline double *dm_hand_state(const dm_hand *x, long i) {
    return x->e->state + (size_t)(x->first + i) * dm_state_size(dm_hand_dim(x));
}

static inline dm_member *dm_hand_member(const dm_hand *x, long i) {
    return x->e->member + x->first + i;
}

/* Member i still runs. */
static inline int dm_hand_runs(const dm_hand *x, long i) {
    return dm_hand_member(x, i)->status == DM_OK && !(x->ended >> i & 1);
}

/* Lanes have steps of their own, by member. */
static inline int dm_hand_has_paces(const dm_hand *x) {
    return x->e->pace && dm_block_is_paced(x->b);
}

/* Its steps, and how many of them from row to row. */
static inline long dm_hand_steps(const dm_hand *x, long i) {
    return dm_hand_has_paces(x) ? x->e->pace[x->first + i].steps : x->e->steps;
}

static inline long dm_hand_every(const dm_hand *x, long i) {
    return dm_hand_has_paces(x) ? x->e->pace[x->first + i].every : x->e->rows->every;
}

/* What is computed for member i alone has its parameters. */
void dm_hand_choose(const dm_hand *x, long i);

/* Of member i after so many steps, or as its state has it. */
double dm_hand_time(const dm_hand *x, long i, const double *state, long steps);

/* A row of every member that still runs and has one due, a look at those that are due. */
void dm_hand_keep_rows(dm_hand *x);

/* The last state, or the last good one, if it is not a row yet. */
void dm_hand_keep_last_row(dm_hand *x, long i);

/* Beside its flow: member i, whose state this is after so many steps. */
void dm_hand_look_beside(const dm_hand *x, long i, const double *state, long steps);

/* A lane without a member of its own runs along with the numbers of another, or is left alone. */
void dm_hand_pad(dm_hand *x);

/* Was member i looked at beside its flow after so many steps? */
int dm_hand_has_seen(const dm_hand *x, long i, long steps);

/* The members that are to be looked at now, since that is due or since they end here, but for those
 * that lanes are done with; x->told and x->there of those of them of which lanes tell. */
uint64_t dm_hand_find_inertia(dm_hand *x);

/* Fills in x->next and its kin, of members that still run. */
void dm_hand_find_next(dm_hand *x);

#endif
