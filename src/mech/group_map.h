/* group_map.h - a function of a step on a group with the matrix of its derivatives. */
#ifndef DM_GROUP_MAP_H
#define DM_GROUP_MAP_H

#include "code/kernel.h"

/* Where both are very many operations, as of exp on SO(5), a kernel of them all would be larger
 * than any cache, if it could be made: there one row of the matrix is found after the other, by one
 * reverse sweep with weights of the values, in lanes where there are some. */
typedef struct {
    dm_kernel plain; /* takes inputs[inputs], gives values[values] */
    dm_kernel whole; /* values, then their derivatives row by row; no outputs: by */
    dm_kernel row;  /* takes (inputs, weights[values]): derivatives of the weighted sum [columns] */
    uint32_t lanes; /* of `row`, of one member */
    uint32_t inputs, values, columns;
} dm_group_map;

/* f[values] of a graph by its inputs first .. first + columns - 1; lanes of `row`: what `compile`
 * makes has members in them, or is the native code of one. */
dm_status dm_group_map_make(dm_group_map *out, dm_graph *g, const dm_node *f, uint32_t values,
                            uint32_t first, uint32_t columns, dm_compile *compile, dm_arena *arena);

/* Constant outputs into out[values (columns + 1)][members], once. */
void dm_group_map_prepare(const dm_group_map *m, uint32_t members, double *out);

/* Doubles of room for maps of so many inputs, values and columns in all. */
static inline size_t dm_group_map_room(size_t numbers) {
    return 8 * numbers;
}

/* Values and matrix at in[inputs][members], members 1 or as many as lanes of the kernels. */
void dm_group_map_eval(const dm_group_map *m, const double *in, double *out, uint32_t members,
                       double *room);

#endif
