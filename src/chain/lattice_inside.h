/* lattice_inside.h - parts of a run over a lattice, for the files of this room only. */
#ifndef DM_LATTICE_INSIDE_H
#define DM_LATTICE_INSIDE_H

#include "algebra/body_sum.h"
#include "chain/lattice.h"

/* Numbers of a sum that vary from body to body. */
struct dm_lattice_data {
    const dm_sum *sum;
    const dm_column *column;
    uint32_t array;
};

/* Entry of body i; i beyond the end: what lies there in its lane. */
static inline size_t dm_lattice_at(const dm_lattice *l, uint32_t i) {
    return (size_t)(i % l->depth) * DM_ARRAY_GROUP + i / l->depth;
}

/* What a lattice will look like, before its loops are made: 0 where the bodies have none. */
int dm_lattice_layout(dm_lattice *l);

/* Where depth j and its entries in the buffer are. */
dm_array_bases dm_lattice_bases(const dm_lattice *l, int64_t j, int64_t in_tile);

/* Coordinates beyond the ends of the parts. */
void dm_lattice_fill_ends(dm_lattice *l);

/* Slopes at depths j + first .. j + end - 1 of a tile that begins at depth j. */
void dm_lattice_fill(const dm_lattice *l, const dm_lattice_sum *r, int64_t j, int64_t first,
                     int64_t end);

#endif
