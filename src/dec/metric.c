/* metric.c - volumes by Gram determinants, duals by the recursion over flags of centres. Edges and
 * triangles, of which there are most, have formulas of their own: rows "mesh of triangles" and
 * "mesh of tetrahedra" of make bench. */
#include "dec/metric.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Where a cell counts as flat: (k! volume)^2 against the longest edge to the power 2 k. Lengths in
 * doubles leave an error of some 1e-16 in that ratio. */
static const double FLAT = 1e-14;

void dm_metric_lengths(double *length2, const dm_complex *K, const double *points, uint32_t N) {
    for (uint32_t e = 0; e < K->count[1]; e++) {
        const double *a = points + (size_t)K->vertex[1][2 * e] * N;
        const double *b = points + (size_t)K->vertex[1][2 * e + 1] * N;
        double sum = 0.0;
        for (uint32_t i = 0; i < N; i++) sum += (b[i] - a[i]) * (b[i] - a[i]);
        length2[e] = sum;
    }
}

/* ---- one simplex ---- */

/* vertices of a set, ascending; how many */
static uint32_t members(uint32_t *out, uint32_t set) {
    uint32_t count = 0;
    for (uint32_t i = 0; set >> i; i++)
        if (set >> i & 1) out[count++] = i;
    return count;
}

/* G_ij = e_i . e_j, e_i from the first vertex of the set to its others; Cholesky's factor takes its
 * place. Returns det G = (k! volume)^2, not positive where there is no such simplex */
static double factor_gram(double G[DM_DIMENSION][DM_DIMENSION], const dm_cell_metric *c,
                          const uint32_t *v, uint32_t k) {
    double det = 1.0;
    for (uint32_t i = 0; i < k; i++)
        for (uint32_t j = 0; j <= i; j++) {
            double sum = (c->length2[v[0]][v[i + 1]] + c->length2[v[0]][v[j + 1]] -
                          c->length2[v[i + 1]][v[j + 1]]) /
                         2.0;
            for (uint32_t m = 0; m < j; m++) sum -= G[i][m] * G[j][m];
            if (i == j) {
                det *= sum;
                if (!(sum > 0.0)) return det < 0.0 ? det : 0.0;
                G[i][i] = sqrt(sum);
            } else {
                G[i][j] = sum / G[j][j];
            }
        }
    return det;
}

/* 2 G mu = diagonal of G, lambda_0 = 1 - sum mu */
static void solve_centre(double *lambda, double G[DM_DIMENSION][DM_DIMENSION],
                         const dm_cell_metric *c, const uint32_t *v, uint32_t k) {
    double *mu = lambda + 1;
    lambda[0] = 1.0;
    for (uint32_t i = 0; i < k; i++) {
        mu[i] = c->length2[v[0]][v[i + 1]] / 2.0;
        for (uint32_t m = 0; m < i; m++) mu[i] -= G[i][m] * mu[m];
        mu[i] /= G[i][i];
    }
    for (uint32_t i = k; i-- > 0;) {
        for (uint32_t m = i + 1; m < k; m++) mu[i] -= G[m][i] * mu[m];
        mu[i] /= G[i][i];
        lambda[0] -= mu[i];
    }
}

/* (4 area)^2 of a triangle with squared edges a, b, c */
static double area4_squared(double a, double b, double c) {
    const double mixed = a + b - c;
    return 4.0 * a * b - mixed * mixed;
}

/* barycentric coordinates of the centre of the simplex v[0 .. k], k > 0 */
static void centre_of(double *lambda, const dm_cell_metric *c, const uint32_t *v, uint32_t k,
                      dm_centres centres) {
    double G[DM_DIMENSION][DM_DIMENSION];
    if (centres == DM_BARYCENTRES || k == 1) {
        for (uint32_t i = 0; i <= k; i++) lambda[i] = 1.0 / (k + 1);
    } else if (k == 2) {
        const double l[3] = {c->length2[v[1]][v[2]], c->length2[v[0]][v[2]],
                             c->length2[v[0]][v[1]]};
        const double scale = 1.0 / area4_squared(l[0], l[1], l[2]);
        for (uint32_t i = 0; i < 3; i++)
            lambda[i] = l[i] * (l[(i + 1) % 3] + l[(i + 2) % 3] - l[i]) * scale;
    } else {
        factor_gram(G, c, v, k);
        solve_centre(lambda, G, c, v, k);
    }
}

void dm_metric_centre(double *lambda, const dm_cell_metric *c, uint32_t set, dm_centres centres) {
    double own[DM_DIMENSION + 1] = {1.0};
    uint32_t v[DM_DIMENSION + 1], at = 0;
    const uint32_t k = members(v, set) - 1;
    if (k > 0) centre_of(own, c, v, k, centres);
    for (uint32_t i = 0; i <= c->n; i++) lambda[i] = set >> i & 1 ? own[at++] : 0.0;
}

/* ---- one cell with its faces ---- */

/* the numbers of all faces: a set is a set with one vertex more, without that vertex */
static void read_faces(dm_cell_metric *c, const dm_complex *K, uint32_t k, uint32_t cell) {
    const uint32_t all = (2u << k) - 1;
    c->n = k;
    c->face[all] = cell;
    for (uint32_t set = all - 1; set > 0; set--) {
        uint32_t p = 0, size = 0;
        while (set >> p & 1) p++; /* the first vertex that is not in it; it comes p-th */
        for (uint32_t rest = set; rest; rest &= rest - 1) size++;
        c->face[set] = K->face[size][(size_t)c->face[set | 1u << p] * (size + 1) + p];
    }
}

/* squares of lengths of all edges of the cell, both ways */
static void read_lengths(dm_cell_metric *c, const double *length2) {
    for (uint32_t i = 0; i <= c->n; i++) {
        c->length2[i][i] = 0.0;
        for (uint32_t j = 0; j < i; j++)
            c->length2[i][j] = c->length2[j][i] = length2[c->face[1u << i | 1u << j]];
    }
}

/* from G to its faces: h = lambda_w k |G| / |F| for F = G without w, k the degree of G */
static void pass_down(dm_cell_metric *c, uint32_t G, dm_centres centres) {
    double lambda[DM_DIMENSION + 1];
    uint32_t v[DM_DIMENSION + 1];
    const uint32_t k = members(v, G) - 1;
    if (k == 0) return;
    centre_of(lambda, c, v, k, centres);
    if (k == c->n) memcpy(c->centre, lambda, (k + 1) * sizeof *lambda);
    const double factor = k * c->volume[G] * c->share[G] / (c->n - k + 1);
    for (uint32_t i = 0; i <= k; i++) {
        const uint32_t F = G & ~(1u << v[i]);
        c->share[F] += factor * lambda[i] / c->volume[F];
    }
}

/* Shares of a triangle, in the order of what is opposite to its vertices: edges lambda_i 2 A /
 * |e_i|; from an edge to each of its ends |e| |*e| / 4. l: squares of lengths. */
static inline void share_triangle(double *edge, double *vertex, const double *l,
                                  const double *length, double area, dm_centres centres) {
    const double scale = centres == DM_BARYCENTRES ? 0.0 : 0.125 / area;
    const double third = centres == DM_BARYCENTRES ? 2.0 * area / 3.0 : 0.0;
    double piece[3];
    for (uint32_t i = 0; i < 3; i++) { /* |e| |*e| */
        piece[i] = third + l[i] * (l[(i + 1) % 3] + l[(i + 2) % 3] - l[i]) * scale;
        edge[i] = piece[i] / length[i];
    }
    for (uint32_t i = 0; i < 3; i++) vertex[i] = (piece[(i + 1) % 3] + piece[(i + 2) % 3]) / 4.0;
}

/* shares and centre of a cell of degree 2 */
static void read_triangle(dm_cell_metric *c, dm_centres centres) {
    static const uint32_t v[3] = {0, 1, 2};
    const double l[3] = {c->length2[1][2], c->length2[0][2], c->length2[0][1]};
    const double length[3] = {c->volume[6], c->volume[5], c->volume[3]};
    double edge[3], vertex[3];
    share_triangle(edge, vertex, l, length, c->volume[7], centres);
    for (uint32_t i = 0; i < 3; i++)
        c->share[7 & ~(1u << i)] = edge[i], c->share[1u << i] = vertex[i];
    c->share[7] = 1.0;
    centre_of(c->centre, c, v, 2, centres);
}

/* Shares of a tetrahedron: lambda_j 3 V / A_j for face j, and so on down; c->centre is there */
static void share_tetrahedron(dm_cell_metric *c, dm_centres centres) {
    double *share = c->share;
    for (uint32_t set = 1; set < 15; set++) share[set] = 0.0;
    share[15] = 1.0;
    for (uint32_t j = 0; j < 4; j++) {
        const uint32_t F = 15 & ~(1u << j);
        const double area = c->volume[F];
        share[F] = c->centre[j] * 3.0 * c->volume[15] / area;
        const double factor =
            (centres == DM_BARYCENTRES ? area / 3.0 : 1.0 / (16.0 * area)) * share[F];
        for (uint32_t w = 0; w < 4; w++) { /* to the edge a, b opposite to w */
            if (w == j) continue;
            const uint32_t E = F & ~(1u << w);
            const uint32_t a = E & 1 ? 0 : E & 2 ? 1 : 2, b = 6 - a - w - j;
            const double *l = c->length2[w], ab = c->length2[a][b];
            share[E] += factor * (centres == DM_BARYCENTRES ? 1.0 : ab * (l[a] + l[b] - ab));
        }
    }
    for (uint32_t a = 0; a < 4; a++) /* so far |e| |*e| */
        for (uint32_t b = a + 1; b < 4; b++) {
            const uint32_t E = 1u << a | 1u << b;
            share[1u << a] += share[E] / 6.0;
            share[1u << b] += share[E] / 6.0;
            share[E] /= c->volume[E];
        }
}

void dm_metric_simplex(dm_cell_metric *out, const dm_complex *K, const dm_metric *metric,
                       uint32_t k, uint32_t cell) {
    static const uint32_t first[4] = {0, 1, 2, 3};
    const uint32_t all = (2u << k) - 1;
    read_faces(out, K, k, cell);
    read_lengths(out, metric->length2);
    out->centre[0] = 1.0;
    for (uint32_t set = 1; set <= all; set++) {
        uint32_t degree = 0;
        for (uint32_t rest = set & (set - 1); rest; rest &= rest - 1) degree++;
        out->volume[set] = metric->volume[degree][out->face[set]];
    }
    if (k == 2) {
        read_triangle(out, metric->centres);
    } else if (k == 3) {
        centre_of(out->centre, out, first, 3, metric->centres);
        share_tetrahedron(out, metric->centres);
    } else {
        for (uint32_t set = 1; set <= all; set++) out->share[set] = set == all ? 1.0 : 0.0;
        for (uint32_t G = all; G > 0; G--) pass_down(out, G, metric->centres);
    }
}

void dm_metric_cell(dm_cell_metric *out, const dm_complex *K, const dm_metric *metric,
                    uint32_t top) {
    dm_metric_simplex(out, K, metric, K->n, top);
}

/* ---- all of them ---- */

/* memory of all numbers; duals are 0 until shares are added */
static dm_status take(dm_metric *out, dm_arena *arena, const dm_complex *K) {
    out->length2 = dm_arena_take(arena, ((size_t)K->count[1] + 1) * sizeof(double));
    if (!out->length2) return DM_NO_MEMORY;
    for (uint32_t k = 0; k <= K->n; k++) {
        const size_t size = ((size_t)K->count[k] + 1) * sizeof(double);
        out->volume[k] = dm_arena_take(arena, size);
        out->dual[k] = dm_arena_take(arena, size);
        if (!out->volume[k] || !out->dual[k]) return DM_NO_MEMORY;
        memset(out->dual[k], 0, size);
    }
    return DM_OK;
}

/* Squares of lengths whose powers might leave the range of numbers, in units of a power of 4 near
 * the longest; returns the power of 2 of the lengths, 0 for all others. */
static int choose_unit(dm_cell_metric *c, uint32_t k, double *longest) {
    enum { FAR = 100 };
    int exponent;
    frexp(*longest, &exponent);
    const int half = exponent / 2;
    if (abs(exponent) < FAR) return 0;
    for (uint32_t i = 0; i <= k; i++)
        for (uint32_t j = 0; j <= k; j++) c->length2[i][j] = ldexp(c->length2[i][j], -2 * half);
    *longest = ldexp(*longest, -2 * half);
    return half;
}

/* the volume of a triangle or a larger simplex; 0: it is flat or cannot be */
static double volume_of(const dm_metric *metric, const dm_complex *K, uint32_t k, uint32_t cell) {
    static const uint32_t v[DM_DIMENSION + 1] = {0, 1, 2, 3, 4, 5, 6, 7, 8};
    dm_cell_metric c;
    double G[DM_DIMENSION][DM_DIMENSION], longest = 0.0, scale = 1.0;
    read_faces(&c, K, k, cell);
    read_lengths(&c, metric->length2);
    for (uint32_t i = 0; i <= k; i++)
        for (uint32_t j = 0; j < i; j++) longest = fmax(longest, c.length2[i][j]);
    const int unit = choose_unit(&c, k, &longest);
    const double det = k == 2
                           ? area4_squared(c.length2[1][2], c.length2[0][2], c.length2[0][1]) / 4.0
                           : factor_gram(G, &c, v, k);
    for (uint32_t i = 0; i < k; i++) scale *= longest;
    if (!(det > FLAT * scale)) return 0.0;
    scale = sqrt(det);
    for (uint32_t i = 2; i <= k; i++) scale /= i;
    return unit ? ldexp(scale, unit * (int)k) : scale;
}

/* the same of a triangle, of which there are many, by its edges */
static double area_of(const dm_metric *metric, const dm_complex *K, uint32_t cell) {
    static const double LEAST = 0x1p-100, MOST = 0x1p100;
    const uint32_t *e = K->face[2] + 3 * (size_t)cell;
    const double l[3] = {metric->length2[e[0]], metric->length2[e[1]], metric->length2[e[2]]};
    const double longest = fmax(fmax(l[0], l[1]), l[2]);
    if (!(longest > LEAST && longest < MOST)) return volume_of(metric, K, 2, cell);
    const double det = area4_squared(l[0], l[1], l[2]) / 4.0;
    return det > FLAT * (longest * longest) ? sqrt(det) / 2 : 0.0;
}

/* each cell by itself: the volume of a face is the same number in every cell that has it. 0: cell
 * *cell is flat */
static int measure_degree(dm_metric *out, const dm_complex *K, uint32_t k, uint32_t *cell) {
    for (*cell = 0; *cell < K->count[k]; ++*cell) {
        double *volume = out->volume[k] + *cell;
        if (k == 0)
            *volume = 1.0;
        else if (k == 1)
            *volume = sqrt(out->length2[*cell]);
        else
            *volume = k == 2 ? area_of(out, K, *cell) : volume_of(out, K, k, *cell);
        if (!(*volume > 0.0)) return 0;
    }
    return 1;
}

/* of one top cell, to the duals of all its faces */
static void add_shares(dm_metric *out, const dm_complex *K, uint32_t top) {
    dm_cell_metric c;
    dm_metric_cell(&c, K, out, top);
    for (uint32_t set = 1; set < 2u << K->n; set++) {
        uint32_t degree = 0;
        for (uint32_t rest = set & (set - 1); rest; rest &= rest - 1) degree++;
        out->dual[degree][c.face[set]] += c.share[set];
    }
}

/* of all of them, for a mesh of triangles */
static void add_triangles(dm_metric *out, const dm_complex *K) {
    double edge[3], vertex[3];
    for (uint32_t t = 0; t < K->count[2]; t++) {
        const uint32_t *e = K->face[2] + 3 * (size_t)t, *v = K->vertex[2] + 3 * (size_t)t;
        const double l[3] = {out->length2[e[0]], out->length2[e[1]], out->length2[e[2]]};
        const double length[3] = {out->volume[1][e[0]], out->volume[1][e[1]], out->volume[1][e[2]]};
        share_triangle(edge, vertex, l, length, out->volume[2][t], out->centres);
        for (uint32_t i = 0; i < 3; i++) {
            out->dual[1][e[i]] += edge[i];
            out->dual[0][v[i]] += vertex[i];
        }
        out->dual[2][t] = 1.0;
    }
}

dm_status dm_metric_build(dm_metric *out, dm_arena *arena, const dm_complex *K,
                          const double *length2, dm_centres centres, uint32_t *degree,
                          uint32_t *cell) {
    *out = (dm_metric){.centres = centres};
    const dm_status status = take(out, arena, K);
    if (status != DM_OK) return status;
    memcpy(out->length2, length2, K->count[1] * sizeof *length2);
    for (*degree = 0; *degree <= K->n; ++*degree)
        if (!measure_degree(out, K, *degree, cell)) return DM_SINGULAR;
    if (K->n == 2)
        add_triangles(out, K);
    else
        for (uint32_t top = 0; top < K->count[K->n]; top++) add_shares(out, K, top);
    return DM_OK;
}
