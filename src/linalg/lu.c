#include "linalg/lu.h"

/* one matrix: a lane alone */
#define W 1
#define HOW
#define DM_LANES_FUSED 0
#include "linalg/lu_text.h"

/* why a matrix was not factored: the first pivot that is no number, or zero */
INLINE dm_status factor(double *A, uint32_t *pivot, uint32_t n) {
    I numbers;
    if (factor_matrix(A, (I *)pivot, n, &numbers)) return DM_OK;
    return numbers ? DM_SINGULAR : DM_NOT_FINITE;
}

/* sizes of short steps are written out */
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

INLINE void solve(double *x, const double *LU, const uint32_t *pivot, uint32_t n) {
    solve_factored(x, LU, (const I *)pivot, n);
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

/* P A = L U, so that U^T L^T P x is what was in x. */
void dm_lu_solve_transposed(double *x, const double *LU, const uint32_t *pivot, uint32_t n) {
    for (uint32_t i = 0; i < n; i++) {
        for (uint32_t j = 0; j < i; j++) x[i] -= LU[j * (size_t)n + i] * x[j];
        x[i] *= LU[i * (size_t)n + i];
    }
    for (uint32_t i = n; i-- > 0;) {
        for (uint32_t j = i + 1; j < n; j++) x[i] -= LU[j * (size_t)n + i] * x[j];
    }
    for (uint32_t k = n; k-- > 0;) {
        const double last = x[k];
        x[k] = x[pivot[k]];
        x[pivot[k]] = last;
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

/* largest entry of A in row i and column i */
static double cross_size(const double *A, uint32_t i, uint32_t n) {
    double size = 0.0;
    for (uint32_t j = 0; j < n; j++)
        size = fmax(size, fmax(fabs(A[i * (size_t)n + j]), fabs(A[j * (size_t)n + i])));
    return size;
}

int dm_equilibrate(double *A, double *unit, uint32_t n) {
    enum { PASSES = 6 }; /* each takes the square root of what units are apart */
    for (uint32_t i = 0; i < n; i++) unit[i] = 1.0;
    for (int pass = 0; pass < PASSES; pass++) {
        for (uint32_t i = 0; i < n; i++) {
            const double size = cross_size(A, i, n);
            if (!(size > 0.0 && isfinite(size))) return 0;
            int power;
            (void)frexp(size, &power);
            const double s = ldexp(1.0, -power / 2);
            for (uint32_t j = 0; j < n; j++) {
                A[i * (size_t)n + j] *= s;
                A[j * (size_t)n + i] *= s;
            }
            unit[i] *= s;
        }
    }
    return 1;
}
