/* test_lengths.c - steps of changing length: a stepper that has made steps of other lengths makes
 * the same step as one that was opened for it, and a step of another length on the side leaves a
 * run as it was. */
#include "check.h"
#include "code/native/jit.h"
#include "constrained_problems.h"
#include "integ/registry.h"
#include "problems.h"
#include "run/interpolate.h"

/* no two neighbours are equal: what a step leaves is never for the next one, as it may be for a
 * start, which every step of a fresh stepper is */
static const double lengths[] = {0.01, 0.02, 0.01, 0.005, 0.013, 0.01, -0.004, 0.03};
enum { LENGTHS = sizeof lengths / sizeof *lengths, STATE = 4 * PROBLEM_SIZE + 8 };

/* the next step of x, and the same one by a stepper of its own */
static int agree(session *x, const problem *p, const char *rule, double t, double h, double near) {
    session fresh;
    int same = 1;
    long done;
    CHECK(session_open(&fresh, p, rule, h));
    fresh.s.plain = x->s.plain;
    if (x->s.plain) CHECK(dm_stepper_open(&fresh.s) == DM_OK);
    memcpy(fresh.state, x->state, sizeof fresh.state);
    CHECK(dm_advance(&fresh.s, fresh.state, t, h, 1, &done) == DM_OK);
    CHECK(dm_advance(&x->s, x->state, t, h, 1, &done) == DM_OK);
    for (uint32_t k = 0; k < dm_state_size(p->n); k++) {
        const double gap = fabs(x->state[k] - fresh.state[k]);
        same &= gap <= near * (1.0 + fabs(x->state[k]));
    }
    session_close(&fresh);
    return same;
}

/* near 0: the same bits */
static void vary(const problem *p, const char *rule, int plain, double near) {
    session x;
    double t = 0.0;
    if (!CHECK(session_open(&x, p, rule, lengths[0]))) printf("# %s\n", rule);
    x.s.plain = plain;
    if (plain) CHECK(dm_stepper_open(&x.s) == DM_OK);
    for (int k = 0; k < 3 * LENGTHS; k++) {
        const double h = lengths[k % LENGTHS];
        if (!CHECK(agree(&x, p, rule, t, h, near))) printf("# %s: step %d of %g\n", rule, k, h);
        t += h;
    }
    session_close(&x);
}

/* with all that the rule wants; 0: it does not step such models */
static int build(problem *p, const char *rule, dm_node (*L)(dm_graph *g), uint32_t n) {
    dm_rule nodes[DM_RULE_NODES];
    dm_arena_init(&p->arena, problem_allocate, NULL);
    dm_graph *g = dm_graph_new(&p->arena, 2 * n + 1);
    const dm_node l = L(g);
    p->n = n;
    CHECK(dm_rule_read(nodes, rule, NULL) == NULL && nodes[0].method);
    const dm_method *m = nodes[0].method;
    CHECK(dm_model_build(&p->model, g, l, n, 63, dm_native_build, &p->arena) != DM_NO_MEMORY);
    if (m->traits & DM_FOR_PAIRS || dm_rule_fits(nodes, &p->model)) return 0;
    const unsigned wants = 63 | dm_rule_engine(nodes, &p->model)->wants(nodes, &p->model);
    dm_model_build(&p->model, g, l, n, wants, dm_native_build, &p->arena); /* singular if linear */
    return CHECK(!(wants & ~p->model.has & ~(unsigned)DM_WANT_STAGE_LATER));
}

/* ---- models ---- */

/* |v|^2/2 + 1/|q| */
static dm_node separable(dm_graph *g) {
    const dm_node x = dm_input(g, 0), y = dm_input(g, 1), u = dm_input(g, 2), w = dm_input(g, 3);
    const dm_node r2 = dm_add(g, dm_mul(g, x, x), dm_mul(g, y, y));
    const dm_node v2 = dm_add(g, dm_mul(g, u, u), dm_mul(g, w, w));
    return dm_add(g, dm_mul(g, dm_constant(g, 0.5), v2), dm_power(g, r2, dm_constant(g, -0.5)));
}

/* a force that grows with t, and q1 v1 v2: nothing is constant */
static dm_node general(dm_graph *g) {
    const dm_node x = dm_input(g, 0), u = dm_input(g, 2), w = dm_input(g, 3), t = dm_input(g, 4);
    const dm_node mixed = dm_mul(g, dm_constant(g, 0.3), dm_mul(g, x, dm_mul(g, u, w)));
    return dm_add(g, separable(g), dm_add(g, mixed, dm_mul(g, x, t)));
}

/* q1 v2 - q1^2 - q2^2/3, linear in v */
static dm_node degenerate(dm_graph *g) {
    const dm_node x = dm_input(g, 0), y = dm_input(g, 1), w = dm_input(g, 3);
    const dm_node H =
        dm_add(g, dm_mul(g, x, x), dm_mul(g, dm_constant(g, 1.0 / 3.0), dm_mul(g, y, y)));
    return dm_sub(g, dm_mul(g, x, w), H);
}

static void vary_on(const char *rule, dm_node (*L)(dm_graph *g), int plain) {
    problem p = {.q = {0.4, 0.1}, .v = {0.1, 2.0}};
    if (build(&p, rule, L, 2)) vary(&p, rule, plain, 0.0);
    problem_close(&p);
}

/* ---- the tests ---- */

static void vary_instance(const char *rule) {
    vary_on(rule, separable, 0);
    vary_on(rule, general, 0);
}

/* every row of methods.def by its own list; what is measured elsewhere */
static void every_rule(void) {
    static const char *const others[] = {"log-hamiltonian(yoshida(4))", "gauss(4, 2)",
                                         "galerkin(2, gauss(3))", "curve(heun, 0.5)",
                                         "suzuki(4, lobatto(2))"};
    for (const dm_method *const *m = dm_methods; *m; m++)
        for (const char *at = (*m)->instances; *at;) {
            char rule[64] = "";
            const size_t length = strcspn(at, ":");
            memcpy(rule, at, length < sizeof rule ? length : sizeof rule - 1);
            vary_instance(rule);
            at += strcspn(at, ";");
            at += strspn(at, "; ");
        }
    for (size_t i = 0; i < sizeof others / sizeof *others; i++) vary_instance(others[i]);
    vary_on("degenerate(2)", degenerate, 0);
    vary_on("degenerate(1, free)", degenerate, 0);
}

/* merged kicks leave a momentum in the state */
static void plain_sums(void) {
    vary_on("verlet", separable, 1);
    vary_on("kahan-li(6)", separable, 1);
}

static const struct {
    constrained_maker *make;
    uint32_t n, constraints;
    double q[4], v[4];
} constrained[] = {{sphere_maker, 3, 1, {0.6, 0.0, -0.8}, {0.0, 1.0, 0.0}},
                   {breathing_maker, 3, 1, {0.6, 0.0, -0.8}, {0.06, 1.0, -0.08}},
                   {disk_maker, 4, 2, {0}, {1.0, 0.0, 1.0, 2.0}}};

static void with_constraints(void) {
    static const char *const rules[] = {"midpoint", "gauss(3)", "trapezoidal", "lobatto(3)",
                                        "suzuki(4, midpoint)"};
    for (size_t k = 0; k < sizeof constrained / sizeof *constrained; k++) {
        constrained_problem t;
        CHECK(constrained_open(&t, constrained[k].make, constrained[k].n,
                               constrained[k].constraints) == DM_OK);
        constrained_place(&t, constrained[k].q, constrained[k].v);
        for (size_t i = 0; i < sizeof rules / sizeof *rules; i++) vary(&t.p, rules[i], 0, 0.0);
        problem_close(&t.p);
    }
}

/* the multipliers of the last step are a guess for one of any length: another way to the same
 * root */
static void rattle_scales_its_guess(void) {
    static const char *const rules[] = {"rattle", "yoshida(4, rattle)", "shake"};
    static const double near[] = {4e-15, 4e-15, 1e-12}; /* of q; shake has p from q by h */
    static constrained_maker *const makers[] = {sphere_maker, damped_sphere_maker};
    for (size_t k = 0; k < 2; k++) {
        constrained_problem t;
        CHECK(constrained_open(&t, makers[k], 3, 1) == DM_OK);
        constrained_place(&t, constrained[0].q, constrained[0].v);
        for (size_t i = 0; i < sizeof rules / sizeof *rules; i++) vary(&t.p, rules[i], 0, near[i]);
        problem_close(&t.p);
    }
}

/* with rows between steps a run has the bits of one without */
static void steps_on_the_side(void) {
    static const char *const rules[] = {"gauss(2)", "rattle", "yoshida(4, rattle)",
                                        "suzuki(4, midpoint)"};
    for (size_t i = 0; i < sizeof rules / sizeof *rules; i++) {
        constrained_problem t;
        session x, y;
        double aside[400], *place, between[STATE];
        CHECK(constrained_open(&t, sphere_maker, 3, 1) == DM_OK);
        constrained_place(&t, constrained[0].q, constrained[0].v);
        CHECK(session_open(&x, &t.p, rules[i], 0.02) && session_open(&y, &t.p, rules[i], 0.02));
        CHECK(dm_stepper_memory(&y.s, &place) <= 400);
        y.s.aside = aside;
        for (int k = 0; k < 50; k++) {
            CHECK(dm_interpolate(&y.s, between, y.state, 0.0, 0.003, 0.02) == DM_OK);
            CHECK(session_run(&x, 1) == DM_OK && session_run(&y, 1) == DM_OK);
        }
        if (!CHECK(memcmp(x.state, y.state, sizeof x.state) == 0)) printf("# %s\n", rules[i]);
        session_close(&x);
        session_close(&y);
        problem_close(&t.p);
    }
}

int main(void) {
    RUN(every_rule, "every rule: after steps of other lengths the bits of a fresh stepper");
    RUN(plain_sums, "plain sums too");
    RUN(with_constraints, "with constraints too");
    RUN(rattle_scales_its_guess, "rattle scales its guess, the root is the same");
    RUN(steps_on_the_side, "a step on the side leaves a run as it was");
    return check_finish();
}
