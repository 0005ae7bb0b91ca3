/* folds.h - folds of a level set: where its angle with the orbits changes its sign. A search, not
 * a proof: curves along the set, towards the places where it may be narrow, and to lesser
 * angles. */
#ifndef DM_FOLDS_H
#define DM_FOLDS_H

#include "level/level.h"

typedef struct {
    dm_level *level;
    int (*inside)(void *ud, const double *x); /* what the set is restricted to */
    /* Between a and b of one curve the sine changes its sign; or (left) the curve leaves what is
     * inside between left[0] and left[1] and comes back between a and b. 0: enough of them. */
    int (*found)(void *ud, const double *a, const double *b, const double *const left[2]);
    void *ud;
    uint32_t most; /* nodes along curves; as many downhill, three times as many at switches */
} dm_folds;

/* x[count n]: where to start, brought to the set within step[count]. DM_NO_MEMORY. */
dm_status dm_folds_search(const dm_folds *how, const double *x, const double *step, uint32_t count,
                          dm_arena *arena);

#endif
