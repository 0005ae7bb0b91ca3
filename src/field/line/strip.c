/* strip.c - memory of a strip, levels to and from vectors, sums over cells. Sums run from the first
 * cell to the last on every backend. */
#include "field/line/strip.h"

#include <math.h>
#include <string.h>

/* The last group of lanes reads one entry beyond its cells, the right node. */
uint32_t dm_strip_stride(uint32_t cells) {
    return ((cells + 8) & ~7u) + 2 * DM_ARRAY_GROUP;
}

/* how far blocks that meet are apart: neighbours, in a folded ring those next but one */
static uint32_t width_of(const dm_strip *s) {
    const uint32_t n = s->layout.values, apart = dm_strip_is_ring(s) ? 2 : 1;
    const uint32_t most = s->nodes * n - 1, width = (apart + 1) * n - 1;
    return width < most ? width : most;
}

/* outputs of the map that has most */
static uint32_t most_outputs(const dm_strip *s) {
    const uint32_t outputs[] = {s->equation.outputs, s->tangent.outputs, s->after.outputs,
                                s->energy.outputs,   s->clock.outputs,   s->hessian.outputs,
                                s->slopes.outputs};
    uint32_t most = 1;
    for (size_t k = 0; k < sizeof outputs / sizeof *outputs; k++)
        most = outputs[k] > most ? outputs[k] : most;
    return most;
}

/* Padding behind the nodes is read, too, by lanes whose outputs nobody takes. */
static double *zeros(dm_arena *arena, size_t count) {
    double *x = dm_arena_take(arena, count * sizeof *x);
    if (x) memset(x, 0, count * sizeof *x);
    return x;
}

/* Order of the band is that of dm_strip_place already: its own is the identity. */
int dm_strip_open(dm_strip_room *room, const dm_strip *strip, dm_arena *arena) {
    const uint32_t n = dm_strip_unknowns(strip);
    *room = (dm_strip_room){.strip = strip, .band = {.n = n, .width = width_of(strip)}};
    room->memory = zeros(arena, dm_cell_memory(&strip->layout));
    room->scalars = zeros(arena, (size_t)strip->layout.scalars * DM_ARRAY_GROUP);
    room->buffer = zeros(arena, (size_t)most_outputs(strip) * DM_CELL_BLOCK + DM_CELL_BLOCK);
    room->A = zeros(arena, dm_band_size(&room->band));
    double *vectors = zeros(arena, 4 * (size_t)n);
    room->old = zeros(arena, 2 * dm_cell_upper(&strip->layout, 0));
    uint32_t *numbers = dm_arena_take(arena, 2 * (size_t)n * sizeof *numbers);
    if (!room->memory || !room->scalars || !room->buffer || !room->A || !vectors || !room->old ||
        !numbers)
        return 0;
    room->p = vectors;
    room->r = vectors + n;
    room->dx = vectors + 2 * (size_t)n;
    room->scratch = vectors + 3 * (size_t)n;
    room->pivot = numbers;
    room->order = numbers + n;
    for (uint32_t i = 0; i < n; i++) room->order[i] = i;
    room->band.order = room->order;
    return 1;
}

int dm_strip_open_heights(dm_strip_room *room, dm_arena *arena) {
    const size_t n = room->band.n;
    if (!room->z) room->z = zeros(arena, 2 * n);
    room->slope = room->z ? room->z + n : NULL;
    return room->z != NULL;
}

int dm_strip_open_laws(dm_strip_room *room, dm_arena *arena) {
    if (!room->corners) room->corners = zeros(arena, 8 * (size_t)room->strip->cells);
    return room->corners != NULL;
}

/* x at `level`; on a ring the first node once more behind the last, so that every cell has a right
 * one */
static void put(const dm_strip *s, double *level, const double *x) {
    const uint32_t n = s->layout.values;
    for (uint32_t k = 0; k < n; k++) {
        double *to = level + (size_t)k * s->layout.stride;
        for (uint32_t i = 0; i < s->nodes; i++) to[i] = x[(size_t)i * n + k];
        if (dm_strip_is_ring(s)) to[s->nodes] = to[0];
    }
}

/* the other way, without the node that a ring has twice */
static void get(const dm_strip *s, const double *level, double *x) {
    const uint32_t n = s->layout.values;
    for (uint32_t k = 0; k < n; k++) {
        const double *from = level + (size_t)k * s->layout.stride;
        for (uint32_t i = 0; i < s->nodes; i++) x[(size_t)i * n + k] = from[i];
    }
}

void dm_strip_put(dm_strip_room *room, size_t level, const double *x) {
    put(room->strip, room->memory + level, x);
}

void dm_strip_get(const dm_strip_room *room, size_t level, double *x) {
    get(room->strip, room->memory + level, x);
}

/* where level `number` of those before is */
static double *old_level(const dm_strip_room *room, int number) {
    return room->old + (size_t)number * dm_cell_upper(&room->strip->layout, 0);
}

void dm_strip_put_old(dm_strip_room *room, int number, const double *x) {
    put(room->strip, old_level(room, number), x);
}

void dm_strip_get_old(const dm_strip_room *room, int number, double *x) {
    get(room->strip, old_level(room, number), x);
}

/* Scalars of array loops have a copy for every lane. */
void dm_strip_set(dm_strip_room *room, uint32_t k, double x) {
    for (uint32_t i = 0; i < DM_ARRAY_GROUP; i++) room->scalars[k * DM_ARRAY_GROUP + i] = x;
}

/* cells of the block that begins with cell c */
static uint32_t block_of(const dm_strip *s, uint32_t c) {
    return s->cells - c < DM_CELL_BLOCK ? s->cells - c : DM_CELL_BLOCK;
}

/* Left and right node of every cell, in the order of the cells. */
void dm_strip_collect(dm_strip_room *room, const dm_cell_map *f, uint32_t first, double *out) {
    const dm_strip *s = room->strip;
    const uint32_t n = s->layout.values;
    for (uint32_t c = 0; c < s->cells; c += DM_CELL_BLOCK) {
        const uint32_t count = block_of(s, c);
        dm_cell_map_run(f, room->memory, room->scalars, room->buffer, c, count);
        for (uint32_t k = 0; k < n; k++) {
            const double *left = room->buffer + (size_t)(first + k) * DM_CELL_BLOCK;
            const double *right = left + (size_t)n * DM_CELL_BLOCK;
            for (uint32_t i = 0; i < count; i++) {
                out[(size_t)(c + i) * n + k] += left[i];
                out[(size_t)dm_strip_right(s, c + i) * n + k] += right[i];
            }
        }
    }
}

/* One number after the other: lanes have no part in the order of the sum. */
void dm_strip_sum(dm_strip_room *room, const dm_cell_map *f, uint32_t count, double *out) {
    const dm_strip *s = room->strip;
    memset(out, 0, count * sizeof *out);
    for (uint32_t c = 0; c < s->cells; c += DM_CELL_BLOCK) {
        const uint32_t cells = block_of(s, c);
        dm_cell_map_run(f, room->memory, room->scalars, room->buffer, c, cells);
        for (uint32_t k = 0; k < count; k++)
            for (uint32_t i = 0; i < cells; i++) out[k] += room->buffer[k * DM_CELL_BLOCK + i];
    }
}

/* In the order of the cells. */
double dm_strip_size(dm_strip_room *room, const dm_cell_map *f) {
    const dm_strip *s = room->strip;
    double sum = 0.0;
    for (uint32_t c = 0; c < s->cells; c += DM_CELL_BLOCK) {
        const uint32_t cells = block_of(s, c);
        dm_cell_map_run(f, room->memory, room->scalars, room->buffer, c, cells);
        for (uint32_t i = 0; i < cells; i++) sum += fabs(room->buffer[i]);
    }
    return sum;
}

/* S_upper, and half of the force -c u_t over the slab. */
void dm_strip_momenta(dm_strip_room *room, double *p) {
    const dm_strip *s = room->strip;
    const uint32_t n = s->layout.values;
    memset(p, 0, dm_strip_unknowns(s) * sizeof *p);
    dm_strip_collect(room, &s->after, 0, p);
    for (int side = 0; side < 2; side++) {
        const uint32_t i = dm_strip_end(s, side);
        for (uint32_t k = 0; k < n && s->absorbs[side] != 0.0; k++)
            p[(size_t)i * n + k] -= 0.5 * s->absorbs[side] * dm_strip_moved(room, i, k);
    }
}
