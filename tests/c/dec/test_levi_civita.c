/* deficits, rings and rotations on boundaries of simplices, 2 to 7 dimensions: three regular cells
 * meet at every cell of codimension 2, each with the angle acos(1/n) */
#include "check.h"

#include "dec/levi_civita/deficit.h"
#include "dec/levi_civita/ring.h"
#include "dec/levi_civita/rotation.h"
#include "dec/orientation.h"

#include <stdlib.h>
#include <string.h>

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
} mesh;

/* `count` of the facets of a simplex with n + 2 vertices and edges of length 1 */
static void make(mesh *m, uint32_t n, uint32_t count) {
    uint32_t vertex[90], start[11], used = 0, degree, cell;
    double length2[45];
    dm_complex_report report;
    for (uint32_t i = 0; i < count; i++) {
        start[i] = used;
        for (uint32_t j = 0; j < n + 2; j++)
            if (j != i) vertex[used++] = j;
    }
    start[count] = used;
    const dm_simplices given = {n + 2, count, start, vertex};
    dm_arena_init(&m->arena, allocate, NULL);
    CHECK(dm_complex_build(&m->K, &m->arena, &given, NULL, &report) == DM_OK);
    CHECK(dm_complex_orient(&m->K, &m->arena, NULL) == DM_OK);
    for (uint32_t i = 0; i < m->K.count[1]; i++) length2[i] = 1.0;
    CHECK(dm_metric_build(&m->metric, &m->arena, &m->K, length2, NULL, DM_CIRCUMCENTRES, &degree,
                          &cell) == DM_OK);
}

static void deficits(void) {
    for (uint32_t n = 2; n <= 7; n++) {
        double deficit[90];
        dm_turn work[90];
        mesh m;
        make(&m, n, n + 2);
        dm_deficits(deficit, work, &m.K, &m.metric);
        for (uint32_t i = 0; i < m.K.count[n - 2]; i++)
            CHECK_NEAR(deficit[i], 2.0 * acos(-1.0) - 3.0 * acos(1.0 / n), 1e-12);
        dm_arena_release(&m.arena);
    }
}

/* R of n x n times M */
static void multiply(double *M, const double *R, uint32_t n) {
    double out[64];
    for (uint32_t i = 0; i < n; i++)
        for (uint32_t j = 0; j < n; j++) {
            out[i * n + j] = 0.0;
            for (uint32_t k = 0; k < n; k++) out[i * n + j] += R[i * n + k] * M[k * n + j];
        }
    memcpy(M, out, n * n * sizeof *M);
}

static void holonomies(void) {
    for (uint32_t n = 2; n <= 7; n++) {
        mesh m;
        make(&m, n, n + 2);
        const dm_levi_civita c = {&m.K, &m.metric, NULL, DM_BY_FACE};
        for (uint32_t cell = 0; cell < m.K.count[n - 2]; cell++) {
            uint32_t ring[9], length;
            double M[64] = {0.0}, R[64], trace = 0.0;
            CHECK(dm_ring(ring, &length, &m.K, cell) == DM_RING_CLOSED && length == 3);
            for (uint32_t i = 0; i < n; i++) M[i * n + i] = 1.0;
            for (uint32_t i = 0; i < length; i++) {
                CHECK(dm_levi_civita_rotation(R, &c, ring[i], ring[(i + 1) % length]) == DM_OK);
                multiply(M, R, n);
            }
            for (uint32_t i = 0; i < n; i++) trace += M[i * n + i];
            CHECK_NEAR(trace, n - 2.0 + 2.0 * cos(3.0 * acos(1.0 / n)), 1e-12);
            if (n == 2) CHECK_NEAR(M[2], 0.0, 1e-14); /* a half turn */
        }
        CHECK(dm_levi_civita_rotation((double[64]){0}, &c, 0, 0) == DM_SINGULAR);
        dm_arena_release(&m.arena);
    }
}

/* without one facet of the simplex: its vertices and faces are the boundary */
static void boundaries(void) {
    for (uint32_t n = 2; n <= 7; n++) {
        uint32_t ring[9], length, closed = 0;
        mesh m;
        make(&m, n, n + 1);
        for (uint32_t cell = 0; cell < m.K.count[n - 2]; cell++) {
            const dm_ring_kind kind = dm_ring(ring, &length, &m.K, cell);
            CHECK(kind != DM_RING_TORN);
            closed += kind == DM_RING_CLOSED;
        }
        /* those in no face of the facet that is left out: all that have its opposite vertex */
        CHECK(closed == m.K.count[n - 2] - n * (n + 1) / 2);
        dm_arena_release(&m.arena);
    }
}

int main(void) {
    RUN(deficits, "deficits of regular simplices, 2 to 7 dimensions");
    RUN(holonomies, "the rotation round a cell turns one plane by the deficit");
    RUN(boundaries, "rings end at the boundary");
    return check_finish();
}
