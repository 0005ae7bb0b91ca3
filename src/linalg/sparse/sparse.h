/* sparse.h - sparse matrices in compressed columns: assembly, products, sums, transposes.
 *
 * Column j has the entries value[start[j] .. start[j + 1] - 1] in the rows row[...], ascending.
 * No entry is stored twice, and products and sums store none that is 0. A matrix lies in the
 * caller's arena and is not changed once it is made. Indices are int32_t, as the libraries of
 * src/sparse have them: up to 2^31 - 1 entries. */
#ifndef DM_SPARSE_H
#define DM_SPARSE_H

#include "base/arena.h"
#include "base/status.h"

#include <stdint.h>

typedef struct {
    int32_t rows, columns;
    int32_t *start; /* [columns + 1] */
    int32_t *row;   /* [start[columns]] */
    double *value;  /* [start[columns]] */
} dm_sparse;

/* Room for `entries` entries; start[0] = 0, the rest is the caller's. All functions that make a
 * matrix end with DM_OK, DM_NO_MEMORY or DM_TOO_LARGE (more entries than indices). */
dm_status dm_sparse_room(dm_sparse *A, dm_arena *arena, int32_t rows, int32_t columns,
                         int64_t entries);

/* The sum of entries[i] at (row[i], column[i]), i < count, in that order. */
dm_status dm_sparse_assemble(dm_sparse *A, dm_arena *arena, int32_t rows, int32_t columns,
                             int64_t count, const int32_t *row, const int32_t *column,
                             const double *entries);

/* y[rows] = A x[columns], and y[columns] = A^T x[rows], which also is A x of a symmetric A. */
void dm_sparse_apply(double *y, const dm_sparse *A, const double *x);
void dm_sparse_apply_transpose(double *y, const dm_sparse *A, const double *x);

/* A^T without entries that are 0; rows of A need not be ascending for it, those of T are. */
dm_status dm_sparse_transpose(dm_sparse *T, dm_arena *arena, const dm_sparse *A);

/* diag(left) A diag(right), left[rows], right[columns]; NULL stands for ones. */
dm_status dm_sparse_scaled(dm_sparse *out, dm_arena *arena, const dm_sparse *A, const double *left,
                           const double *right);

/* a A + b B of one shape. */
dm_status dm_sparse_sum(dm_sparse *out, dm_arena *arena, double a, const dm_sparse *A, double b,
                        const dm_sparse *B);

/* A B; A.columns = B.rows. DM_STOPPED when *stop was set (stop may be NULL). */
dm_status dm_sparse_product(dm_sparse *out, dm_arena *arena, const dm_sparse *A, const dm_sparse *B,
                            volatile const int *stop);

/* A^T diag(w) A, w[rows]: symmetric to the last bit where the entries of A are -1, 0, 1. */
dm_status dm_sparse_gram(dm_sparse *out, dm_arena *arena, const dm_sparse *A, const double *w,
                         volatile const int *stop);

/* The rows and columns that are kept, in their order: keep_row[rows] and keep_column[columns] are
 * not 0 there; NULL keeps all. */
dm_status dm_sparse_pick(dm_sparse *out, dm_arena *arena, const dm_sparse *A,
                         const unsigned char *keep_row, const unsigned char *keep_column);

/* {{diag(r), -D^T}, {-D, 0}}, r[D.columns]: the symmetric matrix of r x = D^T y, D x given. */
dm_status dm_sparse_saddle(dm_sparse *out, dm_arena *arena, const double *r, const dm_sparse *D);

/* diagonal[min(rows, columns)] */
void dm_sparse_diagonal(double *diagonal, const dm_sparse *A);

/* The largest |A - A^T| of a square matrix over its largest |entry|; T is dm_sparse_transpose. */
double dm_sparse_asymmetry(const dm_sparse *A, const dm_sparse *T);

/* Is every |r_i| <= part * sum_j |A_ij| size_j? terms[rows] is scratch. */
int dm_sparse_is_within(const dm_sparse *A, const double *r, const double *size, double part,
                        double *terms);

#endif
