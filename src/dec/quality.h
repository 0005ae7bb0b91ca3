/* quality.h - what a mesh is worth for what divides by dual volumes, and intrinsic flips that mend
 * the stars of a surface. */
#ifndef DM_QUALITY_H
#define DM_QUALITY_H

#include "dec/metric.h"

typedef struct {
    uint32_t negative[DM_DIMENSION + 1]; /* dual volumes below 0 of cells of degree k */
    uint32_t zero[DM_DIMENSION + 1];     /* modulus within 1e-12 of the largest */
    uint32_t crossed; /* facets between two top cells with negative dual: 0 is locally Delaunay */
    double least;     /* least barycentric coordinate of a circumcentre of any cell */
} dm_quality;

/* DM_OK, or DM_STOPPED when *stop was set (stop may be NULL). */
dm_status dm_quality_measure(dm_quality *out, const dm_complex *K, const dm_metric *metric,
                             volatile const int *stop);

/* Triangles that are to be flipped: everything in one list, changed in place. Edge i of a triangle
 * is opposite to its vertex i. */
typedef struct {
    uint32_t triangles;
    uint32_t (*vertex)[3];
    double (*length2)[3];  /* of edges */
    uint32_t (*beside)[3]; /* triangle behind an edge, UINT32_MAX at the boundary */
    uint32_t flips;        /* so many were made */
} dm_triangles;

/* From a complex of dimension 2, an edge of which has at most two triangles, and an orientation;
 * the arrays, [count[2]], are the caller's. Triangles run in the coherent orientation. */
void dm_triangles_read(dm_triangles *out, const dm_complex *K, const double *length2);

/* Flip edges with a negative dual, |*e| < 0, between two triangles until there are none: what
 * results is the intrinsic Delaunay triangulation, which needs no points (Bobenko & Springborn
 * 2007). stack: 3 entries a triangle. DM_SINGULAR where the result is no simplicial complex: edge
 * ends[2] would be there twice, or be a loop; DM_STOPPED. */
dm_status dm_triangles_flip(dm_triangles *t, uint32_t *stack, volatile const int *stop,
                            uint32_t *ends);

#endif
