/* a complex has the faces that can be counted by hand, each once, in order */
#include "check.h"

#include "dec/complex.h"
#include "dec/orientation.h"

#include <stdlib.h>

static void *allocate(void *ud, void *block, size_t old_size, size_t new_size) {
    (void)ud, (void)old_size;
    if (new_size) return realloc(block, new_size);
    free(block);
    return NULL;
}

static dm_status build(dm_complex *K, dm_arena *arena, uint32_t vertices, uint32_t simplices,
                       uint32_t length, const uint32_t *vertex, dm_complex_report *report) {
    uint32_t start[64];
    for (uint32_t i = 0; i <= simplices; i++) start[i] = i * length;
    const dm_simplices given = {vertices, simplices, start, vertex};
    const dm_status status = dm_complex_build(K, arena, &given, NULL, report);
    return status == DM_OK ? dm_complex_orient(K, arena, NULL) : status;
}

/* d d = 0: every cell of degree k - 2 of a cell of degree k comes twice, with opposite signs */
static int boundary_of_boundary(const dm_complex *K) {
    int defect = 0;
    for (uint32_t k = 2; k <= K->n; k++)
        for (uint32_t c = 0; c < K->count[k]; c++) {
            int times[70] = {0};
            for (uint32_t j = 0; j <= k; j++) {
                const uint32_t f = K->face[k][c * (k + 1) + j];
                for (uint32_t i = 0; i < k; i++)
                    times[K->face[k - 1][f * k + i]] += (i + j) % 2 ? -1 : 1;
            }
            for (uint32_t b = 0; b < K->count[k - 2]; b++) defect += times[b] != 0;
        }
    return defect;
}

static void octahedron(void) {
    static const uint32_t faces[] = {0, 2, 4, 2, 1, 4, 1, 3, 4, 3, 0, 4,
                                     5, 2, 0, 1, 2, 5, 3, 1, 5, 0, 3, 5};
    dm_arena arena;
    dm_complex K;
    dm_complex_report report;
    dm_arena_init(&arena, allocate, NULL);
    CHECK(build(&K, &arena, 6, 8, 3, faces, &report) == DM_OK);
    CHECK(K.n == 2 && K.count[0] == 6 && K.count[1] == 12 && K.count[2] == 8);
    CHECK(dm_complex_euler(&K) == 2 && K.pure && K.orientation);
    CHECK(boundary_of_boundary(&K) == 0);
    const uint32_t none[] = {0, 1}, some[] = {2, 5};
    CHECK(dm_complex_find(&K, 1, none) == UINT32_MAX);
    const uint32_t e = dm_complex_find(&K, 1, some);
    CHECK(e < 12 && K.coface_at[1][e + 1] - K.coface_at[1][e] == 2);
    uint32_t component[6], work[6];
    CHECK(dm_complex_components(&K, component, work) == 1);
    dm_arena_release(&arena);
}

static void moebius_band_has_no_orientation(void) {
    static const uint32_t band[] = {0, 1, 2, 1, 2, 3, 2, 3, 4, 3, 4, 0, 4, 0, 1};
    dm_arena arena;
    dm_complex K;
    dm_complex_report report;
    dm_arena_init(&arena, allocate, NULL);
    CHECK(build(&K, &arena, 5, 5, 3, band, &report) == DM_OK);
    CHECK(K.orientation == NULL && dm_complex_crowded(&K) == UINT32_MAX);
    CHECK(dm_complex_euler(&K) == 0);
    dm_arena_release(&arena);
}

/* the faces of a 7-simplex: binomial coefficients */
static void simplex_of_dimension_7(void) {
    static const uint32_t vertex[] = {7, 3, 1, 0, 2, 4, 6, 5};
    static const uint32_t binomial[] = {8, 28, 56, 70, 56, 28, 8, 1};
    dm_arena arena;
    dm_complex K;
    dm_complex_report report;
    dm_arena_init(&arena, allocate, NULL);
    CHECK(build(&K, &arena, 8, 1, 8, vertex, &report) == DM_OK);
    for (uint32_t k = 0; k < 8; k++) CHECK(K.count[k] == binomial[k]);
    CHECK(boundary_of_boundary(&K) == 0 && dm_complex_euler(&K) == 1);
    dm_arena_release(&arena);
}

/* Of the boundary of an 8-simplex with a simplex beside it, every cell: ascending, face j is what is
 * left without vertex j, in order, and found by its vertices. Degrees 4 to 6 of 7 are not stored. */
static void vertices_of_cells(void) {
    uint32_t vertex[80], used = 0;
    dm_arena arena;
    dm_complex K;
    dm_complex_report report;
    for (uint32_t i = 0; i < 9; i++)
        for (uint32_t j = 9; j-- > 0;)
            if (j != i) vertex[used++] = j;
    for (uint32_t j = 3; j < 11; j++) vertex[used++] = j;
    dm_arena_init(&arena, allocate, NULL);
    CHECK(build(&K, &arena, 11, 10, 8, vertex, &report) == DM_OK);
    CHECK(K.vertex[3] && !K.vertex[4] && !K.vertex[6] && K.vertex[7]);
    int wrong = 0;
    for (uint32_t k = 1; k <= 7; k++)
        for (uint32_t c = 0; c < K.count[k]; c++) {
            uint32_t here[DM_DIMENSION + 1], there[DM_DIMENSION + 1];
            const uint32_t *v = dm_complex_vertices(&K, k, c, here);
            wrong += dm_complex_find(&K, k, v) != c;
            for (uint32_t j = 0; j <= k; j++) {
                const uint32_t *f =
                    dm_complex_vertices(&K, k - 1, K.face[k][c * (k + 1) + j], there);
                wrong += j > 0 && v[j - 1] >= v[j];
                for (uint32_t i = 0; i < k; i++) wrong += f[i] != v[i < j ? i : i + 1];
            }
        }
    CHECK(wrong == 0);
    dm_arena_release(&arena);
}

static void faults_are_named(void) {
    static const uint32_t repeated[] = {0, 1, 2, 1, 3, 1}, twice[] = {0, 1, 2, 1, 2, 3, 2, 0, 1},
                          unknown[] = {0, 1, 9};
    dm_arena arena;
    dm_complex K;
    dm_complex_report report;
    dm_arena_init(&arena, allocate, NULL);
    CHECK(build(&K, &arena, 4, 2, 3, repeated, &report) == DM_SINGULAR);
    CHECK(report.fault == DM_COMPLEX_REPEATED && report.simplex == 1);
    CHECK(build(&K, &arena, 4, 3, 3, twice, &report) == DM_SINGULAR);
    CHECK(report.fault == DM_COMPLEX_DUPLICATE && report.simplex == 2 && report.other == 0);
    CHECK(build(&K, &arena, 4, 1, 3, unknown, &report) == DM_SINGULAR);
    CHECK(report.fault == DM_COMPLEX_UNKNOWN && report.simplex == 0);
    dm_arena_release(&arena);
}

int main(void) {
    RUN(octahedron, "an octahedron has its faces, in order");
    RUN(moebius_band_has_no_orientation, "a Moebius band has no orientation");
    RUN(simplex_of_dimension_7, "a simplex of dimension 7 has binomial numbers of faces");
    RUN(vertices_of_cells, "cells have their vertices, also where these are not stored");
    RUN(faults_are_named, "what is no complex is refused, with the simplex");
    return check_finish();
}
