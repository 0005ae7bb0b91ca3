/* stage_place.h - where the matrix of a step was made, which further steps take again while it
 * serves (Hairer & Wanner 1996, IV.8): a part of the memory, so that a run that goes on from a
 * checkpoint makes the same one. Only steps of the h of the run know of it. */
#ifndef DM_STAGE_PLACE_H
#define DM_STAGE_PLACE_H

#include <stddef.h>

typedef struct {
    size_t size; /* of a place: the numbers that a matrix is made of, beside h; t is the last. 0: no
                  * matrix is kept, since it is of h alone */
    double *memory; /* [2 + size]: h; steps that the place served, 0: none is kept, below: so many
                     * are left without one; the place */
    double *made;   /* [size] the place that the factors in hand are of */
    int is_made;    /* they are of one, and of this h */
} dm_stage_place;

/* Which matrix a step begins with: its own, its own, which is kept, or that of the memory. */
typedef enum { DM_PLACE_OWN, DM_PLACE_NEW, DM_PLACE_KEPT } dm_place_use;

static const double DM_PLACE_SLOW = 0.1; /* rate that a kept matrix may not exceed */

/* Doubles of one; laid out in them, empty. What of it is memory. */
size_t dm_stage_place_room(size_t size);
void dm_stage_place_open(dm_stage_place *p, double *room, size_t size);
size_t dm_stage_place_memory(const dm_stage_place *p);

/* A run with the step h begins. */
void dm_stage_place_clear(dm_stage_place *p, double h);

/* A step h begins at (here[size - 1], t). */
dm_place_use dm_stage_place_ask(dm_stage_place *p, const double *here, double t, double h);

/* The numbers and, behind them, the t of the memory's place. */
const double *dm_stage_place_of(const dm_stage_place *p);

/* Are the factors in hand those of the memory's place? They are from here on. */
int dm_stage_place_has(const dm_stage_place *p);
void dm_stage_place_make(dm_stage_place *p);

/* The step that asked has ended after so many iterations; the kept matrix did not serve, and (here,
 * t) takes its place, unless it had served no step but its own; a new one did not serve. */
void dm_stage_place_ended(dm_stage_place *p, int iterations);
dm_place_use dm_stage_place_failed(dm_stage_place *p, const double *here, double t);
void dm_stage_place_leave(dm_stage_place *p);

#endif
