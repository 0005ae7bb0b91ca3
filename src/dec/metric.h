/* metric.h - volumes and signed dual volumes of a complex, from squared edge lengths alone (Leok
 * 3.3, 3.4). Points only serve to make the lengths, so a mesh of points and one of lengths have
 * the same numbers, and n-dimensional meshes may lie in any space or in none. Areas of slender
 * triangles, of which lengths know few digits, are the exception.
 *
 * Dual volumes follow flags of centres: for a face F of G = F + w the centre of G lies
 * lambda_w(G) height_w above F, height_w = (k + 1) |G| / |F| for F of degree k, and
 *   |*F in S| = sum over w of lambda_w height_w |*(F + w) in S| / (n - k),   |*S| = 1
 * inside each top cell S. With circumcentres lambda may be negative and so may a dual volume; the
 * supports |F| |*F| / C(n, k) still add up to |K| for every k. */
#ifndef DM_METRIC_H
#define DM_METRIC_H

#include "dec/complex.h"

typedef enum { DM_CIRCUMCENTRES, DM_BARYCENTRES } dm_centres;

typedef struct {
    double *length2;                  /* [count[1]]: squares of lengths */
    double *volume[DM_DIMENSION + 1]; /* [count[k]]; of vertices 1 */
    double *dual[DM_DIMENSION + 1];   /* [count[k]]: of the dual cell, of degree n - k, signed */
    dm_centres centres;
} dm_metric;

/* One cell: its faces, volumes, shares of dual volumes, and its centre. A face is a set of the
 * n + 1 vertices of the cell, bit j for vertex j. */
enum { DM_FACES = 1 << (DM_DIMENSION + 1) };
typedef struct {
    uint32_t n;
    uint32_t face[DM_FACES]; /* number of the face, among the cells of its degree */
    double length2[DM_DIMENSION + 1][DM_DIMENSION + 1];
    double volume[DM_FACES];
    double share[DM_FACES];          /* |*face in the cell| */
    double centre[DM_DIMENSION + 1]; /* barycentric coordinates of the centre of the cell */
} dm_cell_metric;

/* where the vertices are: at[count[0]][N] */
typedef struct {
    const double *at;
    uint32_t N;
} dm_points;

/* length2[count[1]] of points. */
void dm_metric_lengths(double *length2, const dm_complex *K, const dm_points *points);

/* All volumes and duals; points: NULL, there are lengths alone. DM_SINGULAR: a cell whose volume is
 * imaginary, or so small beside its longest edge that lengths in doubles cannot tell it from flat;
 * *degree and *cell say which. Cells of other than top degree that lie in no top cell have a dual
 * volume of 0. */
dm_status dm_metric_build(dm_metric *out, dm_arena *arena, const dm_complex *K,
                          const double *length2, const dm_points *points, dm_centres centres,
                          uint32_t *degree, uint32_t *cell);

/* One cell of degree k by itself: shares are of its own centre, |*face in the cell|. */
void dm_metric_simplex(dm_cell_metric *out, const dm_complex *K, const dm_metric *metric,
                       uint32_t k, uint32_t cell);

/* One top cell, for what needs shares (flat, sharp, divergence, contraction). */
void dm_metric_cell(dm_cell_metric *out, const dm_complex *K, const dm_metric *metric,
                    uint32_t top);

/* Barycentric coordinates lambda[n + 1] of the centre of the face `set` of a cell: those of the
 * vertices in the set, the others 0. */
void dm_metric_centre(double *lambda, const dm_cell_metric *c, uint32_t set, dm_centres centres);

#endif
