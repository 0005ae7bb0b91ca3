/* curves.h - a curve segment on a model of models.h, for the tests of curves. */
#ifndef CURVES_H
#define CURVES_H

#include "check.h"
#include "integ/curve/curve_segment.h"
#include "models.h"
#include "problems.h"

static const char *const methods[] = {"euler",   "midpoint",  "heun",      "kutta3",   "rk4",
                                      "dopri5",  "butcher6",  "fehlberg7", "dop853",   "gsl-rk2",
                                      "gsl-rk4", "gsl-rkf45", "gsl-rkck",  "gsl-rk8pd"};
enum { METHODS = sizeof methods / sizeof *methods };

/* weights of the central difference of order 6 */
static const double DIFFERENCE[3] = {45.0, -9.0, 1.0};

typedef struct {
    dm_model model;
    dm_arena arena;
    uint32_t n;
    dm_curve curve;
    dm_segment segment;
    double *memory, *y;
} bench;

/* L(q, v, t) with a mass that varies, terms linear in v, and time */
static inline dm_node crooked(dm_graph *g, const dm_node *q, const dm_node *v) {
    const dm_node t = dm_input(g, 4), one = dm_constant(g, 1.5);
    const dm_node bend = dm_apply(g, DM_OP_COS, q[1], 0, 0);
    const dm_node mass = dm_add(g, one, bend);
    const dm_node cross = graph_product(g, v[0], v[1], q[0], t);
    const dm_node swirl = graph_product(g, v[0], q[1], q[1], one);
    const dm_node quartic = graph_product(g, v[1], v[1], v[1], v[1]);
    const dm_node slow = times_of(g, 0.1, quartic);
    const dm_node T = dm_mul(g, mass, sum_of_squares(g, v, 2));
    const dm_node height = dm_apply(g, DM_OP_SIN, dm_mul(g, q[0], q[1]), 0, 0);
    const dm_node all = dm_add(g, dm_add(g, T, times_of(g, 0.2, cross)), slow);
    return dm_sub(g, dm_add(g, all, swirl), height);
}

static const model curved = {"crooked", 2, crooked};

static inline int bench_open(bench *b, const model *m, const char *method, double bias) {
    dm_node x[2 * 16];
    *b = (bench){.n = m->n};
    dm_arena_init(&b->arena, problem_allocate, NULL);
    dm_graph *g = dm_graph_new(&b->arena, 2 * m->n + 1);
    for (uint32_t i = 0; i < 2 * m->n; i++) x[i] = dm_input(g, i);
    const dm_node L = m->lagrangian(g, x, x + m->n);
    const unsigned want = DM_WANT_VALUE | DM_WANT_SLOPE | DM_WANT_MASS | DM_WANT_ENERGY;
    if (dm_model_build(&b->model, g, L, m->n, want, dm_tape_build, &b->arena) != DM_OK) return 0;
    if (!dm_curve_find(&b->curve, method) || !dm_curve_bias(&b->curve, bias)) return 0;
    b->memory = calloc(dm_segment_work(&b->curve, &b->model) + 2 * m->n, sizeof(double));
    b->y = b->memory + dm_segment_work(&b->curve, &b->model);
    for (uint32_t i = 0; i < 2 * m->n; i++) b->y[i] = 0.5 + 0.1 * ((7 * i) % 5);
    return dm_segment_open(&b->segment, &b->curve, &b->model, b->memory) == DM_OK;
}

static inline void bench_close(bench *b) {
    free(b->memory);
    dm_arena_release(&b->arena);
}

#endif
