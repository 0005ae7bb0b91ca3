/* deficit.h - curvature of a simplicial manifold as angles: at a cell of codimension 2 the top
 * cells have angles, and what their sum lacks of 2 pi is the curvature there (Regge). On a surface
 * that of the vertices sums to 2 pi chi (Gauss-Bonnet). */
#ifndef DM_DEFICIT_H
#define DM_DEFICIT_H

#include "dec/metric.h"

/* A sum of angles between 0 and pi as a direction in the upper half plane and the half turns left
 * out, so that a sum costs products and one arc tangent. */
typedef struct {
    double re, im;
    uint32_t half, cells; /* cells: how many angles were added */
} dm_turn;

/* deficit[count[n - 2]], 2 pi - sum of the angles of the top cells at every cell, at the boundary
 * too. work[count[n - 2]]. n >= 2; K has a metric. */
void dm_deficits(double *deficit, dm_turn *work, const dm_complex *K, const dm_metric *metric);

#endif
