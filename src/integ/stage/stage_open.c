/* stage_open.c - what a step of stages wants of its model, which form it takes, and its memory. */
#include "base/doubles.h"
#include "integ/stage/lanes/one_point.h"
#include "integ/stage/stage_inside.h"
#include "integ/stage/sweep/stage_sweep.h"
#include "integ/stage/workspace/stage_warm.h"

#include "linalg/solve/newton.h"

#include <math.h>
#include <string.h>

static const unsigned SIMPLE = DM_SEPARABLE | DM_CONSTANT_MASS;

unsigned dm_stage_wants(const dm_rule *rule, const dm_model *m) {
    (void)rule;
    const int simple = (m->structure & SIMPLE) == SIMPLE;
    return simple ? DM_WANT_STAGE_LATER | DM_WANT_FORCE
                  : DM_WANT_STAGE | DM_WANT_SLOPE | DM_WANT_MASS;
}

/* The first guess, which lays M and its pivots there, then Newton's method; factors that stay from
 * step to step lie behind the guess. */
static size_t scratch_size(size_t s, size_t r, const dm_model *m) {
    const size_t n = m->n, unknowns = dm_larger(s, r) * n;
    return dm_newton_work((uint32_t)unknowns) + dm_legendre_work(m) + n * n + n;
}

/* struct, table, weights and arrays of Newton's method, then room for each of the other roads */
size_t dm_stage_work(size_t s, size_t r, const dm_model *m) {
    const size_t n = m->n, curve = 2 * n + 3 * n * n;
    return dm_doubles(sizeof(dm_stage)) + dm_stage_table_size(s, r) + dm_stage_weights_size(s, r) +
           2 * n + 1 + r * 2 * n + r * curve + 2 * dm_larger(s, r) * n + 2 * n + 2 * r * n + 4 * n +
           n + 1 + 2 * dm_doubles(r * 4) + scratch_size(s, r, m) +
           dm_step_matrix_work((uint32_t)(dm_larger(s, r) * n)) + dm_one_point_size(m) +
           dm_stage_warm_size(s, m->n) + dm_stage_sweeps_size(s, r, m);
}

/* returns what is left */
static double *lay_out(dm_stage *g, double *memory) {
    dm_stage_newton *w = &g->newton;
    dm_stage_points *p = &g->points;
    const size_t n = g->n, s = g->table.s, r = g->table.r;
    w->x = dm_take(&memory, 2 * n + 1);
    w->slopes = dm_take(&memory, r * 2 * n);
    w->curve = dm_take(&memory, r * (2 * n + 3 * n * n));
    w->root = dm_take(&memory, dm_larger(s, r) * n);
    p->v0 = dm_take(&memory, n);
    p->a0 = dm_take(&memory, n);
    p->u = dm_take(&memory, r * n);
    p->base = dm_take(&memory, r * n);
    g->group.next = dm_take(&memory, 4 * n);
    p->kind = (uint32_t *)(void *)dm_take(&memory, dm_doubles(r * sizeof(uint32_t)));
    w->solved = (uint32_t *)(void *)dm_take(&memory, dm_doubles(r * sizeof(uint32_t)));
    w->place = dm_take(&memory, n + 1);
    w->lists = dm_take(&memory, dm_step_matrix_work((uint32_t)(dm_larger(s, r) * n)));
    g->room = scratch_size(s, r, g->m);
    g->scratch = dm_take(&memory, g->room);
    g->before.root = dm_take(&memory, dm_larger(s, r) * n);
    w->missed = g->before.root; /* which continuation has done with */
    return memory;
}

/* sweeps, a step of one point or Newton's method alone, as method and model have it */
static void choose_road(dm_stage *g, const dm_galerkin *basis, double *memory) {
    if (!basis->sweeps && dm_one_point_open(g, memory)) return;
    memory += dm_one_point_size(g->m);
    dm_stage_sweeps_open(g, basis, memory + dm_stage_warm_size(g->table.s, g->n));
    if (!g->sweeps && !g->separable) dm_stage_warm_open(g, basis, memory);
}

dm_status dm_stage_open(dm_stepper *stepper, const dm_galerkin *basis) {
    dm_stage *g = dm_stage_of(stepper);
    const dm_model *m = stepper->model;
    double *memory = stepper->work + dm_doubles(sizeof *g);
    *g = (dm_stage){.m = m, .n = m->n};
    g->weights.h = NAN; /* of no step yet */
    g->group.h = &g->weights.h;
    g->separable = (m->structure & SIMPLE) == SIMPLE;
    g->newton.slope = g->separable ? &m->force : &m->slope;
    dm_stage_table_find(&g->table, basis, m, memory);
    memory += dm_stage_table_size(g->table.s, g->table.r);
    dm_stage_weights_place(&g->weights, &g->table, memory);
    memory = lay_out(g, memory + dm_stage_weights_size(g->table.s, g->table.r));
    if (g->separable) dm_stage_separable_open(g);
    choose_road(g, basis, memory);
    if (g->one_point) stepper->report.operations = g->one_point->kernel.operations;
    return DM_OK;
}
