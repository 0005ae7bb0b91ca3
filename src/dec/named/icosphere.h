/* icosphere.h - the icosahedron, each triangle split in four again and again, on the unit sphere.
 * The numbering decides the order of cells, so it is fixed: the midpoints of a face (a, b, c) come
 * as ab, bc, ca where an edge is first met; its parts are (a, ab, ca), (b, bc, ab), (c, ca, bc),
 * (ab, bc, ca). */
#ifndef DM_ICOSPHERE_H
#define DM_ICOSPHERE_H

#include "base/arena.h"
#include "base/status.h"

#include <stdint.h>

enum { DM_ICOSPHERE_MOST = 12 }; /* splits: more leave 32 bits */

typedef struct {
    uint32_t vertices, faces;
    double *point;  /* [vertices][3] */
    uint32_t *face; /* [faces][3], seen from outside against the clock or all with it */
} dm_icosphere;

/* `splits` times split, at most DM_ICOSPHERE_MOST: 10 4^s + 2 vertices, 20 4^s faces. DM_OK,
 * DM_NO_MEMORY, DM_STOPPED. */
dm_status dm_icosphere_make(dm_icosphere *out, dm_arena *arena, uint32_t splits,
                            volatile const int *stop);

#endif
