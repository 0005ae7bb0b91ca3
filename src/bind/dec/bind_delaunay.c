/* bind_delaunay.c - Delaunay triangulations of points, by dm/delaunay.so. */
#include "bind/core/bind.h"
#include "bind/core/child_process.h"
#include "bind/core/module.h"
#include "bind/value/array.h"
#include "dec/complex.h"
#include "dec/delaunay.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { FEW = 5000 }; /* points: of more Ctrl-C ends the triangulation */

static const dm_delaunay *load(lua_State *L) {
    static const dm_delaunay *table;
    char why[DML_WHY];
    if (!table) table = dml_module("delaunay", DM_DELAUNAY_SYMBOL, "libqhull-dev", why);
    if (!table) luaL_error(L, "dm.mesh: triangulations of points need qhull: %s", why);
    return table;
}

/* ---- two points at one place ---- */

/* what qsort compares: a point with its number behind it */
static uint32_t sorted_dimension;

static int compare(const void *a, const void *b) {
    const double *x = a, *y = b;
    for (uint32_t j = 0; j <= sorted_dimension; j++)
        if (x[j] != y[j]) return x[j] < y[j] ? -1 : 1;
    return 0;
}

/* Raise where two points are the same, with the first such pair in their order in space. out, or
 * NULL: the numbers of the points in that order. */
static void sort_points(lua_State *L, const double *points, uint32_t count, uint32_t n,
                        uint32_t *out) {
    double *row = lua_newuserdatauv(L, (size_t)count * (n + 1) * sizeof *row, 0);
    for (uint32_t i = 0; i < count; i++) {
        memcpy(row + (size_t)i * (n + 1), points + (size_t)i * n, n * sizeof *row);
        row[(size_t)i * (n + 1) + n] = i;
    }
    sorted_dimension = n;
    qsort(row, count, (n + 1) * sizeof *row, compare);
    for (uint32_t i = 0; i < count; i++) {
        const double *now = row + (size_t)i * (n + 1), *last = now - (n + 1);
        if (out) out[i] = (uint32_t)now[n];
        if (i > 0 && memcmp(now, last, n * sizeof *now) == 0)
            luaL_error(L, "dm.mesh: points %d and %d are the same point: a duplicate",
                       (int)last[n] + 1, (int)now[n] + 1);
    }
    lua_pop(L, 1);
}

/* ---- the call ---- */

static void refuse(lua_State *L, const dm_delaunay_report *report, uint32_t n) {
    const int which = (int)report->which + 1;
    switch (report->fault) {
    case DM_DELAUNAY_FLAT:
        luaL_error(L,
                   "dm.mesh: all points lie in a space smaller than of dimension %d, or within "
                   "rounding of one: there are no simplices of degree %d between them",
                   (int)n, (int)n);
        break;
    case DM_DELAUNAY_UNUSED:
        luaL_error(L, "dm.mesh: point %d lies within rounding of others: it is in no simplex",
                   which);
        break;
    case DM_DELAUNAY_CRACKED:
        luaL_error(L,
                   "dm.mesh: a simplex with point %d is flat within rounding: points are too "
                   "close to a smaller space there",
                   which);
        break;
    default:
        luaL_error(L, "dm.mesh: qhull gave up: %s", report->message);
    }
}

/* numbers of vertices, from 1 */
static int push_cells(lua_State *L, const uint32_t *vertex, size_t count) {
    double *out = dml_pushvector(L, (uint32_t)count);
    for (size_t i = 0; i < count; i++) out[i] = vertex[i] + 1.0;
    return 1;
}

/* dimension 1: neighbours on the line */
static int push_line(lua_State *L, const double *points, uint32_t count) {
    uint32_t *order = lua_newuserdatauv(L, count * sizeof *order, 0);
    sort_points(L, points, count, 1, order);
    double *out = dml_pushvector(L, 2 * (count - 1));
    for (uint32_t i = 0; i + 1 < count; i++)
        out[2 * i] = order[i] + 1.0, out[2 * i + 1] = order[i + 1] + 1.0;
    return 1;
}

typedef struct {
    const dm_delaunay *table;
    const double *points; /* [count][n] */
    uint32_t count, n;
    /* set */
    uint32_t *cell, cells;
    dm_delaunay_report report;
} job;

static dm_status triangulate(void *given, dm_arena *arena) {
    job *j = given;
    return j->table->triangulate(&j->cell, &j->cells, j->points, j->count, j->n, arena, &j->report);
}

static int delaunay(lua_State *L) {
    const dml_array *a = dml_checkarray(L, 1, 2);
    const double *points = dml_numbersof(a);
    const uint32_t count = a->rows, n = a->columns;
    if (!points || n < 1 || n > DM_DIMENSION)
        luaL_error(L, "dm.mesh: points of 1 to %d coordinates are triangulated", DM_DIMENSION);
    if (count < n + 1)
        luaL_error(L, "dm.mesh: %d points are too few for a simplex of dimension %d", (int)count,
                   (int)n);
    for (size_t i = 0; i < (size_t)count * n; i++)
        if (!isfinite(points[i]))
            luaL_error(L, "dm.mesh: point %d is not finite", (int)(i / n) + 1);
    if (n == 1) return push_line(L, points, count);
    job j = {.table = load(L), .points = points, .count = count, .n = n};
    sort_points(L, points, count, n, NULL);
    dm_arena *arena = dml_pusharena(L);
    const dm_status status = count <= FEW ? triangulate(&j, arena)
                                          : dml_child(triangulate, &j, sizeof j, arena, &dml_stop);
    if (status == DM_SINGULAR) refuse(L, &j.report, n);
    if (status == DM_STOPPED) dml_checkstop(L);
    if (status != DM_OK) luaL_error(L, "dm.mesh: %s", dm_status_text(status));
    return push_cells(L, j.cell, (size_t)j.cells * (n + 1));
}

static const dml_row functions[] =
    {{"delaunay", delaunay,
      "dm.delaunay(points) -> dm.vector\n"
      "The simplices of the Delaunay triangulation of the rows of a matrix, of 1 to 8 coordinates: "
      "numbers of points from 1, n + 1 a simplex; dm.mesh{points =} makes the mesh of them. Of "
      "points on one sphere, as in grids, it takes one triangulation of many, chosen by their "
      "coordinates: the order of points does not matter. Raises on duplicate points and on points "
      "in a smaller space, and where "
      "qhull "
      "(libqhull-dev) is missing."},
     {NULL, NULL, NULL}};

const dml_class dml_class_delaunay = {.functions = functions};
