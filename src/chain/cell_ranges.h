/* cell_ranges.h - the gradient of sums over cells (chain/cells.h) by threads that have a range of
 * its entries each: a thread goes through the cells that have entries of its range, in the order in
 * which one thread goes through all, so with its bits. Cells that have entries of two ranges are
 * gone through by both threads; where these are many, as on meshes with neighbours far apart in
 * number, chain/cell_lists.h is faster. Moves the rows "leapfrog, 2 threads" of make bench. */
#ifndef DM_CELL_RANGES_H
#define DM_CELL_RANGES_H

#include "chain/cells.h"

/* some cells of a sum, one behind the other */
typedef struct {
    uint32_t sum, first, count;
    int border; /* some of them have entries of other ranges, too */
} dm_cell_piece;

typedef struct dm_cell_ranges {
    struct dm_cell_ranges *next; /* those for other threads */
    uint32_t parts, unit;
    uint32_t *start; /* [parts + 1] of piece; NULL: too many cells are on borders */
    dm_cell_piece *piece;
} dm_cell_ranges;

/* Part `part` of `parts` of m entries, whole units of them. */
void dm_cell_range(uint32_t m, uint32_t unit, uint32_t part, uint32_t parts, uint32_t *from,
                   uint32_t *to);

/* The cells of all ranges of c, made where they are not there yet; NULL: no memory, or not worth
 * it. */
const dm_cell_ranges *dm_cell_ranges_make(const dm_cells *c, uint32_t unit, uint32_t parts,
                                          dm_arena *arena);

/* The entries of out[m] that are of the range of `part`, of the gradient at x; factor[sums], work[]
 * as dm_cells has it. No other entry is read or written. */
void dm_cell_ranges_gradient(const dm_cells *c, const dm_cell_ranges *r, double *out,
                             const double *factor, const double *x, double *work, uint32_t part);

#endif
