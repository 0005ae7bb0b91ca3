/* volumes and signed duals against values worked by hand (Leok 3.3; triangles and tetrahedra) */
#include "check.h"

#include "dec/metric.h"
#include "dec/orientation.h"

#include <stdlib.h>

static void *allocate(void *ud, void *block, size_t old_size, size_t new_size) {
    (void)ud, (void)old_size;
    if (new_size) return realloc(block, new_size);
    free(block);
    return NULL;
}

typedef struct {
    dm_arena arena;
    dm_complex K;
    dm_metric metric;
    dm_status status;
    uint32_t degree, cell;
} mesh;

/* one simplex of dimension n with these points */
static void make(mesh *m, uint32_t n, const double *points, dm_centres centres) {
    uint32_t vertex[9], start[2] = {0, n + 1};
    double length2[36];
    dm_complex_report report;
    for (uint32_t i = 0; i <= n; i++) vertex[i] = i;
    const dm_simplices given = {n + 1, 1, start, vertex};
    dm_arena_init(&m->arena, allocate, NULL);
    CHECK(dm_complex_build(&m->K, &m->arena, &given, NULL, &report) == DM_OK);
    const dm_points at = {points, n};
    dm_metric_lengths(length2, &m->K, &at);
    m->status =
        dm_metric_build(&m->metric, &m->arena, &m->K, length2, NULL, centres, &m->degree, &m->cell);
}

static void near(const double *got, uint32_t count, const double *want) {
    for (uint32_t i = 0; i < count; i++) CHECK_NEAR(got[i], want[i], 1e-14);
}

static void triangles(void) {
    static const struct {
        double points[6], vertex[3], edge[3];
    } rows[] = {
        {{0, 0, 1, 0, 0, 1}, {0.25, 0.125, 0.125}, {0.5, 0.5, 0}},
        {{0, 0, 4, 0, 1, 1}, {-0.25, 0.25, 2}, {-1, 2.1213203435596424, 1.5811388300841898}},
        {{0, 0, 3, 0, 1, 2}, {1, 0.875, 1.125}, {0.5, 1.1180339887498949, 0.70710678118654757}},
    };
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
        mesh m;
        make(&m, 2, rows[i].points, DM_CIRCUMCENTRES);
        CHECK(m.status == DM_OK);
        near(m.metric.dual[0], 3, rows[i].vertex);
        /* edges 01, 02, 12; the table of the obtuse one has 01, 12 before 02: by length */
        const double edges[] = {rows[i].edge[0], rows[i].edge[1], rows[i].edge[2]};
        near(m.metric.dual[1], 3, edges);
        dm_arena_release(&m.arena);
    }
}

static void corner_of_a_cube(void) {
    static const double points[] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1};
    const double r = sqrt(2.0) / 24, f = -sqrt(3.0) / 6;
    const double edge[] = {0.25, 0.25, 0.25, -r, -r, -r}, face[] = {0.5, 0.5, 0.5, f};
    const double vertex[] = {0.125, 1 / 72.0, 1 / 72.0, 1 / 72.0};
    mesh m;
    make(&m, 3, points, DM_CIRCUMCENTRES);
    CHECK(m.status == DM_OK);
    near(m.metric.dual[0], 4, vertex);
    near(m.metric.dual[1], 6, edge);
    near(m.metric.dual[2], 4, face);
    dm_arena_release(&m.arena);
}

/* sum over faces of degree k of |F| |*F| / C(n, k) = |K|, in 5 dimensions, both kinds of centres */
static void supports_add_up(void) {
    static const double binomial[] = {1, 5, 10, 10, 5, 1};
    double points[30];
    uint32_t s = 12345;
    for (int i = 0; i < 30; i++)
        points[i] = (double)(s = 1664525u * s + 1013904223u) / 4294967296.0;
    for (int centres = 0; centres < 2; centres++) {
        mesh m;
        make(&m, 5, points, centres ? DM_BARYCENTRES : DM_CIRCUMCENTRES);
        CHECK(m.status == DM_OK);
        for (uint32_t k = 0; k <= 5; k++) {
            double sum = 0;
            for (uint32_t i = 0; i < m.K.count[k]; i++)
                sum += m.metric.volume[k][i] * m.metric.dual[k][i] / binomial[k];
            CHECK_NEAR(sum / m.metric.volume[5][0], 1.0, 1e-9);
        }
        dm_arena_release(&m.arena);
    }
}

static void flat_cells_are_named(void) {
    static const double line[] = {0, 0, 1, 1, 2, 2};
    mesh m;
    make(&m, 2, line, DM_CIRCUMCENTRES);
    CHECK(m.status == DM_SINGULAR && m.degree == 2 && m.cell == 0);
    dm_arena_release(&m.arena);
}

int main(void) {
    RUN(triangles, "signed duals of triangles");
    RUN(corner_of_a_cube, "signed duals of a corner tetrahedron");
    RUN(supports_add_up, "supports add up to the volume, in five dimensions");
    RUN(flat_cells_are_named, "a flat cell is named");
    return check_finish();
}
