/* tiling.c - a counter over the cells of a box. */
#include "dec/named/tiling.h"

#include <stddef.h>

/* the next place, axis 0 first; 0 behind the last */
static int advance(uint32_t *at, const uint32_t *count, uint32_t axes) {
    for (uint32_t a = 0; a < axes; a++) {
        if (++at[a] < count[a]) return 1;
        at[a] = 0;
    }
    return 0;
}

/* the vertex with these offsets from a cell's first one */
static uint32_t number_of(const dm_tiling *t, const uint32_t *at, const uint32_t *offset) {
    uint32_t x[DM_TILING_AXES], number = 0;
    for (uint32_t a = 0; a < t->axes; a++) x[a] = at[a] + offset[a];
    if (t->axes > 1 && x[1] >= t->along[1]) x[0] += t->turn;
    for (uint32_t a = t->axes; a-- > 0;)
        number = number * t->along[a] + (x[a] < t->along[a] ? x[a] : x[a] % t->along[a]);
    return number;
}

int dm_tiling_fill(uint32_t *vertex, const dm_tiling *t, volatile const int *stop) {
    uint32_t at[DM_TILING_AXES] = {0};
    do {
        if (at[0] == 0 && stop && *stop) return 0;
        for (uint32_t c = 0; c < t->corners; c++)
            *vertex++ = number_of(t, at, t->corner + (size_t)c * t->axes);
    } while (advance(at, t->cells, t->axes));
    return 1;
}

void dm_tiling_points(double *point, const dm_tiling *t) {
    uint32_t at[DM_TILING_AXES] = {0};
    do
        for (uint32_t a = 0; a < t->axes; a++) *point++ = (double)at[a] / t->cells[a];
    while (advance(at, t->along, t->axes));
}
