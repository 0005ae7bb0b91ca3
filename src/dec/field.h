/* field.h - fields of vectors on a mesh with points, and what leads from them to forms and back
 * (Leok 3.7, Def 3.20-3.23). */
#ifndef DM_FIELD_H
#define DM_FIELD_H

#include "dec/cell.h"

/* A vector at every vertex (primal) or in every top cell (dual), with N components. */
typedef struct {
    int on_cells;
    uint32_t N;
    const double *points; /* [count[0]][N] */
    const double *values; /* [count[0] or count[n]][N] */
} dm_vector_field;

/* rates[n + 1] of the field in cell c: its vector, or the mean over the vertices in `set`. */
void dm_field_rates(double *rates, const dm_vector_field *X, const dm_cell *c, uint32_t set);

/* values[count[n]][N]: only what lies in the cells stays; returns the largest length that went. */
double dm_field_tangent(double *values, const dm_complex *K, const dm_metric *metric,
                        const double *points, uint32_t N);

/* out[count[1]], to primal 1-forms. On cells: sum over top cells of |*e in s| / |*e| X . e (Def
 * 3.22); of edges with zero dual volume the plain mean, and *degenerate counts them; tops:
 * count[1] entries of work. On vertices: (X_0 + X_1) . e / 2. */
void dm_flat_primal(double *out, const dm_complex *K, const dm_metric *metric,
                    const dm_vector_field *X, uint32_t *tops, uint32_t *degenerate);

/* out[count[n - 1]], to dual 1-forms: sum over the top cells of a facet of |*f in s| X . m, m the
 * unit vector along *f (in the plane: the facet turned by +90 degrees). Needs an orientation. */
void dm_flat_dual(double *out, const dm_complex *K, const dm_metric *metric,
                  const dm_vector_field *X);

/* What a sharp cannot divide by: DM_SINGULAR, with the cell of degree `degree`. */
typedef struct {
    uint32_t degree, cell;
} dm_sharp_fault;

/* out[count[0]][N] of a primal 1-form: sum over the top cells of v of |*v in s| / |*v| times the
 * sum of a[v, u] grad phi_u (Def 3.23 corrected: exact on d of linear functions). pinv: 0 where
 * |*v| is zero. */
dm_status dm_sharp_vertices(double *out, const dm_complex *K, const dm_metric *metric,
                            const double *points, uint32_t N, const double *a, int pinv,
                            dm_sharp_fault *fault);

/* Def 3.23 as printed: sum over edges [v, u] and their top cells of a[v, u] |*v in s| / |s| times
 * the unit normal of the edge into s. Not exact on constants, changes with the scale. */
void dm_sharp_thesis(double *out, const dm_complex *K, const dm_metric *metric,
                     const double *points, uint32_t N, const double *a);

/* out[count[n]][N] of a primal 1-form: its Whitney interpolant at the centre of each top cell. */
void dm_sharp_cells(double *out, const dm_complex *K, const dm_metric *metric, const double *points,
                    uint32_t N, const double *a);

/* out[count[n]][N] of a dual 1-form b[count[n - 1]]: least squares of X . m_f = b(f) / |*f| over
 * the facets of each top cell, with weights (|*f in s| / |*f|)^2. A facet of zero dual volume says
 * nothing; two of them in one cell are a fault, or give 0 with pinv. */
dm_status dm_sharp_dual(double *out, const dm_complex *K, const dm_metric *metric,
                        const double *points, uint32_t N, const double *b, int pinv,
                        dm_sharp_fault *fault);

/* out[count[0]]: div X = -delta of X's flat, 1 / |*v| times the flux out of the dual cell of v.
 * boundary: with the flux through the part of it that lies in the boundary of the mesh. */
dm_status dm_divergence(double *out, const dm_complex *K, const dm_metric *metric,
                        const dm_vector_field *X, int boundary, dm_sharp_fault *fault);

#endif
