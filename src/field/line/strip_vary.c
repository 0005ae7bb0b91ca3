/* strip_vary.c - first variations of a run: the linearized equation of every slab. */
#include "field/line/strip_run.h"

#include <string.h>

/* output (row, column) of the second derivatives of cell i of a block */
static double entry(const dm_strip_room *room, uint32_t i, uint32_t row, uint32_t column) {
    const uint32_t n = room->strip->layout.values;
    return room->buffer[((size_t)row * 4 * n + column) * DM_CELL_BLOCK + i];
}

/* the node of input `column` of cell c, as an entry of a vector of all nodes */
static size_t at_of(const dm_strip *s, uint32_t c, uint32_t column) {
    const uint32_t n = s->layout.values, right = column / n % 2;
    return (size_t)(right ? dm_strip_right(s, c) : c) * n + column % n;
}

/* where that entry stands in the band */
static uint32_t place_of(const dm_strip *s, size_t at) {
    const uint32_t n = s->layout.values;
    return dm_strip_place(s, (uint32_t)(at / n)) * n + (uint32_t)(at % n);
}

/* cell i of the block at c: what the lower level does to the equations, and the matrix */
static void add_cell(dm_strip_room *room, uint32_t c, uint32_t i, const double *lower) {
    const dm_strip *s = room->strip;
    const uint32_t n = s->layout.values;
    for (uint32_t a = 0; a < dm_strip_rows(s); a++) {
        const uint32_t row = place_of(s, at_of(s, c + i, a));
        for (uint32_t b = 0; b < 2 * n; b++) {
            const size_t at = at_of(s, c + i, b);
            room->r[row] -= entry(room, i, a, b) * lower[at];
            room->A[dm_band_row(&room->band, row) + dm_band_column(&room->band, place_of(s, at))] +=
                entry(room, i, a, 2 * n + b);
        }
    }
}

/* cell i: what both levels do to the momenta of the upper one */
static void add_momenta(const dm_strip_room *room, uint32_t c, uint32_t i, const double *lower,
                        const double *upper, double *dp) {
    const dm_strip *s = room->strip;
    const uint32_t n = s->layout.values;
    for (uint32_t a = 0; a < 2 * n; a++)
        for (uint32_t b = 0; b < 2 * n; b++) {
            const size_t at = at_of(s, c + i, b);
            dp[at_of(s, c + i, a)] += entry(room, i, 2 * n + a, b) * lower[at] +
                                      entry(room, i, 2 * n + a, 2 * n + b) * upper[at];
        }
}

/* absorbing ends: the force -c/2 (upper - lower) of the lower equation */
static void add_forces(dm_strip_room *room, const double *lower) {
    const dm_strip *s = room->strip;
    const uint32_t n = s->layout.values;
    for (int side = 0; side < 2; side++)
        for (uint32_t k = 0; k < n && s->absorbs[side] != 0.0; k++) {
            const size_t at = (size_t)dm_strip_end(s, side) * n + k;
            const uint32_t row = place_of(s, at);
            room->r[row] -= 0.5 * s->absorbs[side] * lower[at];
            room->A[dm_band_row(&room->band, row) + dm_band_column(&room->band, row)] -=
                0.5 * s->absorbs[side];
        }
}

/* held values keep their variation */
static void hold(dm_strip_room *room, const double *lower) {
    const dm_strip *s = room->strip;
    const uint32_t n = room->band.n, w = room->band.width;
    for (uint32_t u = 0; u < n; u++) {
        if (!s->held[u]) continue;
        const uint32_t row = place_of(s, u), first = row > w ? row - w : 0;
        for (uint32_t j = first; j <= row + w && j < n; j++)
            room->A[dm_band_row(&room->band, row) + dm_band_column(&room->band, j)] = j == row;
        room->r[row] = lower[u];
    }
}

/* a pass over the cells: 0 the equation, 1 the momenta */
static void pass(dm_strip_room *room, const double *lower, const double *upper, double *dp) {
    const dm_strip *s = room->strip;
    for (uint32_t c = 0; c < s->cells; c += DM_CELL_BLOCK) {
        const uint32_t count = s->cells - c < DM_CELL_BLOCK ? s->cells - c : DM_CELL_BLOCK;
        dm_cell_map_run(&s->hessian, room->memory, room->scalars, room->buffer, c, count);
        for (uint32_t i = 0; i < count; i++) {
            if (upper)
                add_momenta(room, c, i, lower, upper, dp);
            else
                add_cell(room, c, i, lower);
        }
    }
}

/* A upper = -(dp + B lower), then dp = C lower + D upper; the matrix is that of Newton at the known
 * levels. */
static dm_status vary_slab(dm_strip_room *room, const double *lower, double *upper, double *dp) {
    const dm_strip *s = room->strip;
    const uint32_t n = room->band.n;
    memset(room->A, 0, dm_band_size(&room->band) * sizeof *room->A);
    memset(room->r, 0, n * sizeof *room->r);
    for (uint32_t u = 0; u < n && dp; u++) room->r[place_of(s, u)] = -dp[u];
    pass(room, lower, NULL, NULL);
    add_forces(room, lower);
    hold(room, lower);
    const dm_status status = dm_band_factor(room->A, room->pivot, &room->band);
    if (status != DM_OK) return status;
    dm_band_solve(room->r, room->A, room->pivot, &room->band, room->scratch);
    for (uint32_t u = 0; u < n; u++) upper[u] = room->r[place_of(s, u)];
    if (!dp) return DM_OK;
    memset(dp, 0, n * sizeof *dp);
    for (int side = 0; side < 2; side++)
        for (uint32_t k = 0; k < s->layout.values && s->absorbs[side] != 0.0; k++) {
            const size_t at = (size_t)dm_strip_end(s, side) * s->layout.values + k;
            dp[at] = -0.5 * s->absorbs[side] * (upper[at] - lower[at]);
        }
    pass(room, lower, upper, dp);
    return DM_OK;
}

/* Slab after slab; dp of one is that of the next. */
dm_status dm_strip_vary(dm_strip_room *room, const dm_strip_levels *along, double *v, double *dp) {
    const dm_strip *s = room->strip;
    const size_t n = dm_strip_unknowns(s);
    for (long k = 0; k + 1 < along->levels; k++) {
        dm_strip_put(room, 0, along->u + (size_t)k * n);
        dm_strip_put(room, dm_cell_upper(&s->layout, 0), along->u + (size_t)(k + 1) * n);
        dm_strip_set(room, DM_STRIP_TIME, along->t[k]);
        dm_strip_set(room, DM_STRIP_HEIGHT, along->t[k + 1] - along->t[k]);
        const dm_status status = vary_slab(room, v + (size_t)k * n, v + (size_t)(k + 1) * n, dp);
        if (status != DM_OK) return status;
    }
    return DM_OK;
}
