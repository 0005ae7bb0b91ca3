/* lie_rule.c - lie(s [, quadrature] [, exp | cayley | pade(k)]) as a row. */
#include "integ/lie/lie.h"
#include "integ/method/stage_table.h"
#include "integ/rules/galerkin.h"

#include <math.h>
#include <string.h>

/* The first argument. */
static int degree(const dm_rule *rule) {
    return (int)rule->arg[0].number;
}

/* -1: it is no map. The Pade approximant of degree 1 is the Cayley map. */
static int tau_of(const dm_rule *arg) {
    if (strcmp(arg->name, "exp") == 0 && !arg->count) return DM_TAU_EXP;
    if (strcmp(arg->name, "cayley") == 0 && !arg->count) return DM_TAU_CAYLEY;
    if (strcmp(arg->name, "pade") != 0 || arg->count != 1 || arg->arg[0].rule) return -1;
    for (int k = 0; k < DM_TAUS - DM_TAU_CAYLEY; k++)
        if (arg->arg[0].number == k + 1) return DM_TAU_CAYLEY + k;
    return -1;
}

/* The last argument may be a map, the second a quadrature. */
static const dm_rule *named(const dm_rule *rule, int i) {
    return i < rule->count ? rule->arg[i].rule : NULL;
}

dm_tau dm_lie_tau(const dm_rule *rule) {
    for (int i = 1; i < rule->count; i++)
        if (named(rule, i) && tau_of(named(rule, i)) >= 0) return (dm_tau)tau_of(named(rule, i));
    return DM_TAU_EXP;
}

/* NULL: gauss(s). */
static const dm_rule *quadrature_of(const dm_rule *rule) {
    const dm_rule *q = named(rule, 1);
    return q && tau_of(q) < 0 ? q : NULL;
}

/* Of a quadrature by name. */
static int nodes(const dm_rule *q) {
    return (int)q->arg[0].number;
}

/* A whole number that is not too large. */
static int is_count(double number, int least) {
    return number >= least && number <= DM_QUADRATURE_NODES && number == floor(number);
}

/* What stands where is told by the names of the arguments. */
static const char *check(const dm_rule *rule) {
    const dm_rule *q = quadrature_of(rule);
    const int last = q ? 2 : 1;
    if (rule->count < 1 || rule->arg[0].rule || !is_count(rule->arg[0].number, 1))
        return "lie takes the degree of its curves, from 1 to 32";
    const dm_quadrature_row *row = q ? dm_quadrature_find(q->name) : NULL;
    if (q && (!row || q->count != 1 || q->arg[0].rule || !is_count(q->arg[0].number, row->least)))
        return "behind the degree come a quadrature, as gauss(2), and a map, exp, cayley "
               "or pade(k), k from 1 to 4";
    if (q && nodes(q) < degree(rule))
        return "curves of degree s need a quadrature of s nodes at least";
    if (rule->count > last + 1 ||
        (rule->count > last && !(named(rule, last) && tau_of(named(rule, last)) >= 0)))
        return "its last argument is a map from the algebra, exp, cayley or pade(k), k from 1 to 4";
    return NULL;
}

/* That of the Galerkin method of the same degree and quadrature. */
static void basis(dm_galerkin *g, const dm_rule *rule) {
    const dm_rule *named_quadrature = quadrature_of(rule);
    dm_quadrature q;
    if (named_quadrature)
        dm_quadrature_find(named_quadrature->name)->fill(&q, nodes(named_quadrature));
    else
        dm_quadrature_gauss(&q, degree(rule));
    dm_galerkin_of(g, degree(rule), &q);
}

/* The chart does not change it. */
static int order(const dm_rule *rule) {
    dm_galerkin g;
    basis(&g, rule);
    return dm_galerkin_order(&g);
}

const dm_method dm_method_lie = {
    .name = "lie",
    .signature = "lie(s [, quadrature] [, exp | cayley | pade(k)])",
    .doc = "Lie group variational integrator of degree s on any group: curves g0 tau(xi(t)) in the "
           "natural chart about the start of a step, tau = exp, the Cayley map or a diagonal Pade "
           "approximant of exp (k from 1, which is Cayley's, to 4), the action by "
           "gauss(s) or another quadrature; order 2 s, s dim G unknowns a step (Leok 5.3.2, with "
           "the signs of B7). Symplectic, keeps momentum maps and coadjoint orbits. With "
           "constraints and "
           "rolling conditions s multipliers a step for each, and one for the hidden constraint; "
           "lie(1) is RATTLE on the group; chains of bodies are solved as a band. On R^n it is "
           "galerkin(s, quadrature).",
    .orders = "that of galerkin: 2 s for gauss(s) and lobatto(s + 1)",
    .stages = "r",
    .cost = "s dim G unknowns",
    .instances = "lie(1):1:0; lie(2):2:0; lie(3):3:0; lie(2, lobatto(3)):3:0",
    .traits = DM_SYMPLECTIC | DM_CONSTRAINTS | DM_ON_GROUPS,
    .check = check,
    .order = order,
    .engine = &dm_engine_lie,
    .basis = basis,
};
