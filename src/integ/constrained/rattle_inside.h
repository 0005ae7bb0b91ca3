/* rattle_inside.h - what the graphs of a constrained step share while they are made. */
#ifndef DM_RATTLE_INSIDE_H
#define DM_RATTLE_INSIDE_H

#include "graph/linear.h"
#include "integ/constrained/rattle.h"
#include "integ/split/fused.h"

typedef struct {
    dm_fusion f; /* the graph of the kernel that is being made, and the model */
    const dm_model *model;
    dm_rattle_layout at;
    dm_arena *arena;
    int no_memory;
    dm_graph *source;       /* inputs q, v, t */
    dm_node *force, *G, *g; /* of source: F[n], the nonzeros of G, g[m] */
    dm_node *g_t;           /* [m] */
    /* f[n] and df/dv [n*n] where f sees v, and is then no part of F; else NULL */
    dm_node *drag, *drag_v;
    dm_node *with;            /* inputs of source in the kernel's graph */
    uint32_t *row, *column;   /* row i of G has the nonzeros row[i] .. row[i + 1] - 1 */
    dm_node h, half, t0, t;   /* inputs */
    dm_node *q, *p, *lq, *lp; /* the state */
} dm_rattle_frame;

/* `count` nodes, zeroed; NULL is remembered, so that no kernel comes out without what should be
 * in it. */
dm_node *dm_rattle_take(dm_rattle_frame *b, size_t count);

/* A new graph, with its state and coefficients; the kernel of roots[count] in it. */
int dm_rattle_begin(dm_rattle_frame *b);
dm_status dm_rattle_end(dm_rattle_frame *b, dm_kernel *out, const dm_node *roots, size_t count);

/* Nodes of the inputs first .. first + count - 1. */
void dm_rattle_inputs(const dm_rattle_frame *b, dm_node *out, uint32_t first, uint32_t count);

/* roots[count] of the source, compacted and contracted together, at q[n], v[n] (NULL: it is not
 * in them) and t: the same roots give the same bits in every kernel. */
typedef struct {
    const dm_node *q, *v;
    dm_node t;
} dm_rattle_point;
void dm_rattle_evaluate(dm_rattle_frame *b, dm_node *out, const dm_node *roots, size_t count,
                        const dm_rattle_point *at);

/* B[n*m] = W G^T, times h where that is a node; A[m*m] = G B, symmetric: only its upper half. */
void dm_rattle_spread(const dm_rattle_frame *b, dm_node *B, const dm_node *G, dm_node h);
void dm_rattle_multiply(const dm_rattle_frame *b, dm_node *A, const dm_node *G, const dm_node *B,
                        int symmetric);

/* out[n] = what q moves by, its low part too: low + h W (p + h/2 F - shift) + B lambda, B = h W
 * G0^T. */
int dm_rattle_displace(dm_rattle_frame *b, dm_node *out, const dm_node *F, const dm_node *B,
                       const dm_node *lambda);

/* sum + x y in the kernel's graph */
static inline dm_node dm_rattle_add_product(const dm_rattle_frame *b, dm_node sum, dm_node x,
                                            dm_node y) {
    return dm_add_product(b->f.graph, sum, x, y);
}

/* The kernels `first` and `newton` (rattle_iterate.c). */
dm_status dm_rattle_make_iterate(dm_rattle_frame *b, dm_kernel *out, int first);

#endif
