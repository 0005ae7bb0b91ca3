/* chain_inside.h - loops of a chain, for the files that make and run them only. */
#ifndef DM_CHAIN_INSIDE_H
#define DM_CHAIN_INSIDE_H

#include "chain/lattice.h"
#include "integ/split/chain.h"

enum { TIME, KICK, DRIFT, AGAIN_KICK, AGAIN_DRIFT }; /* numbers of a pass */

struct dm_chain {
    dm_lattice lattice;
    dm_splitting table;
    double c[DM_SPLITTING_STAGES + 1]; /* time of kick k is t + c_k h */
    int first, last; /* kicks of a step; the first one of all may belong to the turn */
    int plain;
    uint32_t q, q0, p0, dq, dp, weight;
    double same_weight;                                 /* 1/m where it is that of all, else 0 */
    dm_array_loop lead[2], middle[2], turn[2], stop[2]; /* alone; fused with the slopes */
    int fused;
};

static inline dm_lattice_pair dm_chain_positions(const dm_chain *c) {
    return (dm_lattice_pair){c->q0, c->plain ? DM_LATTICE_NONE : c->dq};
}

/* chain_make.c: the loops of all steps with such a table; they take its coefficients as they
 * run. */
dm_status dm_chain_make(dm_chain *c, const dm_model *m);

#endif
