/* tiling.h - simplices of a box of equal cells: a pattern of simplices, moved from cell to cell.
 * Grids, flat tori, cube tilings and body-centred lattices are such. */
#ifndef DM_TILING_H
#define DM_TILING_H

#include <stdint.h>

enum { DM_TILING_AXES = 8 };

/* Vertex (x_0, x_1, ...) has the number x_0 + along[0] (x_1 + along[1] (x_2 + ...)). */
typedef struct {
    uint32_t axes;
    uint32_t cells[DM_TILING_AXES]; /* in every direction */
    uint32_t along[DM_TILING_AXES]; /* vertices; coordinates are taken modulo them */
    uint32_t turn;                  /* what a way round axis 1 adds to coordinate 0 */
    uint32_t corners;               /* vertices of the pattern, of all its simplices */
    const uint32_t *corner;         /* [corners][axes], from the first vertex of a cell */
} dm_tiling;

/* vertex[cells of the box][corners], axis 0 first. 0: *stop was set. */
int dm_tiling_fill(uint32_t *vertex, const dm_tiling *t, volatile const int *stop);

/* point[vertices][axes] of the vertices: x_a / cells[a]. */
void dm_tiling_points(double *point, const dm_tiling *t);

#endif
