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
    return (size_t)(i % l->depth) * DM_STRIP_GROUP + i / l->depth;
}

/* What a lattice will look like, before its loops are made: 0 where the bodies have none. */
int dm_lattice_layout(dm_lattice *l);

/* Where depth j and its entries in the buffer are. */
dm_strip_bases dm_lattice_bases(const dm_lattice *l, int64_t j, int64_t in_tile);

/* In a loop that moves on: position of coordinate c one group on. */
dm_node dm_lattice_ahead(const dm_lattice *l, dm_strip_draft *d, dm_lattice_pair at, uint32_t c);

/* Coordinates beyond the ends of the parts. */
void dm_lattice_fill_ends(dm_lattice *l);

/* Slopes at depths j + first .. j + end - 1 of a tile that begins at depth j. */
void dm_lattice_fill(const dm_lattice *l, const dm_rounds *r, int64_t j, int64_t first,
                     int64_t end);

/* There are enough bodies for a stack. */
static inline int dm_lattice_is_deep(const dm_lattice *l) {
    return l->depth > 4 * l->room;
}

/* lattice_wide.c: one array from x or to x by AVX-512; gives how many depths are done, a start
 * of each part. */
uint32_t dm_lattice_wide_load(const dm_lattice *l, double *to, const double *x);
uint32_t dm_lattice_wide_store(const dm_lattice *l, double *x, const double *from);

/* Every entry of an array is a number; 0: not known here. */
int dm_lattice_wide_finite(const dm_lattice *l, const double *x, int *finite);

/* dm_lattice_copy_ends of one array. */
void dm_lattice_ends_of(const dm_lattice *l, double *x, uint32_t count);

#endif
