/* strip_laws.c - conservation laws of a run, node by node: sums over the boundary of the cells
 * around a node, which are zero where its equation holds and each cell has the symmetry. */
#include "base/largest.h"
#include "field/line/strip_run.h"

#include <math.h>
#include <string.h>

/* the corners of a cell, as slopes count them */
enum { LOWER_LEFT, LOWER_RIGHT, UPPER_LEFT, UPPER_RIGHT, CORNERS };

/* which slab of the run is read */
typedef struct {
    const dm_strip_law *law;
    long slab; /* its lower level */
} place;

/* entry of a vector of all nodes and levels for value k at a corner of cell c */
static size_t at_of(const dm_strip *s, const place *at, uint32_t c, uint32_t corner, uint32_t k) {
    const uint32_t n = s->layout.values, node = corner % 2 ? dm_strip_right(s, c) : c;
    const size_t level = (size_t)at->slab + corner / 2;
    return level * dm_strip_unknowns(s) + (size_t)node * n + k;
}

/* S_corner . xi at a corner of cell i of the block at c; *size: at least the sum of its terms
 * without signs */
static double current(const dm_strip_room *room, const place *at, uint32_t c, uint32_t i,
                      uint32_t corner, double *size) {
    const uint32_t n = room->strip->layout.values;
    double sum = 0.0, all = 0.0;
    for (uint32_t k = 0; k < n; k++) {
        const double term = room->buffer[(size_t)(corner * n + k) * DM_CELL_BLOCK + i] *
                            at->law->xi[at_of(room->strip, at, c + i, corner, k)];
        sum += term;
        all += fabs(term);
    }
    *size = dm_largest(*size, all);
    return sum;
}

/* d(S_corner)(v) w - d(S_corner)(w) v there */
static double form(const dm_strip_room *room, const place *at, uint32_t c, uint32_t i,
                   uint32_t corner, double *size) {
    const uint32_t n = room->strip->layout.values;
    const double *v = at->law->v, *w = at->law->w;
    double sum = 0.0, all = 0.0;
    for (uint32_t k = 0; k < n; k++) {
        const size_t own = at_of(room->strip, at, c + i, corner, k);
        double dv = 0.0, dw = 0.0, terms = 0.0;
        for (uint32_t b = 0; b < 4 * n; b++) {
            const double h =
                room->buffer[((size_t)(corner * n + k) * 4 * n + b) * DM_CELL_BLOCK + i];
            const size_t other = at_of(room->strip, at, c + i, b / n, b % n);
            dv += h * v[other];
            dw += h * w[other];
            terms += fabs(h * v[other] * w[own]) + fabs(h * w[other] * v[own]);
        }
        sum += dv * w[own] - dw * v[own];
        all += terms;
    }
    *size = dm_largest(*size, all);
    return sum;
}

/* corners[CORNERS][cells] of a slab */
static void read_slab(dm_strip_room *room, const dm_strip_levels *along, const place *at,
                      double *corners, double *size) {
    const dm_strip *s = room->strip;
    const size_t n = dm_strip_unknowns(s);
    const dm_cell_map *map = at->law->xi ? &s->slopes : &s->hessian;
    dm_strip_put(room, 0, along->u + (size_t)at->slab * n);
    dm_strip_put(room, dm_cell_upper(&s->layout, 0), along->u + (size_t)(at->slab + 1) * n);
    dm_strip_set(room, DM_STRIP_TIME, along->t[at->slab]);
    dm_strip_set(room, DM_STRIP_HEIGHT, along->t[at->slab + 1] - along->t[at->slab]);
    for (uint32_t c = 0; c < s->cells; c += DM_CELL_BLOCK) {
        const uint32_t count = s->cells - c < DM_CELL_BLOCK ? s->cells - c : DM_CELL_BLOCK;
        dm_cell_map_run(map, room->memory, room->scalars, room->buffer, c, count);
        for (uint32_t i = 0; i < count; i++)
            for (uint32_t k = 0; k < CORNERS; k++)
                corners[(size_t)k * s->cells + c + i] =
                    at->law->xi ? current(room, at, c, i, k, size) : form(room, at, c, i, k, size);
    }
}

/* all corners of cell c but the one at the node */
static double beside(const double *corners, uint32_t cells, uint32_t c, uint32_t node_corner) {
    double sum = 0.0;
    for (uint32_t k = 0; k < CORNERS; k++)
        if (k != node_corner) sum += corners[(size_t)k * cells + c];
    return sum;
}

/* the boundary sum around node i between two slabs; an end of an open line has two cells */
static double around(const dm_strip *s, const double *below, const double *above, uint32_t i) {
    const int ring = dm_strip_is_ring(s);
    double sum = 0.0;
    if (ring || i < s->cells)
        sum += beside(below, s->cells, i, UPPER_LEFT) + beside(above, s->cells, i, LOWER_LEFT);
    if (ring || i > 0) {
        const uint32_t left = i > 0 ? i - 1 : s->cells - 1;
        sum +=
            beside(below, s->cells, left, UPPER_RIGHT) + beside(above, s->cells, left, LOWER_RIGHT);
    }
    return sum;
}

/* Two slabs at a time: the corners of the upper one are those of the lower one next. */
double dm_strip_residual(dm_strip_room *room, const dm_strip_levels *along, const dm_strip_law *law,
                         double area, double *size) {
    const dm_strip *s = room->strip;
    double *below = room->corners, *above = below + CORNERS * (size_t)s->cells, largest = 0.0;
    *size = 0.0;
    for (long k = 0; k + 1 < along->levels; k++) {
        const place at = {law, k};
        read_slab(room, along, &at, above, size);
        for (uint32_t i = 0; i < s->nodes && k > 0; i++)
            if (!law->leave[i]) largest = dm_largest(largest, around(s, below, above, i) / area);
        double *last = below;
        below = above;
        above = last;
    }
    *size /= area;
    return largest;
}
