/* strip_limit.c - the height at which the fastest oscillation begins to grow.
 * An oscillation u + (-1)^k v is a motion where (S_ll + S_uu - S_lu - S_ul) v = 0. For small
 * heights that form has the signature of the kinetic energy; the first height at which it has
 * another one is the limit. */
#include "field/line/strip_run.h"

#include <float.h>
#include <math.h>
#include <string.h>

enum { HALVINGS = 60 };
static const double SMALLER = 1e-6; /* heights that are tried, from one to the next */
static const double RANGE = 1e24;   /* of heights, beside the width of a cell */

/* Cell c, number i of its block: what its corners a and b add: the left and the right node of the
 * lower level and, 2 and 3, of the upper one. What is of both levels counts against the rest. */
static void add_corners(dm_strip_room *room, uint32_t c, uint32_t i, uint32_t a, uint32_t b) {
    const dm_strip *s = room->strip;
    const uint32_t n = s->layout.values, node[2] = {c, dm_strip_right(s, c)};
    const uint32_t u = node[a % 2] * n, v = node[b % 2] * n;
    const uint32_t row = dm_strip_place(s, node[a % 2]) * n;
    const uint32_t column = dm_strip_place(s, node[b % 2]) * n;
    const double *part = room->buffer + ((size_t)a * n * 4 * n + b * n) * DM_CELL_BLOCK + i;
    for (uint32_t j = 0; j < n; j++, part += (size_t)4 * n * DM_CELL_BLOCK)
        for (uint32_t k = 0; k < n && !s->held[u + j]; k++) {
            const double x = part[(size_t)k * DM_CELL_BLOCK];
            if (s->held[v + k]) continue;
            room->A[dm_band_row(&room->band, row + j) + dm_band_column(&room->band, column + k)] +=
                a / 2 == b / 2 ? x : -x;
            room->r[row + j] += fabs(x);
        }
}

/* the form in the band of A, upper and lower part; held unknowns and their rows are those of 1. In
 * r the sum of the sizes of what was added up in each row, from which its round-off comes. */
static void assemble(dm_strip_room *room, double h) {
    const dm_strip *s = room->strip;
    const uint32_t n = s->layout.values;
    dm_strip_set(room, DM_STRIP_HEIGHT, h);
    memset(room->A, 0, dm_band_size(&room->band) * sizeof *room->A);
    memset(room->r, 0, room->band.n * sizeof *room->r);
    for (uint32_t c = 0; c < s->cells; c += DM_CELL_BLOCK) {
        const uint32_t count = s->cells - c < DM_CELL_BLOCK ? s->cells - c : DM_CELL_BLOCK;
        dm_cell_map_run(&s->hessian, room->memory, room->scalars, room->buffer, c, count);
        for (uint32_t i = 0; i < count; i++)
            for (uint32_t k = 0; k < 16; k++) add_corners(room, c + i, i, k / 4, k % 4);
    }
    for (uint32_t u = 0; u < room->band.n; u++) {
        const uint32_t row = dm_strip_place(s, u / n) * n + u % n;
        if (s->held[u])
            room->A[dm_band_row(&room->band, row) + dm_band_column(&room->band, row)] = 1.0;
    }
}

/* negative pivots of the symmetric band, by Sylvester's law; -1: one that is zero, or no more than
 * the round-off of n rows makes of its terms */
static long negatives(dm_strip_room *room) {
    const uint32_t n = room->band.n, w = room->band.width;
    const double round_off = DBL_EPSILON * (8.0 + n);
    long count = 0;
    for (uint32_t k = 0; k < n; k++) {
        double *column = room->A + dm_band_row(&room->band, 0) + dm_band_column(&room->band, k);
        const double pivot = column[k];
        const uint32_t last = k + w < n ? k + w : n - 1;
        if (!(fabs(pivot) > round_off * room->r[k])) return -1;
        count += pivot < 0.0;
        for (uint32_t j = k + 1; j <= last; j++) {
            double *target = room->A + dm_band_row(&room->band, 0) + dm_band_column(&room->band, j);
            const double part = target[k] / pivot;
            for (uint32_t i = k + 1; i <= last && part != 0.0; i++) target[i] -= part * column[i];
        }
    }
    return count;
}

/* of the form at height h */
static long signature(dm_strip_room *room, double h) {
    assemble(room, h);
    return negatives(room);
}

/* Does every unknown have kinetic energy, a form that grows as 1/h for small heights? */
static int is_kinetic(dm_strip_room *room, double h) {
    for (int half = 0; half < 2; half++) {
        assemble(room, half ? 0.5 * h : h);
        for (uint32_t u = 0; u < room->band.n; u++) {
            const uint32_t n = room->strip->layout.values;
            const uint32_t row = dm_strip_place(room->strip, u / n) * n + u % n;
            const double diagonal =
                room->A[dm_band_row(&room->band, row) + dm_band_column(&room->band, row)];
            if (half && !room->strip->held[u] && !(fabs(diagonal) > 1.5 * fabs(room->dx[u])))
                return 0;
            room->dx[u] = diagonal;
        }
    }
    return 1;
}

/* A height of `unit` or below at which the form is that of the kinetic energy: it grows as 1/h, and
 * its signature stays. 0: there is none. */
static double find_small(dm_strip_room *room, double unit, long *kinetic) {
    for (double h = SMALLER * unit; h > unit / RANGE; h *= SMALLER) {
        if (!is_kinetic(room, h)) continue;
        *kinetic = signature(room, h);
        if (*kinetic >= 0 && signature(room, 0.5 * h) == *kinetic) return h;
    }
    return 0.0;
}

/* Is the kinetic energy of both signs? Oscillations of either may then become motions in pairs that
 * leave the signature as it is. */
static int is_mixed(const dm_strip *s, long kinetic) {
    long all = 0;
    for (uint32_t u = 0; u < dm_strip_unknowns(s); u++) all += !s->held[u];
    return kinetic > 0 && kinetic < all;
}

/* Up by half as much again until the signature changes, then bisection to round-off. Where the form
 * is left with round-off alone, as of rules that do not see potentials in (-1)^k, it never does: no
 * height is too large. */
double dm_strip_limit(dm_strip_room *room, const double *u, double unit) {
    dm_strip_put(room, 0, u);
    dm_strip_put(room, dm_cell_upper(&room->strip->layout, 0), u);
    dm_strip_set(room, DM_STRIP_TIME, 0.0);
    long kinetic = 0;
    double low = find_small(room, unit, &kinetic), high = low;
    if (low == 0.0) return NAN;
    long now = kinetic;
    while (high < RANGE * unit && now == kinetic)
        low = high, high *= 1.5, now = signature(room, high);
    if (now == kinetic || now < 0) return is_mixed(room->strip, kinetic) ? -1.0 : INFINITY;
    for (int k = 0; k < HALVINGS && high - low > 1e-15 * high; k++) {
        const double middle = 0.5 * (low + high);
        if (signature(room, middle) == kinetic)
            low = middle;
        else
            high = middle;
    }
    return 0.5 * (low + high);
}
