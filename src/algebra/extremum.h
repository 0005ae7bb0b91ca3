/* extremum.h - a function of x that is f(x, y) at the y for which f is stationary. Where y has a
 * formula the value is a node like any other; what is kept beside the graph is f, for smaller
 * derivatives: by the envelope property the gradient is f_x, and the Hessian f_xx - f_xy f_yy^-1
 * f_yx, both at that y. */
#ifndef DM_EXTREMUM_H
#define DM_EXTREMUM_H

#include "graph/graph.h"

typedef struct dm_extremum {
    dm_node value;    /* of the graph it belongs to */
    uint32_t n, m;    /* entries of x, the first inputs of that graph, and of y */
    const dm_node *y; /* [m] of that graph */
    dm_graph *of;     /* inputs x[n], y[m], then those of the graph behind x */
    dm_node f;
    struct dm_extremum *next; /* of the graph, newest first */
} dm_extremum;

/* Keep a copy of *e (next is set here). */
void dm_extremum_keep(dm_graph *g, const dm_extremum *e);

/* The extremum whose value is this node, NULL when it is none. */
const dm_extremum *dm_extremum_find(const dm_graph *g, dm_node value);

/* gradient[n], hessian[n*n] (symmetric) of e->value as nodes of g. */
void dm_extremum_derive(dm_graph *g, const dm_extremum *e, dm_node *gradient, dm_node *hessian);

#endif
