/* rotation.c - see rotation.h */
#include "dec/levi_civita/rotation.h"

#include "dec/gram.h"

#include <string.h>

enum { N = DM_DIMENSION };

typedef double axes[N][N]; /* rows are vectors of n entries */

static double dot(const double *a, const double *b, uint32_t n) {
    double sum = 0.0;
    for (uint32_t i = 0; i < n; i++) sum += a[i] * b[i];
    return sum;
}

/* ---- frames ---- */

void dm_levi_civita_frame(double *place, const dm_levi_civita *c, uint32_t top) {
    const uint32_t n = c->K->n, vertices[] = {0, 1, 2, 3, 4, 5, 6, 7, 8};
    double own[N][N];
    dm_cell_metric cell;
    dm_metric_cell(&cell, c->K, c->metric, top);
    dm_gram_factor(own, cell.length2, vertices, n);
    const double *T = c->turn ? c->turn + (size_t)top * n * n : NULL;
    const int over = c->K->orientation && c->K->orientation[top] < 0;
    memset(place, 0, (size_t)n * sizeof *place);
    for (uint32_t i = 0; i < n; i++) {
        double *p = place + (size_t)(i + 1) * n;
        for (uint32_t j = i + 1; j < n; j++) own[i][j] = 0.0;
        if (over) own[i][n - 1] = -own[i][n - 1];
        for (uint32_t j = 0; j < n; j++) {
            p[j] = own[i][j];
            if (!T) continue;
            p[j] = 0.0;
            for (uint32_t m = 0; m < n; m++) p[j] += T[(size_t)m * n + j] * own[i][m];
        }
    }
}

/* ---- across a facet ---- */

/* take from v what it has along the rows before, twice, and make it a unit vector */
static void orthonormalize(axes u, uint32_t row, uint32_t n) {
    for (int round = 0; round < 2; round++)
        for (uint32_t j = 0; j < row; j++) {
            const double along = dot(u[row], u[j], n);
            for (uint32_t m = 0; m < n; m++) u[row][m] -= along * u[j][m];
        }
    const double scale = 1.0 / sqrt(dot(u[row], u[row], n));
    for (uint32_t m = 0; m < n; m++) u[row][m] *= scale;
}

/* An orthonormal basis that knows the facet opposite to vertex `apex`: its edges from its first
 * vertex made orthonormal one after the other, then the normal, outward times `side`. */
static void basis_of(axes u, const double *place, uint32_t apex, double side, uint32_t n) {
    const double *first = place + (size_t)(apex == 0) * n;
    uint32_t row = 0;
    for (uint32_t i = apex == 0 ? 2 : 1; i <= n; i++) {
        if (i == apex) continue;
        for (uint32_t m = 0; m < n; m++) u[row][m] = place[(size_t)i * n + m] - first[m];
        orthonormalize(u, row++, n);
    }
    for (uint32_t m = 0; m < n; m++) u[row][m] = side * (first[m] - place[(size_t)apex * n + m]);
    orthonormalize(u, row, n);
}

/* R = sum of b_j a_j^T */
static void by_face(double *R, axes a, axes b, uint32_t n) {
    for (uint32_t i = 0; i < n; i++)
        for (uint32_t j = 0; j < n; j++) {
            double sum = 0.0;
            for (uint32_t m = 0; m < n; m++) sum += b[m][i] * a[m][j];
            R[(size_t)i * n + j] = sum;
        }
}

/* R = 1 + X + X^2 / (1 + a.b), X = b a^T - a b^T */
static void by_normal(double *R, const double *a, const double *b, uint32_t n) {
    const double cosine = dot(a, b, n);
    const double scale = 1.0 + cosine > 1e-14 ? 1.0 / (1.0 + cosine) : 0.0;
    for (uint32_t i = 0; i < n; i++)
        for (uint32_t j = 0; j < n; j++) {
            /* X^2 = (a.b) (a b^T + b a^T) - a a^T - b b^T for unit vectors */
            const double square = cosine * (a[i] * b[j] + b[i] * a[j]) - a[i] * a[j] - b[i] * b[j];
            const double turn = b[i] * a[j] - a[i] * b[j] + square * scale;
            R[(size_t)i * n + j] = (i == j) + (scale > 0.0 ? turn : 0.0);
        }
}

/* the places of the vertices of `from` and of `to` that the other one has not */
static int apexes(uint32_t *apex, const dm_complex *K, uint32_t from, uint32_t to) {
    const uint32_t n = K->n, *f = K->face[n] + (size_t)from * (n + 1),
                   *t = K->face[n] + (size_t)to * (n + 1);
    for (apex[0] = 0; apex[0] <= n; apex[0]++)
        for (apex[1] = 0; apex[1] <= n; apex[1]++)
            if (f[apex[0]] == t[apex[1]]) return 1;
    return 0;
}

dm_status dm_levi_civita_rotation(double *R, const dm_levi_civita *c, uint32_t from, uint32_t to) {
    const uint32_t n = c->K->n;
    double place[(N + 1) * N];
    uint32_t apex[2];
    axes a, b;
    if (from == to || !apexes(apex, c->K, from, to)) return DM_SINGULAR;
    dm_levi_civita_frame(place, c, from);
    basis_of(a, place, apex[0], 1.0, n);
    dm_levi_civita_frame(place, c, to);
    basis_of(b, place, apex[1], -1.0, n);
    if (c->rule == DM_BY_FACE)
        by_face(R, a, b, n);
    else
        by_normal(R, a[n - 1], b[n - 1], n);
    return DM_OK;
}
