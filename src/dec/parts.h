/* parts.h - parts of a complex as marks on its cells: boundary, open stars (Leok 3.3). */
#ifndef DM_PARTS_H
#define DM_PARTS_H

#include "dec/complex.h"

/* mark[count[k]]: 1 where a cell lies in the boundary, the closure of the cells of degree n - 1
 * with one top cell. work: count[d] bytes for the largest d < n. Returns how many are marked. */
uint32_t dm_parts_boundary(uint8_t *mark, uint8_t *work, const dm_complex *K, uint32_t k);

/* mark[count[d]]: 1 where a cell of degree d has cell `cell` of degree k as a face, or is it;
 * d >= k; work as above, count[d] bytes. */
uint32_t dm_parts_star(uint8_t *mark, uint8_t *work, const dm_complex *K, uint32_t k, uint32_t cell,
                       uint32_t d);

/* Is it a manifold, with boundary or without? Pure, at most two top cells at a facet, and the link
 * of every cell connected, with the Euler number of a sphere or, at the boundary, of a ball: up to
 * dimension 3 that is all; beyond, a link may be something else with these numbers. Linear in the
 * cells, times 4^n. -1: no memory. */
int dm_parts_manifold(const dm_complex *K, dm_arena *scratch);

#endif
