#include "integ/method/method.h"

#include "integ/method/lift.h"
#include "integ/method/stage_table.h"
#include "mech/constraints.h"

#include <math.h>
#include <stdlib.h>

/* Without a check of its own a method takes no argument. */
const char *dm_rule_check(const dm_rule *rule) {
    const dm_method *m = rule->method;
    if (m->check) return m->check(rule);
    return rule->count ? "it takes no argument" : NULL;
}

/* A fixed order is what the row says in words. */
int dm_rule_order(const dm_rule *rule) {
    const dm_method *m = rule->method;
    return m->order ? m->order(rule) : (int)strtol(m->orders, NULL, 10);
}

/* The engine of the row may know a better one for the model; what does not know groups steps their
 * lift. */
const dm_engine *dm_rule_engine(const dm_rule *rule, const dm_model *m) {
    const dm_engine *e = rule->method->engine;
    if (m->group && !(rule->method->traits & DM_ON_GROUPS)) return &dm_engine_lift;
    return e->choose ? e->choose(rule, m) : e;
}

/* Asked of the engine that would step it. */
const char *dm_rule_fits(const dm_rule *rule, const dm_model *m) {
    const dm_engine *e = dm_rule_engine(rule, m);
    if (m->group && m->structure & DM_HAMILTONIAN && !e->hamiltonian)
        return "it needs a Lagrangian, and this H has none (d2H/dp2 is singular, or H is not "
               "quadratic in p); gauss(s), midpoint and its compositions, rkmk4 and "
               "crouch-grossman3 step any H on a group";
    if (m->structure & DM_HAMILTONIAN && !e->hamiltonian)
        return "it needs a Lagrangian, and this H has none (d2H/dp2 is singular, or H is not "
               "quadratic in p); gauss(s), lobatto(s), midpoint, verlet and explicit Runge-Kutta "
               "rules step any H(q, p)";
    if (m->unfit) return m->unfit;
    if (m->sphere && !e->spheres)
        return "the values of this field are unit vectors; take rattle, or a composition of it";
    if (m->worked && !e->works)
        return "the field has forces beside L (force, absorbing), which it does not know; take "
               "verlet, midpoint, gauss(s) or rattle";
    return e->fits ? e->fits(rule, m) : NULL;
}

static const long double SAME = 1e-14L;

/* nodes and weights are their own mirror image; a tableau: a_ij + a_(s+1-i)(s+1-j) = b_j (HLW
 * V.2.1) */
static int is_symmetric(const dm_galerkin *g) {
    const int r = g->q.r;
    for (int i = 0; i < r; i++) {
        if (fabsl(g->q.c[i] + g->q.c[r - 1 - i] - 1.0L) > SAME ||
            fabsl(g->q.b[i] - g->q.b[r - 1 - i]) > SAME)
            return 0;
        for (int j = 0; g->tableau && j < r; j++)
            if (fabsl(g->a[i][j] + g->a[r - 1 - i][r - 1 - j] - g->q.b[j]) > SAME) return 0;
    }
    return 1;
}

/* Symmetry of a rule of stages is a property of its numbers, also of a user's. */
unsigned dm_rule_traits(const dm_rule *rule) {
    const dm_method *method = rule->method;
    dm_galerkin g = {.s = 0};
    if (!method->basis) return method->traits;
    method->basis(&g, rule);
    return method->traits | (g.s && is_symmetric(&g) ? DM_SYMMETRIC : 0);
}

/* One trait for every kind of constraint that is there. */
unsigned dm_method_needs(const dm_model *m) {
    unsigned needs = 0;
    if (m->constraints && m->constraints->holonomic) needs |= DM_HOLONOMIC;
    if (m->constraints && m->constraints->rolling) needs |= DM_ROLLING;
    if (m->constraints && m->constraints->forced) needs |= DM_FORCED;
    return needs;
}
