/* supports.c - pieces of the subdivision of both meshes against each other. */
#include "dec/transfer/supports.h"

#include "dec/transfer/boxes.h"
#include "dec/transfer/simplex.h"

#include <math.h>
#include <string.h>

enum { MOST = DM_SIMPLEX_VERTICES };

/* The pieces of a mesh: one for every flag of faces of a top cell. */
typedef struct {
    uint32_t count, n;
    double *points;   /* [count][n + 1][n] the centres of a flag */
    uint32_t *vertex; /* [count][n + 1]: numbers of these points */
    uint32_t *cell;   /* [count]: the k-cell of the flag */
    double *volume;   /* [count], signed */
} pieces;

/* flags of a simplex of degree n - 1 */
static uint32_t factorial(uint32_t n) {
    return n < 2 ? 1 : n * factorial(n - 1);
}

/* the centre of a face of a top cell */
static void centre_of(double *out, const dm_realization *r, uint32_t top, uint32_t set,
                      const dm_cell_metric *c) {
    double lambda[MOST];
    const uint32_t *vertex = r->K->vertex[r->K->n] + (size_t)top * (r->K->n + 1);
    dm_metric_centre(lambda, c, set, r->metric->centres);
    for (uint32_t i = 0; i < r->N; i++) {
        out[i] = 0.0;
        for (uint32_t j = 0; j <= r->K->n; j++)
            out[i] += lambda[j] * r->points[(size_t)vertex[j] * r->N + i];
    }
}

/* the volume of points[n + 1][n] times n!, signed */
static double signed_volume(const double *points, uint32_t n) {
    double a[MOST][MOST];
    for (uint32_t i = 0; i < n; i++)
        for (uint32_t j = 0; j < n; j++) a[i][j] = points[(i + 1) * n + j] - points[j];
    return dm_determinant(a, n);
}

/* the sign that the volume of a flag has where all centres lie inside: that of its vertices in the
 * order in which faces take them, about the points of the cell */
static double flag_sign(const dm_realization *r, uint32_t top, const uint32_t *order) {
    const uint32_t n = r->K->n, *vertex = r->K->vertex[n] + (size_t)top * (n + 1);
    double points[MOST * MOST];
    for (uint32_t i = 0; i <= n; i++)
        memcpy(points + i * n, r->points + (size_t)vertex[order[i]] * n, n * sizeof *points);
    return signed_volume(points, n) < 0.0 ? -1.0 : 1.0;
}

/* the simplex of the centres of order[0], order[0 1], ..., all vertices */
static void add_flag(pieces *p, const dm_realization *r, uint32_t top, const uint32_t *order,
                     uint32_t k, const dm_cell_metric *c) {
    const uint32_t n = r->K->n, at = p->count++;
    uint32_t set = 0;
    for (uint32_t d = 0; d <= n; d++) {
        set |= 1u << order[d];
        if (d == k) p->cell[at] = c->face[set];
        centre_of(p->points + ((size_t)at * (n + 1) + d) * n, r, top, set, c);
        p->vertex[(size_t)at * (n + 1) + d] = at * (n + 1) + d;
    }
    p->volume[at] = signed_volume(p->points + (size_t)at * (n + 1) * n, n) *
                    flag_sign(r, top, order) / factorial(n);
}

/* all orders of the vertices of a top cell */
static void add_flags(pieces *p, const dm_realization *r, uint32_t top, uint32_t *order,
                      uint32_t from, uint32_t k, const dm_cell_metric *c) {
    if (from > r->K->n) {
        add_flag(p, r, top, order, k, c);
        return;
    }
    for (uint32_t j = from; j <= r->K->n; j++) {
        const uint32_t a = order[from], b = order[j];
        order[from] = b, order[j] = a;
        add_flags(p, r, top, order, from + 1, k, c);
        order[from] = a, order[j] = b;
    }
}

/* (n + 1)! pieces a top cell; their volumes add up to that of the mesh, signs and all */
static dm_status make_pieces(pieces *p, const dm_realization *r, uint32_t k, dm_arena *arena) {
    const uint32_t n = r->K->n, tops = r->K->count[n];
    const size_t most = (size_t)tops * factorial(n + 1);
    *p = (pieces){.n = n};
    if (most * (n + 1) > UINT32_MAX) return DM_TOO_LARGE;
    p->points = dm_arena_take(arena, (most * (n + 1) * n + 1) * sizeof *p->points);
    p->vertex = dm_arena_take(arena, (most * (n + 1) + 1) * sizeof *p->vertex);
    p->cell = dm_arena_take(arena, (most + 1) * sizeof *p->cell);
    p->volume = dm_arena_take(arena, (most + 1) * sizeof *p->volume);
    if (!p->points || !p->vertex || !p->cell || !p->volume) return DM_NO_MEMORY;
    for (uint32_t top = 0; top < tops; top++) {
        uint32_t order[MOST];
        dm_cell_metric c;
        for (uint32_t j = 0; j <= n; j++) order[j] = j;
        dm_metric_cell(&c, r->K, r->metric, top);
        add_flags(p, r, top, order, 0, k, &c);
    }
    return DM_OK;
}

/* the sign of the product of the directions of two k-cells, 0 where they are perpendicular */
static double direction_sign(const dm_realization *from, uint32_t s, const dm_realization *to,
                             uint32_t t, uint32_t k) {
    double a[MOST][MOST], size = 1.0;
    uint32_t room[2][DM_DIMENSION + 1];
    const uint32_t *v = dm_complex_vertices(from->K, k, s, room[0]);
    const uint32_t *w = dm_complex_vertices(to->K, k, t, room[1]);
    for (uint32_t i = 0; i < k; i++) {
        double largest = 0.0;
        for (uint32_t j = 0; j < k; j++) {
            a[i][j] = 0.0;
            for (uint32_t c = 0; c < from->N; c++)
                a[i][j] += (from->points[(size_t)v[i + 1] * from->N + c] -
                            from->points[(size_t)v[0] * from->N + c]) *
                           (to->points[(size_t)w[j + 1] * to->N + c] -
                            to->points[(size_t)w[0] * to->N + c]);
        }
        for (uint32_t j = 0; j < k; j++) largest = fmax(largest, fabs(a[i][j]));
        size *= largest;
    }
    const double product = dm_determinant(a, k);
    if (k && fabs(product) <= 1e-12 * size) return 0.0;
    return product < 0.0 ? -1.0 : 1.0;
}

/* the share of piece a that lies in piece b */
static double overlap(const pieces *p, uint32_t a, const pieces *q, uint32_t b) {
    const uint32_t n = p->n;
    const double *corner[MOST];
    double value[MOST][MOST], lambda[MOST], largest = 1.0;
    dm_placer place;
    dm_simplex_part part;
    for (uint32_t j = 0; j <= n; j++) corner[j] = q->points + ((size_t)b * (n + 1) + j) * n;
    if (dm_placer_make(&place, corner, n, n) != DM_OK) return 0.0;
    for (uint32_t j = 0; j <= n; j++) {
        dm_placer_place(&place, lambda, p->points + ((size_t)a * (n + 1) + j) * n);
        for (uint32_t i = 0; i <= n; i++) {
            value[i][j] = lambda[i];
            largest = fmax(largest, fabs(lambda[i]));
        }
    }
    dm_simplex_clip(&part, n, n, value, 1e-12 * largest);
    return part.share;
}

/* rows of all cells t that piece a of `to` belongs to */
static dm_status add_piece(dm_entries *out, const pieces *p, uint32_t a, const pieces *q,
                           dm_boxes *boxes, const dm_realization *from, const dm_realization *to,
                           const double *support, uint32_t k) {
    const uint32_t n = p->n;
    const double *corner[MOST];
    for (uint32_t j = 0; j <= n; j++) corner[j] = p->points + ((size_t)a * (n + 1) + j) * n;
    const uint32_t near = dm_boxes_near(boxes, corner, n + 1, 1e-9);
    for (uint32_t i = 0; i < near; i++) {
        const uint32_t b = boxes->found[i], s = q->cell[b];
        if (q->volume[b] == 0.0 || support[s] == 0.0) continue;
        const double both = overlap(p, a, q, b) * p->volume[a];
        const double sign = q->volume[b] < 0.0 ? -1.0 : 1.0;
        if (fabs(both) < 1e-14 * fabs(support[s])) continue;
        const double value = direction_sign(from, s, to, p->cell[a], k) * sign * both / support[s];
        if (!dm_entries_add(out, p->cell[a], s, value)) return DM_NO_MEMORY;
    }
    return DM_OK;
}

/* Supports |V_s| first, then every piece of `to` against the pieces of `from` beside it. */
dm_status dm_supports_transfer(dm_entries *out, const dm_realization *from,
                               const dm_realization *to, uint32_t k, dm_arena *scratch,
                               volatile const int *stop) {
    pieces p, q;
    dm_boxes boxes;
    dm_status status = make_pieces(&p, to, k, scratch);
    if (status == DM_OK) status = make_pieces(&q, from, k, scratch);
    if (status != DM_OK) return status;
    double *support = dm_arena_take(scratch, ((size_t)from->K->count[k] + 1) * sizeof *support);
    if (!support) return DM_NO_MEMORY;
    memset(support, 0, ((size_t)from->K->count[k] + 1) * sizeof *support);
    for (uint32_t b = 0; b < q.count; b++) support[q.cell[b]] += q.volume[b];
    status = dm_boxes_make(&boxes, scratch, q.vertex, q.count, q.n + 1, q.points, q.n);
    for (uint32_t a = 0; a < p.count && status == DM_OK; a++) {
        if (a % 64 == 0 && stop && *stop) return DM_STOPPED;
        if (p.volume[a] != 0.0) status = add_piece(out, &p, a, &q, &boxes, from, to, support, k);
    }
    return status;
}
