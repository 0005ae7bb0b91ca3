/* gauss.c - Gauss collocation of any stage number. */
#include "integ/stage/stage.h"

#include <math.h>

/* The first argument. */
static int stages(const dm_rule *rule) {
    return (int)rule->arg[0].number;
}

/* sweeps a step, 0: to round-off */
static int sweeps(const dm_rule *rule) {
    return rule->count > 1 ? (int)rule->arg[1].number : 0;
}

/* A whole number from 1 on. */
static int is_count(double number, int most) {
    return number >= 1 && number <= most && number == floor(number);
}

static const char *check(const dm_rule *rule) {
    enum { SWEEPS = 50 };
    if (rule->count < 1 || rule->count > 2 || rule->arg[0].rule ||
        !is_count(rule->arg[0].number, DM_QUADRATURE_NODES))
        return "gauss takes one whole number of stages from 1 to 32";
    if (rule->count == 2 && (rule->arg[1].rule || !is_count(rule->arg[1].number, SWEEPS)))
        return "the second argument of gauss is a whole number of sweeps from 1 to 50";
    return NULL;
}

static int order(const dm_rule *rule) {
    return 2 * stages(rule);
}

/* Collocation at the zeros of P_s. */
static void basis(dm_galerkin *g, const dm_rule *rule) {
    dm_quadrature q;
    dm_quadrature_gauss(&q, stages(rule));
    dm_galerkin_collocation(g, &q);
    g->sweeps = sweeps(rule);
}

const dm_method dm_method_gauss = {
    .name = "gauss",
    .signature = "gauss(s [, sweeps])",
    .doc = "Gauss collocation with s stages, order 2 s; implicit, s n unknowns a step (HLW II.1.3; "
           "variational: HLW VI.6.4, Leok 2.4). The step equation is solved to round-off; a number "
           "of sweeps, as in gauss(8, 4), ends the fixed-point iteration there: cheaper, "
           "symplectic and symmetric only up to the error left. Constraints, rolling, forces: s "
           "multipliers each, same order (Jay 2007, 2009).",
    .orders = "2 s",
    .stages = "s",
    .cost = "s n unknowns",
    .instances = "gauss(1):1:0; gauss(2):2:0; gauss(3):3:0; gauss(4):4:0; gauss(5):5:0; "
                 "gauss(6):6:0; gauss(7):7:0; gauss(8):8:0",
    .traits = DM_SYMMETRIC | DM_SYMPLECTIC | DM_CONSTRAINTS,
    .check = check,
    .order = order,
    .engine = &dm_engine_stage,
    .basis = basis,
};
