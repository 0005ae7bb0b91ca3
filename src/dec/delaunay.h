/* delaunay.h - what dm/delaunay.so gives: Delaunay triangulations of points in any dimension, by
 * qhull. The core links no library of it; the module has this table under DM_DELAUNAY_SYMBOL. */
#ifndef DM_DELAUNAY_H
#define DM_DELAUNAY_H

#include "base/arena.h"
#include "base/status.h"

#include <stdint.h>

#define DM_DELAUNAY_SYMBOL "dm_delaunay_table"

/* What keeps points from having a triangulation. */
typedef enum {
    DM_DELAUNAY_FINE,
    DM_DELAUNAY_FLAT,    /* all lie in a smaller space, as far as rounding tells */
    DM_DELAUNAY_UNUSED,  /* point `which` is in no simplex: it lies within rounding of others */
    DM_DELAUNAY_CRACKED, /* a simplex inside, with point `which`, is flat */
    DM_DELAUNAY_FAILED   /* qhull gave up, see message */
} dm_delaunay_fault;

typedef struct {
    dm_delaunay_fault fault;
    uint32_t which;
    char message[200]; /* of the library */
} dm_delaunay_report;

typedef struct {
    /* *cell[*cells][n + 1], in the arena: the simplices with no point of points[count][n] inside
     * of their circumsphere, n >= 2. Points on one sphere get one triangulation of many, chosen by
     * their coordinates, whatever their order. Flat simplices along the hull are left out.
     * DM_SINGULAR: see *report; DM_NO_MEMORY. */
    dm_status (*triangulate)(uint32_t **cell, uint32_t *cells, const double *points, uint32_t count,
                             uint32_t n, dm_arena *arena, dm_delaunay_report *report);
} dm_delaunay;

#endif
