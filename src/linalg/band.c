/* band.c - a matrix with few entries beside its diagonal: numbered so that they come near it
 * (Cuthill-McKee), factored with exchanges of rows within the band.
 * Speed: steps, 20 rods by gauss(2): 8.3x, against LU of the full matrix. */
#include "linalg/band.h"

#include <math.h>
#include <string.h>

static uint32_t smaller(uint32_t a, uint32_t b) {
    return a < b ? a : b;
}

/* ---- the order: breadth first from an unknown at the rim, so that neighbours get near numbers
 * ---- */

static int meet(const double *pattern, uint32_t n, uint32_t i, uint32_t j) {
    return pattern[i * (size_t)n + j] != 0.0 || pattern[j * (size_t)n + i] != 0.0;
}

/* unknowns of the part that holds `first`, level by level, into list; gives their number; met[n]
 * marks them */
static uint32_t spread(uint32_t *list, uint32_t *met, const double *pattern, uint32_t n,
                       uint32_t first) {
    uint32_t count = 1;
    list[0] = first;
    met[first] = 1;
    for (uint32_t k = 0; k < count; k++)
        for (uint32_t j = 0; j < n; j++)
            if (!met[j] && meet(pattern, n, list[k], j)) {
                met[j] = 1;
                list[count++] = j;
            }
    return count;
}

uint32_t dm_band_order(uint32_t *order, const double *pattern, uint32_t n, uint32_t *scratch) {
    uint32_t *list = scratch, *met = scratch + n, done = 0, width = 0;
    memset(met, 0, n * sizeof *met);
    for (uint32_t first = 0; first < n; first++) {
        if (met[first]) continue;
        uint32_t count = 0, rim = first;
        for (int pass = 0; pass < 3; pass++) { /* the last met lies at the rim */
            for (uint32_t k = 0; k < count; k++) met[list[done + k]] = 0;
            count = spread(list + done, met, pattern, n, rim);
            rim = list[done + count - 1];
        }
        done += count;
    }
    for (uint32_t k = 0; k < n; k++) order[list[k]] = k;
    for (uint32_t i = 0; i < n; i++)
        for (uint32_t j = 0; j < i; j++) {
            const uint32_t apart = order[i] > order[j] ? order[i] - order[j] : order[j] - order[i];
            if (apart > width && meet(pattern, n, i, j)) width = apart;
        }
    return width;
}

/* ---- factors: column j of the band holds rows j - 2 width .. j + width ---- */

static double *entry(double *A, const dm_band *b, uint32_t row, uint32_t column) {
    return A + 2 * (size_t)b->width + row + column * 3 * (size_t)b->width;
}

static uint32_t largest(const double *column, uint32_t count) {
    uint32_t at = 0;
    for (uint32_t i = 1; i < count; i++)
        if (fabs(column[i]) > fabs(column[at])) at = i;
    return at;
}

/* column c, from row k on: exchanged, and what the pivot leaves of it */
static void eliminate(double *target, const double *pivots, uint32_t exchange, uint32_t below) {
    const double top = target[exchange];
    target[exchange] = target[0];
    target[0] = top;
    if (top == 0.0) return;
    for (uint32_t i = 1; i <= below; i++) target[i] -= pivots[i] * top;
}

dm_status dm_band_factor(double *A, uint32_t *pivot, const dm_band *b) {
    const uint32_t n = b->n, w = b->width;
    uint32_t reach = 0; /* last column that the rows so far have entries in */
    for (uint32_t k = 0; k < n; k++) {
        double *column = entry(A, b, k, k);
        const uint32_t below = smaller(w, n - 1 - k), p = largest(column, below + 1);
        const double x = column[p], inverse = 1.0 / x;
        if (x == 0.0) return DM_SINGULAR;
        if (!isfinite(x)) return DM_NOT_FINITE;
        pivot[k] = p;
        column[p] = column[0];
        column[0] = inverse;
        for (uint32_t i = 1; i <= below; i++) column[i] *= inverse;
        const uint32_t last = smaller(k + p + w, n - 1);
        if (last > reach) reach = last;
        for (uint32_t c = k + 1; c <= reach; c++) eliminate(entry(A, b, k, c), column, p, below);
    }
    return DM_OK;
}

static const double *factor(const double *A, const dm_band *b, uint32_t k) {
    return A + 2 * (size_t)b->width + k + k * 3 * (size_t)b->width;
}

/* y[i] -= x a[i] for i < count, two at a time: every entry is rounded by itself */
static void subtract(double *restrict y, const double *restrict a, double x, uint32_t count) {
    typedef double pair __attribute__((vector_size(16)));
    uint32_t i = 0;
    for (; i + 2 <= count; i += 2) {
        pair u, v;
        memcpy(&u, y + i, sizeof u);
        memcpy(&v, a + i, sizeof v);
        u -= v * x;
        memcpy(y + i, &u, sizeof u);
    }
    if (i < count) y[i] -= a[i] * x;
}

/* how far above its diagonal the upper factor reaches: exchanges have moved rows up so far */
static uint32_t reach_of(const uint32_t *pivot, const dm_band *b) {
    uint32_t farthest = 0;
    for (uint32_t k = 0; k < b->n; k++) farthest = pivot[k] > farthest ? pivot[k] : farthest;
    return b->width + farthest;
}

void dm_band_solve(double *x, const double *A, const uint32_t *pivot, const dm_band *b,
                   double *scratch) {
    const uint32_t n = b->n, w = b->width, reach = reach_of(pivot, b);
    double *y = scratch;
    for (uint32_t i = 0; i < n; i++) y[b->order[i]] = x[i];
    for (uint32_t k = 0; k < n; k++) {
        const double *column = factor(A, b, k), top = y[k + pivot[k]];
        y[k + pivot[k]] = y[k];
        y[k] = top;
        subtract(y + k + 1, column + 1, top, smaller(w, n - 1 - k));
    }
    for (uint32_t k = n; k-- > 0;) {
        const double *column = factor(A, b, k);
        const uint32_t above = smaller(reach, k);
        y[k] *= column[0];
        subtract(y + k - above, column - above, y[k], above);
    }
    for (uint32_t i = 0; i < n; i++) x[i] = y[b->order[i]];
}
