/* transfer.c - cells of one mesh against the top cells of the other one. */
#include "dec/transfer/transfer.h"

#include "dec/transfer/boxes.h"
#include "dec/transfer/entries.h"
#include "dec/transfer/simplex.h"
#include "dec/transfer/supports.h"

#include <math.h>

enum { MOST = DM_SIMPLEX_VERTICES };

/* barycentric coordinates below it are 0, beside the largest; distances from a plane, beside the
 * size of the cell; what may be missing of a cell */
static const double ZERO = 1e-10, FLAT = 1e-7, COVERED = 1e-7;

/* a transfer on its way */
typedef struct {
    const dm_realization *from, *to;
    uint32_t k;
    dm_boxes boxes;
    dm_entries entries;
    uint32_t *tops[MOST]; /* [count[d]] of `from`: how many top cells each cell lies in */
} transfer;

static const double *point_of(const dm_realization *r, uint32_t vertex) {
    return r->points + (size_t)vertex * r->N;
}

/* the points of a cell */
static void points_of(const dm_realization *r, uint32_t k, uint32_t cell, const double *at[MOST]) {
    uint32_t room[DM_DIMENSION + 1];
    const uint32_t *vertex = dm_complex_vertices(r->K, k, cell, room);
    for (uint32_t j = 0; j <= k; j++) at[j] = point_of(r, vertex[j]);
}

/* Ready to place points in a cell; 0 where it is degenerate, as no cell of a metric is. */
static int open_cell(dm_placer *p, const dm_realization *r, uint32_t k, uint32_t cell) {
    const double *at[MOST];
    points_of(r, k, cell, at);
    return dm_placer_make(p, at, k, r->N) == DM_OK;
}

/* value[i][j] = barycentric coordinate i of vertex j; *least: below it a value is 0. 0 where the
 * vertices are not in the plane of the cell. */
static int place_cell(const dm_placer *p, const double *const *at, uint32_t many,
                      double value[MOST][MOST], double *least) {
    double lambda[MOST], largest = 1.0;
    for (uint32_t j = 0; j < many; j++) {
        if (dm_placer_place(p, lambda, at[j]) > FLAT * p->size) return 0;
        for (uint32_t i = 0; i <= p->n; i++) {
            value[i][j] = lambda[i];
            largest = fmax(largest, fabs(lambda[i]));
        }
    }
    *least = ZERO * largest;
    return 1;
}

/* ---- Whitney ---- */

/* how many top cells share the face of `top` in which all of a cell lies */
static uint32_t sharing(const transfer *t, uint32_t top, const double value[MOST][MOST],
                        double least) {
    const uint32_t n = t->from->K->n;
    uint32_t face = 0, degree = 0;
    for (uint32_t i = 0; i <= n; i++) {
        int zero = 1;
        for (uint32_t j = 0; j <= t->k; j++) zero = zero && fabs(value[i][j]) <= least;
        if (!zero) face |= 1u << i, degree++;
    }
    if (degree == n + 1 || !degree) return 1;
    return t->tops[degree - 1][dm_complex_face(t->from->K, n, top, face)];
}

/* The integral of the Whitney form of a face over a part: share times the determinant of values at
 * its centre and slopes along the cell. */
static double integral(const dm_simplex_part *part, uint32_t k, const uint32_t *face,
                       const double value[MOST][MOST]) {
    double a[MOST][MOST];
    for (uint32_t i = 0; i <= k; i++) {
        a[i][0] = 0.0;
        for (uint32_t j = 0; j <= k; j++) a[i][0] += part->centre[j] * value[face[i]][j];
        for (uint32_t j = 1; j <= k; j++) a[i][j] = value[face[i]][j] - value[face[i]][0];
    }
    return part->share * dm_determinant(a, k + 1);
}

/* the k-faces of top cell `top`, each with its integral */
static int add_whitney(transfer *t, uint32_t cell, uint32_t top, const dm_simplex_part *part,
                       const double value[MOST][MOST], double weight) {
    const uint32_t n = t->from->K->n, k = t->k;
    for (uint32_t set = 1; set < 2u << n; set++) {
        uint32_t face[MOST], size = 0;
        for (uint32_t i = 0; i <= n && size <= k + 1; i++)
            if (set >> i & 1) {
                if (size <= k) face[size] = i;
                size++;
            }
        if (size != k + 1) continue;
        const double x = weight * integral(part, k, face, value);
        if (fabs(x) < 1e-15) continue;
        if (!dm_entries_add(&t->entries, cell, dm_complex_face(t->from->K, n, top, set), x))
            return 0;
    }
    return 1;
}

/* one cell of `to`; *covered: the share of it that was found */
static dm_status whitney_cell(transfer *t, uint32_t cell, double *covered) {
    const double *at[MOST];
    double value[MOST][MOST], least;
    points_of(t->to, t->k, cell, at);
    const uint32_t near = dm_boxes_near(&t->boxes, at, t->k + 1, 1e-6);
    *covered = 0.0;
    for (uint32_t q = 0; q < near; q++) {
        const uint32_t top = t->boxes.found[q];
        dm_placer p;
        dm_simplex_part part;
        if (!open_cell(&p, t->from, t->from->K->n, top)) return DM_SINGULAR;
        if (!place_cell(&p, at, t->k + 1, value, &least)) continue;
        dm_simplex_clip(&part, t->k, p.n, value, least);
        if (!(part.share > 0.0)) continue;
        const double weight = 1.0 / sharing(t, top, value, least);
        *covered += weight * part.share;
        if (!add_whitney(t, cell, top, &part, value, weight)) return DM_NO_MEMORY;
    }
    return DM_OK;
}

/* tops[d][cell] */
static dm_status count_tops(transfer *t, dm_arena *scratch) {
    const dm_complex *K = t->from->K;
    for (uint32_t d = 0; d <= K->n; d++) {
        t->tops[d] = dm_arena_take(scratch, ((size_t)K->count[d] + 1) * sizeof **t->tops);
        if (!t->tops[d]) return DM_NO_MEMORY;
        for (uint32_t i = 0; i < K->count[d]; i++) t->tops[d][i] = 0;
    }
    for (uint32_t top = 0; top < K->count[K->n]; top++)
        for (uint32_t set = 1; set < 2u << K->n; set++) {
            uint32_t size = 0;
            for (uint32_t rest = set; rest; rest &= rest - 1) size++;
            t->tops[size - 1][dm_complex_face(K, K->n, top, set)]++;
        }
    return DM_OK;
}

/* ---- sum ---- */

/* the cells of `from` inside of one of `to`, with the signs of their directions against its own */
static dm_status sum_cell(transfer *t, uint32_t cell, double *covered) {
    const double *at[MOST], *inner[MOST];
    double value[MOST][MOST], least;
    dm_placer p;
    points_of(t->to, t->k, cell, at);
    *covered = 0.0;
    if (!open_cell(&p, t->to, t->k, cell)) return DM_SINGULAR;
    const uint32_t near = dm_boxes_near(&t->boxes, at, t->k + 1, 1e-6);
    for (uint32_t q = 0; q < near; q++) {
        const uint32_t part = t->boxes.found[q];
        points_of(t->from, t->k, part, inner);
        if (t->k == 0) p.size = t->boxes.scale[0] > 0.0 ? 1.0 / t->boxes.scale[0] : 1.0;
        if (!place_cell(&p, inner, t->k + 1, value, &least)) continue;
        int inside = 1;
        for (uint32_t i = 0; i <= t->k; i++)
            for (uint32_t j = 0; j <= t->k; j++) inside = inside && value[i][j] >= -least;
        if (!inside) continue;
        const double share = dm_determinant(value, t->k + 1);
        *covered += fabs(share);
        if (!dm_entries_add(&t->entries, cell, part, share < 0.0 ? -1.0 : 1.0)) return DM_NO_MEMORY;
    }
    return DM_OK;
}

/* ---- all cells ---- */

/* [count[k]][k + 1]: those of the complex, or made in the arena; NULL without memory */
static const uint32_t *all_vertices(const dm_complex *K, uint32_t k, dm_arena *arena) {
    const size_t length = k + 1;
    if (K->vertex[k]) return K->vertex[k];
    uint32_t *out = dm_arena_take(arena, K->count[k] * length * sizeof *out);
    for (uint32_t i = 0; out && i < K->count[k]; i++)
        dm_complex_vertices(K, k, i, out + i * length);
    return out;
}

/* bins of the cells that those of `to` are compared with: top cells, or for sums the k-cells */
static dm_status open_transfer(transfer *t, dm_transfer_rule rule, dm_arena *scratch) {
    const uint32_t d = rule == DM_TRANSFER_SUM ? t->k : t->from->K->n;
    const uint32_t *vertex = all_vertices(t->from->K, d, scratch);
    if (!vertex) return DM_NO_MEMORY;
    const dm_status status = dm_boxes_make(&t->boxes, scratch, vertex, t->from->K->count[d], d + 1,
                                           t->from->points, t->from->N);
    if (status != DM_OK || rule != DM_TRANSFER_WHITNEY) return status;
    return count_tops(t, scratch);
}

dm_status dm_transfer(dm_sparse *out, dm_arena *arena, dm_arena *work, const dm_realization *from,
                      const dm_realization *to, uint32_t k, dm_transfer_rule rule,
                      volatile const int *stop, dm_transfer_report *report) {
    transfer t = {.from = from, .to = to, .k = k, .entries.arena = work};
    dm_status status = rule == DM_TRANSFER_THESIS
                           ? dm_supports_transfer(&t.entries, from, to, k, work, stop)
                           : open_transfer(&t, rule, work);
    const uint32_t cells = rule == DM_TRANSFER_THESIS ? 0 : to->K->count[k];
    for (uint32_t cell = 0; cell < cells && status == DM_OK; cell++) {
        double covered = 0.0;
        if (cell % 64 == 0 && stop && *stop) return DM_STOPPED;
        status = rule == DM_TRANSFER_SUM ? sum_cell(&t, cell, &covered)
                                         : whitney_cell(&t, cell, &covered);
        if (status == DM_OK && fabs(covered - 1.0) > COVERED) status = DM_SINGULAR;
        *report = (dm_transfer_report){cell, covered};
    }
    if (status != DM_OK) return status;
    return dm_sparse_assemble(out, arena, (int32_t)to->K->count[k], (int32_t)from->K->count[k],
                              (int64_t)t.entries.count, t.entries.row, t.entries.column,
                              t.entries.value);
}
