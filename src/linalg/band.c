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

/* y[i] -= x a[i] for i < count, several at a time: every entry is rounded by itself */
static inline void subtract(double *restrict y, const double *restrict a, double x,
                            uint32_t count) {
    typedef double four __attribute__((vector_size(32)));
    uint32_t i = 0;
    for (; i + 4 <= count; i += 4) {
        four u, v;
        memcpy(&u, y + i, sizeof u);
        memcpy(&v, a + i, sizeof v);
        u -= v * x;
        memcpy(y + i, &u, sizeof u);
    }
    for (; i < count; i++) y[i] -= a[i] * x;
}

/* column c, from row k on: exchanged, and what the pivot leaves of it */
static void eliminate(double *target, const double *pivots, uint32_t exchange, uint32_t below) {
    const double top = target[exchange];
    target[exchange] = target[0];
    target[0] = top;
    if (top == 0.0) return;
    subtract(target + 1, pivots + 1, top, below);
}

dm_status dm_band_factor(double *A, uint32_t *pivot, const dm_band *b) {
    const uint32_t n = b->n, w = b->width;
    uint32_t reach = 0; /* last column that the rows so far have entries in */
    for (uint32_t k = 0; k < n; k++) {
        double *column = entry(A, b, k, k);
        if (b->stop && *b->stop) return DM_STOPPED;
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

enum { TOGETHER = 4 }; /* columns whose parts of a vector are taken off in one pass over it */

/* subtract of several columns, one after the other for every entry, which is rounded each time, and
 * two entries at a time: a pass for each would read what the one before has only just written. */
static void subtract_together(double *restrict y, const double *const *a, const double *x,
                              uint32_t count) {
    typedef double pair __attribute__((vector_size(16)));
    uint32_t i = 0;
    for (; i + 2 <= count; i += 2) {
        pair u, v;
        memcpy(&u, y + i, sizeof u);
#pragma GCC unroll 4
        for (int j = 0; j < TOGETHER; j++) {
            memcpy(&v, a[j] + i, sizeof v);
            u -= v * x[j];
        }
        memcpy(y + i, &u, sizeof u);
    }
    for (int j = 0; i < count && j < TOGETHER; j++) y[i] -= a[j][i] * x[j];
}

/* how far above its diagonal the upper factor reaches: exchanges have moved rows up so far */
static uint32_t reach_of(const uint32_t *pivot, const dm_band *b) {
    uint32_t farthest = 0;
    for (uint32_t k = 0; k < b->n; k++) farthest = pivot[k] > farthest ? pivot[k] : farthest;
    return b->width + farthest;
}

/* row k of y takes its place, and goes off rows k + 1 .. end - 1 by column k */
static void step_forward(double *y, const double *column, uint32_t k, uint32_t exchange,
                         uint32_t end) {
    const double top = y[k + exchange];
    y[k + exchange] = y[k];
    y[k] = top;
    if (end > k + 1) subtract(y + k + 1, column + 1, top, end - k - 1);
}

/* Four rows in a row by the columns of the same numbers, which exchange nothing: in registers,
 * since each waits for the one before. x[j] = row k + j, lower triangle of 1. */
static void lead_forward(double *y, const double *const *a, double *x) {
    double x1 = y[1], x2 = y[2], x3 = y[3];
    x[0] = y[0];
    x1 -= a[0][1] * x[0], x2 -= a[0][2] * x[0], x3 -= a[0][3] * x[0];
    x2 -= a[1][1] * x1, x3 -= a[1][2] * x1;
    x3 -= a[2][1] * x2;
    y[1] = x[1] = x1, y[2] = x[2] = x2, y[3] = x[3] = x3;
}

/* The same upwards from y[0], whose columns have their inverse pivots. */
static void lead_backward(double *y, const double *const *a, double *x) {
    double x1 = y[-1], x2 = y[-2], x3 = y[-3];
    x[0] = y[0] * a[0][0];
    x1 -= a[0][-1] * x[0], x2 -= a[0][-2] * x[0], x3 -= a[0][-3] * x[0];
    x1 *= a[1][0];
    x2 -= a[1][-1] * x1, x3 -= a[1][-2] * x1;
    x2 *= a[2][0];
    x3 -= a[2][-1] * x2;
    x3 *= a[3][0];
    y[0] = x[0], y[-1] = x[1] = x1, y[-2] = x[2] = x2, y[-3] = x[3] = x3;
}

/* Columns k .. k + 3: rows up to the farthest that they exchange one by one, then those that all of
 * them reach, then the last few; 0: they exchange rows that are farther away than they reach. */
static int forward_together(double *y, const double *A, const uint32_t *pivot, const dm_band *b,
                            uint32_t k) {
    const uint32_t w = b->width, end = k + w + 1; /* of the rows that the first column reaches */
    const double *a[TOGETHER];
    double x[TOGETHER];
    uint32_t lead = k + TOGETHER;
    if (end + TOGETHER - 1 > b->n) return 0;
    for (uint32_t j = 0; j < TOGETHER; j++) {
        if (pivot[k + j] && k + j + pivot[k + j] >= lead) lead = k + j + pivot[k + j] + 1;
        a[j] = factor(A, b, k + j);
    }
    if (lead > end) return 0;
    if (!(pivot[k] | pivot[k + 1] | pivot[k + 2] | pivot[k + 3]))
        lead_forward(y + k, a, x);
    else
        for (uint32_t j = 0; j < TOGETHER; j++) {
            step_forward(y, a[j], k + j, pivot[k + j], lead);
            x[j] = y[k + j];
        }
    for (uint32_t j = 0; j < TOGETHER; j++) a[j] += lead - k - j;
    subtract_together(y + lead, a, x, end - lead);
    for (uint32_t j = 1; j < TOGETHER; j++) subtract(y + end, a[j] + (end - lead), x[j], j);
    return 1;
}

/* Columns k, k - 1, k - 2, k - 3 of the upper factor, the same from below. Above their reach they
 * are 0 as far as their room goes. */
static void backward_together(double *y, const double *A, const dm_band *b, uint32_t reach,
                              uint32_t k) {
    const uint32_t first = k - (TOGETHER - 1), most = smaller(reach + TOGETHER - 1, 2 * b->width);
    const uint32_t begin = k > most ? k - most : 0;
    const double *a[TOGETHER];
    double x[TOGETHER];
    for (uint32_t j = 0; j < TOGETHER; j++) a[j] = factor(A, b, k - j);
    lead_backward(y + k, a, x);
    for (uint32_t j = 0; j < TOGETHER; j++) a[j] -= k - j - begin;
    subtract_together(y + begin, a, x, first - begin);
    for (uint32_t j = 1; j < TOGETHER && begin; j++) {
        const uint32_t reached = k - j > reach ? k - j - reach : 0;
        if (reached < begin) subtract(y + reached, a[j] - (begin - reached), x[j], begin - reached);
    }
}

void dm_band_solve(double *x, const double *A, const uint32_t *pivot, const dm_band *b,
                   double *scratch) {
    const uint32_t n = b->n, w = b->width, reach = reach_of(pivot, b);
    double *y = scratch;
    uint32_t k = 0;
    for (uint32_t i = 0; i < n; i++) y[b->order[i]] = x[i];
    while (k < n) {
        if (forward_together(y, A, pivot, b, k)) {
            k += TOGETHER;
            continue;
        }
        step_forward(y, factor(A, b, k), k, pivot[k], smaller(k + w, n - 1) + 1);
        k++;
    }
    for (k = n; k >= TOGETHER && reach >= TOGETHER; k -= TOGETHER)
        backward_together(y, A, b, reach, k - 1);
    while (k-- > 0) {
        const double *column = factor(A, b, k);
        const uint32_t above = smaller(reach, k);
        y[k] *= column[0];
        subtract(y + k - above, column - above, y[k], above);
    }
    for (uint32_t i = 0; i < n; i++) x[i] = y[b->order[i]];
}
