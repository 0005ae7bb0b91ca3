/*
** fused.h - one stage of an explicit step as one straight-line kernel from state to state: force, kick, drift
** and their compensated sums in one graph, the coefficients of the stage among the inputs. The same numbers as
** through a force kernel but for rounding; every backend gives the same bits.
*/
#ifndef DM_FUSED_H
#define DM_FUSED_H

#include "integ/method.h"

#include <math.h>
#include <string.h>

enum {
    DM_FUSED_COEFFICIENTS = 4, /* of a stage, at most */
    DM_FUSED_LARGEST =
        20000 /* operations of the force; above, a kernel for it alone serves as well */
};

/* A graph under construction, made as it stands. Inputs: state[size], then the coefficients. */
typedef struct {
    dm_graph *graph;
    const dm_model *model;
    uint32_t size;
    dm_node *with;  /* [inputs of L] what stands for q, v, t in the model's expressions */
    dm_node *force; /* [n] the model's expressions, compacted */
    uint32_t lanes; /* members that the kernel steps side by side, 1 unless changed */
} dm_fusion;

/*
** Begin a kernel around expressions[n] of the model's graph. 0 when it cannot be had: no graph (hyper-dual
** numbers), too large, no memory.
*/
int dm_fusion_begin(dm_fusion *b, const dm_model *m, const dm_node *expressions,
                    uint32_t size);

/* Nodes for the inputs: state[size], and coefficient i. */
void dm_fusion_state(dm_fusion *b, dm_node *state);
dm_node dm_fusion_coefficient(dm_fusion *b, uint32_t i);

/* out[n] = the expressions at positions q[n] and time t. */
void dm_fusion_evaluate(dm_fusion *b, dm_node *out, const dm_node *q, dm_node t);

/* high + low += x, as base/sum.h does it. */
void dm_fusion_add(dm_fusion *b, dm_node *high, dm_node *low, dm_node x);

/* v[n] = M^-1 (p - shift), and the shifted moved[n] = p - shift (may be NULL). */
void dm_fusion_velocity(dm_fusion *b, dm_node *v, dm_node *moved, const dm_node *p);

/* Compile roots[m] into *out; 0 when it cannot be had. */
int dm_fusion_end(dm_fusion *b, dm_kernel *out, const dm_node *roots, uint32_t m);

/* The two buffers between which stages go to and fro: state[size][lanes], then coefficients. */
typedef struct {
    double *now, *next;
    uint32_t size; /* 0: no fused stages */
    uint32_t lanes;
    double has[2][DM_FUSED_COEFFICIENTS]; /* lanes, first group: what now and next have */
} dm_fused;

/* Buffers in the model's arena; 0 without memory. */
int dm_fused_open(dm_fused *f, const dm_model *m, uint32_t size, uint32_t lanes);

/* One stage: coefficients[count] of it, then the kernel from now to next, which change places. */
static inline void dm_fused_stage(dm_fused *f, const dm_kernel *k,
                                  const double *coefficients, int count) {
    for (int i = 0; i < count; i++) f->now[f->size + (uint32_t)i] = coefficients[i];
    dm_kernel_eval(k, f->now, f->next);
    double *swap = f->now;
    f->now = f->next;
    f->next = swap;
}

/* Lanes: all groups are about to begin anew, none of their coefficients is known. */
static inline void dm_fused_forget(dm_fused *f) {
    for (int i = 0; i < DM_FUSED_COEFFICIENTS; i++) f->has[0][i] = f->has[1][i] = NAN;
}

/* coefficient i of the next stage into all groups, where it is not there already */
static inline void dm_fused_broadcast(dm_fused *f, uint32_t groups, int i, double c) {
    if (memcmp(f->has[0] + i, &c, sizeof c) == 0) return;
    f->has[0][i] = c;
    for (uint32_t g = 0; g < groups; g++) {
        double *place = f[g].now + (f[g].size + (size_t)i) * f->lanes;
        for (uint32_t lane = 0; lane < f->lanes; lane += 4, place += 4)
            place[0] = place[1] = place[2] = place[3] = c;
    }
}

/*
** One stage of every group before the next one: their latencies overlap. The coefficients are written for
** all groups first: a kernel would wait for so many narrow stores right before it.
*/
static inline void dm_fused_groups(dm_fused *f, uint32_t groups, const dm_kernel *k,
                                   const double *coefficients, int count) {
    for (int i = 0; i < count; i++) dm_fused_broadcast(f, groups, i, coefficients[i]);
    for (uint32_t g = 0; g < groups; g++) {
        dm_kernel_eval(k, f[g].now, f[g].next);
        double *swap = f[g].now;
        f[g].now = f[g].next;
        f[g].next = swap;
    }
    for (int i = 0; i < DM_FUSED_COEFFICIENTS; i++) {
        const double kept = f->has[0][i];
        f->has[0][i] = f->has[1][i];
        f->has[1][i] = kept;
    }
}

#endif
