/* transfer.h - forms from one mesh to another one of the same set, |K| = |M| (Leok 3.14), as
 * sparse matrices with a row for every k-cell of M and a column for every one of K.
 *
 * Whitney: the integral of the Whitney form over the cell, piece by piece of the top cells of K.
 * The form is affine and its tangential part continuous, so each piece counts by its volume and
 * centre; a cell that lies in a face common to several top cells counts in each of them by the
 * part of one. It is exact on constant forms, commutes with d, and is the identity for K = M.
 * Sum: for cells of M that are unions of cells of K, the sum of these with their signs.
 * Thesis: sum of sgn |V_t and V_s| / |V_s| over supports, sgn the sign of the product of the
 * directions. As printed; right for k = n alone. */
#ifndef DM_TRANSFER_H
#define DM_TRANSFER_H

#include "dec/metric.h"
#include "linalg/sparse/sparse.h"

typedef enum { DM_TRANSFER_WHITNEY, DM_TRANSFER_SUM, DM_TRANSFER_THESIS } dm_transfer_rule;

/* A mesh with its points[count[0]][N]. */
typedef struct {
    const dm_complex *K;
    const dm_metric *metric;
    const double *points;
    uint32_t N;
} dm_realization;

/* The first cell of degree k of M of which not all is covered by K, or more than once, and how much
 * of it is: a share of its volume. */
typedef struct {
    uint32_t cell;
    double covered;
} dm_transfer_report;

/* Both of one dimension and one N; `work` is not needed afterwards. DM_SINGULAR: the meshes do not
 * cover the same set (sum: K is not nested in M), see *report; DM_NO_MEMORY, DM_TOO_LARGE,
 * DM_STOPPED. */
dm_status dm_transfer(dm_sparse *out, dm_arena *arena, dm_arena *work, const dm_realization *from,
                      const dm_realization *to, uint32_t k, dm_transfer_rule rule,
                      volatile const int *stop, dm_transfer_report *report);

#endif
