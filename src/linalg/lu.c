#include "linalg/lu.h"

#include <float.h>
#include <math.h>
#include <stddef.h>

/* row of the largest entry of column k at or below the diagonal */
static uint32_t pivot_row(const double *A, uint32_t k, uint32_t n) {
    uint32_t best = k;
    for (uint32_t i = k + 1; i < n; i++)
        if (fabs(A[i * (size_t)n + k]) > fabs(A[best * (size_t)n + k])) best = i;
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
static void eliminate(double *restrict A, uint32_t k, uint32_t n) {
    const double *row = A + k * (size_t)n;
    for (uint32_t i = k + 1; i < n; i++) {
        double *below = A + i * (size_t)n;
        const double factor = below[k] * row[k];
        below[k] = factor;
        for (uint32_t j = k + 1; j < n; j++) below[j] -= factor * row[j];
    }
}

dm_status dm_lu_factor(double *A, uint32_t *pivot, uint32_t n) {
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

void dm_lu_solve(double *x, const double *LU, const uint32_t *pivot, uint32_t n) {
    for (uint32_t k = 0; k < n; k++) {
        const double t = x[pivot[k]];
        x[pivot[k]] = x[k];
        x[k] = t;
    }
    for (uint32_t i = 1; i < n; i++) {
        const double *row = LU + i * (size_t)n;
        double sum = x[i];
        for (uint32_t j = 0; j < i; j++) sum -= row[j] * x[j];
        x[i] = sum;
    }
    for (uint32_t i = n; i-- > 0;) {
        const double *row = LU + i * (size_t)n;
        double sum = x[i];
        for (uint32_t j = i + 1; j < n; j++) sum -= row[j] * x[j];
        x[i] = sum * row[i];
    }
}

/* largest entry of A in column j */
static double column_size(const double *A, uint32_t j, uint32_t n) {
    double size = 0.0;
    for (uint32_t i = 0; i < n; i++) size = fmax(size, fabs(A[i * (size_t)n + j]));
    return size;
}

dm_status dm_lu_inverse(double *inverse, double *A, uint32_t *pivot, double *column,
                        uint32_t n) {
    for (uint32_t j = 0; j < n; j++) column[j] = column_size(A, j, n);
    const dm_status status = dm_lu_factor(A, pivot, n);
    if (status != DM_OK) return status;
    for (uint32_t k = 0; k < n; k++) /* U's diagonal against the columns as they were */
        if (fabs(A[k * (size_t)n + k]) * column[k] > 1.0 / (DBL_EPSILON * n))
            return DM_SINGULAR;
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
