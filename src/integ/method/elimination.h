/* elimination.h - M^-1 written out as nodes: M = l D l^T with blocks of two in D (the last may
 * be one), which has half as many divisions that wait for each other as single pivots. */
#ifndef DM_ELIMINATION_H
#define DM_ELIMINATION_H

#include "graph/graph.h"

typedef struct {
    dm_graph *g;
    uint32_t n;
    dm_node *mass;  /* [n*n] M, lower triangle; what is left of it */
    dm_node *lower; /* [n*n] rows of l, and D^-1 in the blocks */
    /* [n] positive where M is positive definite, and elimination then exact to round-off */
    dm_node *pivot;
    dm_node *shift; /* [n] p - b, then v */
} dm_elimination;

/* l, D^-1 and pivots; 0 at a pivot that vanishes everywhere. */
int dm_elimination_factor(dm_elimination *e);

/* v = l^-T D^-1 l^-1 (p - b) */
void dm_elimination_solve(dm_elimination *e);

#endif
