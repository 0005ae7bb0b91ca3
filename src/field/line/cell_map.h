/* cell_map.h - one function of a cell of a line, between two levels, run along all cells in lanes.
 *
 * A cell has a left and a right node on the lower and on the upper level, n values at each. Its
 * function takes, in this order, lower[2n] (left node, then right), upper[2n], the numbers of the
 * cell alone (where it is), and scalars that all cells share (t, h). Levels stand in memory value
 * after value, each an array along the nodes, so that a group of cells is a group of lanes. */
#ifndef DM_CELL_MAP_H
#define DM_CELL_MAP_H

#include "code/loops/array_loop.h"

enum { DM_CELL_BLOCK = 512, DM_CELL_MOST = 90, DM_CELL_LOOPS = 128 };

/* where the inputs are */
typedef struct {
    uint32_t values;  /* n of a node */
    uint32_t columns; /* numbers of a cell alone */
    uint32_t scalars; /* numbers that all cells share */
    uint32_t stride;  /* doubles of an array: nodes, one more on a ring, rounded up and padded */
} dm_cell_layout;

/* value k of node i of the lower level, of the upper one; column k of cell i */
static inline size_t dm_cell_lower(const dm_cell_layout *l, uint32_t k) {
    return (size_t)k * l->stride;
}
static inline size_t dm_cell_upper(const dm_cell_layout *l, uint32_t k) {
    return (size_t)(l->values + k) * l->stride;
}
static inline size_t dm_cell_column(const dm_cell_layout *l, uint32_t k) {
    return (2 * (size_t)l->values + k) * l->stride;
}

/* Doubles of both levels and the columns. */
static inline size_t dm_cell_memory(const dm_cell_layout *l) {
    return (2 * (size_t)l->values + l->columns) * l->stride;
}

/* Inputs of a function of a cell. */
static inline uint32_t dm_cell_inputs(const dm_cell_layout *l) {
    return 4 * l->values + l->columns + l->scalars;
}

/* outputs are cut into loops of at most DM_CELL_MOST */
typedef struct {
    const dm_array_loop *loop; /* [loops] */
    uint32_t loops, outputs;
} dm_cell_map;

/* roots[m] of g, whose inputs are those of a cell. DM_TOO_LARGE: more inputs or outputs than
 * there is room for. */
dm_status dm_cell_map_build(dm_cell_map *out, const dm_cell_layout *layout, dm_graph *g,
                            const dm_node *roots, uint32_t m, dm_compile *compile, dm_arena *arena);

/* The outputs of cells first .. first + count, count <= DM_CELL_BLOCK: output k of cell first + i
 * is buffer[k * DM_CELL_BLOCK + i]. scalars: a copy of each for every lane of DM_ARRAY_GROUP. */
void dm_cell_map_run(const dm_cell_map *f, double *memory, const double *scalars, double *buffer,
                     uint32_t first, uint32_t count);

#endif
