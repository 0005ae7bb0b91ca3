/* lobatto.c - the Lobatto IIIA-IIIB pair of any stage number. */
#include "integ/stage/stage.h"

/* The one argument. */
static int stages(const dm_rule *rule) {
    return (int)rule->arg[0].number;
}

static const char *check(const dm_rule *rule) {
    const double s = rule->arg[0].number;
    if (rule->count != 1 || rule->arg[0].rule || s != (int)s || s < 2 || s > DM_QUADRATURE_NODES)
        return "lobatto takes one whole number of stages from 2 to 32";
    return NULL;
}

/* Two less than Gauss nodes: both ends are given. */
static int order(const dm_rule *rule) {
    return 2 * stages(rule) - 2;
}

/* Collocation with both ends: positions by IIIA, momenta by IIIB. */
static void basis(dm_galerkin *g, const dm_rule *rule) {
    dm_quadrature q;
    dm_quadrature_lobatto(&q, stages(rule));
    dm_galerkin_collocation(g, &q);
}

const dm_method dm_method_lobatto = {
    .name = "lobatto",
    .signature = "lobatto(s)",
    .doc = "Lobatto IIIA-IIIB pair with s stages, order 2 s - 2; implicit, s n unknowns a step, (s "
           "- 2) n when L = T(v) - V(q) (HLW II.2.2; variational: HLW VI.6.4). Constraints, "
           "rolling, forces: s - 1 multipliers each, same order (Jay 1996).",
    .orders = "2 s - 2",
    .stages = "s",
    .cost = "s n unknowns; (s - 2) n when L = T(v) - V(q)",
    .instances = "lobatto(2):2:2; lobatto(3):3:0; lobatto(4):4:0; lobatto(5):5:0; lobatto(6):6:0",
    .traits = DM_SYMMETRIC | DM_SYMPLECTIC | DM_CONSTRAINTS,
    .check = check,
    .order = order,
    .engine = &dm_engine_stage,
    .basis = basis,
};
