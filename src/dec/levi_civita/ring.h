/* ring.h - the top cells round a cell of codimension 2, in the order of its dual loop (Leok 4.7.3).
 * The loop leaves a top cell s with the sides a and b, the vertices of s that the cell has not,
 * through the facet that has b, where the cell followed by (a, b) is s in its orientation: on a
 * surface that is anticlockwise. Without an orientation the first top cell counts as positive. */
#ifndef DM_RING_H
#define DM_RING_H

#include "dec/complex.h"

/* What is round a cell: a loop, a fan that ends at the boundary, or neither (facets of more than
 * two top cells, several loops or fans at one cell). */
typedef enum { DM_RING_CLOSED, DM_RING_BOUNDARY, DM_RING_TORN } dm_ring_kind;

/* ring[facets of the cell]: the top cells of the loop, the first being the one with the least
 * number; *length of them. Only a closed ring is written. n >= 2, cell of degree n - 2. */
dm_ring_kind dm_ring(uint32_t *ring, uint32_t *length, const dm_complex *K, uint32_t cell);

/* The first cell of degree n - 2 that is torn, or UINT32_MAX: where there is none, all have a loop
 * or a single fan. ring[count[n]]. Linear in the cells. */
uint32_t dm_ring_torn(uint32_t *ring, const dm_complex *K);

#endif
