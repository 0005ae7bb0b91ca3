/* matchings of complexes whose homology is known, and Smith's form of a matrix worked by hand */
#include "check.h"

#include "dec/homology/matching.h"
#include "dec/homology/smith.h"

#include <stdlib.h>

static void *allocate(void *ud, void *block, size_t old_size, size_t new_size) {
    (void)ud, (void)old_size;
    if (new_size) return realloc(block, new_size);
    free(block);
    return NULL;
}

/* the boundary of a simplex of n + 1 vertices: a sphere */
static void make_sphere(dm_complex *K, dm_arena *arena, uint32_t n) {
    uint32_t start[10], vertex[72], at = 0;
    dm_complex_report report;
    for (uint32_t i = 0; i <= n; i++) {
        start[i] = at;
        for (uint32_t v = 0; v <= n; v++)
            if (v != i) vertex[at++] = v;
    }
    start[n + 1] = at;
    const dm_simplices given = {n + 1, n + 1, start, vertex};
    CHECK(dm_complex_build(K, arena, &given, NULL, &report) == DM_OK);
}

/* every face of an upper cell but its partner has come before */
static int is_ordered(const dm_matching *M) {
    for (uint32_t k = 1; k <= M->K->n; k++)
        for (uint32_t b = 0; b < M->K->count[k]; b++) {
            if (M->kind[k][b] != DM_CELL_UPPER) continue;
            const uint32_t a = M->partner[k][b];
            if (M->kind[k - 1][a] != DM_CELL_LOWER || M->partner[k - 1][a] != b) return 0;
            for (uint32_t j = 0; j <= k; j++) {
                const uint32_t face = M->K->face[k][b * (k + 1) + j];
                if (face != a && M->time[k - 1][face] >= M->time[k - 1][a]) return 0;
            }
        }
    return 1;
}

static void spheres(void) {
    for (uint32_t n = 2; n <= 7; n++)
        for (int collapse = 0; collapse < 2; collapse++) {
            dm_arena arena;
            dm_complex K;
            dm_matching M;
            const dm_matching_wish wish = {.hub = n - 1, .collapse = collapse};
            dm_arena_init(&arena, allocate, NULL);
            make_sphere(&K, &arena, n);
            CHECK(dm_matching_build(&M, &arena, &K, &wish, NULL) == DM_OK);
            CHECK(M.criticals[0] == 1 && M.critical[0][0] == n - 1);
            for (uint32_t k = 1; k < K.n; k++) CHECK(M.criticals[k] == 0);
            CHECK(M.criticals[K.n] == 1 && is_ordered(&M));
            dm_arena_release(&arena);
        }
}

/* the whole sphere is a cycle: it flows to its critical cell, once; a vertex to the hub */
static void flows(void) {
    dm_arena arena;
    dm_complex K;
    dm_matching M;
    dm_flow w;
    const dm_matching_wish wish = {.hub = 0};
    dm_arena_init(&arena, allocate, NULL);
    make_sphere(&K, &arena, 4);
    CHECK(dm_matching_build(&M, &arena, &K, &wish, NULL) == DM_OK);
    CHECK(dm_flow_open(&w, &arena, &M, 3) == DM_OK);
    for (uint32_t i = 0; i < 5; i++) CHECK(dm_flow_add(&w, i, i % 2 ? -7 : 7));
    CHECK(dm_flow_run(&w, NULL) == DM_OK && w.uppers == 0);
    CHECK(w.rests == 1 && (w.rest[0].coefficient == 7 || w.rest[0].coefficient == -7));
    CHECK(dm_flow_open(&w, &arena, &M, 0) == DM_OK);
    CHECK(dm_flow_add(&w, 3, 2) && dm_flow_run(&w, NULL) == DM_OK);
    CHECK(w.uppers == 1 && w.rests == 1 && w.rest[0].cell == 0 && w.rest[0].coefficient == 2);
    /* what leaves 64 bits is told, and leaves nothing behind */
    CHECK(dm_flow_add(&w, 0, INT64_MAX) && dm_flow_add(&w, 3, 2));
    CHECK(dm_flow_run(&w, NULL) == DM_TOO_LARGE);
    CHECK(dm_flow_add(&w, 3, 2) && dm_flow_run(&w, NULL) == DM_OK && w.rest[0].coefficient == 2);
    dm_arena_release(&arena);
}

/* 2 4 4, -6 6 12, 10 4 16: divisors 2, 4, 624 of minors, so factors 2, 2, 156 */
static void smith_form(void) {
    static const int64_t A[] = {2, 4, 4, -6, 6, 12, 10, 4, 16}, factors[] = {2, 2, 156};
    dm_arena arena;
    dm_smith s;
    dm_arena_init(&arena, allocate, NULL);
    CHECK(dm_smith_open(&s, &arena, 3, 3) == DM_OK);
    for (int i = 0; i < 9; i++) s.D[i] = A[i];
    CHECK(dm_smith_form(&s, NULL) == DM_OK && s.rank == 3);
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++) {
            int64_t product = 0, unit_of_u = 0, unit_of_v = 0;
            for (int k = 0; k < 3; k++) {
                for (int l = 0; l < 3; l++)
                    product += s.U[3 * i + k] * A[3 * k + l] * s.V[3 * l + j];
                unit_of_u += s.U[3 * i + k] * s.W[3 * k + j];
                unit_of_v += s.V[3 * i + k] * s.X[3 * k + j];
            }
            CHECK(product == (i == j ? factors[i] : 0) && s.D[3 * i + j] == product);
            CHECK(unit_of_u == (i == j) && unit_of_v == (i == j));
        }
    dm_arena_release(&arena);
}

int main(void) {
    RUN(spheres, "spheres have two critical cells, in an order that can be built");
    RUN(flows, "chains flow to critical cells");
    RUN(smith_form, "Smith's form and what makes it");
    return check_finish();
}
