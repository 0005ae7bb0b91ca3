/* cells_split.h - kicks and drifts of a field on a mesh (chain/cells.h): all forces, then entry by
 * entry the kick and the next drift, in as many threads as are asked for. No entry is
 * written by two places, so the bits do not depend on threads. Unit vectors (fields with values on
 * a sphere) take RATTLE's step in the place of the drift. Forces f(q, v, t) beside L
 * (chain/virtual_work.h) act in the kicks: the one that ends a step is implicit in v,
 *   p1 = p + h/2 (L_q + f(q1, v1, t1)),   v1 = M^-1 p1,
 * cell by cell, the one that begins the next explicit; both together are the central difference
 * M (q2 - 2 q1 + q0) / h^2 = L_q + f where f is linear in v. */
#ifndef DM_CELLS_SPLIT_H
#define DM_CELLS_SPLIT_H

#include "integ/split/splitting.h"

typedef struct dm_cells_split dm_cells_split;

/* Doubles of workspace; 0 where the model is not of this kind or its force not yet made. */
size_t dm_cells_split_work(const dm_model *m);

/* In that workspace, opened for a table of kicks and drifts; NULL: not of this kind. */
dm_cells_split *dm_cells_split_open(const dm_model *m, const dm_splitting *table, int plain,
                                    int threads, double *work);

/* Is the table kick, drift, kick, so that forces of v can be implicit in its second half? */
int dm_cells_split_damps(const dm_splitting *table);

/* `count` steps of h from time t, in place. goes_on: the state is what the last call left. *done:
 * how many; the state is that behind them. *forces: how many were made. DM_NOT_FINITE;
 * DM_NO_CONVERGENCE where the equation of a value without mass has no root near it. */
dm_status dm_cells_split_run(dm_cells_split *s, double *state, double t, double h, long count,
                             int goes_on, long *done, long *forces);

/* Values without mass in q[n] as their own equation has them at time t; DM_NO_CONVERGENCE. */
dm_status dm_cells_split_settle(dm_cells_split *s, double *q, double t);

void dm_cells_split_close(dm_cells_split *s);

#endif
