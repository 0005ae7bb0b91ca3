/* delaunay_child.h - a triangulation that Ctrl-C ends. */
#ifndef DML_DELAUNAY_CHILD_H
#define DML_DELAUNAY_CHILD_H

#include "dec/delaunay.h"

/* table->triangulate of many points in a process of its own: qhull asks nobody whether to go on, so
 * that process is ended when *stop is set (DM_STOPPED). Of few points, and where there can be no
 * process, in this one. */
dm_status dml_triangulate(const dm_delaunay *table, uint32_t **cell, uint32_t *cells,
                          const double *points, uint32_t count, uint32_t n, dm_arena *arena,
                          volatile const int *stop, dm_delaunay_report *report);

#endif
