/* jit_plan.h - what a kernel computes, in order: operations that feed library calls first, so
 * that little is alive across the calls; sine and cosine of one angle as one call. Every
 * operand knows where it is used next. */
#ifndef DM_JIT_PLAN_H
#define DM_JIT_PLAN_H

#include "graph/graph.h"

#define DM_NEVER UINT32_MAX

/* one operation of the kernel, or a library call with two results */
typedef struct {
    uint8_t op; /* dm_op; DM_OP_SIN with two results is a sincos */
    uint8_t operands;
    dm_node d, d2; /* results; d2 = 0: one only */
    dm_node arg[3];
    uint32_t next[3]; /* position of the operand's next use after this one */
} dm_step;

typedef struct {
    dm_step *steps;
    uint32_t count, end; /* steps; nodes are below end */
    uint32_t calls;      /* steps that call the library */
    uint32_t *first;     /* [end] position of the first use */
    uint32_t *output;    /* [end] number of an output plus one that has this node, 0: none */
    uint32_t *also;      /* [m] another output of the same node plus one, 0: no more */
    const dm_node *roots;
    uint32_t m;
    dm_arena *scratch; /* for all that is not needed once there is code */
} dm_plan;

/* 0 without memory, which comes from `scratch`. */
int dm_plan_make(dm_plan *p, dm_graph *g, const dm_node *roots, uint32_t m, dm_arena *scratch);

/* The same for a part of a loop: every root is used once more at the end, at position `count`,
 * and none is written. */
int dm_plan_make_part(dm_plan *p, dm_graph *g, const dm_node *roots, uint32_t m, dm_arena *scratch);

static inline int dm_is_call(uint8_t op) {
    return (op >= DM_OP_EXP && op <= DM_OP_TANH) || op == DM_OP_POW || op == DM_OP_ATAN2;
}

#endif
