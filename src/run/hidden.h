/* hidden.h - what a step cannot have seen: narrow features of the forces between the points where
 * a rule evaluates them. */
#ifndef DM_HIDDEN_H
#define DM_HIDDEN_H

#include "graph/bounds.h"
#include "mech/model.h"

/* The forces E(q, v, t) of a system, dL/dq, dL/dv and what else pushes it, and what is watched, as
 * a graph; in phase space E(q, p, t): forces, the rates of q, what is watched. */
typedef struct {
    const dm_graph *graph; /* of them alone: inputs q[n], v[n] or p[n], t */
    const dm_node *roots;  /* [count], the forces, then [parts], what of them may be narrow */
    uint32_t n, count, parts;
    uint32_t impulses; /* of the first so many roots only what they add up to over a step matters */
    int in_phase_space; /* then n rates of q are behind them, which add up, too */
    uint32_t watched;  /* of the roots, the last so many, in units of what they may be off unseen */
    double negligible; /* of the largest momentum so far: an impulse so small is none */
    dm_interval *value, *rate, *bend; /* [dm_graph_size], scratch: forces, their d/ds, d2/ds2 */
    double *weight; /* [dm_graph_size], scratch: what nodes count for in the forces */
    double noise;   /* what their impulse may be by round-off */
    dm_interval *in, *rate_in, *bend_in; /* [2n + 1], scratch */
    dm_interval *found;                  /* [count + parts], scratch: the forces in a box */
    double *samples;                     /* [dm_hidden_samples x (count + parts)], scratch */
    double (*curve)[6];    /* [n], in phase space [2n], scratch: y(s) = sum_k curve[k] (s - 1/2)^k
                            * of y = q, p along a step */
    double *velocity;      /* [3n], scratch: at its start, middle, end */
    const dm_model *model; /* whose p = dL/dv tells the velocity; NULL: it is not known */
    double *work;          /* [dm_legendre_work of it], scratch */
} dm_hidden;

enum { DM_HIDDEN_PARTS = 8 }; /* of a step, at whose ends forces are sampled */

/* Doubles of `samples`: at the ends of the parts, and behind them the largest of each. */
static inline size_t dm_hidden_samples(uint32_t count) {
    return (DM_HIDDEN_PARTS + 2) * (size_t)count;
}

/* list[] = the nodes that may have narrow features of their own, for `parts`: results of other
 * operations than sums, products and low powers, and what joins two such. A feature of theirs may
 * be small beside all that is added to it later. Returns how many; rough[dm_graph_size] is scratch,
 * list has room for as many. */
uint32_t dm_hidden_parts(const dm_graph *g, dm_node *list, unsigned char *rough);

/* A step by q[n] and p[n] at its start, middle and end. */
typedef struct {
    double t, h;
    const double *q[3], *p[3];
    double position, momentum; /* the largest |q_i| and |p_i| so far */
} dm_swept;

/* Is all that the forces can be in the boxes that a step sweeps like what samples of them are, and
 * all that their parts can be, unless it counts for nothing?
 * 1, or 0 and in *where the time of the first box, after so many bisections, where it is not. */
int dm_hidden_nothing(dm_hidden *x, const dm_swept *step, double *where);

#endif
