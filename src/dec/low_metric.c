/* low_metric.c - triangles and tetrahedra: rows "mesh of triangles" and "mesh of tetrahedra" of
 * make bench. Cells are read by the faces of their faces; loops have constant ends. */
#include "dec/low_metric.h"

#include <string.h>

/* squares of longer, or shorter, longest edges go the general road, which scales them */
static const double LEAST = 0x1p-100, MOST = 0x1p100;

static const uint32_t FOUR[4] = {0, 1, 2, 3};

/* ---- triangles ---- */

double dm_metric_area(const dm_metric *metric, const dm_complex *K, uint32_t cell) {
    const uint32_t *e = K->face[2] + 3 * (size_t)cell;
    const double l[3] = {metric->length2[e[0]], metric->length2[e[1]], metric->length2[e[2]]};
    const double longest = fmax(fmax(l[0], l[1]), l[2]);
    if (!(longest > LEAST && longest < MOST)) return 0.0;
    const double det = dm_area4_squared(l[0], l[1], l[2]) / 4.0;
    return det > DM_SLENDER * (longest * longest) ? sqrt(det) / 2 : 0.0;
}

/* edges lambda_i 2 A / |e_i|; from an edge to each of its ends |e| |*e| / 4. Products of no more
 * than three lengths or so, here and below: powers of lengths leave the range of numbers first. */
static inline void share_triangle(double *edge, double *vertex, const double *l,
                                  const double *length, double area, dm_centres centres) {
    const double scale = centres == DM_BARYCENTRES ? 0.0 : 0.125 / area;
    const double third = centres == DM_BARYCENTRES ? 2.0 * area / 3.0 : 0.0;
    double piece[3];
    for (uint32_t i = 0; i < 3; i++) { /* |e| |*e| */
        piece[i] = third + l[i] * scale * (l[(i + 1) % 3] + l[(i + 2) % 3] - l[i]);
        edge[i] = piece[i] / length[i];
    }
    for (uint32_t i = 0; i < 3; i++) vertex[i] = (piece[(i + 1) % 3] + piece[(i + 2) % 3]) / 4.0;
}

void dm_share_triangle(double *edge, double *vertex, const double *l, const double *length,
                       double area, dm_centres centres) {
    share_triangle(edge, vertex, l, length, area, centres);
}

void dm_share_triangles(dm_metric *out, const dm_complex *K) {
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

/* ---- tetrahedra ---- */

/* edge[a][b] = edge[b][a]: the edges of a tetrahedron, through its faces 3, 2 and 0 */
static inline void read_edges(uint32_t edge[4][4], const dm_complex *K, uint32_t t) {
    const uint32_t *F = K->face[3] + 4 * (size_t)t;
    const uint32_t *f3 = K->face[2] + 3 * (size_t)F[3], *f2 = K->face[2] + 3 * (size_t)F[2];
    edge[0][1] = edge[1][0] = f3[2];
    edge[0][2] = edge[2][0] = f3[1];
    edge[1][2] = edge[2][1] = f3[0];
    edge[0][3] = edge[3][0] = f2[1];
    edge[1][3] = edge[3][1] = f2[0];
    edge[2][3] = edge[3][2] = K->face[2][3 * (size_t)F[0]];
}

/* squares of lengths of all edges, both ways; returns the longest */
static inline double read_squares(dm_squares *l, const double *length2, uint32_t edge[4][4]) {
    double longest = 0.0;
    for (uint32_t i = 0; i < 4; i++) {
        l[i][i] = 0.0;
        for (uint32_t j = 0; j < i; j++) {
            l[i][j] = l[j][i] = length2[edge[i][j]];
            longest = fmax(longest, l[i][j]);
        }
    }
    return longest;
}

double dm_metric_solid(const dm_metric *metric, const dm_complex *K, uint32_t cell) {
    uint32_t edge[4][4];
    dm_squares l[4];
    double G[DM_DIMENSION][DM_DIMENSION];
    read_edges(edge, K, cell);
    const double longest = read_squares(l, metric->length2, edge);
    if (!(longest > LEAST && longest < MOST)) return 0.0;
    const double det = dm_gram_factor(G, l, FOUR, 3);
    return det > DM_FLAT * (longest * longest * longest) ? sqrt(det) / 2 / 3 : 0.0;
}

/* what goes from face j, with a share to be spread, to the edge a, b opposite to w in it */
static inline void to_edge(dm_tetrahedron_shares *out, const dm_squares *l, double factor,
                           const int circum, const uint32_t w, const uint32_t a, const uint32_t b) {
    const double ab = l[a][b];
    out->edge[a][b] += circum ? factor * ab * (l[w][a] + l[w][b] - ab) : factor;
}

static inline void from_face(dm_tetrahedron_shares *out, const dm_squares *l, double factor,
                             const int circum, const uint32_t a, const uint32_t b,
                             const uint32_t c) {
    to_edge(out, l, factor, circum, a, b, c);
    to_edge(out, l, factor, circum, b, a, c);
    to_edge(out, l, factor, circum, c, a, b);
}

/* lambda_j 3 V / A_j for face j, from it to its edges, a sixth of |e| |*e| to their ends */
__attribute__((always_inline)) static inline void share_tetrahedron(
    dm_tetrahedron_shares *out, const dm_squares *l, double length[4][4], const double *area,
    double volume, const double *centre, const int circum) {
    double factor[4];
    memset(out, 0, sizeof *out);
    for (uint32_t j = 0; j < 4; j++) {
        out->face[j] = centre[j] * 3.0 * volume / area[j];
        factor[j] = (circum ? 1.0 / (16.0 * area[j]) : area[j] / 3.0) * out->face[j];
    }
    from_face(out, l, factor[0], circum, 1, 2, 3);
    from_face(out, l, factor[1], circum, 0, 2, 3);
    from_face(out, l, factor[2], circum, 0, 1, 3);
    from_face(out, l, factor[3], circum, 0, 1, 2);
    for (uint32_t a = 0; a < 4; a++) /* so far |e| |*e| */
        for (uint32_t b = a + 1; b < 4; b++) {
            out->vertex[a] += out->edge[a][b] / 6.0;
            out->vertex[b] += out->edge[a][b] / 6.0;
            out->edge[a][b] /= length[a][b];
        }
}

void dm_share_tetrahedron(dm_tetrahedron_shares *out, const dm_squares *l, double length[4][4],
                          const double *area, double volume, const double *centre,
                          dm_centres centres) {
    share_tetrahedron(out, l, length, area, volume, centre, centres != DM_BARYCENTRES);
}

/* all of them to the duals of tetrahedron t's faces */
static inline void add_shares(dm_metric *out, const dm_complex *K, uint32_t t, uint32_t edge[4][4],
                              const dm_tetrahedron_shares *shares) {
    const uint32_t *F = K->face[3] + 4 * (size_t)t, *v = K->vertex[3] + 4 * (size_t)t;
    for (uint32_t i = 0; i < 4; i++) {
        out->dual[2][F[i]] += shares->face[i];
        out->dual[0][v[i]] += shares->vertex[i];
        for (uint32_t j = i + 1; j < 4; j++) out->dual[1][edge[i][j]] += shares->edge[i][j];
    }
    out->dual[3][t] = 1.0;
}

/* circum: to circumcentres, else to barycentres */
static inline void share_all(dm_metric *out, const dm_complex *K, const int circum) {
    uint32_t edge[4][4];
    dm_squares l[4];
    dm_tetrahedron_shares shares;
    double G[DM_DIMENSION][DM_DIMENSION], area[4], length[4][4];
    double centre[4] = {0.25, 0.25, 0.25, 0.25};
    for (uint32_t t = 0; t < K->count[3]; t++) {
        read_edges(edge, K, t);
        read_squares(l, out->length2, edge);
        for (uint32_t i = 0; i < 4; i++) {
            area[i] = out->volume[2][K->face[3][4 * (size_t)t + i]];
            for (uint32_t j = i + 1; j < 4; j++) length[i][j] = out->volume[1][edge[i][j]];
        }
        if (circum) {
            dm_gram_factor(G, l, FOUR, 3);
            dm_gram_centre(centre, G, l, FOUR, 3);
        }
        share_tetrahedron(&shares, l, length, area, out->volume[3][t], centre, circum);
        add_shares(out, K, t, edge, &shares);
    }
}

void dm_share_tetrahedra(dm_metric *out, const dm_complex *K) {
    if (out->centres == DM_BARYCENTRES)
        share_all(out, K, 0);
    else
        share_all(out, K, 1);
}
