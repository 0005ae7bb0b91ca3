#include "linalg/inverse.h"

#include <math.h>
#include <stddef.h>

static inline __attribute__((always_inline)) uint32_t largest_in(const double *A, uint32_t n,
                                                                 uint32_t k) {
    uint32_t best = k;
    double most = fabs(A[k * (size_t)n + k]);
    for (uint32_t i = k + 1; i < n; i++) {
        const double size = fabs(A[i * (size_t)n + k]);
        if (!(size <= most)) best = i, most = size;
    }
    return best;
}

static inline __attribute__((always_inline)) void exchange(double *a, double *b, uint32_t n,
                                                           size_t stride) {
#pragma GCC unroll 4
    for (uint32_t j = 0; j < n; j++) {
        const double kept = a[j * stride];
        a[j * stride] = b[j * stride];
        b[j * stride] = kept;
    }
}

/* row k is that of the pivot, which becomes 1 in the row and 0 in all others */
static inline __attribute__((always_inline)) void eliminate(double *A, uint32_t n, uint32_t k) {
    double *row = A + k * (size_t)n;
    const double reciprocal = 1.0 / row[k];
    row[k] = 1.0;
#pragma GCC unroll 4
    for (uint32_t j = 0; j < n; j++) row[j] *= reciprocal;
    for (uint32_t i = 0; i < n; i++) {
        double *other = A + i * (size_t)n;
        const double factor = other[k];
        if (i == k || factor == 0.0) continue;
        other[k] = 0.0;
#pragma GCC unroll 4
        for (uint32_t j = 0; j < n; j++) other[j] -= factor * row[j];
    }
}

/* one number, as frames of groups of dimension one need at every evaluation: the same bits as by
 * the loops */
static dm_status invert_one(double *a, uint32_t *pivot) {
    if (*a == 0.0) return DM_SINGULAR;
    if (!isfinite(*a)) return DM_NOT_FINITE;
    *pivot = 0;
    *a = 1.0 / *a;
    return DM_OK;
}

static inline __attribute__((always_inline)) dm_status invert(double *A, uint32_t *pivot,
                                                              uint32_t n) {
    for (uint32_t k = 0; k < n; k++) {
        pivot[k] = largest_in(A, n, k);
        if (pivot[k] != k) exchange(A + k * (size_t)n, A + pivot[k] * (size_t)n, n, 1);
        const double size = fabs(A[k * (size_t)n + k]);
        if (size == 0.0) return DM_SINGULAR;
        if (!isfinite(size)) return DM_NOT_FINITE;
        eliminate(A, n, k);
    }
    for (uint32_t k = n; k-- > 0;)
        if (pivot[k] != k) exchange(A + k, A + pivot[k], n, n);
    return DM_OK;
}

/* Loops of a length that the compiler knows, for the small ones. */
dm_status dm_invert(double *A, uint32_t *pivot, uint32_t n) {
    switch (n) {
    case 1:
        return invert_one(A, pivot);
    case 2:
        return invert(A, pivot, 2);
    case 3:
        return invert(A, pivot, 3);
    case 4:
        return invert(A, pivot, 4);
    default:
        return invert(A, pivot, n);
    }
}
