/* trapezoidal.c - Ld = h/2 [L(q0, v) + L(q1, v)] with v = (q1 - q0)/h. */
#include "integ/stage/lanes/stage_lanes.h"
#include "integ/constrained/constrained.h"

static const char *check(const dm_rule *rule) {
    return rule->count ? "trapezoidal takes no argument" : NULL;
}

static int order(const dm_rule *rule) {
    (void)rule;
    return 2;
}

static size_t work(const dm_rule *rule, const dm_model *m) {
    (void)rule;
    return dm_stage_work(1, 2, m);
}

/* one velocity, two points */
static void basis(dm_galerkin *g, const dm_rule *rule) {
    (void)rule;
    *g = (dm_galerkin){.s = 1, .node = {0.5L}};
    dm_quadrature_lobatto(&g->q, 2);
}

static dm_status open(dm_stepper *s) {
    dm_galerkin g;
    basis(&g, s->rule);
    return dm_stage_open(s, &g);
}

const dm_method dm_method_trapezoidal = {
    .name = "trapezoidal",
    .signature = "trapezoidal",
    .doc = "Trapezoidal discrete Lagrangian, order 2; n unknowns a step, none when L = "
           "T(v) - V(q), "
           "where it is Stoermer-Verlet (HLW VI.6.2, Marsden-West 2001 ex. 2.3.1). "
           "Constraints, rolling, forces: one multiplier each, same order.",
    .orders = "2",
    .stages = "2",
    .cost = "2 forces; else n unknowns",
    .instances = "trapezoidal:2:2",
    .traits = DM_SYMMETRIC | DM_SYMPLECTIC | DM_KEEPS | DM_CONSTRAINTS,
    .check = check,
    .order = order,
    .basis = basis,
    .wants = dm_stage_wants,
    .work = work,
    .open = open,
    .start = dm_stage_start,
    .step = dm_stage_step,
    .memory = dm_stage_memory,
    .impulses = dm_constrained_impulses,
    .widen = dm_stage_widen,
    .advance_lanes = dm_stage_advance_lanes,
};
