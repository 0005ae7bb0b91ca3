/*
** fused.h - a whole explicit step as one straight-line kernel from state to state: the force, the kicks, the
** drifts and their compensated sums in one graph. The same numbers as step by step through a force kernel
** but for rounding; every backend gives the same bits.
*/
#ifndef DM_FUSED_H
#define DM_FUSED_H

#include "integ/method.h"

typedef struct {
    dm_kernel kernel; /* size -> size */
    dm_kernel
        first; /* size -> what is carried from step to step beside the state, found from the state */
    double *now, *next;
    uint32_t size; /* 0: there is none */
    double h;      /* the step it was made for */
} dm_fused;

/* A graph under construction: nodes are made as they stand. */
typedef struct {
    dm_graph *graph;
    const dm_model *model;
    dm_node
        *with; /* [inputs of L] what stands for q, v, t in the model's own expressions */
    dm_node *
        force; /* [n] compacted expressions of the model: the force, or the well and the force */
    uint32_t count;
} dm_fusion;

enum {
    DM_FUSED_LARGEST = 6000
}; /* operations of a step: more does not fit the instruction cache */

/*
** Begin a step with `inputs` inputs around expressions[count] of the model's graph, of which a step needs
** `times` copies. 0 when it cannot be had: no graph (hyper-dual numbers), L depends on t, too large, no memory.
*/
int dm_fusion_begin(dm_fusion *b, const dm_model *m, const dm_node *expressions,
                    uint32_t count, uint32_t times, uint32_t inputs);

/* out[count] = the expressions at positions q[n]. */
void dm_fusion_evaluate(dm_fusion *b, const dm_node *q, dm_node *out);

/* high + low += x, as base/sum.h does it. */
void dm_fusion_add(dm_fusion *b, dm_node *high, dm_node *low, dm_node x);

/* c * x; a factor of 1 is left out. */
dm_node dm_fusion_scale(dm_fusion *b, double c, dm_node x);

/* v[n] = scale * M^-1 (p - shift). */
void dm_fusion_velocity(dm_fusion *b, dm_node *v, const dm_node *p, double scale);

/* Compile roots[size], and first[extra] (may be none), into *out; size = 0 there when it cannot be had. */
void dm_fusion_end(dm_fusion *b, dm_fused *out, const dm_node *roots, uint32_t size,
                   const dm_node *first, uint32_t extra);

/* `count` steps of the state in f->now. */
void dm_fused_run(dm_fused *f, long count);

#endif
