/* cell_lists.h - the gradient of sums over cells (chain/cells.h) by threads: the slopes of all
 * cells first, then entry by entry the sum of those that belong to it, in the order in which one
 * thread adds them up, so with its bits. Every slope and every entry has one writer. */
#ifndef DM_CELL_LISTS_H
#define DM_CELL_LISTS_H

#include "chain/cells.h"

typedef struct dm_cell_lists {
    size_t *slot;   /* [sums]: slopes of output k of cell i are at slot + width (k cells + i) */
    uint8_t *width; /* [sums] 2: behind every slope is its opposite, for entries that subtract it */
    double *slope;  /* those of all sums; NULL: nobody has asked for lists */
    uint32_t *start; /* [m + 1] of list */
    uint32_t *list;  /* slopes of an entry */
    uint8_t *alike;  /* [m / 64 + 1] of 64 entries: how many terms each has; 0: not the same */
} dm_cell_lists;

/* The lists of c, made where they are not there yet. DM_TOO_LARGE: more than 2^32 slopes. */
dm_status dm_cell_lists_make(const dm_cells *c, dm_arena *arena);

/* Part `part` of `parts` of the slopes at x; factor[sums], work[] as dm_cells has it. */
void dm_cell_lists_slopes(const dm_cells *c, const double *factor, const double *x, double *work,
                          uint32_t part, uint32_t parts);

/* Entries [from, to) of the gradient, once all slopes are there. */
void dm_cell_lists_entries(const dm_cells *c, double *out, uint32_t from, uint32_t to);

#endif
