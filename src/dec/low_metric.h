/* low_metric.h - volumes and shares of triangles and tetrahedra, of which meshes have most, by
 * formulas of their own; the numbers are those of metric.h. */
#ifndef DM_LOW_METRIC_H
#define DM_LOW_METRIC_H

#include "dec/gram.h"
#include "dec/metric.h"

/* Area and volume of a cell of degree 2 and 3 by the lengths of its edges. 0: it is flat, cannot
 * be, or its numbers are too large or too small for this road. */
double dm_metric_area(const dm_metric *metric, const dm_complex *K, uint32_t cell);
double dm_metric_solid(const dm_metric *metric, const dm_complex *K, uint32_t cell);

/* Shares of a triangle, in the order of what is opposite to its vertices: edge[3] and vertex[3] of
 * squares of lengths l[3] and lengths[3]. */
void dm_share_triangle(double *edge, double *vertex, const double *l, const double *length,
                       double area, dm_centres centres);

/* Shares of a tetrahedron: of face i (opposite to vertex i), edge a < b, vertex i. */
typedef struct {
    double face[4], edge[4][4], vertex[4];
} dm_tetrahedron_shares;

/* l: squares of lengths; length[a][b] for a < b; area[i] of face i; centre: its barycentric
 * coordinates. */
void dm_share_tetrahedron(dm_tetrahedron_shares *out, const dm_squares *l, double length[4][4],
                          const double *area, double volume, const double *centre,
                          dm_centres centres);

/* Duals of a whole mesh of triangles, or of tetrahedra, whose volumes are there: added to what
 * stands in out->dual. */
void dm_share_triangles(dm_metric *out, const dm_complex *K);
void dm_share_tetrahedra(dm_metric *out, const dm_complex *K);

#endif
