/* delaunay_qhull.c - dm/delaunay.so: the lower hull of the points lifted to a paraboloid (Brown
 * 1979), by the reentrant libqhull_r. Points on one sphere lift to one facet of many simplices;
 * heights that are moved a little choose among these, and do so alike on both sides of every face,
 * as those of a regular triangulation. The move is a function of the coordinates, so the order of
 * points does not matter. Memory of qhull is its own and goes before the call returns. */
#define _GNU_SOURCE /* fmemopen */
#include "dec/delaunay.h"

#include <libqhull_r/libqhull_r.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

/* Qt: facets in simplices; Qc: coplanar points are kept; Q12: goes on where facets are wide; Qx:
 * few merges, for many dimensions */
static const char LOW[] = "qhull Qt Qc Q12 Pp", HIGH[] = "qhull Qt Qc Q12 Pp Qx";

/* Below it a simplex is flat, as in dec/gram.h: (n! volume)^2 by the longest edge to the power 2 n,
 * from dimension 4 on the least square of a height by that of the edge. */
static const double FLAT = 1e-14;

/* How far heights are moved, by squares of distances: the first that gives a triangulation is
 * taken. */
static const double MOVES[] = {1e-9, 1e-8, 1e-7, 1e-6, 1e-5};
enum { TRIES = sizeof MOVES / sizeof *MOVES, MOST = 16 };

/* Points about their mean, the largest coordinate 1, with room for their height: [count][n + 1] */
static void centre_points(double *out, const double *points, uint32_t count, uint32_t n) {
    double largest = 0.0;
    for (uint32_t j = 0; j < n; j++) {
        double mean = 0.0;
        for (uint32_t i = 0; i < count; i++) mean += points[(size_t)i * n + j] / count;
        for (uint32_t i = 0; i < count; i++) {
            double *x = out + (size_t)i * (n + 1) + j;
            *x = points[(size_t)i * n + j] - mean;
            largest = fmax(largest, fabs(*x));
        }
    }
    for (size_t i = 0; largest > 0.0 && i < (size_t)count * (n + 1); i++) out[i] /= largest;
}

/* a number from 0 to 1 that looks random, of the bits of a point */
static double scattered(const double *point, uint32_t n) {
    uint64_t h = 0x9e3779b97f4a7c15u;
    for (uint32_t j = 0; j < n; j++) {
        const double x = point[j] + 0.0; /* -0 is 0 */
        uint64_t bits;
        memcpy(&bits, &x, sizeof bits);
        h = (h ^ bits) * 0xbf58476d1ce4e5b9u;
        h ^= h >> 29;
    }
    h *= 0x94d049bb133111ebu;
    return (double)(h >> 11) * 0x1p-53;
}

/* sum of c_ij x_i x_j, i < j, with c_ij that have no relation: spheres become ellipsoids that are a
 * little askew, which settles all cells of a grid alike and by much more than rounding */
static double askew(const double *x, uint32_t n) {
    double sum = 0.0, c = 0.0;
    for (uint32_t i = 0; i < n; i++)
        for (uint32_t j = i + 1; j < n; j++) {
            c = fmod(c + 0.6180339887498949, 1.0);
            sum += (0.5 + c) * x[i] * x[j];
        }
    return sum;
}

/* |x|^2 and the move; points on spheres of other kinds than those of grids are left to chance */
static void lift(double *moved, const double *points, uint32_t count, uint32_t n, double move) {
    const double by_chance = 0.02 * pow(count, -2.0 / n);
    for (uint32_t i = 0; i < count; i++) {
        double *x = moved + (size_t)i * (n + 1), sum = 0.0;
        for (uint32_t j = 0; j < n; j++) sum += x[j] * x[j];
        x[n] = sum + move * (askew(x, n) + by_chance * scattered(points + (size_t)i * n, n));
    }
}

/* ---- facets of the hull ---- */

/* What reading a hull needs to know; used[count]: which points have been seen in simplices. */
typedef struct {
    qhT *qh;
    const double *moved; /* [count][n + 1] */
    uint32_t count, n;
    unsigned char *used;
} reading;

/* is the simplex of these n + 1 points flat? By Cholesky's factor of its Gram matrix */
static int is_flat(const reading *r, const uint32_t *v) {
    const uint32_t n = r->n;
    double E[8][8], G[8][8], det = 1.0, longest = 0.0, scale = 1.0, least = INFINITY;
    for (uint32_t i = 0; i < n; i++)
        for (uint32_t j = 0; j < n; j++)
            E[i][j] =
                r->moved[(size_t)v[i + 1] * (n + 1) + j] - r->moved[(size_t)v[0] * (n + 1) + j];
    for (uint32_t i = 0; i < n; i++)
        for (uint32_t j = 0; j <= i; j++) {
            double sum = 0.0;
            for (uint32_t m = 0; m < n; m++) sum += E[i][m] * E[j][m];
            if (i == j) longest = fmax(longest, sum);
            for (uint32_t m = 0; m < j; m++) sum -= G[i][m] * G[j][m];
            if (i == j && !(sum > 0.0)) return 1;
            G[i][j] = i == j ? sqrt(sum) : sum / G[j][j];
            if (i == j) det *= sum, least = fmin(least, sum);
        }
    for (uint32_t i = 0; i < n; i++) scale *= longest;
    return n <= 3 ? !(det > FLAT * scale) : !(least > FLAT * longest);
}

/* the points of a facet of the lower hull, or 0 */
static int read_facet(const reading *r, facetT *facet, uint32_t *v) {
    vertexT *vertex, **vertexp;
    uint32_t size = 0;
    if (!facet->normal || !(facet->normal[r->n] < 0.0)) return 0;
    FOREACHvertex_(facet->vertices) {
        const int id = qh_pointid(r->qh, vertex->point);
        if (size > r->n || id < 0 || (uint32_t)id >= r->count) return 0;
        v[size++] = (uint32_t)id;
    }
    return size == r->n + 1;
}

/* a flat simplex all of whose neighbours are simplices: not one that stands upright at the hull */
static int is_inside(const reading *r, facetT *facet) {
    facetT *neighbor, **neighborp;
    uint32_t v[MOST];
    FOREACHneighbor_(facet) if (!read_facet(r, neighbor, v) || is_flat(r, v)) return 0;
    return 1;
}

static dm_status refuse(dm_delaunay_report *report, dm_delaunay_fault fault, uint32_t which) {
    report->fault = fault;
    report->which = which;
    return DM_SINGULAR;
}

/* all simplices of the hull; strict: none may come from a facet of many */
static dm_status read_hull(const reading *r, uint32_t **cell, uint32_t *cells, int strict,
                           dm_arena *arena, dm_delaunay_report *report) {
    facetT *facet;
    qhT *qh = r->qh;
    uint32_t v[MOST], most = 0;
    FORALLfacets most++;
    *cells = 0;
    *cell = dm_arena_take(arena, ((size_t)most + 1) * (r->n + 1) * sizeof **cell);
    if (!*cell) return DM_NO_MEMORY;
    memset(r->used, 0, r->count);
    FORALLfacets {
        if (!read_facet(r, facet, v)) continue;
        const int flat = is_flat(r, v);
        if (flat ? is_inside(r, facet) : strict && facet->tricoplanar)
            return refuse(report, DM_DELAUNAY_CRACKED, v[0]);
        if (flat) continue;
        for (uint32_t j = 0; j <= r->n; j++) r->used[v[j]] = 1;
        memcpy(*cell + (size_t)(*cells)++ * (r->n + 1), v, (r->n + 1) * sizeof *v);
    }
    for (uint32_t i = 0; i < r->count; i++)
        if (!r->used[i]) return refuse(report, DM_DELAUNAY_UNUSED, i);
    return DM_OK;
}

/* what a code of qhull says of the points; the first line of its text goes along */
static dm_status explain(int code, dm_delaunay_report *report) {
    char *end = strchr(report->message, '\n');
    if (end) *end = '\0';
    if (code == qh_ERRmem) return DM_NO_MEMORY;
    return refuse(report, code == qh_ERRsingular ? DM_DELAUNAY_FLAT : DM_DELAUNAY_FAILED, 0);
}

/* one hull of the lifted points */
static dm_status try_once(reading *r, uint32_t **cell, uint32_t *cells, int strict, dm_arena *arena,
                          dm_delaunay_report *report) {
    char command[sizeof HIGH];
    qhT hull;
    int left = 0, total = 0;
    *report = (dm_delaunay_report){DM_DELAUNAY_FINE, 0, ""};
    FILE *errors = fmemopen(report->message, sizeof report->message, "w");
    if (!errors) return DM_NO_MEMORY;
    r->qh = &hull;
    strcpy(command, r->n > 3 ? HIGH : LOW);
    qh_zero(&hull, errors);
    const int code = qh_new_qhull(&hull, (int)r->n + 1, (int)r->count,
                                  (double *)(uintptr_t)r->moved, 0, command, NULL, errors);
    const dm_status status = code ? DM_OK : read_hull(r, cell, cells, strict, arena, report);
    qh_freeqhull(&hull, !qh_ALL);
    qh_memfreeshort(&hull, &left, &total);
    fclose(errors);
    r->qh = NULL;
    report->message[sizeof report->message - 1] = '\0';
    return code ? explain(code, report) : status;
}

/* n + 1 points: a hull needs one more */
static dm_status one_simplex(const reading *r, uint32_t **cell, uint32_t *cells, dm_arena *arena,
                             dm_delaunay_report *report) {
    *cell = dm_arena_take(arena, r->count * sizeof **cell);
    if (!*cell) return DM_NO_MEMORY;
    for (uint32_t i = 0; i < r->count; i++) (*cell)[i] = i;
    *cells = 1;
    return is_flat(r, *cell) ? refuse(report, DM_DELAUNAY_FLAT, 0) : DM_OK;
}

static dm_status triangulate(uint32_t **cell, uint32_t *cells, const double *points, uint32_t count,
                             uint32_t n, dm_arena *arena, dm_delaunay_report *report) {
    double *moved = dm_arena_take(arena, (size_t)count * (n + 1) * sizeof *moved);
    unsigned char *used = dm_arena_take(arena, count);
    dm_status status = DM_SINGULAR;
    if (!moved || !used) return DM_NO_MEMORY;
    reading r = {.moved = moved, .count = count, .n = n, .used = used};
    memset(moved, 0, (size_t)count * (n + 1) * sizeof *moved);
    centre_points(moved, points, count, n);
    if (count == n + 1) return one_simplex(&r, cell, cells, arena, report);
    for (uint32_t i = 0; i < TRIES && status == DM_SINGULAR; i++) {
        lift(moved, points, count, n, MOVES[i]);
        status = try_once(&r, cell, cells, i + 1 < TRIES, arena, report);
        if (report->fault == DM_DELAUNAY_FLAT) break;
    }
    return status;
}

extern const dm_delaunay dm_delaunay_table;
const dm_delaunay dm_delaunay_table = {.triangulate = triangulate};
