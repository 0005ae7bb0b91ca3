/* the loop over time: rows, stop flag, progress, failure, equal bits; and the fit of a drift. */
#include "check.h"
#include "problems.h"
#include "run/drift.h"

enum { WIDTH = 5, MOST = 4096 };

static double rows[MOST * WIDTH];

static int open_kepler(session *x, problem *p, const char *rule) {
    problem_kepler(p, PROBLEM_SEPARABLE);
    return session_open(x, p, rule, 0.01);
}

static void counts_rows(void) {
    static const struct {
        long steps, every, rows;
    } cases[] = {{0, 1, 1},  {1, 1, 2},    {10, 1, 11}, {10, 5, 3},
                 {10, 3, 5}, {10, 100, 2}, {9, 3, 4}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        const dm_run_plan plan = {.t0 = 2.0,
                                  .h = 0.01,
                                  .steps = cases[i].steps,
                                  .every = cases[i].every};
        problem p;
        session x;
        long done = -1, filled = -1;
        CHECK(dm_run_rows(&plan) == cases[i].rows);
        CHECK(open_kepler(&x, &p, "verlet"));
        CHECK(dm_run(&plan, &x.s, x.state, rows, &done, &filled) == DM_OK);
        CHECK(done == cases[i].steps && filled == cases[i].rows);
        CHECK(rows[0] == 2.0 && rows[1] == 0.4 && rows[4] == 2.0);
        CHECK(rows[WIDTH * (filled - 1)] == 2.0 + (double)cases[i].steps * 0.01);
        CHECK(memcmp(rows + WIDTH * (filled - 1) + 1, x.state, 4 * sizeof(double)) == 0);
        session_close(&x);
    }
}

/* each row is the state that single steps reach; time is t0 + k h exactly */
static void rows_are_the_states_of_single_steps(void) {
    static const char *const rules[] = {"verlet", "gauss(2)", "rk8pd"};
    for (int i = 0; i < 3; i++) {
        const dm_run_plan plan = {.h = 0.01, .steps = 3000, .every = 7};
        problem p;
        session x, y;
        long done, filled;
        CHECK(open_kepler(&x, &p, rules[i]) && open_kepler(&y, &p, rules[i]));
        CHECK(dm_run(&plan, &x.s, x.state, rows, &done, &filled) == DM_OK);
        for (long k = 0, row = 0; k <= 3000; k++) {
            if (k % 7 == 0 || k == 3000) {
                CHECK(rows[WIDTH * row] == 0.0 + (double)k * 0.01);
                CHECK(memcmp(rows + WIDTH * row++ + 1, y.state, 4 * sizeof(double)) == 0);
            }
            CHECK(session_run(&y, 1) == DM_OK);
        }
        session_close(&x);
        session_close(&y);
    }
}

/* L = v^2/2 - q^2/2 + q cos 2t at other recording intervals: bursts must not move the times */
static void times_do_not_depend_on_bursts(void) {
    double last[2][4];
    for (int i = 0; i < 2; i++) {
        problem p = {.n = 1};
        session x;
        long done, filled;
        const dm_run_plan plan = {.t0 = 0.1, .h = 0.01, .steps = 2000, .every = i ? 1 : 2000};
        dm_arena_init(&p.arena, problem_allocate, NULL);
        dm_graph *g = dm_graph_new(&p.arena, 3);
        const dm_node q = dm_input(g, 0), v = dm_input(g, 1), t = dm_input(g, 2);
        const dm_node drive = dm_apply(g, DM_OP_COS, dm_add(g, t, t), 0, 0);
        const dm_node L = dm_add(g, dm_mul(g, dm_constant(g, 0.5), dm_mul(g, v, v)),
                                 dm_mul(g, q, dm_sub(g, drive, q)));
        CHECK(dm_model_build(&p.model, g, L, 1, 63, dm_tape_build, &p.arena) == DM_OK);
        p.v[0] = 1.0;
        CHECK(session_open(&x, &p, "verlet", 0.01));
        CHECK(dm_run(&plan, &x.s, x.state, rows, &done, &filled) == DM_OK);
        memcpy(last[i], x.state, sizeof last[i]);
        session_close(&x);
        problem_close(&p);
    }
    CHECK(memcmp(last[0], last[1], sizeof last[0]) == 0);
}

/* ---- stop, progress, failure ---- */

static volatile sig_atomic_t stop;
static long told, last_told;

static void stop_at_the_second_call(void *ud, long done, long steps) {
    CHECK(done > last_told && done <= steps && ud == &told);
    last_told = done;
    if (++told == 2) stop = 1;
}

static void stops_on_request_with_the_rows_so_far(void) {
    const dm_run_plan plan = {.h = 0.01,
                              .steps = 2000000000L,
                              .every = 1000000000L,
                              .stop = &stop,
                              .progress = stop_at_the_second_call,
                              .ud = &told};
    problem p;
    session x;
    long done, filled;
    stop = 0, told = last_told = 0;
    CHECK(open_kepler(&x, &p, "verlet"));
    CHECK(dm_run(&plan, &x.s, x.state, rows, &done, &filled) == DM_STOPPED);
    CHECK(told == 2 && done == last_told && filled == 2);
    CHECK(rows[WIDTH] == (double)done * 0.01);
    CHECK(memcmp(rows + WIDTH + 1, x.state, 4 * sizeof(double)) == 0);
    session_close(&x);
}

static void a_flag_that_is_up_stops_before_the_first_step(void) {
    const dm_run_plan plan = {.h = 0.01, .steps = 10, .every = 1, .stop = &stop};
    problem p;
    session x;
    long done, filled;
    stop = 1;
    CHECK(open_kepler(&x, &p, "midpoint"));
    CHECK(dm_run(&plan, &x.s, x.state, rows, &done, &filled) == DM_STOPPED);
    CHECK(done == 0 && filled == 1);
    session_close(&x);
}

/* Henon-Heiles above its escape energy */
static void a_failure_keeps_the_last_good_row(void) {
    static const char *const rules[] = {"verlet", "midpoint", "rk8pd"};
    for (int i = 0; i < 3; i++) {
        const dm_run_plan plan = {.h = 0.05, .steps = 100000, .every = 100};
        problem p;
        session x;
        long done, filled;
        problem_henon_heiles(&p, PROBLEM_SEPARABLE);
        p.q[1] = 2.0;
        CHECK(session_open(&x, &p, rules[i], 0.05));
        CHECK(dm_run(&plan, &x.s, x.state, rows, &done, &filled) != DM_OK);
        CHECK(done > 0 && done < 100000 &&
              filled == dm_run_rows(&(dm_run_plan){.steps = done, .every = 100}));
        CHECK(rows[WIDTH * (filled - 1)] == (double)done * 0.05);
        for (long k = 0; k < filled * WIDTH; k++) CHECK(isfinite(rows[k]));
        CHECK(memcmp(rows + WIDTH * (filled - 1) + 1, x.state, 4 * sizeof(double)) == 0);
        session_close(&x);
    }
}

static void a_start_that_is_not_finite_is_refused(void) {
    const dm_run_plan plan = {.h = 0.01, .steps = 10, .every = 1};
    problem p;
    session x;
    long done, filled;
    CHECK(open_kepler(&x, &p, "verlet"));
    x.state[1] = NAN;
    CHECK(dm_run(&plan, &x.s, x.state, rows, &done, &filled) == DM_NOT_FINITE);
    CHECK(done == 0 && filled == 1);
    session_close(&x);
}

/* ---- drift ---- */

enum { POINTS = 2000 };

static double t[POINTS], y[POINTS];

/* y = 5 + slope t + cos(w t) + noise u, u uniform in [-1, 1) */
static dm_drift fit(double slope, double w, double noise) {
    uint64_t seed = 3;
    dm_drift d;
    for (int i = 0; i < POINTS; i++) {
        seed = seed * 6364136223846793005u + 1442695040888963407u;
        const double u = (double)(seed >> 11) * 0x1p-52 - 1.0;
        t[i] = 0.1 * i;
        y[i] = 5.0 + slope * t[i] + cos(w * t[i]) + noise * u;
    }
    dm_drift_fit(&d, t, 1, y, POINTS);
    return d;
}

static void finds_a_slope_and_its_error(void) {
    for (double slope = -0.01; slope <= 0.01; slope += 0.005) {
        const dm_drift d = fit(slope, 3.0, 0.1);
        CHECK_NEAR(d.slope, slope, 5.0 * d.error);
        CHECK(d.error > 0.0 && d.error < 2e-4);
        CHECK_NEAR(d.mean, 5.0 + slope * t[POINTS - 1] / 2.0, 0.05);
    }
}

/* the slope left by an oscillation of amplitude 1 is at most 24/(w T^2); its error covers it */
static void an_oscillation_is_no_drift(void) {
    const double T = 0.1 * (POINTS - 1);
    int covered = 0, cases = 0;
    for (double w = 0.5; w < 20.0; w *= 1.05, cases++) {
        const dm_drift d = fit(0.0, w, 0.0);
        CHECK(fabs(d.slope) < 24.0 / (w * T * T));
        CHECK_NEAR(d.largest, 2.0, 0.05);
        CHECK(d.error < 60.0 / (w * T * T));
        covered += fabs(d.slope) < 2.0 * d.error;
    }
    CHECK(covered == cases);
}

static void lines_constants_and_short_columns(void) {
    const double time[6] = {0, -1, 1, -1, 2, -1}, value[3] = {1, 3, 5};
    dm_drift d;
    dm_drift_fit(&d, time, 2, value, 3);
    CHECK_NEAR(d.slope, 2.0, 1e-15);
    CHECK_NEAR(d.error, 0.0, 1e-15);
    CHECK(d.mean == 3.0 && d.largest == 4.0);
    dm_drift_fit(&d, time, 2, value, 1);
    CHECK(d.slope == 0.0 && d.error == 0.0 && d.mean == 1.0 && d.largest == 0.0);
    for (int i = 0; i < POINTS; i++) t[i] = i, y[i] = 1e9;
    dm_drift_fit(&d, t, 1, y, POINTS);
    CHECK(d.slope == 0.0 && d.error == 0.0 && d.mean == 1e9 && d.largest == 0.0);
    for (int i = 0; i < POINTS; i++) t[i] = 1.0;
    dm_drift_fit(&d, t, 1, y, POINTS);
    CHECK(d.slope == 0.0 && d.error == 0.0);
}

/* to another level within three rows; a line, a spike, what comes back and what began so are
 * none */
static void a_jump_is_told_from_a_drift(void) {
    for (int kind = 0; kind < 5; kind++) {
        for (int i = 0; i < POINTS; i++) {
            const double rest = 0.01 * sin(0.3 * i);
            const int after = i >= 60, spike = i == 60;
            const double shape[] = {after     ? 3.0
                                    : i == 59 ? 0.7
                                              : 0.0,
                                    0.05 * i, 3.0 * spike, after && i < 90 ? 3.0 : 0.0,
                                    i > 0 ? 3.0 : 0.0};
            y[i] = -1.0 + rest + shape[kind];
        }
        CHECK(dm_drift_jump(y, POINTS) == (kind ? 0 : 60));
    }
    CHECK(dm_drift_jump(y, 1) == 0 && dm_drift_jump(y, 5) == 0);
}

/* a factor of ten in every quarter, or not */
static void growth_is_told_from_a_drift(void) {
    enum { SOME = 100 };
    for (int kind = 0; kind < 5; kind++) {
        for (int i = 0; i < SOME; i++) {
            const double shape[] = {1e-9 * exp(0.11 * i) * cos(2.0 * i), 1e-9 * exp(0.08 * i),
                                    0.05 * i, sin(0.3 * i), i == 99 ? 1e9 : 0.0};
            y[i] = 5.0 + (i ? shape[kind] : 0.0);
        }
        CHECK(dm_drift_grows(y, SOME) == (kind == 0));
    }
    CHECK(!dm_drift_grows(y, 1) && !dm_drift_grows(y, 19));
}

/* in words: an oscillation that has nearly turned is never said to drift, nor few rows; a line
 * under an oscillation is */
static void a_verdict_needs_enough_rows(void) {
    int found = 0;
    for (double turns = 0.85; turns < 12.0; turns += 0.05)
        for (double phase = 0.0; phase < 6.28; phase += 0.1) {
            dm_drift d;
            for (int i = 0; i < 200; i++) {
                t[i] = i, y[i] = -1.0 + 1e-3 * cos(phase + 6.283185307179586 * turns * i / 200);
            }
            dm_drift_fit(&d, t, 1, y, 200);
            found += dm_drift_judge(&d, t, 1, y, 200) == DM_DRIFT_FOUND;
        }
    CHECK(found == 0);
    const dm_drift line = fit(0.02, 3.0, 0.1);
    CHECK(dm_drift_judge(&line, t, 1, y, POINTS) == DM_DRIFT_FOUND);
    CHECK(dm_drift_judge(&line, t, 1, y, 11) == DM_DRIFT_OPEN);
    const dm_drift none = fit(0.0, 3.0, 0.1);
    CHECK(dm_drift_judge(&none, t, 1, y, POINTS) == DM_DRIFT_NONE);
}

/* a large constant must not cost the digits of a small drift */
static void a_small_drift_of_a_large_number(void) {
    dm_drift d;
    for (int i = 0; i < POINTS; i++) t[i] = 1e6 + i, y[i] = -1e3 + ldexp(i, -30);
    dm_drift_fit(&d, t, 1, y, POINTS);
    CHECK_NEAR(d.slope, ldexp(1.0, -30), 1e-18);
}

int main(void) {
    RUN(counts_rows, "rows: the start, one in every, the end");
    RUN(rows_are_the_states_of_single_steps, "rows are the states of single steps, bit for bit");
    RUN(times_do_not_depend_on_bursts, "times do not depend on bursts");
    RUN(stops_on_request_with_the_rows_so_far, "tells progress, stops on request");
    RUN(a_flag_that_is_up_stops_before_the_first_step, "a flag that is up stops at once");
    RUN(a_failure_keeps_the_last_good_row, "a failure keeps the last good row");
    RUN(a_start_that_is_not_finite_is_refused, "a start that is not finite is refused");
    RUN(finds_a_slope_and_its_error, "finds a slope within its error");
    RUN(an_oscillation_is_no_drift, "an oscillation is no drift");
    RUN(lines_constants_and_short_columns, "lines, constants, short columns");
    RUN(a_jump_is_told_from_a_drift, "a jump is told from a drift");
    RUN(growth_is_told_from_a_drift, "growth is told from a drift");
    RUN(a_verdict_needs_enough_rows, "a verdict in words needs enough rows");
    RUN(a_small_drift_of_a_large_number, "a small drift of a large number");
    return check_finish();
}
