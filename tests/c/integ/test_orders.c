/* test_orders.c - the order of every rule, measured: the error at time T against the exact
 * solution for N and 2 N steps, N where the error is small but far above round-off. */
#include "check.h"
#include "integ/method/quadrature.h"
#include "integ/registry.h"
#include "integ/rules/sprk.h"
#include "integ/stage/stage.h"
#include "problems.h"

#include <gsl/gsl_integration.h>

typedef struct {
    const char *rule;
    double order;
    long kepler, pendulum; /* N on the two problems, 0: not there */
} row;

static const row rows[] = {
    {"verlet", 2, 800, 800},     {"midpoint", 2, 800, 800},   {"trapezoidal", 2, 800, 800},
    {"gauss(1)", 2, 800, 800},   {"gauss(2)", 4, 400, 400},   {"gauss(3)", 6, 200, 100},
    {"gauss(4)", 8, 100, 50},    {"gauss(5)", 10, 40, 0},     {"lobatto(2)", 2, 800, 800},
    {"lobatto(3)", 4, 400, 400}, {"lobatto(4)", 6, 100, 100}, {"lobatto(5)", 8, 50, 50},
    {"rk4", 4, 800, 400},        {"rkf45", 5, 800, 400},      {"rk8pd", 8, 100, 0},
    {"rk8", 8, 100, 0},
};

/* distance of q at time T from `exact`; NaN when the run fails */
static double error_of(const problem *p, const char *rule, double T, long N, const double *exact) {
    session x;
    double sum = 0.0;
    const int fine = session_open(&x, p, rule, T / (double)N) && session_run(&x, N) == DM_OK;
    for (uint32_t i = 0; i < p->n; i++) sum += pow(x.state[i] - exact[i], 2);
    session_close(&x);
    return fine ? sqrt(sum) : NAN;
}

static void check_order(const problem *p, const row *r, double T, long N, const double *exact) {
    const double coarse = error_of(p, r->rule, T, N, exact);
    const double fine = error_of(p, r->rule, T, 2 * N, exact);
    if (!CHECK_NEAR(log2(coarse / fine), r->order, 0.05)) printf("# %s\n", r->rule);
    CHECK(fine > 1e-14);
    dm_rule nodes[DM_RULE_NODES];
    CHECK(dm_rule_read(nodes, r->rule, NULL) == NULL);
    CHECK(dm_rule_order(nodes) == (int)r->order);
}

/* from the far end of the ellipse through the near one; exact by Kepler's equation */
static void orders_on_kepler(unsigned structure) {
    const double e = 0.6, b = 0.8, T = 4.0;
    double E = PI + T, exact[2];
    problem p;
    for (int i = 0; i < 50; i++) E -= (E - e * sin(E) - PI - T) / (1.0 - e * cos(E));
    exact[0] = cos(E) - e, exact[1] = b * sin(E);
    problem_kepler(&p, structure);
    p.q[0] = -1.0 - e;
    p.v[1] = -b / (1.0 + e);
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++)
        check_order(&p, rows + i, T, rows[i].kepler, exact);
}

static void orders_on_separable_kepler(void) {
    orders_on_kepler(PROBLEM_SEPARABLE);
}

static void orders_on_kepler_taken_as_general(void) {
    orders_on_kepler(PROBLEM_GENERAL);
}

/* two independent methods agree on where the double spherical pendulum is at time T */
static void reference(const problem *p, double T, double *exact) {
    session x;
    CHECK(session_open(&x, p, "gauss(7)", T / 400) && session_run(&x, 400) == DM_OK);
    memcpy(exact, x.state, p->n * sizeof *exact);
    session_close(&x);
    CHECK(error_of(p, "rk8pd", T, 3000, exact) < 5e-14);
}

static void orders_on_the_double_spherical_pendulum(void) {
    static const row prince_dormand = {"rk8pd", 8, 0, 80};
    double exact[4];
    problem p;
    CHECK(problem_double_pendulum(&p) == DM_OK);
    reference(&p, 1.0, exact);
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++)
        if (rows[i].pendulum) check_order(&p, rows + i, 1.0, rows[i].pendulum, exact);
    reference(&p, 1.5, exact);
    check_order(&p, &prince_dormand, 1.5, 80, exact);
    problem_close(&p);
}

/* ---- time in L: the points of a step must be taken at their own times ---- */

static void build(problem *p, dm_graph *g, dm_node L) {
    CHECK(dm_model_build(&p->model, g, L, 1, 63, dm_tape_build, &p->arena) == DM_OK);
}

static dm_graph *new_graph(problem *p) {
    *p = (problem){.n = 1};
    dm_arena_init(&p->arena, problem_allocate, NULL);
    return dm_graph_new(&p->arena, 3);
}

/* L = v^2/2 - q^2/2 + q cos 2t, q = cos t + sin t - cos(2t)/3: separable */
static void orders_with_a_force_that_varies_in_time(void) {
    problem p;
    dm_graph *g = new_graph(&p);
    const dm_node q = dm_input(g, 0), v = dm_input(g, 1), t = dm_input(g, 2);
    const dm_node half = dm_constant(g, 0.5), drive = dm_apply(g, DM_OP_COS, dm_add(g, t, t), 0, 0);
    dm_node L = dm_sub(g, dm_mul(g, v, v), dm_mul(g, q, q));
    build(&p, g, dm_add(g, dm_mul(g, half, L), dm_mul(g, q, drive)));
    CHECK(p.model.structure & DM_SEPARABLE && !(p.model.structure & DM_AUTONOMOUS));
    p.q[0] = 2.0 / 3.0, p.v[0] = 1.0;
    const double T = 3.0, exact = cos(T) + sin(T) - cos(2 * T) / 3.0;
    static const row timed[] = {{"verlet", 2, 400, 0},     {"midpoint", 2, 400, 0},
                                {"gauss(2)", 4, 100, 0},   {"gauss(3)", 6, 20, 0},
                                {"lobatto(3)", 4, 100, 0}, {"trapezoidal", 2, 400, 0},
                                {"rk4", 4, 200, 0}};
    for (size_t i = 0; i < sizeof timed / sizeof *timed; i++)
        check_order(&p, timed + i, T, timed[i].kepler, &exact);
    problem_close(&p);
}

/* L = exp(t) v^2/2 - exp(t) q^2/2, q'' + q' + q = 0: general, damped in time */
static void orders_with_a_mass_that_grows_in_time(void) {
    problem p;
    dm_graph *g = new_graph(&p);
    const dm_node q = dm_input(g, 0), v = dm_input(g, 1);
    const dm_node grow = dm_apply(g, DM_OP_EXP, dm_input(g, 2), 0, 0);
    const dm_node L = dm_sub(g, dm_mul(g, v, v), dm_mul(g, q, q));
    build(&p, g, dm_mul(g, dm_mul(g, dm_constant(g, 0.5), grow), L));
    CHECK(!(p.model.structure & (DM_AUTONOMOUS | DM_CONSTANT_MASS | DM_SEPARABLE)));
    const double T = 2.0, w = sqrt(0.75);
    const double exact = exp(-T / 2) * (cos(w * T) + sin(w * T) / (2 * w));
    p.q[0] = 1.0, p.v[0] = 0.0;
    static const row timed[] = {{"verlet", 2, 400, 0},    {"midpoint", 2, 400, 0},
                                {"gauss(2)", 4, 50, 0},   {"gauss(3)", 6, 20, 0},
                                {"lobatto(3)", 4, 50, 0}, {"trapezoidal", 2, 400, 0},
                                {"rk4", 4, 100, 0}};
    for (size_t i = 0; i < sizeof timed / sizeof *timed; i++)
        check_order(&p, timed + i, T, timed[i].kepler, &exact);
    problem_close(&p);
}

/* ---- coefficients ---- */

static void gauss_nodes_are_those_of_gsl(void) {
    for (int r = 1; r <= 20; r++) {
        dm_quadrature q;
        gsl_integration_glfixed_table *table = gsl_integration_glfixed_table_alloc((size_t)r);
        dm_quadrature_gauss(&q, r);
        for (int i = 0; i < r; i++) {
            double c, b;
            gsl_integration_glfixed_point(0.0, 1.0, (size_t)i, &c, &b, table);
            CHECK_NEAR((double)q.c[i], c, 4e-16);
            CHECK_NEAR((double)q.b[i], b, 4e-16);
        }
        gsl_integration_glfixed_table_free(table);
    }
}

static void lobatto_nodes_in_closed_form(void) {
    dm_quadrature q;
    dm_quadrature_lobatto(&q, 4); /* HLW II.1.8: (5 -+ sqrt 5)/10, weights 1/12, 5/12 */
    CHECK_NEAR((double)q.c[1], (5.0 - sqrt(5.0)) / 10.0, 1e-16);
    CHECK_NEAR((double)q.b[0], 1.0 / 12.0, 1e-16);
    CHECK_NEAR((double)q.b[1], 5.0 / 12.0, 1e-16);
    dm_quadrature_lobatto(&q, 5);
    CHECK_NEAR((double)q.c[1], 0.5 - sqrt(21.0) / 14.0, 1e-16);
    CHECK_NEAR((double)q.b[2], 16.0 / 45.0, 1e-16);
}

/* sum b_i c_i^k = 1/(k+1) up to the degree promised, for every number of nodes */
static void quadratures_are_as_exact_as_promised(void) {
    for (int r = 1; r <= DM_QUADRATURE_NODES; r++)
        for (int lobatto = 0; lobatto < 2; lobatto++) {
            dm_quadrature q;
            if (lobatto && r < 2) continue;
            (lobatto ? dm_quadrature_lobatto : dm_quadrature_gauss)(&q, r);
            for (int k = 0; k <= 2 * r - 1 - 2 * lobatto; k++) {
                long double sum = 0.0L;
                for (int i = 0; i < r; i++) sum += q.b[i] * powl(q.c[i], k);
                CHECK_NEAR((double)(sum * (k + 1) - 1.0L), 0.0, 2e-15 * (k + 1));
            }
        }
}

/* and Radau and Clenshaw-Curtis; not one degree more */
static void quadratures_with_names(void) {
    for (const dm_quadrature_row *by = dm_quadratures; by->name; by++)
        for (int r = by->least; r <= DM_QUADRATURE_NODES; r++) {
            dm_quadrature q;
            const int degree = strcmp(by->name, "gauss") == 0             ? 2 * r - 1
                               : strcmp(by->name, "lobatto") == 0         ? 2 * r - 3
                               : strcmp(by->name, "clenshaw-curtis") == 0 ? r - 1 + r % 2
                                                                          : 2 * r - 2;
            by->fill(&q, r);
            CHECK(dm_quadrature_find(by->name) == by && q.r == r);
            if (!CHECK(dm_quadrature_degree(&q, 1e-12) == degree))
                printf("# %s(%d): %d\n", by->name, r, dm_quadrature_degree(&q, 1e-12));
            for (int i = 0; i < r; i++) {
                CHECK(q.c[i] >= (i ? q.c[i - 1] : 0.0L) && q.c[i] <= 1.0L && q.b[i] > 0.0L);
                dm_quadrature same = q;
                dm_quadrature_interpolate(&same); /* the weights belong to the nodes */
                if (r <= 12) CHECK_NEAR((double)(same.b[i] - q.b[i]), 0.0, 1e-14);
            }
        }
    CHECK(dm_quadrature_find("simpson") == NULL);
}

static void radau_nodes_in_closed_form(void) {
    dm_quadrature q; /* HLW IV.5: (4 -+ sqrt 6)/10, 1 and (16 -+ sqrt 6)/36, 1/9 */
    dm_quadrature_radau(&q, 3);
    CHECK_NEAR((double)q.c[0], (4.0 - sqrt(6.0)) / 10.0, 1e-16);
    CHECK_NEAR((double)q.c[2], 1.0, 0.0);
    CHECK_NEAR((double)q.b[0], (16.0 - sqrt(6.0)) / 36.0, doubles_only() ? 1e-15 : 1e-16);
    dm_quadrature_clenshaw_curtis(&q, 3); /* Simpson */
    CHECK_NEAR((double)q.b[1], 2.0 / 3.0, 1e-16);
}

static double exact(dm_weight w) {
    return (double)dm_weight_exact(w);
}

/* a Nystroem method is symplectic when mean_i = b_i (1 - c_i) and
 * b_i (mean_j - A_ij) = b_j (mean_i - A_ji) (HLW IV.2.3); collocation: A row sums c_i^2/2 */
static void separable_tables_are_symplectic(void) {
    for (int s = 2; s <= 12; s++)
        for (int lobatto = 0; lobatto < 2; lobatto++) {
            static double memory[4096];
            dm_stage_table t;
            dm_galerkin g;
            dm_quadrature q;
            (lobatto ? dm_quadrature_lobatto : dm_quadrature_gauss)(&q, s);
            dm_galerkin_collocation(&g, &q);
            CHECK(dm_stage_table_size((size_t)s, (size_t)s) <= 4096);
            dm_stage_table_fill(&t, &g, memory);
            for (int i = 0; i < s; i++) {
                double sum = 0.0;
                CHECK_NEAR(exact(t.mean[i]), exact(t.b[i]) * (1.0 - exact(t.c[i])), 1e-15);
                for (int j = 0; j < s; j++) {
                    const double left = exact(t.b[i]) * (exact(t.mean[j]) - exact(t.A[i * s + j]));
                    const double right = exact(t.b[j]) * (exact(t.mean[i]) - exact(t.A[j * s + i]));
                    CHECK_NEAR(left, right, 1e-15);
                    sum += exact(t.A[i * s + j]);
                }
                CHECK_NEAR(sum, 0.5 * exact(t.c[i]) * exact(t.c[i]), 1e-15);
            }
        }
}

/* collocation and its partner: orders 2 s, 2 s - 1 and 2 s - 2, with coefficients rounded to
 * doubles as a user gives them */
static void orders_of_tableaus(void) {
    static const struct {
        const char *quadrature;
        int lost;
    } known[] = {{"gauss", 0}, {"radau", 1}, {"radau-left", 1}, {"lobatto", 2}};
    for (size_t k = 0; k < sizeof known / sizeof *known; k++)
        for (int s = 2; s <= 8; s++) {
            static dm_tableau t;
            dm_quadrature q;
            long double value[DM_QUADRATURE_NODES];
            int i, j;
            dm_quadrature_find(known[k].quadrature)->fill(&q, s);
            t = (dm_tableau){.s = s};
            for (i = 0; i < s; i++) {
                dm_lagrange(value, t.a[i], q.c, s, q.c[i]);
                for (j = 0; j < s; j++) t.a[i][j] = (long double)(double)t.a[i][j];
                t.b[i] = (long double)(double)q.b[i];
            }
            dm_tableau_partner(&t);
            CHECK_NEAR((double)dm_tableau_defect(&t, &i, &j), 0.0, 1e-16);
            if (!CHECK(dm_tableau_order(&t, 0) == 2 * s - known[k].lost))
                printf("# %s(%d): %d\n", known[k].quadrature, s, dm_tableau_order(&t, 0));
        }
}

/* one instance of what a method claims; tests/lua/rule/test_rules.lua measures the rest */
static void check_instance(const dm_method *m, const char *text, size_t length) {
    char rule[80] = "";
    dm_rule nodes[DM_RULE_NODES];
    int stages = 0, forces = -1;
    const char *colon = memchr(text, ':', length);
    if (!CHECK(colon && length < sizeof rule)) return;
    memcpy(rule, text, (size_t)(colon - text));
    CHECK(sscanf(colon, ":%d:%d", &stages, &forces) == 2 && stages > 0 && forces >= 0);
    if (!CHECK(dm_rule_read(nodes, rule, NULL) == NULL)) return;
    CHECK(nodes[0].method == m && dm_rule_check(nodes) == NULL);
    if (m->basis) {
        static dm_galerkin g;
        m->basis(&g, nodes);
        if (!CHECK(g.q.r == stages)) printf("# %s\n", rule);
    }
}

static void claims_are_about_methods(void) {
    for (const dm_method *const *m = dm_methods; *m; m++) {
        if (!CHECK((*m)->orders && (*m)->stages && (*m)->cost)) printf("# %s\n", (*m)->name);
        for (const char *at = (*m)->instances; *at;) {
            const size_t length = strcspn(at, ";");
            check_instance(*m, at, length);
            at += length;
            at += strspn(at, "; ");
        }
    }
}

int main(void) {
    RUN(gauss_nodes_are_those_of_gsl, "Gauss nodes and weights are those of GSL");
    RUN(lobatto_nodes_in_closed_form, "Lobatto nodes and weights in closed form");
    RUN(quadratures_are_as_exact_as_promised, "quadratures are as exact as promised, r to 32");
    RUN(quadratures_with_names, "quadratures by name: degree, weights of their nodes");
    RUN(radau_nodes_in_closed_form, "Radau nodes in closed form, Simpson's weights");
    RUN(separable_tables_are_symplectic, "tables are symplectic to 1e-15");
    RUN(orders_of_tableaus, "tableaus of known order, to order 16");
    RUN(claims_are_about_methods, "each method has its row of claims");
    RUN(orders_on_separable_kepler, "every rule has its order on Kepler's problem");
    RUN(orders_on_kepler_taken_as_general, "and when its structure is hidden");
    RUN(orders_on_the_double_spherical_pendulum, "and on the double spherical pendulum");
    RUN(orders_with_a_force_that_varies_in_time, "and with a force that varies in time");
    RUN(orders_with_a_mass_that_grows_in_time, "and with a mass that grows in time");
    return check_finish();
}
