/* built.h - a model that a test builds from an L of its own, node by node. */
#ifndef DM_TEST_BUILT_H
#define DM_TEST_BUILT_H

#include "problems.h"

static uint64_t seed = 7;

/* uniform in [-1, 1) */
static inline double random_number(void) {
    seed = seed * 6364136223846793005u + 1442695040888963407u;
    return (double)(seed >> 11) * 0x1p-52 - 1.0;
}

typedef struct {
    dm_arena arena;
    dm_graph *g;
    dm_model model;
} built;

static inline void start(built *b, uint32_t inputs) {
    dm_arena_init(&b->arena, problem_allocate, NULL);
    b->g = dm_graph_new(&b->arena, inputs);
    b->model = (dm_model){0};
}

static inline dm_status finish(built *b, dm_node L, uint32_t n) {
    return dm_model_build(&b->model, b->g, L, n, 63, dm_tape_build, &b->arena);
}

static inline void stop(built *b) {
    dm_arena_release(&b->arena);
}

static inline dm_node number(built *b, double x) {
    return dm_constant(b->g, x);
}

static inline dm_node input(built *b, uint32_t i) {
    return dm_input(b->g, i);
}

static inline dm_node times(built *b, dm_node x, dm_node y) {
    return dm_mul(b->g, x, y);
}

#endif
