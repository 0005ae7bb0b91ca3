/* chain.h - splitting steps of a model whose force is loops along arrays (chain/lattice.h): kick
 * and drift of a stage are one pass over the bodies, right behind their slopes. Sums are kept
 * with compensation as q = q0 + dq, p = p0 + dp: q0 and p0 are those of the start of the step,
 * to the increments everything is added, and the end of the step makes one compensated sum of
 * each. Plain sums are added to q and p themselves, and leave the low parts of the state as they
 * are. */
#ifndef DM_CHAIN_H
#define DM_CHAIN_H

#include "integ/split/splitting.h"

typedef struct dm_chain dm_chain;

/* Doubles of workspace; 0 where the model is not of this kind. */
size_t dm_chain_work(const dm_model *m);

/* In that workspace; NULL where the model is not of this kind. */
dm_chain *dm_chain_open(const dm_model *m, const dm_splitting *table, int plain, double *work);

typedef struct {
    double h, t;
    long count;  /* of steps */
    int goes_on; /* the state is what the last burst left, in the arrays too */
} dm_chain_burst;

/* Gives the number of forces, 0 when what comes out is not finite: the state is as it was then. */
long dm_chain_run(dm_chain *c, double *state, const dm_chain_burst *b);

#endif
