/* hamilton.h - Hamilton's equations of a Lagrangian quadratic in v as one kernel, for methods
 * that make kernels of their own: inputs (q[n], p[n], t), outputs v[n] = M^-1 (p - b), L_q(q, v,
 * t)[n] and the n pivots of M = L_vv, where L_v = M(q, t) v + b(q, t); to L_q a force f(q, v, t)
 * of the model is added. The elimination is exact to round-off where all pivots are positive. */
#ifndef DM_HAMILTON_H
#define DM_HAMILTON_H

#include "mech/model.h"

enum { DM_HAMILTON_LARGEST = 16 }; /* coordinates: n^3/6 products are written out */

/* True when the kernel can be made: a traced L, quadratic in v, not too large. */
int dm_hamilton_fits(const dm_model *m);

/* Kernels for up to `stages` members at once. Returns how many one evaluation takes: 8, 4 or 1,
 * laid out as in[input][lane], out[output][lane]; 0 where there is no kernel. */
uint32_t dm_hamilton_build(dm_kernel *out, const dm_model *m, uint32_t stages);

/* The same in three parts, between which momenta may be renewed. Where M = l D l^T with blocks
 * of two in D: force takes (q, v, t) and gives L_q[n] and what is known of M; factors takes that
 * and gives n pivots, a triangle with l below the blocks and D^-1 in them, and b; velocity takes
 * (that triangle, b, p) and gives v[n]. So a division never waits for p. Known are the lower
 * triangle of M by rows and b[n]. */
typedef struct {
    dm_kernel force, factors, velocity;
} dm_hamilton;

uint32_t dm_hamilton_split(dm_hamilton *out, const dm_model *m, uint32_t stages);

/* Numbers that are known of M and b: inputs of `factors`. */
static inline uint32_t dm_hamilton_known(uint32_t n) {
    return n * (n + 1) / 2 + n;
}

/* The same for roots[count] of a graph of the model's. */
uint32_t dm_lanes_build(dm_kernel *out, const dm_model *m, dm_graph *g, const dm_node *roots,
                        uint32_t count, uint32_t stages);

/* And of a graph that dm_compact_graph made, to which some nodes may have been added. */
uint32_t dm_lanes_build_compacted(dm_kernel *out, const dm_model *m, dm_graph *g,
                                  const dm_node *roots, uint32_t count, uint32_t stages);

#endif
