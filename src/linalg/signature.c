#include "linalg/signature.h"

#include <math.h>
#include <stddef.h>

#define W 1
#define HOW
#define DM_LANES_FUSED 0
#include "linalg/pivots_text.h"

/* What is left of A: rows and columns from `first` on. */
typedef struct {
    double *A;
    uint32_t n, first;
} rest;

static double *at(const rest *r, uint32_t i, uint32_t j) {
    return r->A + (size_t)i * r->n + j;
}

/* Row and column a change places with b. */
static void exchange(const rest *r, uint32_t a, uint32_t b) {
    if (a == b) return;
    for (uint32_t k = r->first; k < r->n; k++) {
        const double x = *at(r, a, k);
        *at(r, a, k) = *at(r, b, k);
        *at(r, b, k) = x;
    }
    for (uint32_t k = r->first; k < r->n; k++) {
        const double x = *at(r, k, a);
        *at(r, k, a) = *at(r, k, b);
        *at(r, k, b) = x;
    }
}

/* The largest entry of the diagonal. */
static uint32_t find_diagonal(const rest *r) {
    uint32_t found = r->first;
    for (uint32_t i = r->first + 1; i < r->n; i++)
        if (fabs(*at(r, i, i)) > fabs(*at(r, found, found))) found = i;
    return found;
}

/* Is it large enough for the entries of its own column? Always where all values are positive: then
 * no other entry need be looked at. */
static int is_large(const rest *r, uint32_t k, double single) {
    const double one = fabs(*at(r, k, k));
    for (uint32_t i = r->first; i < r->n; i++)
        if (i != k && !(one >= single * fabs(*at(r, i, k)))) return 0;
    return *at(r, k, k) > 0.0;
}

/* The largest entry beside the diagonal. */
static void find_beside(const rest *r, uint32_t *row, uint32_t *column) {
    double beside = -1.0;
    for (uint32_t i = r->first; i < r->n; i++)
        for (uint32_t j = r->first; j < i; j++)
            if (fabs(*at(r, i, j)) > beside) beside = fabs(*at(r, i, j)), *row = i, *column = j;
}

/* A -= a a^T / pivot behind the first row of what is left */
static void eliminate_one(const rest *r) {
    eliminate_by_pivot(r->A, r->n, r->first, *at(r, r->first, r->first));
    for (uint32_t i = r->first + 1; i < r->n; i++)
        for (uint32_t j = r->first + 1; j < i; j++) *at(r, j, i) = *at(r, i, j);
}

/* the same with the first two rows, whose block [a, b; b, c] has a negative determinant, which is
 * returned */
static double eliminate_two(const rest *r) {
    const uint32_t k = r->first;
    const double a = *at(r, k, k), b = *at(r, k + 1, k), c = *at(r, k + 1, k + 1);
    const double det = a * c - b * b;
    for (uint32_t i = k + 2; i < r->n; i++) {
        const double x = *at(r, i, k), y = *at(r, i, k + 1);
        const double u = (c * x - b * y) / det, v = (a * y - b * x) / det;
        for (uint32_t j = k + 2; j < r->n; j++)
            *at(r, i, j) -= u * *at(r, k, j) + v * *at(r, k + 1, j);
    }
    return det;
}

uint32_t dm_negative_values(double *A, uint32_t n, double *least, double *all) {
    static const double SINGLE = 0.6403882032022076; /* (1 + sqrt 17)/8: growth is least */
    const double common = common_of(A, n), share = 1.0 / common;
    rest r = {.A = A, .n = n};
    uint32_t negative = 0;
    double product = common;
    *least = INFINITY, *all = 0.0;
    while (r.first < n) {
        const uint32_t diagonal = find_diagonal(&r);
        uint32_t row = r.first, column = r.first;
        if (!is_large(&r, diagonal, SINGLE)) find_beside(&r, &row, &column);
        const double one = fabs(*at(&r, diagonal, diagonal)), two = fabs(*at(&r, row, column));
        if (row == column || one >= SINGLE * two) {
            *least = fmin(*least, one);
            if (one == 0.0 || !(one < INFINITY)) return negative; /* zeros, or no numbers */
            exchange(&r, r.first, diagonal);
            negative += *at(&r, r.first, r.first) < 0.0;
            eliminate_one(&r);
            product *= one * share;
            r.first++;
            continue;
        }
        *least = fmin(*least, two);
        if (!(two < INFINITY)) return negative;
        exchange(&r, r.first, column); /* column < row, so that row is still in its place */
        exchange(&r, r.first + 1, row == r.first ? column : row);
        negative++; /* one value of each sign */
        product *= fabs(eliminate_two(&r)) * share * share;
        r.first += 2;
    }
    *all = product;
    return negative;
}

int dm_all_positive(double *A, uint32_t n, double far, double *least, double *all) {
    switch (n) {
    case 1:
        return find_pivots(A, 1, far, 1, least, all);
    case 2:
        return find_pivots(A, 2, far, 1, least, all);
    case 3:
        return find_pivots(A, 3, far, 1, least, all);
    case 4:
        return find_pivots(A, 4, far, 1, least, all);
    default:
        return find_pivots(A, n, far, 1, least, all);
    }
}

static const double FAR = 1e-6; /* of ones on the diagonal, far above round-off */

/* Where all entries may have either sign at once: x.M x >= |x|.C |x|, C the centre with minus the
 * largest sizes beside its diagonal. */
static int is_positive_by_size(double *A, const double *radius, uint32_t n) {
    double least, all;
    for (uint32_t i = 0; i < n; i++)
        for (uint32_t j = 0; j < n; j++) {
            if (i == j) continue;
            A[i * n + j] = -(fabs(A[i * n + j]) + radius[i * n + j]);
            if (!(A[i * n + j] > -1.0)) return 0;
        }
    return dm_all_positive(A, n, FAR, &least, &all);
}

/* Where they stay near to the centre: its least value is above the largest row sum of radii. */
static int is_positive_around(double *A, const double *radius, uint32_t n) {
    double least, all, largest = 0.0;
    for (uint32_t i = 0; i < n; i++) {
        double sum = 0.0;
        for (uint32_t j = 0; j < n; j++) sum += radius[i * n + j];
        largest = fmax(largest, sum);
    }
    if (!(largest < 1.0)) return 0;
    for (uint32_t i = 0; i < n; i++) A[i * n + i] -= largest;
    return dm_all_positive(A, n, FAR, &least, &all);
}

int dm_surely_positive(double *A, double *radius, uint32_t n) {
    double copy[DM_SURELY_MOST * DM_SURELY_MOST], size[DM_SURELY_MOST];
    if (n > DM_SURELY_MOST) return 0;
    for (uint32_t i = 0; i < n; i++) {
        if (!(A[i * n + i] > 0.0 && A[i * n + i] < INFINITY)) return 0;
        size[i] = sqrt(A[i * n + i]);
    }
    for (uint32_t i = 0; i < n; i++)
        for (uint32_t j = 0; j < n; j++) {
            A[i * n + j] = copy[i * n + j] = i == j ? 1.0 : A[i * n + j] / size[i] / size[j];
            radius[i * n + j] = radius[i * n + j] / size[i] / size[j];
            if (!isfinite(A[i * n + j])) return 0;
        }
    return is_positive_by_size(copy, radius, n) || is_positive_around(A, radius, n);
}

/* x - 2 (w . x) w of a vector whose entries are so far apart, from `first` on; |w| = 1 */
static void reflect(double *x, size_t apart, const double *w, uint32_t first, uint32_t n) {
    double along = 0.0;
    for (uint32_t i = first; i < n; i++) along += w[i] * x[i * apart];
    for (uint32_t i = first; i < n; i++) x[i * apart] -= 2.0 * along * w[i];
}

/* The reflection w that takes g[first..n-1] to a multiple of its first entry; 0: nothing is left of
 * g but rounding. */
static int find_reflection(const double *g, uint32_t first, uint32_t n, double *w) {
    static const double NOTHING = 1e-12;
    double whole = 0.0, left = 0.0, size = 0.0;
    for (uint32_t i = 0; i < n; i++) whole = hypot(whole, g[i]);
    for (uint32_t i = first; i < n; i++) left = hypot(left, g[i]);
    if (!(left > NOTHING * whole)) return 0;
    for (uint32_t i = first; i < n; i++) w[i] = g[i] / left;
    w[first] += copysign(1.0, w[first]);
    for (uint32_t i = first; i < n; i++) size = hypot(size, w[i]);
    for (uint32_t i = first; i < n; i++) w[i] /= size;
    return 1;
}

uint32_t dm_restrict(double *A, uint32_t n, double *G, uint32_t k, double *work) {
    uint32_t rank = 0;
    for (uint32_t c = 0; c < k && rank < n; c++) {
        if (!find_reflection(G + (size_t)c * n, rank, n, work)) continue;
        for (uint32_t i = 0; i < n; i++) reflect(A + (size_t)i * n, 1, work, rank, n);
        for (uint32_t j = 0; j < n; j++) reflect(A + j, n, work, rank, n);
        for (uint32_t d = c + 1; d < k; d++) reflect(G + (size_t)d * n, 1, work, rank, n);
        rank++;
    }
    const uint32_t m = n - rank;
    for (uint32_t i = 0; i < m; i++)
        for (uint32_t j = 0; j < m; j++)
            A[(size_t)i * m + j] = A[(size_t)(i + rank) * n + j + rank];
    return m;
}
