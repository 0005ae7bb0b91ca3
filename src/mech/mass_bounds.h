/* mass_bounds.h - d2L/dv2 of a model as a graph of its own, to be enclosed in boxes
 * (graph/bounds.h). */
#ifndef DM_MASS_BOUNDS_H
#define DM_MASS_BOUNDS_H

#include "graph/bounds.h"

enum { DM_MASS_MOST_NODES = 2000 }; /* of a graph that is enclosed */

typedef struct dm_mass_bounds {
    const dm_graph *graph;    /* of M(q, t) alone; inputs q[n], v[n], t and parameters */
    const dm_node *roots;     /* [n*n] */
    uint32_t n, inputs, size; /* size: nodes of the graph */
    int timed;                /* M depends on t, too */
    int shifted;              /* p is not M v alone */
    /* [n*n] how large |dM/ds| and |d2M/ds2| can be along straight lines with |dq_i/ds| <= 1
     * anywhere; infinite where that is not bounded */
    const double *shift, *bend;
} dm_mass_bounds;

/* Of the nodes L_v[n] and M[n*n] of g, where M does not depend on v; in the arena. NULL: no memory,
 * or an M that takes more nodes than looks at it are worth. */
const dm_mass_bounds *dm_mass_bounds_new(dm_graph *g, const dm_node *momentum, const dm_node *mass,
                                         uint32_t n, dm_arena *arena);

/* Is M positive definite whatever q, t and the parameters are, as bounds of its entries tell?
 * scratch: inputs + size intervals. */
int dm_mass_is_definite(const dm_mass_bounds *b, dm_interval *scratch);

/* May an entry of M be infinite at some q, as one over what vanishes there? Not if bounds tell.
 * scratch: 2 (inputs + size) intervals. */
int dm_mass_may_have_pole(const dm_mass_bounds *b, dm_interval *scratch);

/* shift[n*n], bend[n*n] = how large |dM/ds|, |d2M/ds2| can be along lines in the box in[inputs],
 * straight ones, with rates in rate_in[inputs]; scratch: 3 intervals a node. */
void dm_mass_bounds_bend(const dm_mass_bounds *b, const dm_interval *in, const dm_interval *rate_in,
                         double *shift, double *bend, dm_interval *scratch);

#endif
