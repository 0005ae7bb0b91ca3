/* galerkin.c - polynomials of degree s with any quadrature (Marsden-West 2001 sec. 2.2.6, Leok
 * 2.4). */
#include "integ/rules/galerkin.h"
#include "integ/stage/stage.h"

#include <math.h>

/* The first argument. */
static int degree(const dm_rule *rule) {
    return (int)rule->arg[0].number;
}

/* The argument of the second one. */
static int nodes(const dm_rule *rule) {
    return (int)rule->arg[1].rule->arg[0].number;
}

static int is_count(double number, int least) {
    return number >= least && number <= DM_QUADRATURE_NODES && number == floor(number);
}

static const char *check_quadrature(const dm_rule *q) {
    const dm_quadrature_row *row = dm_quadrature_find(q->name);
    if (!row)
        return "its quadrature is one of gauss(r), lobatto(r), radau(r), radau-left(r), "
               "clenshaw-curtis(r); other nodes and weights: dm.galerkin{degree =, nodes =}";
    if (q->count != 1 || q->arg[0].rule || !is_count(q->arg[0].number, row->least))
        return "a quadrature takes a whole number of nodes from 1 to 32 (lobatto and "
               "clenshaw-curtis: from 2)";
    return NULL;
}

const char *dm_galerkin_check(const dm_rule *rule, const char *usage) {
    if (rule->count != 2 || rule->arg[0].rule || !is_count(rule->arg[0].number, 1) ||
        !rule->arg[1].rule)
        return usage;
    const char *wrong = check_quadrature(rule->arg[1].rule);
    if (!wrong && nodes(rule) < degree(rule))
        return "curves of degree s need a quadrature of s nodes at least: with fewer some velocity "
               "moves no node, and the step is not determined";
    return wrong;
}

static const char *check(const dm_rule *rule) {
    const char *usage = "galerkin takes the degree of its polynomials, from 1 to 32, and a "
                        "quadrature, as in galerkin(2, gauss(2))";
    return rule->data ? NULL : dm_galerkin_check(rule, usage); /* data: checked where it was made */
}

/* the velocities stand at the points where there are as many, else at Gauss nodes: the step does
 * not depend on it */
void dm_galerkin_of(dm_galerkin *g, int s, const dm_quadrature *q) {
    dm_galerkin_collocation(g, q);
    if (s == q->r) return;
    dm_quadrature velocities;
    dm_quadrature_gauss(&velocities, s);
    g->s = s;
    for (int j = 0; j < s; j++) g->node[j] = velocities.c[j];
}

/* pivots of G_jk = sum_i b_i l_j(c_i) l_k(c_i), which are those of the kinetic energy of a unit
 * mass */
int dm_galerkin_is_regular(const dm_galerkin *g) {
    static const long double LEAST = 1e-12L;
    long double G[DM_QUADRATURE_NODES][DM_QUADRATURE_NODES] = {{0}};
    for (int i = 0; i < g->q.r; i++) {
        long double l[DM_QUADRATURE_NODES];
        dm_lagrange_value(l, g->node, g->s, g->q.c[i]);
        for (int j = 0; j < g->s; j++)
            for (int k = 0; k < g->s; k++) G[j][k] += g->q.b[i] * l[j] * l[k];
    }
    for (int k = 0; k < g->s; k++) {
        if (!(fabsl(G[k][k]) > LEAST)) return 0;
        for (int i = k + 1; i < g->s; i++)
            for (int j = g->s - 1; j >= k; j--) G[i][j] -= G[i][k] / G[k][k] * G[k][j];
    }
    return 1;
}

/* As it was made by dm.galerkin, or by name. */
void dm_galerkin_basis(dm_galerkin *g, const dm_rule *rule) {
    dm_quadrature q;
    if (rule->data) {
        *g = *(const dm_galerkin *)rule->data;
        return;
    }
    dm_quadrature_find(rule->arg[1].rule->name)->fill(&q, nodes(rule));
    dm_galerkin_of(g, degree(rule), &q);
}

static int smaller(int a, int b) {
    return a < b ? a : b;
}

/* 2 s: the best curve of degree s (Hall & Leok 2015). e + 1: the action along it by a quadrature
 * exact to degree e. 2 (e - s + 2): L_v meets variations of degree s - 1 under that quadrature,
 * so that the velocities are off by h^(e - s + 2), and their error enters the extremal value
 * squared (measured in the tests: it is sharp). */
int dm_galerkin_order(const dm_galerkin *g) {
    static const double tolerance = 1e-12; /* a user has rounded nodes */
    const int exact = dm_quadrature_degree(&g->q, tolerance);
    return smaller(smaller(2 * g->s, exact + 1), 2 * (exact - g->s + 2));
}

static int order(const dm_rule *rule) {
    dm_galerkin g;
    dm_galerkin_basis(&g, rule);
    return dm_galerkin_order(&g);
}

const dm_method dm_method_galerkin = {
    .name = "galerkin",
    .signature = "galerkin(s, quadrature(r))",
    .doc = "Galerkin variational integrator: curves of degree s, the action by r nodes of gauss, "
           "lobatto, radau, radau-left or clenshaw-curtis; order the smaller of 2 s and the degree "
           "to which the quadrature is exact + 1; s n unknowns a step. Own nodes and weights: "
           "dm.galerkin. Marsden-West 2001 sec. 2.2.6, Leok 2.4; order: Hall & Leok 2015. "
           "Constraints, rolling, forces: s multipliers each, same order.",
    .orders = "least of 2 s, e + 1, 2 (e - s + 2), quadrature exact to degree e",
    .stages = "r",
    .cost = "s n unknowns",
    .instances = "galerkin(1, radau(1)):1:0; galerkin(1, radau-left(1)):1:0; galerkin(2, "
                 "radau(2)):2:0; galerkin(2, radau-left(2)):2:0; galerkin(3, radau(3)):3:0; "
                 "galerkin(4, radau(4)):4:0; galerkin(5, radau(5)):5:0; galerkin(6, radau(6)):6:0; "
                 "galerkin(7, radau(7)):7:0; galerkin(8, radau(8)):8:0; galerkin(2, gauss(2)):2:0; "
                 "galerkin(2, gauss(3)):3:0; galerkin(2, lobatto(3)):3:0; galerkin(3, "
                 "lobatto(4)):4:0; galerkin(2, radau(3)):3:0; galerkin(3, clenshaw-curtis(4)):4:0; "
                 "galerkin(4, clenshaw-curtis(4)):4:0; galerkin(5, clenshaw-curtis(5)):5:0",
    .traits = DM_SYMPLECTIC | DM_CONSTRAINTS,
    .check = check,
    .order = order,
    .engine = &dm_engine_stage,
    .basis = dm_galerkin_basis,
};
