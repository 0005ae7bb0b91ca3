/* rotation.h - the discrete Levi-Civita connection of a simplicial manifold (Leok 4.7.3): an
 * orthonormal frame in every top cell, and for every two that share a facet the rotation that takes
 * vectors from one frame to the other. The cell's own frame is Cholesky's, from lengths alone: the
 * edges from the first vertex have a lower triangular matrix in it, and the last axis is turned
 * over where the coherent orientation is negative. */
#ifndef DM_ROTATION_H
#define DM_ROTATION_H

#include "dec/metric.h"

typedef enum {
    DM_BY_FACE,  /* R takes the edges of the facet to themselves, the outward normal to the inward
                  * one: what unfolding the two cells does */
    DM_BY_NORMAL /* as printed: the least rotation that takes the normals to each other, and none
                  * where they are opposite; right where frames come of one chart [E10] */
} dm_transport_rule;

typedef struct {
    const dm_complex *K;
    const dm_metric *metric;
    const double *turn; /* [count[n]][n][n]: columns are the axes of the frame in the own frame of
                         * the cell; NULL: own frames */
    dm_transport_rule rule;
} dm_levi_civita;

/* place[n + 1][n]: the vertices of a top cell in its frame, the first at 0. */
void dm_levi_civita_frame(double *place, const dm_levi_civita *c, uint32_t top);

/* R[n][n] from the frame of top cell `from` to that of `to`; orthogonal, with determinant 1 where K
 * is oriented. DM_SINGULAR: they share no facet. */
dm_status dm_levi_civita_rotation(double *R, const dm_levi_civita *c, uint32_t from, uint32_t to);

#endif
