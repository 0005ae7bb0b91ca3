/* ring.c - see ring.h */
#include "dec/levi_civita/ring.h"

#include "dec/cell.h"

/* the vertices of a top cell that the cell has not: their places a < b */
static void sides_of(uint32_t *side, const dm_complex *K, uint32_t top, const uint32_t *vertex) {
    const uint32_t n = K->n, *v = K->vertex[n] + (size_t)top * (n + 1);
    uint32_t found = 0;
    for (uint32_t j = 0, at = 0; j <= n; j++) {
        if (at < n - 1 && v[j] == vertex[at])
            at++;
        else if (found < 2)
            side[found++] = j;
    }
}

/* the other top cell at the facet opposite to vertex `place` of `top`; UINT32_MAX at the boundary,
 * the cell itself where there are more than two */
static uint32_t across(const dm_complex *K, uint32_t top, uint32_t place) {
    const uint32_t n = K->n, facet = K->face[n][(size_t)top * (n + 1) + place];
    const uint32_t first = K->coface_at[n - 1][facet], last = K->coface_at[n - 1][facet + 1];
    if (last - first == 1) return UINT32_MAX;
    if (last - first > 2) return top;
    const uint32_t *two = K->coface[n - 1] + first;
    return two[0] == top ? two[1] : two[0];
}

/* the place of the side that the next facet lies opposite to, in the first top cell */
static uint32_t first_place(const dm_complex *K, uint32_t top, const uint32_t *side) {
    const uint32_t all = (2u << K->n) - 1, two = 1u << side[0] | 1u << side[1];
    int sign = dm_parity(all & ~two, two);
    if (K->orientation) sign *= K->orientation[top];
    return side[sign > 0 ? 0 : 1];
}

/* the least top cell of the facets at the cell */
static uint32_t first_top(const dm_complex *K, uint32_t cell) {
    const uint32_t n = K->n, k = n - 2;
    uint32_t least = UINT32_MAX;
    for (uint32_t i = K->coface_at[k][cell]; i < K->coface_at[k][cell + 1]; i++) {
        const uint32_t facet = K->coface[k][i], at = K->coface_at[n - 1][facet];
        if (at < K->coface_at[n - 1][facet + 1] && K->coface[n - 1][at] < least)
            least = K->coface[n - 1][at];
    }
    return least;
}

dm_ring_kind dm_ring(uint32_t *ring, uint32_t *length, const dm_complex *K, uint32_t cell) {
    uint32_t room[DM_DIMENSION + 1];
    const uint32_t n = K->n, k = n - 2, *vertex = dm_complex_vertices(K, k, cell, room);
    const uint32_t facets = K->coface_at[k][cell + 1] - K->coface_at[k][cell];
    const uint32_t start = first_top(K, cell);
    uint32_t side[2] = {0, 1}, top = start, count = 0;
    *length = 0;
    if (start == UINT32_MAX) return DM_RING_BOUNDARY;
    sides_of(side, K, top, vertex);
    uint32_t place = first_place(K, top, side);
    do {
        if (count == facets) return DM_RING_TORN;
        ring[count++] = top;
        /* the facet that is left has this vertex beside the cell; in the next top cell the facet
         * opposite to it is left */
        const uint32_t kept = side[0] == place ? side[1] : side[0];
        const uint32_t name = K->vertex[n][(size_t)top * (n + 1) + kept];
        const uint32_t next = across(K, top, place);
        if (next == UINT32_MAX) return DM_RING_BOUNDARY;
        if (next == top) return DM_RING_TORN;
        top = next;
        sides_of(side, K, top, vertex);
        place = K->vertex[n][(size_t)top * (n + 1) + side[0]] == name ? side[0] : side[1];
    } while (top != start);
    *length = count;
    return count == facets ? DM_RING_CLOSED : DM_RING_TORN;
}

/* A fan has two ends: facets of one top cell. A cell at the boundary with two ends may have a loop
 * beside its fan: then the fan is shorter than what is there. */
static int single_fan(const dm_complex *K, uint32_t cell) {
    uint32_t room[DM_DIMENSION + 1];
    const uint32_t n = K->n, k = n - 2, *vertex = dm_complex_vertices(K, k, cell, room);
    const uint32_t first = K->coface_at[k][cell], last = K->coface_at[k][cell + 1];
    uint32_t ends = 0, facet = UINT32_MAX, count = 1, side[2] = {0, 1};
    for (uint32_t i = first; i < last; i++) {
        const uint32_t f = K->coface[k][i];
        const uint32_t tops = K->coface_at[n - 1][f + 1] - K->coface_at[n - 1][f];
        if (tops > 2) return 0;
        if (tops == 1) ends++, facet = f;
    }
    if (ends == 0) return first == last; /* a cell in no top cell */
    if (ends != 2) return 0;
    uint32_t top = K->coface[n - 1][K->coface_at[n - 1][facet]];
    while (top != UINT32_MAX) {
        sides_of(side, K, top, vertex);
        const uint32_t *faces = K->face[n] + (size_t)top * (n + 1);
        const uint32_t place = faces[side[0]] == facet ? side[1] : side[0];
        facet = faces[place], count++;
        top = across(K, top, place);
    }
    return count == last - first;
}

uint32_t dm_ring_torn(uint32_t *ring, const dm_complex *K) {
    uint32_t length;
    for (uint32_t cell = 0; cell < K->count[K->n - 2]; cell++) {
        const dm_ring_kind kind = dm_ring(ring, &length, K, cell);
        if (kind == DM_RING_TORN) return cell;
        if (kind == DM_RING_BOUNDARY && !single_fan(K, cell)) return cell;
    }
    return UINT32_MAX;
}
