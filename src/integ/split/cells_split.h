/* cells_split.h - kicks and drifts of a field on a mesh (chain/cells.h): all slopes, then entry by
 * entry the force, the kick and the next drift, in as many threads as are asked for. No entry is
 * written by two places, so the bits do not depend on threads. Unit vectors (fields with values on
 * a sphere) take RATTLE's step in the place of the drift. */
#ifndef DM_CELLS_SPLIT_H
#define DM_CELLS_SPLIT_H

#include "integ/split/splitting.h"

typedef struct dm_cells_split dm_cells_split;

/* Doubles of workspace; 0 where the model is not of this kind or its force not yet made. */
size_t dm_cells_split_work(const dm_model *m);

/* In that workspace, opened for a table of kicks and drifts; NULL: not of this kind. */
dm_cells_split *dm_cells_split_open(const dm_model *m, const dm_splitting *table, int plain,
                                    int threads, double *work);

/* `count` steps of h from time t, in place; gives the number of forces. */
long dm_cells_split_run(dm_cells_split *s, double *state, double t, double h, long count);

/* Values without mass in q[n] as their own equation has them at time t. */
void dm_cells_split_settle(dm_cells_split *s, double *q, double t);

void dm_cells_split_close(dm_cells_split *s);

#endif
