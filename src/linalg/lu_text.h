/* lu_text.h - LU of lu.h for W matrices side by side, A[row][column][lane]; a text for files that
 * have numbers/lanes_text.h, which of one lane is lu.c. Every lane has the pivots and the bits
 * that it has alone. pivot[k] is the row that every lane exchanges with row k. */
#ifndef DM_LU_TEXT_H
#define DM_LU_TEXT_H

#include "numbers/lanes_text.h"

enum { LU_IN_REGISTERS = 4 }; /* unknowns at most; their loops are written out */

/* rows a[n] and b[n] change places where `yes`; some lane says yes */
INLINE void exchange_where(I yes, double *a, double *b, uint32_t n) {
#pragma GCC unroll 4
    for (uint32_t j = 0; j < n; j++) {
        const V x = load(a + j * W), y = load(b + j * W);
        store(a + j * W, pick_some(yes, y, x));
        store(b + j * W, pick_some(yes, x, y));
    }
}

/* row k of rows[n][length] and the row of every lane's pivot */
INLINE void exchange_rows(double *rows, I pivot, uint32_t k, uint32_t n, size_t length) {
    if (!some(WHERE(pivot != same_number(k)))) return;
#if W == 1
    (void)n;
    exchange_where(1, rows + k * length, rows + (uint32_t)pivot * length, (uint32_t)length);
#else
    for (uint32_t i = k + 1; i < n; i++) {
        const I yes = WHERE(pivot == same_number(i));
        if (some(yes))
            exchange_where(yes, rows + k * length * W, rows + i * length * W, (uint32_t)length);
    }
#endif
}

/* row of the largest entry of column k at or below the diagonal */
INLINE I find_pivot(const double *A, uint32_t k, uint32_t n) {
    V largest = magnitude(load(A + (k * (size_t)n + k) * W));
    I best = same_number(k);
#pragma GCC unroll 4
    for (uint32_t i = k + 1; i < n; i++) {
        const V size = magnitude(load(A + (i * (size_t)n + k) * W));
        const I yes = WHERE(size > largest);
        largest = pick(yes, size, largest);
        best = pick_number(yes, same_number(i), best);
    }
    return best;
}

/* rows below k minus their multiple of row k; the multiples stay in column k */
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

/* the lanes whose matrix is regular and finite; *numbers: all pivots so far are finite. Where no
 * lane is left the rest is not done. */
INLINE I factor_matrix(double *A, I *pivot, uint32_t n, I *numbers) {
    I fine = all_lanes();
    *numbers = fine;
#pragma GCC unroll 4
    for (uint32_t k = 0; k < n; k++) {
        double *diagonal = A + (k * (size_t)n + k) * W;
        pivot[k] = find_pivot(A, k, n);
        exchange_rows(A, pivot[k], k, n, n);
        const V p = load(diagonal);
        *numbers &= is_finite(p);
        fine &= *numbers & WHERE(magnitude(p) >= same(DBL_MIN));
        if (!some(fine)) return fine;
        store(diagonal, same(1.0) / p);
        eliminate_below(A, k, n);
    }
    return fine;
}

/* x = U^-1 L^-1 x; `at` may be x, and stays in registers where it is not */
INLINE void substitute(double *at, double *x, const double *LU, uint32_t n) {
#pragma GCC unroll 4
    for (uint32_t i = 0; i < n; i++) {
        const double *row = LU + i * (size_t)n * W;
        V sum = load(x + i * W);
#pragma GCC unroll 4
        for (uint32_t j = 0; j < i; j++) sum -= load(row + j * W) * load(at + j * W);
        store(at + i * W, sum);
    }
#pragma GCC unroll 4
    for (uint32_t i = n; i-- > 0;) {
        const double *row = LU + i * (size_t)n * W;
        V sum = load(at + i * W);
#pragma GCC unroll 4
        for (uint32_t j = i + 1; j < n; j++) sum -= load(row + j * W) * load(at + j * W);
        sum *= load(row + i * W);
        store(at + i * W, sum);
        store(x + i * W, sum);
    }
}

/* x[n] = A^-1 x from the factors */
INLINE void solve_factored(double *x, const double *LU, const I *pivot, uint32_t n) {
    V at[LU_IN_REGISTERS];
#pragma GCC unroll 4
    for (uint32_t k = 0; k < n; k++) exchange_rows(x, pivot[k], k, n, 1);
    substitute(n <= LU_IN_REGISTERS ? (double *)at : x, x, LU, n);
}

#endif
