/* metric.c - volumes by Gram determinants, duals by the recursion over flags of centres. Triangles
 * and tetrahedra, of which there are most, have formulas of their own, low_metric.c. */
#include "dec/gram.h"
#include "dec/low_metric.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const double *point(const dm_points *points, uint32_t vertex) {
    return points->at + (size_t)vertex * points->N;
}

void dm_metric_lengths(double *length2, const dm_complex *K, const dm_points *points) {
    for (uint32_t e = 0; e < K->count[1]; e++) {
        const double *a = point(points, K->vertex[1][2 * e]);
        const double *b = point(points, K->vertex[1][2 * e + 1]);
        double sum = 0.0;
        for (uint32_t i = 0; i < points->N; i++) sum += (b[i] - a[i]) * (b[i] - a[i]);
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

/* barycentric coordinates of the centre of the simplex v[0 .. k], k > 0 */
static void centre_of(double *lambda, const dm_cell_metric *c, const uint32_t *v, uint32_t k,
                      dm_centres centres) {
    double G[DM_DIMENSION][DM_DIMENSION];
    if (centres == DM_BARYCENTRES || k == 1) {
        for (uint32_t i = 0; i <= k; i++) lambda[i] = 1.0 / (k + 1);
    } else if (k == 2) {
        double l[3] = {c->length2[v[1]][v[2]], c->length2[v[0]][v[2]], c->length2[v[0]][v[1]]};
        const double longest = fmax(fmax(l[0], l[1]), l[2]);
        const double area4 = 4.0 * c->volume[1u << v[0] | 1u << v[1] | 1u << v[2]] / longest;
        for (uint32_t i = 0; i < 3; i++) l[i] /= longest;
        const double scale = 1.0 / (area4 * area4);
        for (uint32_t i = 0; i < 3; i++)
            lambda[i] = l[i] * (l[(i + 1) % 3] + l[(i + 2) % 3] - l[i]) * scale;
    } else {
        dm_gram_factor(G, c->length2, v, k);
        dm_gram_centre(lambda, G, c->length2, v, k);
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

/* shares and centre of a cell of degree 2 */
static void read_triangle(dm_cell_metric *c, dm_centres centres) {
    static const uint32_t v[3] = {0, 1, 2};
    const double l[3] = {c->length2[1][2], c->length2[0][2], c->length2[0][1]};
    const double length[3] = {c->volume[6], c->volume[5], c->volume[3]};
    double edge[3], vertex[3];
    dm_share_triangle(edge, vertex, l, length, c->volume[7], centres);
    for (uint32_t i = 0; i < 3; i++)
        c->share[7 & ~(1u << i)] = edge[i], c->share[1u << i] = vertex[i];
    c->share[7] = 1.0;
    centre_of(c->centre, c, v, 2, centres);
}

/* the same of degree 3 */
static void read_tetrahedron(dm_cell_metric *c, dm_centres centres) {
    static const uint32_t v[4] = {0, 1, 2, 3};
    const double area[4] = {c->volume[14], c->volume[13], c->volume[11], c->volume[7]};
    double length[4][4] = {{0}};
    dm_tetrahedron_shares shares;
    centre_of(c->centre, c, v, 3, centres);
    for (uint32_t b = 1; b < 4; b++)
        for (uint32_t a = 0; a < b; a++) length[a][b] = c->volume[1u << a | 1u << b];
    dm_share_tetrahedron(&shares, c->length2, length, area, c->volume[15], c->centre, centres);
    for (uint32_t i = 0; i < 4; i++)
        c->share[15 & ~(1u << i)] = shares.face[i], c->share[1u << i] = shares.vertex[i];
    for (uint32_t b = 1; b < 4; b++)
        for (uint32_t a = 0; a < b; a++) c->share[1u << a | 1u << b] = shares.edge[a][b];
    c->share[15] = 1.0;
}

void dm_metric_simplex(dm_cell_metric *out, const dm_complex *K, const dm_metric *metric,
                       uint32_t k, uint32_t cell) {
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
        read_tetrahedron(out, metric->centres);
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

/* a b - c d to the last digits (Kahan; Jeannerod, Louvet, Muller 2013) */
static double difference(double a, double b, double c, double d) {
    const double cd = c * d;
    return fma(a, b, -cd) + fma(-c, d, cd);
}

/* (2 area)^2 in R^N: the sum of (u_i v_j - u_j v_i)^2, i < j, of two edges */
static double area2_squared(const dm_points *points, const uint32_t *vertex) {
    const double *a = point(points, vertex[0]);
    const double *b = point(points, vertex[1]), *c = point(points, vertex[2]);
    double sum = 0.0;
    for (uint32_t i = 0; i < points->N; i++)
        for (uint32_t j = 0; j < i; j++) {
            const double minor = difference(b[i] - a[i], c[j] - a[j], b[j] - a[j], c[i] - a[i]);
            sum += minor * minor;
        }
    return sum;
}

/* The same by squares of lengths: the longest against the middle one first, which loses nothing of
 * a needle (Kahan, Miscalculating area and angles of a needle-like triangle). */
static double area2_by_lengths(double a, double b, double c) {
    const double longest = fmax(a, fmax(b, c)), least = fmin(a, fmin(b, c));
    const double middle = fmax(fmin(a, b), fmin(fmax(a, b), c));
    const double mixed = least + (middle - longest);
    return least * middle - mixed * mixed / 4.0;
}

/* of a slender one; 0: it is flat */
static double slender_area(const dm_complex *K, const dm_points *points, const dm_cell_metric *c,
                           uint32_t cell, double longest, int unit) {
    double det = 0.0;
    if (points && !unit) {
        det = area2_squared(points, K->vertex[2] + 3 * (size_t)cell);
        return det > DM_FLAT_POINTS * (longest * longest) ? sqrt(det) / 2.0 : 0.0;
    }
    det = area2_by_lengths(c->length2[1][2], c->length2[0][2], c->length2[0][1]);
    return det > DM_FLAT * (longest * longest) ? ldexp(sqrt(det) / 2.0, 2 * unit) : 0.0;
}

/* the volume of a triangle or a larger simplex; 0: it is flat or cannot be */
static double volume_of(const dm_metric *metric, const dm_complex *K, const dm_points *points,
                        uint32_t k, uint32_t cell) {
    static const uint32_t v[DM_DIMENSION + 1] = {0, 1, 2, 3, 4, 5, 6, 7, 8};
    dm_cell_metric c;
    double G[DM_DIMENSION][DM_DIMENSION], longest = 0.0, scale = 1.0;
    read_faces(&c, K, k, cell);
    read_lengths(&c, metric->length2);
    for (uint32_t i = 0; i <= k; i++)
        for (uint32_t j = 0; j < i; j++) longest = fmax(longest, c.length2[i][j]);
    const int unit = choose_unit(&c, k, &longest);
    if (k == 2) return slender_area(K, points, &c, cell, longest, unit);
    const double det = dm_gram_factor(G, c.length2, v, k);
    for (uint32_t i = 0; i < k; i++) scale *= longest;
    if (k <= DM_SMALL && !(det > DM_FLAT * scale)) return 0.0;
    if (k > DM_SMALL && !(det > 0.0 && dm_gram_least(G, k) > DM_FLAT * longest)) return 0.0;
    scale = sqrt(det);
    for (uint32_t i = 2; i <= k; i++) scale /= i;
    return unit ? ldexp(scale, unit * (int)k) : scale;
}

/* each cell by itself: the volume of a face is the same number in every cell that has it. 0: cell
 * *cell is flat */
static int measure_degree(dm_metric *out, const dm_complex *K, const dm_points *points, uint32_t k,
                          uint32_t *cell) {
    for (*cell = 0; *cell < K->count[k]; ++*cell) {
        double *volume = out->volume[k] + *cell;
        if (k == 0)
            *volume = 1.0;
        else if (k == 1)
            *volume = sqrt(out->length2[*cell]);
        else if (k == 2)
            *volume = dm_metric_area(out, K, *cell);
        else if (k == 3)
            *volume = dm_metric_solid(out, K, *cell);
        else
            *volume = volume_of(out, K, points, k, *cell);
        if (!(*volume > 0.0) && k > 1) *volume = volume_of(out, K, points, k, *cell);
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

dm_status dm_metric_build(dm_metric *out, dm_arena *arena, const dm_complex *K,
                          const double *length2, const dm_points *points, dm_centres centres,
                          uint32_t *degree, uint32_t *cell) {
    *out = (dm_metric){.centres = centres};
    const dm_status status = take(out, arena, K);
    if (status != DM_OK) return status;
    memcpy(out->length2, length2, K->count[1] * sizeof *length2);
    for (*degree = 0; *degree <= K->n; ++*degree)
        if (!measure_degree(out, K, points, *degree, cell)) return DM_SINGULAR;
    if (K->n == 2)
        dm_share_triangles(out, K);
    else if (K->n == 3)
        dm_share_tetrahedra(out, K);
    else
        for (uint32_t top = 0; top < K->count[K->n]; top++) add_shares(out, K, top);
    return DM_OK;
}
