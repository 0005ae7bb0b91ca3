/* boxes.h - which simplices may meet a box: a grid of bins over their bounding boxes, by up to
 * three coordinates. Time and memory to make it are linear in the simplices of a mesh whose cells
 * are not too unlike in size. */
#ifndef DM_BOXES_H
#define DM_BOXES_H

#include "base/arena.h"
#include "base/status.h"

#include <stdint.h>

enum { DM_BOX_AXES = 3 };

typedef struct {
    uint32_t axes, N, size; /* coordinates of the grid; of the points; vertices of a simplex */
    uint32_t count;         /* simplices */
    const uint32_t *vertex; /* [count][size] */
    const double *points;   /* [][N] */
    uint32_t bins[DM_BOX_AXES];
    double low[DM_BOX_AXES], scale[DM_BOX_AXES];
    uint32_t *start, *item; /* simplices of bin b: item[start[b] .. start[b + 1] - 1], ascending */
    uint32_t *stamp, now;   /* [count]: met in the query `now` */
    uint32_t *found;        /* [count] of the last query */
} dm_boxes;

/* count > 0, N > 0; the arrays of simplices and points stay the caller's. DM_NO_MEMORY. */
dm_status dm_boxes_make(dm_boxes *b, dm_arena *arena, const uint32_t *vertex, uint32_t count,
                        uint32_t size, const double *points, uint32_t N);

/* The simplices whose bins meet the bounding box of points at[many][N], which is made wider by
 * `margin` of its largest side: b->found[result], in no order. */
uint32_t dm_boxes_near(dm_boxes *b, const double *const *at, uint32_t many, double margin);

#endif
