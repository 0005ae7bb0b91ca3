/* lu_lanes_text.h - lu.h for W matrices side by side, A[row][column][lane]: every lane has the
 * pivots and the bits that dm_lu_factor gives it alone. A text for files that have
 * numbers/lanes_text.h. */
#ifndef DM_LU_LANES_TEXT_H
#define DM_LU_LANES_TEXT_H

#include "numbers/lanes_text.h"

#include <float.h>

/* rows of A[n] that lanes exchange at column k: one row of a pair is k */
typedef struct {
    I row;        /* the other one */
    uint32_t any; /* 0: no lane exchanges */
} lanes_pivot;

INLINE void exchange_where(I yes, double *a, double *b, uint32_t n) {
#pragma GCC unroll 4
    for (uint32_t j = 0; j < n; j++) {
        const V x = load(a + j * W), y = load(b + j * W);
        store(a + j * W, pick(yes, y, x));
        store(b + j * W, pick(yes, x, y));
    }
}

/* row of the largest entry of column k at or below the diagonal */
INLINE void find_pivot(lanes_pivot *pivot, const double *A, uint32_t k, uint32_t n) {
    V largest = magnitude(load(A + (k * (size_t)n + k) * W));
    I best = (I){0} + (long long)k;
#pragma GCC unroll 4
    for (uint32_t i = k + 1; i < n; i++) {
        const V size = magnitude(load(A + (i * (size_t)n + k) * W));
        const I yes = (I)(size > largest);
        largest = pick(yes, size, largest);
        best = (yes & ((I){0} + (long long)i)) | (~yes & best);
    }
    pivot->row = best;
    pivot->any = bits_of((I)(best != (long long)k));
}

INLINE void eliminate_below(double *A, uint32_t k, uint32_t n) {
    const double *row = A + k * (size_t)n * W;
#pragma GCC unroll 4
    for (uint32_t i = k + 1; i < n; i++) {
        double *below = A + i * (size_t)n * W;
        const V factor = load(below + k * W) * load(row + k * W);
        store(below + k * W, factor);
#pragma GCC unroll 4
        for (uint32_t j = k + 1; j < n; j++)
            store(below + j * W, load(below + j * W) - factor * load(row + j * W));
    }
}

/* the lanes whose matrix is regular and finite */
INLINE I factor_lanes(double *A, lanes_pivot *pivot, uint32_t n) {
    I fine = mask_of((1u << W) - 1);
#pragma GCC unroll 4
    for (uint32_t k = 0; k < n; k++) {
        double *row = A + k * (size_t)n * W;
        find_pivot(pivot + k, A, k, n);
        for (uint32_t i = k + 1; pivot[k].any && i < n; i++) {
            const I yes = (I)(pivot[k].row == (long long)i);
            if (bits_of(yes)) exchange_where(yes, row, A + i * (size_t)n * W, n);
        }
        const V p = load(row + k * W);
        fine &= is_finite(p) & (I)(magnitude(p) >= same(DBL_MIN));
        store(row + k * W, same(1.0) / p);
        eliminate_below(A, k, n);
    }
    return fine;
}

INLINE void solve_lanes(double *x, const double *LU, const lanes_pivot *pivot, uint32_t n) {
#pragma GCC unroll 4
    for (uint32_t k = 0; k < n; k++)
        for (uint32_t i = k + 1; pivot[k].any && i < n; i++)
            exchange_where((I)(pivot[k].row == (long long)i), x + k * W, x + i * W, 1);
#pragma GCC unroll 4
    for (uint32_t i = 1; i < n; i++) {
        const double *row = LU + i * (size_t)n * W;
        V sum = load(x + i * W);
#pragma GCC unroll 4
        for (uint32_t j = 0; j < i; j++) sum -= load(row + j * W) * load(x + j * W);
        store(x + i * W, sum);
    }
#pragma GCC unroll 4
    for (uint32_t i = n; i-- > 0;) {
        const double *row = LU + i * (size_t)n * W;
        V sum = load(x + i * W);
#pragma GCC unroll 4
        for (uint32_t j = i + 1; j < n; j++) sum -= load(row + j * W) * load(x + j * W);
        store(x + i * W, sum * load(row + i * W));
    }
}

/* factors and pivots of the lanes of `yes` from another matrix */
INLINE void take_factors(I yes, double *to, lanes_pivot *pivot, const double *from,
                         const lanes_pivot *other, uint32_t n) {
    for (size_t k = 0; k < (size_t)n * n; k++) put_where(yes, to + k * W, load(from + k * W));
    for (uint32_t k = 0; k < n; k++) {
        pivot[k].row = (yes & other[k].row) | (~yes & pivot[k].row);
        pivot[k].any |= other[k].any;
    }
}

#endif
