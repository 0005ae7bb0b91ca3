/* test_sweeps.c - Gauss and its kin by fixed-point sweeps over stages in lanes, on traced
 * models. */
#include "check.h"
#include "code/native/jit.h"
#include "numbers/processor.h"
#include "problems.h"
#include "run/interpolate.h"

static const char *const rules[] = {"midpoint", "gauss(2)", "gauss(3)",  "gauss(4)",
                                    "gauss(6)", "gauss(8)", "lobatto(4)"};
enum { RULES = sizeof rules / sizeof *rules };

/* L = |v|^2/2 + 1/|q|, or as one that seems general: + d/dt of q1^2 q2, which changes no path */
static void kepler(problem *p, int hidden, dm_compile *compile) {
    *p = (problem){.n = 2, .q = {0.4, 0.0}, .v = {0.0, 2.0}};
    dm_arena_init(&p->arena, problem_allocate, NULL);
    dm_graph *g = dm_graph_new(&p->arena, 5);
    const dm_node x = dm_input(g, 0), y = dm_input(g, 1), u = dm_input(g, 2), w = dm_input(g, 3);
    const dm_node r2 = dm_add(g, dm_mul(g, x, x), dm_mul(g, y, y));
    const dm_node v2 = dm_add(g, dm_mul(g, u, u), dm_mul(g, w, w));
    dm_node L =
        dm_add(g, dm_mul(g, dm_constant(g, 0.5), v2), dm_power(g, r2, dm_constant(g, -0.5)));
    if (hidden) {
        const dm_node xy = dm_mul(g, x, y), xx = dm_mul(g, x, x);
        const dm_node first = dm_mul(g, dm_mul(g, dm_constant(g, 2.0), xy), u);
        L = dm_add(g, L, dm_add(g, first, dm_mul(g, xx, w)));
    }
    CHECK(dm_model_build(&p->model, g, L, 2, 63, compile, &p->arena) == DM_OK);
}

/* unit masses, rods of length 1, angles away from the poles */
static void pendulum(problem *p, dm_compile *compile) {
    CHECK(problem_double_pendulum(p) == DM_OK);
    const dm_source s = p->model.source;
    CHECK(dm_model_build(&p->model, s.graph, s.lagrangian, 4, 63, compile, &p->arena) == DM_OK);
}

static void make(problem *p, int which, dm_compile *compile) {
    if (which == 2)
        pendulum(p, compile);
    else
        kepler(p, which, compile);
}

static dm_status run(session *x, const problem *p, const char *rule, double h, long steps,
                     long every) {
    long done, rows;
    const dm_run_plan plan = {.h = h, .steps = steps, .every = every};
    const dm_status status = session_open(x, p, rule, h) ? DM_OK : DM_NO_MEMORY;
    return status == DM_OK ? dm_run(&plan, &x->s, x->state, NULL, &done, &rows) : status;
}

static double distance(const session *x, const session *y, uint32_t n) {
    double worst = 0.0;
    for (uint32_t i = 0; i < 2 * n; i++) worst = fmax(worst, fabs(x->state[i] - y->state[i]));
    return worst;
}

/* ---- the same bits everywhere ---- */

static void the_widths_have_the_same_bits(void) {
    static const uint32_t lanes[] = {0, 1, 4, 8};
    const uint32_t most = dm_jit_lanes();
    for (int which = 0; which < 3; which++)
        for (int i = 0; i < RULES; i++) {
            session x[4];
            for (int k = 0; k < 4; k++) {
                problem p;
                dm_jit_limit(lanes[k]);
                make(&p, which, k ? dm_native_build : dm_tape_build);
                CHECK(run(x + k, &p, rules[i], 0.01, 200, 200) == DM_OK);
                session_close(x + k);
                problem_close(&p);
                dm_jit_limit(most);
                if (!CHECK(memcmp(x[0].state, x[k].state, sizeof x->state) == 0))
                    printf("# %s, %u lanes, problem %d\n", rules[i], lanes[k], which);
            }
        }
}

static void every_width_has_the_same_bits(void) {
    for (int level = DM_PLAIN; level <= DM_AVX512; level++) {
        dm_processor_limit((dm_processor_level)level);
        the_widths_have_the_same_bits();
    }
}

/* sums with and without fused products come to the same end but for rounding, and so do 4 and 8
 * stages in them */
static void every_processor_finds_the_same_end(void) {
    for (int which = 0; which < 3; which++)
        for (int i = 0; i < RULES; i++) {
            session x[2];
            for (int k = 0; k < 2; k++) {
                problem p;
                dm_processor_limit(k ? DM_AVX512 : DM_PLAIN);
                make(&p, which, dm_native_build);
                CHECK(run(x + k, &p, rules[i], 0.02, 50, 50) == DM_OK);
                session_close(x + k);
                problem_close(&p);
            }
            CHECK(distance(x, x + 1, which == 2 ? 4 : 2) < 5e-14);
        }
}

static void rows_do_not_depend_on_bursts(void) {
    for (int which = 0; which < 3; which++) {
        problem p;
        session x, y;
        make(&p, which, dm_native_build);
        CHECK(run(&x, &p, "gauss(4)", 0.02, 500, 500) == DM_OK);
        CHECK(run(&y, &p, "gauss(4)", 0.02, 500, 1) == DM_OK);
        CHECK(memcmp(x.state, y.state, sizeof x.state) == 0);
        session_close(&x);
        session_close(&y);
        problem_close(&p);
    }
}

/* ---- the root ---- */

/* Newton's method, which is left when the model shows no graph, finds the same end */
static void newton_finds_the_same_root(void) {
    for (int which = 0; which < 3; which++)
        for (int i = 0; i < RULES; i++) {
            problem p, q;
            session x, y;
            make(&p, which, dm_native_build);
            q = p;
            q.model.source.graph = NULL;
            CHECK(run(&x, &p, rules[i], 0.02, 50, 50) == DM_OK);
            CHECK(run(&y, &q, rules[i], 0.02, 50, 50) == DM_OK);
            if (!CHECK(distance(&x, &y, p.n) < 5e-14))
                printf("# %s, problem %d: %g\n", rules[i], which, distance(&x, &y, p.n));
            CHECK(y.s.report.evaluations > 0 && x.s.report.residual < 1e-11);
            session_close(&x);
            session_close(&y);
            problem_close(&p);
        }
}

static double angular_momentum(const double *z) {
    return (z[0] * z[3] - z[1] * z[2]) + (z[0] * z[7] - z[1] * z[6]) + (z[4] * z[3] - z[5] * z[2]);
}

/* what the last sweep leaves, or a rounded coefficient, would err alike in every step */
static void angular_momentum_walks_at_random(void) {
    for (int i = 1; i < RULES; i++) {
        problem p;
        session x;
        kepler(&p, 0, dm_native_build);
        CHECK(run(&x, &p, rules[i], 0.1, 100000, 100000) == DM_OK);
        if (!CHECK_NEAR(angular_momentum(x.state) / 0.8, 1.0, 3e-14)) printf("# %s\n", rules[i]);
        session_close(&x);
        problem_close(&p);
    }
}

/* ---- the memory of the last step ---- */

static void the_last_step_saves_sweeps(void) {
    problem p;
    session x, y;
    kepler(&p, 0, dm_native_build);
    CHECK(run(&x, &p, "gauss(6)", 0.05, 400, 400) == DM_OK);
    CHECK(session_open(&y, &p, "gauss(6)", 0.05));
    CHECK(dm_stepper_start(&y.s, y.state, 0.0, 1.0) == DM_OK); /* for steps of another length */
    CHECK(session_run(&y, 400) == DM_OK);
    CHECK((double)x.s.report.newton < 0.75 * (double)y.s.report.newton);
    CHECK(distance(&x, &y, 2) < 1e-12);
    session_close(&x);
    session_close(&y);
    problem_close(&p);
}

/* by sweeps of either form, and by Newton's method of the general one */
static const struct {
    int which;
    const char *rule;
} remembering[] = {{0, "gauss(4)"},
                   {1, "gauss(4)"},
                   {2, "gauss(8)"},
                   {2, "midpoint"},
                   {1, "lobatto(3)"}};
enum { REMEMBERING = sizeof remembering / sizeof *remembering };

static void state_and_memory_go_on(int which, const char *rule) {
    problem p;
    session x, y;
    double *from = NULL, *to = NULL;
    make(&p, which, dm_native_build);
    CHECK(run(&x, &p, rule, 0.01, 150, 150) == DM_OK);
    CHECK(session_open(&y, &p, rule, 0.01));
    const size_t size = dm_stepper_memory(&x.s, &from);
    CHECK(size > 0 && size == dm_stepper_memory(&y.s, &to));
    memcpy(to, from, size * sizeof *to);
    memcpy(y.state, x.state, sizeof y.state);
    CHECK(session_run(&x, 150) == DM_OK && session_run(&y, 150) == DM_OK);
    if (!CHECK(memcmp(x.state, y.state, sizeof x.state) == 0))
        printf("# %s, problem %d\n", rule, which);
    session_close(&x);
    session_close(&y);
    problem_close(&p);
}

static void newton_saves_iterations(void) {
    problem p;
    session x, y;
    kepler(&p, 1, dm_native_build);
    CHECK(run(&x, &p, "midpoint", 0.01, 250, 250) == DM_OK);
    CHECK(session_open(&y, &p, "midpoint", 0.01));
    CHECK(dm_stepper_start(&y.s, y.state, 0.0, 1.0) == DM_OK); /* for steps of another length */
    CHECK(session_run(&y, 250) == DM_OK);
    CHECK((double)x.s.report.evaluations < 0.8 * (double)y.s.report.evaluations);
    CHECK(distance(&x, &y, 2) < 1e-12);
    session_close(&x);
    session_close(&y);
    problem_close(&p);
}

static void state_and_memory_go_on_bit_for_bit(void) {
    for (int i = 0; i < REMEMBERING; i++)
        state_and_memory_go_on(remembering[i].which, remembering[i].rule);
}

static void begin_again(session *x, const problem *p) {
    double *work = malloc(dm_legendre_work(&p->model) * sizeof *work);
    memset(x->state, 0, sizeof x->state);
    memcpy(x->state, p->q, p->n * sizeof *p->q);
    CHECK(work && dm_legendre(&p->model, x->state + p->n, p->q, p->v, 0.0, work) == DM_OK);
    free(work);
}

/* a second run of one stepper is the first again; a step to a time between changes nothing */
static void start_and_interpolation(int which, const char *rule) {
    problem p;
    session x, y;
    double between[4 * PROBLEM_SIZE + 8], first[4 * PROBLEM_SIZE + 8];
    long done, rows;
    const dm_run_plan plan = {.h = 0.02, .steps = 100, .every = 100};
    make(&p, which, dm_native_build);
    CHECK(run(&x, &p, rule, 0.02, 100, 100) == DM_OK);
    memcpy(first, x.state, sizeof first);
    CHECK(run(&y, &p, rule, 0.02, 100, 100) == DM_OK);
    for (int i = 0; i < 50; i++) {
        CHECK(dm_interpolate(&y.s, between, y.state, 2.0, 2.01, y.h) == DM_OK);
        CHECK(session_run(&x, 1) == DM_OK && session_run(&y, 1) == DM_OK);
    }
    CHECK(memcmp(x.state, y.state, sizeof x.state) == 0);
    begin_again(&x, &p);
    CHECK(dm_run(&plan, &x.s, x.state, NULL, &done, &rows) == DM_OK);
    if (!CHECK(memcmp(x.state, first, sizeof first) == 0))
        printf("# %s, problem %d\n", rule, which);
    session_close(&x);
    session_close(&y);
    problem_close(&p);
}

static void start_forgets_and_interpolation_leaves_alone(void) {
    for (int i = 0; i < REMEMBERING; i++)
        start_and_interpolation(remembering[i].which, remembering[i].rule);
}

/* a step without solution changes neither the state nor what is remembered */
static void fail(int which, const char *rule) {
    problem p;
    session x;
    double *place, kept[200], state[4 * PROBLEM_SIZE + 8];
    make(&p, which, dm_native_build);
    CHECK(run(&x, &p, rule, 0.02, 20, 20) == DM_OK);
    const size_t size = dm_stepper_memory(&x.s, &place);
    CHECK(size <= 200);
    memcpy(kept, place, size * sizeof *kept);
    memcpy(state, x.state, sizeof state);
    x.state[2] = state[2] = INFINITY;
    CHECK(session_run(&x, 1) != DM_OK);
    CHECK(memcmp(state, x.state, sizeof state) == 0);
    if (!CHECK(memcmp(kept, place, size * sizeof *kept) == 0))
        printf("# %s, problem %d\n", rule, which);
    session_close(&x);
    problem_close(&p);
}

static void a_failed_step_leaves_the_memory_alone(void) {
    for (int i = 0; i < REMEMBERING; i++) fail(remembering[i].which, remembering[i].rule);
}

/* ---- stiff springs, sweeps by number ---- */

/* V = k (|q| - 1)^2 / 2 with h sqrt(k) = 5: sweeps diverge, Newton's method takes the step */
static void newton_takes_stiff_steps(void) {
    problem p = {.n = 2, .q = {1.0, 0.0}, .v = {0.0, 1.0}};
    session x;
    dm_arena_init(&p.arena, problem_allocate, NULL);
    dm_graph *g = dm_graph_new(&p.arena, 5);
    dm_node r2 = 0, v2 = 0;
    for (uint32_t i = 0; i < 2; i++) {
        const dm_node q = dm_input(g, i), v = dm_input(g, 2 + i);
        r2 = dm_add(g, r2, dm_mul(g, q, q));
        v2 = dm_add(g, v2, dm_mul(g, v, v));
    }
    const dm_node r = dm_apply(g, DM_OP_SQRT, r2, 0, 0);
    const dm_node d = dm_sub(g, r, dm_constant(g, 1.0));
    const dm_node V = dm_mul(g, dm_constant(g, 1e4), dm_mul(g, d, d));
    const dm_node L = dm_mul(g, dm_constant(g, 0.5), dm_sub(g, v2, V));
    CHECK(dm_model_build(&p.model, g, L, 2, 63, dm_native_build, &p.arena) == DM_OK);
    CHECK(run(&x, &p, "midpoint", 0.05, 400, 400) == DM_OK);
    CHECK(fabs(hypot(x.state[0], x.state[1]) - 1.0) < 0.2);
    CHECK(x.s.report.iterations > 0);
    session_close(&x);
    problem_close(&p);
}

/* each sweep takes its share of the error, down to what is solved to round-off */
static void more_sweeps_come_nearer(void) {
    static const char *const by_number[] = {"gauss(4, 1)", "gauss(4, 2)", "gauss(4, 3)"};
    for (int which = 0; which < 3; which++) {
        problem p;
        session x, y;
        double before = 1.0;
        make(&p, which, dm_native_build);
        CHECK(run(&x, &p, "gauss(4)", 0.01, 60, 60) == DM_OK);
        for (int k = 0; k < 3; k++) {
            CHECK(run(&y, &p, by_number[k], 0.01, 60, 60) == DM_OK);
            const double gap = distance(&x, &y, p.n);
            if (!CHECK(gap < 0.2 * before || gap < 1e-13) ||
                !CHECK(gap < 1e-13 || y.s.report.newton < x.s.report.newton))
                printf("# %s, problem %d: %g after %g, %ld\n", by_number[k], which, gap, before,
                       y.s.report.newton);
            before = gap;
            session_close(&y);
        }
        session_close(&x);
        problem_close(&p);
    }
}

int main(void) {
    RUN(every_width_has_the_same_bits, "tape, 1, 4 and 8 lanes have the same bits");
    RUN(every_processor_finds_the_same_end, "every processor's sums come to the same end");
    RUN(rows_do_not_depend_on_bursts, "rows do not depend on bursts");
    RUN(newton_finds_the_same_root, "Newton's method finds the same root");
    if (!doubles_only()) RUN(angular_momentum_walks_at_random, "angular momentum walks at random");
    RUN(the_last_step_saves_sweeps, "the last step's polynomial saves sweeps");
    RUN(newton_saves_iterations, "the last steps' velocities save Newton's method work");
    RUN(state_and_memory_go_on_bit_for_bit, "state and memory go on bit for bit");
    RUN(start_forgets_and_interpolation_leaves_alone,
        "a new start forgets; a step between leaves the memory alone");
    RUN(a_failed_step_leaves_the_memory_alone, "a failed step leaves the memory alone");
    RUN(newton_takes_stiff_steps, "Newton's method takes stiff steps");
    RUN(more_sweeps_come_nearer, "more sweeps come nearer");
    return check_finish();
}
