/* the step equation with multipliers and forces: orders, exact solutions, constraints to round-off,
 * symmetry, failures */
#include "check.h"
#include "constrained_problems.h"

typedef struct {
    constrained_maker *make;
    uint32_t n, constraints;
    double q[4], v[4];
    const char *name;
} start;

static const start sphere = {sphere_maker, 3, 1, {0.6, 0.0, -0.8}, {0.0, 1.0, 0.0}, "sphere"};
static const start damped_sphere = {damped_sphere_maker, 3, 1, {0.6, 0.0, -0.8}, {0.0, 1.0, 0.0},
                                    "damped sphere"};
static const start breathing = {breathing_maker,       3, 1, {0.6, 0.0, -0.8}, {0.06, 1.0, -0.08},
                                "sphere that breathes"};
static const start disk = {disk_maker, 4, 2, {0}, {1.0, 0.0, 1.0, 2.0}, "rolling disk"};
static const start knife = {knife_maker, 3, 1, {0}, {0.0, 0.0, 1.0}, "knife edge"};
static const start particle = {particle_maker,         3, 1, {1.0, 0.5, 0.0}, {0.4, 1.0, 0.2},
                               "nonholonomic particle"};
static const start speed = {speed_maker, 2, 1, {0.3, 0.2}, {0.6, 0.8}, "given speed"};
static const start pushed = {pushed_maker, 2, 1, {0.3, 0.2}, {0.6, 0.8}, "given speed, given E"};
static const start damped = {damped_maker, 1, 0, {1.0}, {0.0}, "damped oscillator"};

static void open_at(constrained_problem *t, const start *s) {
    CHECK(constrained_open(t, s->make, s->n, s->constraints) == DM_OK);
    constrained_place(t, s->q, s->v);
}

/* (q, p) at time 1 after `steps` steps */
static int end_of(double *end, const constrained_problem *t, const char *rule, long steps) {
    session x;
    const int fine =
        session_open(&x, &t->p, rule, 1.0 / (double)steps) && session_run(&x, steps) == DM_OK;
    memcpy(end, x.state, 2 * t->p.n * sizeof *end);
    session_close(&x);
    return fine;
}

static double gap(const double *a, const double *b, uint32_t n) {
    double worst = 0.0;
    for (uint32_t i = 0; i < n; i++) worst = fmax(worst, fabs(a[i] - b[i]));
    return worst;
}

/* ---- orders ---- */

typedef struct {
    const char *rule;
    int order;
    long steps; /* and twice as many */
} row;

static const row rows[] = {{"midpoint", 2, 32},   {"trapezoidal", 2, 32}, {"gauss(1)", 2, 32},
                           {"gauss(2)", 4, 16},   {"gauss(3)", 6, 8},     {"gauss(4)", 8, 4},
                           {"lobatto(2)", 2, 32}, {"lobatto(3)", 4, 16},  {"lobatto(4)", 6, 8},
                           {"lobatto(5)", 8, 4}};
enum { ROWS = sizeof rows / sizeof *rows };

static void check_orders(const start *s, const double *want, uint32_t columns) {
    constrained_problem t;
    double coarse[8], fine[8];
    open_at(&t, s);
    for (int i = 0; i < ROWS; i++) {
        const long steps = rows[i].steps;
        CHECK(end_of(coarse, &t, rows[i].rule, steps));
        CHECK(end_of(fine, &t, rows[i].rule, 2 * steps));
        const double order = log2(gap(coarse, want, columns) / gap(fine, want, columns));
        if (!CHECK(fabs(order - rows[i].order) < 0.1))
            printf("# %s, %s: order %.2f\n", s->name, rows[i].rule, order);
    }
    problem_close(&t.p);
}

/* the end by a rule of order 12, fine steps */
static void find_end(double *want, const start *s) {
    constrained_problem t;
    open_at(&t, s);
    CHECK(end_of(want, &t, "gauss(6)", 60));
    problem_close(&t.p);
}

static void orders_with_constraints(void) {
    const start *const problems[] = {&damped_sphere, &breathing};
    for (int i = 0; i < 2; i++) {
        double want[8];
        find_end(want, problems[i]);
        check_orders(problems[i], want, 6);
    }
}

/* z from the angles of the same motion, which knows no multiplier */
static void orders_against_angles(void) {
    const start angles = {angles_maker, 2, 0, {acos(0.8), 0.0}, {0.0, 1.0 / 0.6}, "angles"};
    double a[8];
    find_end(a, &angles);
    const double q[3] = {sin(a[0]) * cos(a[1]), sin(a[0]) * sin(a[1]), -cos(a[0])};
    check_orders(&sphere, q, 3);
}

/* heading 2 t, roll t: x = sin(2 t) / 2, y = (1 - cos(2 t)) / 2 (Bloch 2003, 1.4) */
static void orders_of_the_disk(void) {
    const double want[4] = {0.5 * sin(2.0), 0.5 * (1.0 - cos(2.0)), 1.0, 2.0};
    check_orders(&disk, want, 4);
}

/* heading t: x = sin^2(t) / 2, y = (t - sin(2 t) / 2) / 2 (Bloch 2003, 1.6) */
static void orders_of_the_knife(void) {
    const double want[3] = {0.5 * sin(1.0) * sin(1.0), 0.5 * (1.0 - 0.5 * sin(2.0)), 1.0};
    check_orders(&knife, want, 3);
}

static void orders_with_rolling(void) {
    double want[8];
    find_end(want, &particle);
    check_orders(&particle, want, 6);
}

/* reactions that turn with v: at the constraint points v is that of the momentum there */
static void orders_with_nonlinear_rolling(void) {
    const start *const problems[] = {&speed, &pushed};
    for (int i = 0; i < 2; i++) {
        double want[8];
        constrained_problem t;
        open_at(&t, problems[i]);
        CHECK(end_of(want, &t, "gauss(8)", 200));
        problem_close(&t.p);
        check_orders(problems[i], want, 4);
    }
}

/* |v| = 1 by Chetaev's rule bends the path by the force across it: heading' = F . (J v) (Gauss'
 * principle) */
static void given_speed_follows_its_heading(void) {
    constrained_problem t, other;
    double end[8], oblique[8], x = 0.3, y = 0.2, a = atan2(0.8, 0.6);
    open_at(&t, &speed);
    CHECK(end_of(end, &t, "gauss(4)", 100));
    const int steps = 20000;
    for (int i = 0; i < steps; i++) { /* explicit midpoint in the heading */
        const double h = 1.0 / steps;
        const double xm = x + 0.5 * h * cos(a), ym = y + 0.5 * h * sin(a);
        const double turn = sin(a) * cos(x) * cos(y) + cos(a) * sin(x) * sin(y);
        const double am = a + 0.5 * h * turn;
        a += h * (sin(am) * cos(xm) * cos(ym) + cos(am) * sin(xm) * sin(ym));
        x += h * cos(am), y += h * sin(am);
    }
    CHECK_NEAR(end[0], x, 1e-8);
    CHECK_NEAR(end[1], y, 1e-8);
    CHECK_NEAR(atan2(end[3], end[2]), a, 1e-8);
    open_at(&other, &pushed);
    CHECK(end_of(oblique, &other, "gauss(4)", 100));
    CHECK(gap(end, oblique, 2) > 1e-2);
    problem_close(&t.p);
    problem_close(&other.p);
}

/* ---- constraints, momenta, symmetry ---- */

static void constraints_hold_to_round_off(void) {
    const start *const problems[] = {&sphere,   &damped_sphere, &disk,  &knife,
                                     &particle, &speed,         &pushed};
    for (int k = 0; k < 7; k++)
        for (int i = 0; i < ROWS; i++) {
            constrained_problem t;
            session x;
            open_at(&t, problems[k]);
            CHECK(session_open(&x, &t.p, rows[i].rule, 0.05));
            double worst = 0.0;
            for (int step = 0; step < 200; step++) {
                CHECK(session_run(&x, 1) == DM_OK);
                worst = fmax(worst, constrained_defect(&t, x.state, 0.0));
            }
            double size = 1.0;
            for (uint32_t j = 0; j < 2 * t.p.n; j++) size = fmax(size, fabs(x.state[j]));
            CHECK_NEAR(worst, 0.0, 2e-15 * size);
            session_close(&x);
            problem_close(&t.p);
        }
}

/* the constraint does not drift in 10^5 steps, nor does the momentum about the vertical */
static void nothing_drifts(void) {
    const char *const long_rules[] = {"midpoint", "gauss(2)", "lobatto(3)"};
    for (int i = 0; i < 3; i++) {
        constrained_problem t;
        session x;
        open_at(&t, &sphere);
        CHECK(session_open(&x, &t.p, long_rules[i], 0.02));
        CHECK(session_run(&x, 20000) == DM_OK);
        const double *z = x.state;
        CHECK_NEAR(constrained_defect(&t, z, 0.0), 0.0, 2e-15);
        CHECK_NEAR(z[0] * z[4] - z[1] * z[3], 0.6, 3e-14);
        session_close(&x);
        problem_close(&t.p);
    }
}

static void turn_back(session *x, uint32_t n) {
    for (uint32_t i = 0; i < n; i++) {
        x->state[n + i] = -x->state[n + i];
        x->state[3 * n + i] = -x->state[3 * n + i];
    }
}

static void steps_go_back(void) {
    const start *const problems[] = {&sphere, &disk, &knife, &particle, &speed};
    for (int k = 0; k < 5; k++)
        for (int i = 0; i < ROWS; i++) {
            constrained_problem t;
            session x;
            open_at(&t, problems[k]);
            CHECK(session_open(&x, &t.p, rows[i].rule, 0.05));
            for (int leg = 0; leg < 2; leg++) {
                CHECK(session_run(&x, 40) == DM_OK);
                turn_back(&x, t.p.n);
            }
            CHECK_NEAR(gap(x.state, t.p.q, t.p.n), 0.0, 1e-13);
            session_close(&x);
            problem_close(&t.p);
        }
}

/* ---- forces ---- */

/* energy after 1000 coarse steps from 1/2; it swings by c around its mean decay */
static double damped_energy(const char *rule) {
    constrained_problem t;
    session x;
    open_at(&t, &damped);
    CHECK(session_open(&x, &t.p, rule, 0.3));
    CHECK(session_run(&x, 1000) == DM_OK);
    const double E = 0.5 * (x.state[0] * x.state[0] + x.state[1] * x.state[1]);
    session_close(&x);
    problem_close(&t.p);
    return E;
}

/* midpoint maps (q, p) by (1 - h A/2)^-1 (1 + h A/2), A = [0 1; -1 -c], whose determinant is the
 * decay a step */
static void damping_is_right_at_coarse_steps(void) {
    const double c = 0.002, h = 0.3, a = 1.0 + h * h / 4.0, b = c * h / 2.0;
    const double decay = 0.5 * pow((a - b) / (a + b), 1000.0);
    CHECK_NEAR(damped_energy("midpoint") / decay, 1.0, c);
    CHECK_NEAR(damped_energy("trapezoidal") / (0.5 * exp(-300.0 * c)), 1.0, h * h / 4.0);
    CHECK_NEAR(damped_energy("gauss(2)") / (0.5 * exp(-300.0 * c)), 1.0, c);
    CHECK_NEAR(damped_energy("gauss(4)") / (0.5 * exp(-300.0 * c)), 1.0, c);
    CHECK_NEAR(damped_energy("lobatto(4)") / (0.5 * exp(-300.0 * c)), 1.0, c);
}

/* ---- failures, memory ---- */

static void redundant_constraints_are_named(void) {
    const start twice = {twice_maker, 3, 2, {0.6, 0.0, -0.8}, {0.0, 1.0, 0.0}, "twice"};
    constrained_problem t;
    session x;
    open_at(&t, &twice);
    CHECK(session_open(&x, &t.p, "midpoint", 0.05));
    CHECK(session_run(&x, 1) == DM_SINGULAR);
    CHECK(x.s.report.trouble.dependent == 2);
    session_close(&x);
    problem_close(&t.p);
}

/* a step across the sphere has no root: the state stays, the residual is told */
static void too_long_a_step_fails(void) {
    constrained_problem t;
    session x;
    open_at(&t, &sphere);
    CHECK(session_open(&x, &t.p, "midpoint", 40.0));
    double before[4 * PROBLEM_SIZE + 8];
    memcpy(before, x.state, sizeof before);
    const dm_status status = session_run(&x, 1);
    if (status != DM_OK) {
        CHECK(memcmp(before, x.state, sizeof before) == 0);
        CHECK(x.s.report.residual > 0.0);
    } else {
        CHECK(constrained_defect(&t, x.state, 0.0) < 1e-12);
    }
    session_close(&x);
    problem_close(&t.p);
}

/* a step of another length on the side leaves the run alone; state and memory are all that a run
 * goes on from */
static void memory_holds_what_a_run_needs(void) {
    const start *const problems[] = {&sphere, &disk, &speed};
    for (int k = 0; k < 3; k++) {
        constrained_problem t;
        session x, y, z;
        double side[4 * PROBLEM_SIZE + 8], *from, *to;
        open_at(&t, problems[k]);
        CHECK(session_open(&x, &t.p, "gauss(2)", 0.05));
        CHECK(session_open(&y, &t.p, "gauss(2)", 0.05));
        CHECK(session_open(&z, &t.p, "gauss(2)", 0.05));
        CHECK(session_run(&x, 20) == DM_OK);
        for (int i = 0; i < 20; i++) {
            memcpy(side, y.state, sizeof side);
            CHECK(y.s.engine->step(&y.s, side, 0.0, 0.02) == DM_OK);
            CHECK(session_run(&y, 1) == DM_OK);
        }
        CHECK(memcmp(x.state, y.state, 4 * t.p.n * sizeof(double)) == 0);
        const size_t count = dm_stepper_memory(&x.s, &from);
        CHECK(dm_stepper_memory(&z.s, &to) == count);
        memcpy(to, from, count * sizeof *to);
        memcpy(z.state, x.state, sizeof z.state);
        CHECK(session_run(&x, 20) == DM_OK && session_run(&z, 20) == DM_OK);
        CHECK(memcmp(x.state, z.state, 4 * t.p.n * sizeof(double)) == 0);
        session_close(&x);
        session_close(&y);
        session_close(&z);
        problem_close(&t.p);
    }
}

/* cranks of length 1 that a rod of length 2 couples */
static void linkage_maker(constrained_draft *d) {
    const dm_node across[] = {less(d, d->q[2], d->q[0]), less(d, d->q[3], d->q[1])};
    const dm_node crank[] = {less(d, d->q[2], num(d, 2.0)), d->q[3]};
    d->L = times(d, 0.5, dot_of(d, d->v, d->v, 4));
    d->constraint[0] = less(d, dot_of(d, d->q, d->q, 2), num(d, 1.0));
    d->constraint[1] = less(d, dot_of(d, crank, crank, 2), num(d, 1.0));
    d->constraint[2] = less(d, dot_of(d, across, across, 2), num(d, 4.0));
    d->constraints = 3;
}

/* What rattle compares from step to step (rattle.c: VOLUME of its memory) is of the place alone, so
 * that steps of compositions, which go back and are of other lengths, are not looked into. */
static void volumes_are_those_of_the_place(void) {
    static const double parts[] = {0.01, -0.01, 0.02, -0.015};
    const start linkage = {linkage_maker,
                           4,
                           3,
                           {0.54030230586813977, 0.8414709848078965, 2.54030230586813977,
                            0.8414709848078965},
                           {-0.8414709848078965, 0.54030230586813977, -0.8414709848078965,
                            0.54030230586813977},
                           "linkage"};
    constrained_problem t;
    open_at(&t, &linkage);
    for (int i = 0; i < 4; i++) {
        session x;
        double *memory;
        CHECK(session_open(&x, &t.p, "rattle", parts[i]));
        CHECK(session_run(&x, 1) == DM_OK);
        CHECK(dm_stepper_memory(&x.s, &memory) > 1);
        CHECK_NEAR(memory[1], sin(1.0) * sin(1.0), 0.1); /* det G G^T over the squares of rows */
        session_close(&x);
    }
    problem_close(&t.p);
}

int main(void) {
    RUN(orders_with_constraints, "orders 2s and 2r - 2 with constraints, forces, time");
    RUN(orders_against_angles, "the same against the motion in angles");
    RUN(orders_of_the_disk, "and against the exact motion of a rolling disk");
    RUN(orders_of_the_knife, "and of a knife edge on a slope");
    RUN(orders_with_rolling, "orders 2s and 2r - 2 of a rolling constraint in a potential");
    RUN(orders_with_nonlinear_rolling, "orders where reactions turn with the velocity");
    RUN(given_speed_follows_its_heading, "given speed: Chetaev's rule, and another E");
    RUN(constraints_hold_to_round_off, "constraints and rolling hold to round-off");
    RUN(nothing_drifts, "neither constraint nor momentum drift");
    RUN(steps_go_back, "steps of symmetric rules go back");
    RUN(damping_is_right_at_coarse_steps, "damping is right at coarse steps");
    RUN(redundant_constraints_are_named, "redundant constraints are named");
    RUN(too_long_a_step_fails, "too long a step fails and leaves the state");
    RUN(memory_holds_what_a_run_needs, "memory holds what a run needs");
    RUN(volumes_are_those_of_the_place, "volumes of rows are those of the place");
    return check_finish();
}
