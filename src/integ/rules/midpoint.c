/* midpoint.c - the implicit midpoint rule: Ld = h L((q0 + q1)/2, (q1 - q0)/h). */
#include "integ/stage/stage.h"

/* One velocity at one point. */
static void basis(dm_galerkin *g, const dm_rule *rule) {
    dm_quadrature q;
    (void)rule;
    dm_quadrature_gauss(&q, 1);
    dm_galerkin_collocation(g, &q);
}

const dm_method dm_method_midpoint = {
    .name = "midpoint",
    .aliases = "implicit-midpoint",
    .signature = "midpoint",
    .doc = "Implicit midpoint rule, order 2; n unknowns a step, bounded for stiff springs (HLW "
           "VI.6.3, Marsden-West 2001 ex. 2.3.2). Constraints, rolling, forces: one multiplier "
           "each, same order.",
    .orders = "2",
    .stages = "1",
    .cost = "n unknowns",
    .instances = "midpoint:1:0",
    .traits = DM_SYMMETRIC | DM_SYMPLECTIC | DM_FORMULA | DM_CONSTRAINTS,
    .engine = &dm_engine_stage,
    .basis = basis,
};
