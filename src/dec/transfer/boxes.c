/* boxes.c - counting sort of simplices into bins. */
#include "dec/transfer/boxes.h"

#include <math.h>
#include <string.h>

/* bins from first[axis] to last[axis] */
typedef struct {
    uint32_t first[DM_BOX_AXES], last[DM_BOX_AXES];
} range;

/* Points outside of the grid belong to its outermost bins, so no simplex is ever without one. */
static uint32_t bin_of(const dm_boxes *b, uint32_t axis, double x) {
    const double place = (x - b->low[axis]) * b->scale[axis];
    if (!(place > 0.0)) return 0;
    const double most = b->bins[axis] - 1;
    return (uint32_t)(place < most ? place : most);
}

/* of a box */
static range bins_of(const dm_boxes *b, const double *low, const double *high) {
    range r = {{0}, {0}};
    for (uint32_t a = 0; a < b->axes; a++) {
        r.first[a] = bin_of(b, a, low[a]);
        r.last[a] = bin_of(b, a, high[a]);
    }
    return r;
}

/* the box grows to hold x; only the coordinates of the grid count */
static void widen(double *low, double *high, const double *x, uint32_t axes) {
    for (uint32_t a = 0; a < axes; a++) {
        low[a] = fmin(low[a], x[a]);
        high[a] = fmax(high[a], x[a]);
    }
}

/* those that the bounding box of a simplex meets: more than the simplex does, which only costs */
static range simplex_bins(const dm_boxes *b, uint32_t i) {
    double low[DM_BOX_AXES] = {INFINITY, INFINITY, INFINITY},
           high[DM_BOX_AXES] = {-INFINITY, -INFINITY, -INFINITY};
    for (uint32_t j = 0; j < b->size; j++)
        widen(low, high, b->points + (size_t)b->vertex[(size_t)i * b->size + j] * b->N, b->axes);
    return bins_of(b, low, high);
}

/* numbers of the bins of a range, one after the other: *at is the next, 0 at the end */
static int next_bin(const dm_boxes *b, const range *r, uint32_t at[DM_BOX_AXES], size_t *bin) {
    *bin = ((size_t)at[2] * b->bins[1] + at[1]) * b->bins[0] + at[0];
    for (uint32_t a = 0; a < DM_BOX_AXES; a++) {
        if (at[a]++ < r->last[a]) return 1;
        at[a] = r->first[a];
    }
    return 0;
}

/* As many bins as simplices, at most, in proportion to the sides. */
static void choose_bins(dm_boxes *b, uint32_t vertices_of_all) {
    double high[DM_BOX_AXES] = {-INFINITY, -INFINITY, -INFINITY}, longest = 0.0;
    for (uint32_t a = 0; a < DM_BOX_AXES; a++) b->low[a] = INFINITY, b->bins[a] = 1;
    for (uint32_t i = 0; i < vertices_of_all; i++)
        widen(b->low, high, b->points + (size_t)b->vertex[i] * b->N, b->axes);
    for (uint32_t a = 0; a < b->axes; a++) longest = fmax(longest, high[a] - b->low[a]);
    double product = 1.0;
    uint32_t wide = 0;
    for (uint32_t a = 0; a < b->axes; a++) {
        const double side = (high[a] - b->low[a]) / (longest > 0.0 ? longest : 1.0);
        if (side > 1e-3) product *= side, wide++;
    }
    const double across = wide ? pow((double)b->count / product, 1.0 / wide) : 1.0;
    for (uint32_t a = 0; a < b->axes; a++) {
        const double side = high[a] - b->low[a];
        const double bins = fmin(1024.0, floor(across * side / (longest > 0.0 ? longest : 1.0)));
        b->bins[a] = bins > 1.0 ? (uint32_t)bins : 1;
        b->scale[a] = side > 0.0 ? b->bins[a] / side : 0.0;
    }
}

/* Twice over all simplices: the first time to count what each bin holds, the second to fill it.
 * start[] is shifted by one bin while it is filled, so that it ends where it belongs. */
dm_status dm_boxes_make(dm_boxes *b, dm_arena *arena, const uint32_t *vertex, uint32_t count,
                        uint32_t size, const double *points, uint32_t N) {
    *b = (dm_boxes){.N = N, .size = size, .count = count, .vertex = vertex, .points = points};
    b->axes = N < DM_BOX_AXES ? N : DM_BOX_AXES;
    choose_bins(b, count * size);
    const size_t bins = (size_t)b->bins[0] * b->bins[1] * b->bins[2];
    b->start = dm_arena_take(arena, (bins + 2) * sizeof *b->start);
    b->stamp = dm_arena_take(arena, ((size_t)count + 1) * sizeof *b->stamp);
    b->found = dm_arena_take(arena, ((size_t)count + 1) * sizeof *b->found);
    if (!b->start || !b->stamp || !b->found) return DM_NO_MEMORY;
    memset(b->stamp, 0, ((size_t)count + 1) * sizeof *b->stamp);
    memset(b->start, 0, (bins + 2) * sizeof *b->start);
    for (int fill = 0; fill < 2; fill++) {
        for (uint32_t i = 0; i < count; i++) {
            const range r = simplex_bins(b, i);
            uint32_t at[DM_BOX_AXES] = {r.first[0], r.first[1], r.first[2]};
            size_t bin;
            for (int more = 1; more;) {
                more = next_bin(b, &r, at, &bin);
                if (fill)
                    b->item[b->start[bin + 1]++] = i;
                else
                    b->start[bin + 2]++;
            }
        }
        if (fill) break;
        for (size_t k = 0; k < bins; k++) b->start[k + 2] += b->start[k + 1];
        b->item = dm_arena_take(arena, ((size_t)b->start[bins + 1] + 1) * sizeof *b->item);
        if (!b->item) return DM_NO_MEMORY;
    }
    return DM_OK;
}

/* A simplex stands in every bin that it meets; its stamp says that this query has it already. */
uint32_t dm_boxes_near(dm_boxes *b, const double *const *at, uint32_t many, double margin) {
    double low[DM_BOX_AXES] = {INFINITY, INFINITY, INFINITY},
           high[DM_BOX_AXES] = {-INFINITY, -INFINITY, -INFINITY}, side = 0.0;
    for (uint32_t j = 0; j < many; j++) widen(low, high, at[j], b->axes);
    for (uint32_t a = 0; a < b->axes; a++) side = fmax(side, high[a] - low[a]);
    for (uint32_t a = 0; a < b->axes; a++) {
        const double wider = margin * side + 1e-9 / (b->scale[a] > 0.0 ? b->scale[a] : 1.0);
        low[a] -= wider;
        high[a] += wider;
    }
    const range r = bins_of(b, low, high);
    uint32_t place[DM_BOX_AXES] = {r.first[0], r.first[1], r.first[2]}, count = 0;
    size_t bin;
    b->now++;
    for (int more = 1; more;) {
        more = next_bin(b, &r, place, &bin);
        for (uint32_t k = b->start[bin]; k < b->start[bin + 1]; k++) {
            const uint32_t i = b->item[k];
            if (b->stamp[i] == b->now) continue;
            b->stamp[i] = b->now;
            b->found[count++] = i;
        }
    }
    return count;
}
