/* stage_one_point.c - the step of one_point.h for one member. Where its guess fails it begins from
 * a straight line; where that fails Newton's method takes the step. */
#include "integ/stage/lanes/one_point.h"
#include "integ/stage/stage_inside.h"

#include <string.h>

#define W 1
#define HOW
#define DM_LANES_FUSED 0
#include "integ/stage/lanes/one_point_text.h"

/* ---- memory ---- */

size_t dm_one_point_size(const dm_model *m) {
    if (m->n > DM_ONE_POINT_MOST) return 0;
    return dm_doubles(sizeof(dm_one_point)) + dm_one_point_doubles(m->n) +
           dm_one_point_inputs(m->n) + dm_one_point_outputs(m->n);
}

size_t dm_one_point_memory(const dm_stage *g) {
    return dm_one_point_doubles(g->n);
}

int dm_one_point_open(dm_stage *g, double *memory) {
    dm_one_point *w = (dm_one_point *)(void *)memory;
    const int one = g->table.s == 1 && g->table.r == 1 && g->table.A->top != 0.0;
    dm_kernel kernel;
    if (!g->separable || !one || !dm_one_point_kernel(&kernel, g->m, 1)) return 0;
    g->one_point = w;
    g->group.memory = memory + dm_doubles(sizeof *w);
    w->kernel = kernel;
    w->heaviest = dm_stage_heaviest(g->m);
    w->in = g->group.memory + dm_one_point_memory(g);
    w->out = w->in + dm_one_point_inputs(g->n);
    dm_kernel_prepare(&w->kernel, w->out);
    dm_one_point_clear(g, g->weights.h);
    return 1;
}

void dm_one_point_clear(dm_stage *g, double h) {
    memset(g->group.memory, 0, dm_one_point_memory(g) * sizeof *g->group.memory);
    g->group.memory[DM_WARM_STEP] = h;
}

/* ---- the step ---- */

/* iterate, and tell of it */
INLINE int find_root(one_point_step *a, dm_stage *g, dm_stepper *stepper) {
    const int found = iterate(a, 1);
    g->evaluations += 2 * a->calls;
    stepper->report.iterations += 2 * a->calls;
    stepper->report.residual = a->left * a->kernel->heaviest / fabs(g->weights.h);
    return found;
}

INLINE dm_status step(dm_stage *g, dm_stepper *stepper, uint32_t n) {
    one_point_step a = {.g = g, .group = &g->group, .kernel = g->one_point, .n = n};
    double *guess = g->one_point->in + 2 * n;
    const int known = g->one_point->known = goes_on(&g->group, n);
    int found = 0;
    place_start(&a);
    if (known) {
        place_guess(&a);
        found = find_root(&a, g, stepper);
    }
    if (!found) {
        dm_stage_copy(guess, guess - n, n);
        found = find_root(&a, g, stepper);
    }
    if (!found || !finish_one_point(&a)) return DM_NO_CONVERGENCE;
#pragma GCC unroll 16
    for (uint32_t k = 0; k < 4 * n; k++) g->group.state[k] = a.end[k];
    if (g->group.memory[DM_WARM_STEP] == g->weights.h) keep(&a, 1, known);
    return DM_OK;
}

dm_status dm_one_point_step(dm_stage *g, dm_stepper *stepper) {
    stepper->report.iterations = 0;
    g->group.tolerance = stepper->tolerance;
    if (!g->weights.complete) dm_stage_weights_complete(g);
    switch (g->n) {
    case 1:
        return step(g, stepper, 1);
    case 2:
        return step(g, stepper, 2);
    case 3:
        return step(g, stepper, 3);
    default:
        return step(g, stepper, 4);
    }
}

/* after a step by Newton's method: its root is Z without what the state lacks */
void dm_one_point_newton(dm_stage *g) {
    const uint32_t n = g->n;
    one_point_step a = {.g = g, .group = &g->group, .kernel = g->one_point, .n = n};
    if (g->group.memory[DM_WARM_STEP] != g->weights.h) return;
    for (uint32_t k = 0; k < n; k++) a.Z[k] = g->newton.root[k];
    for (uint32_t k = 0; k < 4 * n; k++) a.end[k] = g->group.state[k];
    keep(&a, 1, g->one_point->known);
}
