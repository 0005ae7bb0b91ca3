/* steps compared and broken: time reversal, equal methods, equal bits, an own Ld, failures. */
#include "check.h"
#include "integ/registry.h"
#include "problems.h"

static const char *const variational[] = {"verlet",   "midpoint", "trapezoidal", "gauss(2)",
                                          "gauss(3)", "gauss(4)", "lobatto(3)",  "lobatto(4)"};
enum { VARIATIONAL = sizeof variational / sizeof *variational };

typedef void maker(problem *p);

static void kepler(problem *p) {
    problem_kepler(p, PROBLEM_SEPARABLE);
}
static void hidden_kepler(problem *p) {
    problem_kepler(p, PROBLEM_GENERAL);
}
static void henon_heiles(problem *p) {
    problem_henon_heiles(p, PROBLEM_SEPARABLE);
}
static void pendulum(problem *p) {
    problem_pendulum(p, PROBLEM_SEPARABLE);
}
static void double_pendulum(problem *p) {
    CHECK(problem_double_pendulum(p) == DM_OK);
}

/* both masses swing around the vertical, far from the poles of the angles */
static void whirling_pendulum(problem *p) {
    double_pendulum(p);
    const double q[4] = {1.0, 0.0, 1.3, 0.2}, v[4] = {0.1, 4.2, -0.1, 4.0};
    memcpy(p->q, q, sizeof q);
    memcpy(p->v, v, sizeof v);
}

static maker *const makers[] = {kepler, hidden_kepler, henon_heiles, pendulum, double_pendulum};
enum { MAKERS = sizeof makers / sizeof *makers };

static double angular_momentum(const double *z) {
    return (z[0] * z[3] - z[1] * z[2]) + (z[0] * z[7] - z[1] * z[6]) + (z[4] * z[3] - z[5] * z[2]);
}

/* ---- time reversal, equal methods, equal bits ---- */

static void symmetric_methods_go_back(void) {
    for (int k = 0; k < MAKERS; k++)
        for (int i = 0; i < VARIATIONAL; i++) {
            problem p;
            session x;
            makers[k](&p);
            CHECK(session_open(&x, &p, variational[i], k == 4 ? 0.01 : 0.05));
            double start[4 * PROBLEM_SIZE + 8];
            memcpy(start, x.state, sizeof start);
            for (int leg = 0; leg < 2; leg++) {
                CHECK(session_run(&x, 100) == DM_OK);
                for (uint32_t j = 0; j < p.n; j++) {
                    x.state[p.n + j] = -x.state[p.n + j];
                    x.state[3 * p.n + j] = -x.state[3 * p.n + j];
                }
            }
            for (uint32_t j = 0; j < 2 * p.n; j++)
                CHECK_NEAR(x.state[j], start[j], 2e-11 * (1.0 + fabs(start[j])));
            session_close(&x);
            problem_close(&p);
        }
}

/* largest difference of the states after 200 steps */
static double gap(const problem *p, const char *one, const problem *r, const char *other,
                  double h) {
    session x, y;
    double worst = 0.0;
    const int fine = session_open(&x, p, one, h) && session_open(&y, r, other, h) &&
                     session_run(&x, 200) == DM_OK && session_run(&y, 200) == DM_OK;
    for (uint32_t i = 0; i < 2 * p->n; i++) worst = fmax(worst, fabs(x.state[i] - y.state[i]));
    session_close(&x);
    session_close(&y);
    return fine ? worst : NAN;
}

static void both_forms_of_a_step_agree(void) {
    problem p, hidden;
    kepler(&p);
    hidden_kepler(&hidden);
    for (int i = 0; i < VARIATIONAL; i++)
        CHECK_NEAR(gap(&p, variational[i], &hidden, variational[i], 0.03), 0.0, 1e-12);
}

static void equal_methods_agree(void) {
    problem p, hidden, whirl;
    kepler(&p);
    hidden_kepler(&hidden);
    whirling_pendulum(&whirl);
    CHECK_NEAR(gap(&p, "verlet", &p, "trapezoidal", 0.03), 0.0, 1e-12);
    CHECK_NEAR(gap(&p, "verlet", &p, "lobatto(2)", 0.03), 0.0, 1e-12);
    CHECK_NEAR(gap(&p, "midpoint", &p, "gauss(1)", 0.03), 0.0, 0.0);
    CHECK_NEAR(gap(&hidden, "verlet", &hidden, "trapezoidal", 0.03), 0.0, 1e-12);
    CHECK_NEAR(gap(&whirl, "verlet", &whirl, "lobatto(2)", 0.01), 0.0, 0.0);
    CHECK(gap(&whirl, "verlet", &whirl, "trapezoidal", 0.01) > 1e-6); /* not separable */
    problem_close(&whirl);
}

static void bursts_have_the_bits_of_single_steps(void) {
    for (const dm_method *const *m = dm_methods; *m; m++) {
        static const char *const known[] = {"verlet", "midpoint", "trapezoidal", "gauss", "lobatto",
                                            "rk4",    "rkf45",    "rk8pd",       "rk8"};
        int mine = 0;
        for (size_t i = 0; i < sizeof known / sizeof *known; i++)
            mine += strcmp((*m)->name, known[i]) == 0;
        for (int k = 0; k < MAKERS && mine; k++) {
            problem p;
            session x, y;
            makers[k](&p);
            const char *rule = strchr((*m)->signature, '(') ? "(3)" : "";
            char text[DM_RULE_NAME + 8];
            snprintf(text, sizeof text, "%s%s", (*m)->name, rule);
            CHECK(session_open(&x, &p, text, 0.005) && session_open(&y, &p, text, 0.005));
            CHECK(session_run(&x, 100) == DM_OK);
            for (int i = 0; i < 100; i++) CHECK(session_run(&y, 1) == DM_OK);
            CHECK(memcmp(x.state, y.state, dm_state_size(p.n) * sizeof(double)) == 0);
            session_close(&x);
            session_close(&y);
            problem_close(&p);
        }
    }
}

/* ---- a user's discrete Lagrangian ---- */

static const double PAIR_STEP = 0.02;

/* Ld = h L((q0 + q1)/2, (q1 - q0)/h) of Kepler: D1, D2, D1D2 by hand */
static void midpoint_pair(const void *pool, const double *x, double *out) {
    const double h = PAIR_STEP, q[2] = {0.5 * (x[0] + x[2]), 0.5 * (x[1] + x[3])};
    double slope[2], curve[4];
    (void)pool;
    kepler_potential(NULL, slope, curve, q);
    for (int i = 0; i < 2; i++) {
        const double v = (x[2 + i] - x[i]) / h;
        out[i] = -v - 0.5 * h * slope[i];
        out[2 + i] = v - 0.5 * h * slope[i];
        for (int j = 0; j < 2; j++)
            out[4 + 2 * i + j] = -(i == j) / h - 0.25 * h * curve[2 * i + j];
    }
}

static void pair_problem(problem *p, dm_eval *eval) {
    problem_kepler(p, 0);
    p->model.pair = (dm_kernel){.eval = eval, .pool = p, .inputs = 4, .outputs = 8};
    p->model.has = DM_WANT_PAIR;
}

static int open_pair(session *x, problem *p) {
    const int fine = session_open(x, p, "del", PAIR_STEP);
    memcpy(x->state + 2, p->v, 2 * sizeof(double)); /* unit masses: p = v */
    return fine;
}

static void an_own_discrete_lagrangian_is_the_equal_of_midpoint(void) {
    problem p, plain;
    session x, y;
    pair_problem(&p, midpoint_pair);
    kepler(&plain);
    CHECK(open_pair(&x, &p) && session_open(&y, &plain, "midpoint", PAIR_STEP));
    CHECK(session_run(&x, 500) == DM_OK && session_run(&y, 500) == DM_OK);
    for (int i = 0; i < 4; i++) CHECK_NEAR(x.state[i], y.state[i], 1e-12);
    CHECK(session_run(&x, 20000) == DM_OK);
    CHECK_NEAR(angular_momentum(x.state) / 0.8, 1.0, 1e-13);
    session_close(&x);
    session_close(&y);
}

static void nan_pair(const void *pool, const double *x, double *out) {
    (void)pool, (void)x;
    for (int i = 0; i < 8; i++) out[i] = NAN;
}

static void a_failing_callback_ends_the_step(void) {
    problem p;
    session x;
    double before[8];
    pair_problem(&p, nan_pair);
    CHECK(open_pair(&x, &p));
    memcpy(before, x.state, sizeof before);
    CHECK(session_run(&x, 3) == DM_NOT_FINITE);
    CHECK(memcmp(before, x.state, sizeof before) == 0);
    session_close(&x);
}

/* ---- failure ---- */

/* run one step that must fail and leave the state alone */
static dm_status failing_step(const problem *p, const char *rule, double h) {
    session x;
    double before[4 * PROBLEM_SIZE + 8];
    CHECK(session_open(&x, p, rule, h));
    memcpy(before, x.state, sizeof before);
    const dm_status status = session_run(&x, 1);
    CHECK(status != DM_OK);
    if (!CHECK(memcmp(before, x.state, sizeof before) == 0)) printf("# %s\n", rule);
    CHECK(isfinite(x.s.report.residual) || status == DM_NOT_FINITE);
    session_close(&x);
    return status;
}

/* the pendulum in angles: 30 s, some 15 swings, in one step */
static void a_step_without_solution_is_reported(void) {
    problem p;
    double_pendulum(&p);
    CHECK(failing_step(&p, "gauss(2)", 30.0) == DM_NO_CONVERGENCE);
    CHECK(failing_step(&p, "verlet", 30.0) == DM_NO_CONVERGENCE);
    CHECK(failing_step(&p, "lobatto(3)", 30.0) == DM_NO_CONVERGENCE);
    problem_close(&p);
}

static void a_start_in_a_singularity_is_reported(void) {
    static const char *const every[] = {"verlet",     "trapezoidal", "gauss(2)",
                                        "lobatto(3)", "rk4",         "rk8pd"};
    problem p;
    kepler(&p);
    p.q[0] = p.q[1] = 0.0;
    for (size_t i = 0; i < sizeof every / sizeof *every; i++)
        CHECK(failing_step(&p, every[i], 0.01) == DM_NOT_FINITE);
}

/* Henon-Heiles blows up above its escape energy: the last finite state is kept, its step told */
static void a_blow_up_stops_at_the_last_good_step(void) {
    problem p;
    session x, y;
    long done = 0;
    henon_heiles(&p);
    p.q[1] = 2.0;
    CHECK(session_open(&x, &p, "verlet", 0.05) && session_open(&y, &p, "verlet", 0.05));
    CHECK(dm_advance(&x.s, x.state, 0.0, x.h, 100000, &done) == DM_NOT_FINITE);
    CHECK(done > 0 && done < 100000);
    CHECK(session_run(&y, done) == DM_OK);
    CHECK(memcmp(x.state, y.state, 8 * sizeof(double)) == 0);
    for (int i = 0; i < 8; i++) CHECK(isfinite(x.state[i]));
    CHECK(session_run(&y, 1) == DM_NOT_FINITE);
    session_close(&x);
    session_close(&y);
}

/* a spring with h omega = 5: midpoint stays bounded, Verlet does not (HLW I.1.4) */
static void a_stiff_spring_separates_implicit_from_explicit(void) {
    problem p;
    session x;
    problem_spring(&p, PROBLEM_SEPARABLE);
    CHECK(session_open(&x, &p, "midpoint", 0.05) && session_run(&x, 2000) == DM_OK);
    CHECK(fabs(hypot(x.state[0], x.state[1]) - 1.0) < 0.1);
    session_close(&x);
    CHECK(session_open(&x, &p, "verlet", 0.05));
    CHECK(session_run(&x, 2000) != DM_OK || hypot(x.state[0], x.state[1]) > 10.0);
    session_close(&x);
}

int main(void) {
    RUN(symmetric_methods_go_back, "symmetric methods go back the way they came");
    RUN(both_forms_of_a_step_agree, "the reduced and the general form of a step agree");
    RUN(equal_methods_agree, "methods that are equal agree");
    RUN(bursts_have_the_bits_of_single_steps, "bursts have the bits of single steps");
    RUN(an_own_discrete_lagrangian_is_the_equal_of_midpoint, "an own Ld equals midpoint");
    RUN(a_failing_callback_ends_the_step, "a failing callback ends the step");
    RUN(a_step_without_solution_is_reported, "a step without solution: status, state unchanged");
    RUN(a_start_in_a_singularity_is_reported, "a start in a singularity is reported");
    RUN(a_blow_up_stops_at_the_last_good_step, "a blow-up stops at the last good step");
    RUN(a_stiff_spring_separates_implicit_from_explicit, "a stiff spring: midpoint bounded");
    return check_finish();
}
