/* pivots_text.h - are all values of W symmetric matrices A[row][column][lane] positive by far? A
 * text for files that have numbers/lanes_text.h, which of one lane is dm_all_positive
 * (signature.c). Every lane has the pivots and the bits that it has alone. Up to four rows are
 * written out.
 * Speed: ensembles, double spherical pendulum midpoint: 1.03x, against loops. */
#ifndef DM_PIVOTS_TEXT_H
#define DM_PIVOTS_TEXT_H

#include "numbers/lanes_text.h"

enum { PIVOTS_WRITTEN_OUT = 4 }; /* rows at most */

/* x and y change places where `yes`; some lane says yes */
INLINE void swap_where(I yes, double *x, double *y) {
    const V a = load(x), b = load(y);
    store(x, pick_some(yes, b, a));
    store(y, pick_some(yes, a, b));
}

/* rows and columns a < b of the lower triangle A[n*n] do */
INLINE void swap_lines_where(I yes, double *A, size_t n, size_t a, size_t b) {
    swap_where(yes, A + (a * n + a) * W, A + (b * n + b) * W);
#pragma GCC unroll 4
    for (size_t i = a + 1; i < n; i++)
        if (i != b) swap_where(yes, A + (i * n + a) * W, A + (i < b ? b * n + i : i * n + b) * W);
}

/* the largest entry of what is left of the diagonal comes to its place k */
INLINE V bring_pivot(double *A, uint32_t n, uint32_t k) {
    V pivot = load(A + (k * n + k) * (size_t)W);
    I found = same_number(k);
#pragma GCC unroll 4
    for (uint32_t i = k + 1; i < n; i++) {
        const V d = load(A + (i * n + i) * (size_t)W);
        const I yes = WHERE(d > pivot);
        pivot = pick(yes, d, pivot);
        found = pick_number(yes, same_number(i), found);
    }
    if (!some(WHERE(found != same_number(k)))) return pivot;
#pragma GCC unroll 4
    for (uint32_t i = k + 1; i < n; i++) {
        const I yes = WHERE(found == same_number(i));
        if (some(yes)) swap_lines_where(yes, A, n, k, i);
    }
    return pivot;
}

/* A -= a a^T / pivot behind column k, in the lower triangle */
INLINE void eliminate_by_pivot(double *A, uint32_t n, uint32_t k, V pivot) {
    const V inverse = same(1.0) / pivot;
#pragma GCC unroll 4
    for (uint32_t i = k + 1; i < n; i++) {
        double *row = A + i * n * (size_t)W;
        const V factor = load(row + k * W) * inverse;
#pragma GCC unroll 4
        for (uint32_t j = k + 1; j <= i; j++)
            store(row + j * W, load(row + j * W) - factor * load(A + (j * n + k) * (size_t)W));
    }
}

/* What the diagonal of A[n*n] has in common, of more rows than are written out: the number nearest
 * to 1 of its sizes and all between them; 1 of zeros alone.
 * Speed: tests/bench/moving_masses.lua: 1.7x for n = 20, 7x for 60, M full, against the product. */
INLINE V common_of(const double *A, uint32_t n) {
    V least = same(INFINITY), most = same(0.0);
    for (uint32_t i = 0; i < n && n > PIVOTS_WRITTEN_OUT; i++) {
        const V size = magnitude(load(A + (i * n + i) * (size_t)W));
        least = pick(WHERE(size < least), size, least);
        most = larger_of(most, size);
    }
    const V below = pick(WHERE(most < same(1.0)), most, same(1.0));
    const V common = larger_of(least, below);
    return n > PIVOTS_WRITTEN_OUT ? pick(WHERE(common > same(0.0)), common, same(1.0)) : same(1.0);
}

/* The lanes of `fine` whose pivots are all above `far`; the least pivot, and what is told of all
 * values (signature.h). The lower triangle of A is overwritten, the pivots stay on the diagonal.
 * Where no lane is left the rest is not done. */
INLINE I find_pivots(double *A, uint32_t n, double far, I fine, V *least, V *all) {
    const V common = common_of(A, n), share = same(1.0) / common;
    *least = same(INFINITY), *all = common;
#pragma GCC unroll 4
    for (uint32_t k = 0; k < n; k++) {
        const V pivot = bring_pivot(A, n, k);
        *least = pick(WHERE(pivot < *least), pivot, *least);
        fine &= WHERE(pivot > same(far));
        if (!some(fine)) return fine;
        *all *= n > PIVOTS_WRITTEN_OUT ? pivot * share : pivot;
        eliminate_by_pivot(A, n, k, pivot);
    }
    return fine & WHERE(*least < same(INFINITY));
}

#endif
