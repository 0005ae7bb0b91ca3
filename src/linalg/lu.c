#include "linalg/lu.h"

#include "base/written_out.h"

#include <float.h>
#include <math.h>
#include <stddef.h>

/* row of the largest entry of column k at or below the diagonal */
DM_WRITTEN_OUT uint32_t pivot_row(const double *A, uint32_t k, uint32_t n) {
    uint32_t best = k;
    double largest = fabs(A[k * (size_t)n + k]);
#pragma GCC unroll 4
    for (uint32_t i = k + 1; i < n; i++) {
        const double size = fabs(A[i * (size_t)n + k]);
        if (size > largest) best = i, largest = size;
    }
    return best;
}

static void exchange(double *a, double *b, uint32_t n) {
    for (uint32_t j = 0; j < n; j++) {
        const double t = a[j];
        a[j] = b[j];
        b[j] = t;
    }
}

/* rows below k minus their multiple of row k; the multiples stay in column k */
DM_WRITTEN_OUT void eliminate(double *restrict A, uint32_t k, uint32_t n) {
    const double *row = A + k * (size_t)n;
#pragma GCC unroll 4
    for (uint32_t i = k + 1; i < n; i++) {
        double *below = A + i * (size_t)n;
        const double factor = below[k] * row[k];
        below[k] = factor;
#pragma GCC unroll 4
        for (uint32_t j = k + 1; j < n; j++) below[j] -= factor * row[j];
    }
}

/* sizes of short steps are written out */
DM_WRITTEN_OUT dm_status factor(double *A, uint32_t *pivot, uint32_t n) {
#pragma GCC unroll 4
    for (uint32_t k = 0; k < n; k++) {
        const uint32_t p = pivot_row(A, k, n);
        double *row = A + k * (size_t)n;
        pivot[k] = p;
        if (p != k) exchange(row, A + p * (size_t)n, n);
        if (!isfinite(row[k])) return DM_NOT_FINITE;
        if (fabs(row[k]) < DBL_MIN) return DM_SINGULAR;
        row[k] = 1.0 / row[k];
        eliminate(A, k, n);
    }
    return DM_OK;
}

dm_status dm_lu_factor(double *A, uint32_t *pivot, uint32_t n) {
    switch (n) {
    case 1:
        return factor(A, pivot, 1);
    case 2:
        return factor(A, pivot, 2);
    case 3:
        return factor(A, pivot, 3);
    case 4:
        return factor(A, pivot, 4);
    default:
        return factor(A, pivot, n);
    }
}

/* x[n] in the order of the rows of the factors */
DM_WRITTEN_OUT void permute(double *x, const uint32_t *pivot, uint32_t n) {
#pragma GCC unroll 4
    for (uint32_t k = 0; k < n; k++)
        if (pivot[k] != k) {
            const double t = x[pivot[k]];
            x[pivot[k]] = x[k];
            x[k] = t;
        }
}

/* x = U^-1 L^-1 x; `at` may be x, and stays in registers where it is not */
DM_WRITTEN_OUT void substitute(double *at, double *x, const double *LU, uint32_t n) {
#pragma GCC unroll 4
    for (uint32_t i = 0; i < n; i++) {
        const double *row = LU + i * (size_t)n;
        double sum = x[i];
#pragma GCC unroll 4
        for (uint32_t j = 0; j < i; j++) sum -= row[j] * at[j];
        at[i] = sum;
    }
#pragma GCC unroll 4
    for (uint32_t i = n; i-- > 0;) {
        const double *row = LU + i * (size_t)n;
        double sum = at[i];
#pragma GCC unroll 4
        for (uint32_t j = i + 1; j < n; j++) sum -= row[j] * at[j];
        x[i] = at[i] = sum * row[i];
    }
}

DM_WRITTEN_OUT void solve(double *x, const double *LU, const uint32_t *pivot, uint32_t n) {
    double at[4];
    permute(x, pivot, n);
    substitute(n <= 4 ? at : x, x, LU, n);
}

void dm_lu_solve(double *x, const double *LU, const uint32_t *pivot, uint32_t n) {
    switch (n) {
    case 1:
        solve(x, LU, pivot, 1);
        break;
    case 2:
        solve(x, LU, pivot, 2);
        break;
    case 3:
        solve(x, LU, pivot, 3);
        break;
    case 4:
        solve(x, LU, pivot, 4);
        break;
    default:
        solve(x, LU, pivot, n);
    }
}

/* largest entry of A in column j */
static double column_size(const double *A, uint32_t j, uint32_t n) {
    double size = 0.0;
    for (uint32_t i = 0; i < n; i++) size = fmax(size, fabs(A[i * (size_t)n + j]));
    return size;
}

dm_status dm_lu_inverse(double *inverse, double *A, uint32_t *pivot, double *column, uint32_t n) {
    for (uint32_t j = 0; j < n; j++) column[j] = column_size(A, j, n);
    const dm_status status = dm_lu_factor(A, pivot, n);
    if (status != DM_OK) return status;
    for (uint32_t k = 0; k < n; k++) /* U's diagonal against the columns as they were */
        if (fabs(A[k * (size_t)n + k]) * column[k] > 1.0 / (DBL_EPSILON * n)) return DM_SINGULAR;
    for (uint32_t j = 0; j < n; j++) {
        for (uint32_t i = 0; i < n; i++) column[i] = i == j;
        dm_lu_solve(column, A, pivot, n);
        for (uint32_t i = 0; i < n; i++) {
            if (!isfinite(column[i])) return DM_SINGULAR;
            inverse[i * (size_t)n + j] = column[i];
        }
    }
    return DM_OK;
}
