/* hidden.h - what a step cannot have seen: narrow features of the forces between the points where
 * a rule evaluates them. */
#ifndef DM_HIDDEN_H
#define DM_HIDDEN_H

#include "graph/bounds.h"

/* The forces E(q, v, t) of a system, dL/dq, dL/dv and what else pushes it, as a graph. */
typedef struct {
    const dm_graph *graph; /* of them alone: inputs q[n], v[n], t */
    const dm_node *roots;  /* [count] */
    uint32_t n, count;
    uint32_t impulses; /* of the first so many roots only what they add up to over a step matters */
    double negligible; /* of the largest momentum so far: an impulse so small is none */
    dm_interval *value, *rate; /* [dm_graph_size], scratch: the forces, and d/ds of them */
    dm_interval *in, *rate_in; /* [2n + 1], scratch */
    dm_interval *found;        /* [count], scratch: the forces in a box */
    double *samples;           /* [dm_hidden_samples x count], scratch */
    long looked;               /* boxes looked at so far */
} dm_hidden;

enum { DM_HIDDEN_PARTS = 8 }; /* of a step, at whose ends forces are sampled */

/* Doubles of `samples`. */
static inline size_t dm_hidden_samples(uint32_t count) {
    return (DM_HIDDEN_PARTS + 1) * (size_t)count;
}

/* A step as the parabola through q[n] at its start, middle and end. */
typedef struct {
    double t, h;
    const double *q[3];
    double momentum; /* the largest |p_i| so far */
} dm_swept;

/* Is all that the forces can be in the boxes that a step sweeps like what samples of them are?
 * 1, or 0 and in *where the time of the first box, after so many bisections, where it is not. */
int dm_hidden_nothing(dm_hidden *x, const dm_swept *step, double *where);

#endif
