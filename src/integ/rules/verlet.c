/* verlet.c - Stoermer-Verlet: explicit when L = T(v) - V(q, t), else Lobatto IIIA-IIIB of 2
 * stages. */
#include "integ/rules/verlet.h"
#include "integ/split/splitting.h"
#include "integ/stage/stage.h"

/* Where L does not separate: Lobatto nodes are both ends. */
static void basis(dm_galerkin *g, const dm_rule *rule) {
    dm_quadrature q;
    (void)rule;
    dm_quadrature_lobatto(&q, 2);
    dm_galerkin_collocation(g, &q);
}

/* One step of half a kick, a drift, half a kick. */
static int splitting(dm_splitting *out, const dm_rule *rule) {
    static const double one = 1.0;
    (void)rule;
    if (out) dm_splitting_compose(out, &one, 1);
    return 1;
}

const dm_method dm_method_verlet = {
    .name = "verlet",
    .aliases = "leapfrog, velocity-verlet, stoermer-verlet, stormer-verlet, strang",
    .signature = "verlet",
    .doc = "Stoermer-Verlet, kick-drift-kick, order 2; explicit, one force a step, when L = T(v) - "
           "V(q, t) with constant mass, else, and with forces beside L, the implicit Lobatto "
           "IIIA-IIIB pair of 2 stages (HLW I.1.4, VI.6.2).",
    .orders = "2",
    .stages = "2",
    .cost = "1 force; else 2 n unknowns",
    .instances = "verlet:2:1",
    .traits = DM_SYMMETRIC | DM_SYMPLECTIC | DM_FORCED,
    .engine = &dm_engine_stage,
    .basis = basis,
    .splitting = splitting,
};

const dm_rule dm_rule_verlet = {.name = "verlet", .method = &dm_method_verlet};
