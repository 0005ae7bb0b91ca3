/* trapezoidal.c - Ld = h/2 [L(q0, v) + L(q1, v)] with v = (q1 - q0)/h. */
#include "integ/stage/stage.h"

/* one velocity, two points */
static void basis(dm_galerkin *g, const dm_rule *rule) {
    (void)rule;
    *g = (dm_galerkin){.s = 1, .node = {0.5L}};
    dm_quadrature_lobatto(&g->q, 2);
}

const dm_method dm_method_trapezoidal = {
    .name = "trapezoidal",
    .signature = "trapezoidal",
    .doc = "Trapezoidal discrete Lagrangian, order 2; n unknowns a step, none when L = T(v) - "
           "V(q), where it is Stoermer-Verlet (HLW VI.6.2, Marsden-West 2001 ex. 2.3.1). "
           "Constraints, rolling, forces: one multiplier each, same order.",
    .orders = "2",
    .stages = "2",
    .cost = "2 forces; else n unknowns",
    .instances = "trapezoidal:2:2",
    .traits = DM_SYMMETRIC | DM_SYMPLECTIC | DM_FORMULA | DM_CONSTRAINTS,
    .engine = &dm_engine_stage,
    .basis = basis,
};
