/* midpoint.c - the implicit midpoint rule: Ld = h L((q0 + q1)/2, (q1 - q0)/h). */
#include "integ/stage/lanes/stage_lanes.h"
#include "integ/constrained/constrained.h"

static const char *check(const dm_rule *rule) {
    return rule->count ? "midpoint takes no argument" : NULL;
}

static int order(const dm_rule *rule) {
    (void)rule;
    return 2;
}

static size_t work(const dm_rule *rule, const dm_model *m) {
    (void)rule;
    return dm_stage_work(1, 1, m);
}

static void basis(dm_galerkin *g, const dm_rule *rule) {
    dm_quadrature q;
    (void)rule;
    dm_quadrature_gauss(&q, 1);
    dm_galerkin_collocation(g, &q);
}

static dm_status open(dm_stepper *s) {
    dm_galerkin g;
    basis(&g, s->rule);
    return dm_stage_open(s, &g);
}

const dm_method dm_method_midpoint = {
    .name = "midpoint",
    .signature = "midpoint",
    .doc = "Implicit midpoint rule, order 2; n unknowns a step, bounded for stiff springs "
           "(HLW VI.6.3, Marsden-West 2001 ex. 2.3.2). Constraints, rolling, forces: one "
           "multiplier each, same order.",
    .orders = "2",
    .stages = "1",
    .cost = "n unknowns",
    .instances = "midpoint:1:0",
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
