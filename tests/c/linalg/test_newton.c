/* Newton's iteration: roots in closed form, quadratic economy, damping, every way to fail. */
#include "check.h"
#include "linalg/solve/newton.h"

#include <math.h>
#include <string.h>

static int evaluations;

static dm_newton_problem problem(uint32_t m,
                                 dm_status (*f)(void *, double *, double *, const double *)) {
    evaluations = 0;
    return (dm_newton_problem){.m = m, .equation = f, .tolerance = 4e-15, .max_iterations = 50};
}

static dm_status square_root(void *ctx, double *r, double *J, const double *x) {
    const double a = ctx ? *(const double *)ctx : 2.0;
    evaluations++;
    r[0] = x[0] * x[0] - a;
    if (J) J[0] = 2.0 * x[0];
    return DM_OK;
}

static void finds_a_square_root(void) {
    double x = 1.5, work[16];
    dm_newton_report report;
    const dm_newton_problem p = problem(1, square_root);
    CHECK(dm_newton_work(1) <= 16);
    CHECK(dm_newton(&x, &p, work, &report) == DM_OK);
    CHECK_NEAR(x, sqrt(2.0), 5e-16);
    CHECK(report.iterations >= 3 && report.iterations <= 12);
}

/* x - work[0 .. m) is where the equation was evaluated last */
static double last_seen[2];

/* circle and line: x^2 + y^2 = 25, x - y = 1, root (4, 3) */
static dm_status circle_and_line(void *ctx, double *r, double *J, const double *x) {
    (void)ctx;
    memcpy(last_seen, x, sizeof last_seen);
    r[0] = x[0] * x[0] + x[1] * x[1] - 25.0;
    r[1] = x[0] - x[1] - 1.0;
    if (J) J[0] = 2.0 * x[0], J[1] = 2.0 * x[1], J[2] = 1.0, J[3] = -1.0;
    return DM_OK;
}

static void finds_a_point_and_tells_the_last_increment(void) {
    double x[2] = {5, 2}, work[64];
    dm_newton_report report;
    const dm_newton_problem p = problem(2, circle_and_line);
    CHECK(dm_newton_work(2) <= 64);
    CHECK(dm_newton(x, &p, work, &report) == DM_OK);
    CHECK_NEAR(x[0], 4.0, 2e-15);
    CHECK_NEAR(x[1], 3.0, 2e-15);
    for (int i = 0; i < 2; i++) CHECK_NEAR(x[i] - work[i], last_seen[i], 1e-15);
}

/* Kepler's equation E - e sin E = M, its derivative is nearly 1 for small e */
static dm_status kepler_equation(void *ctx, double *r, double *J, const double *x) {
    const double e = *(const double *)ctx;
    evaluations++;
    r[0] = x[0] - e * sin(x[0]) - 1.0;
    if (J) J[0] = 1.0 - e * cos(x[0]);
    return DM_OK;
}

static void substitutes_where_that_is_enough(void) {
    double e[2] = {0.01, 0.9}, work[16];
    for (int i = 0; i < 2; i++) {
        double x = 1.0;
        dm_newton_report report;
        dm_newton_problem p = problem(1, kepler_equation);
        p.ctx = e + i;
        p.near_identity = 1;
        CHECK(dm_newton(&x, &p, work, &report) == DM_OK);
        CHECK_NEAR(x - e[i] * sin(x), 1.0, 1e-15);
        CHECK((report.jacobians > 0) == (i == 1));
    }
}

/* log x = 0 from x = 8: the full step leads to x < 0, outside the domain */
static dm_status logarithm(void *ctx, double *r, double *J, const double *x) {
    (void)ctx;
    r[0] = log(x[0]);
    if (J) J[0] = 1.0 / x[0];
    return DM_OK;
}

static void steps_back_into_the_domain(void) {
    double x = 8.0, work[16];
    dm_newton_report report;
    const dm_newton_problem p = problem(1, logarithm);
    CHECK(dm_newton(&x, &p, work, &report) == DM_OK);
    CHECK_NEAR(x, 1.0, 1e-15);
}

/* atan x = 0 from x = 20: full steps diverge */
static dm_status arc(void *ctx, double *r, double *J, const double *x) {
    (void)ctx;
    r[0] = atan(x[0]);
    if (J) J[0] = 1.0 / (1.0 + x[0] * x[0]);
    return DM_OK;
}

static void damps_where_full_steps_diverge(void) {
    double x = 20.0, work[16];
    dm_newton_report report;
    const dm_newton_problem p = problem(1, arc);
    CHECK(dm_newton(&x, &p, work, &report) == DM_OK);
    CHECK_NEAR(x, 0.0, 1e-15);
}

/* an exact root at the start needs one evaluation, and zero is a root like another */
static void knows_a_root_at_the_start(void) {
    double zero = 0.0, x = 0.0, work[16];
    dm_newton_report report;
    dm_newton_problem p = problem(1, square_root);
    p.ctx = &zero;
    p.near_identity = 1;
    CHECK(dm_newton(&x, &p, work, &report) == DM_OK);
    CHECK(x == 0.0 && evaluations == 1);
}

/* rounding in r must not be mistaken for failure: terms of 1e6 cancel to 1e-10 */
static dm_status rounded(void *ctx, double *r, double *J, const double *x) {
    double *size = ctx;
    *size = 1e6;
    r[0] = ((x[0] + 1e6) - 1e6) - 1.0 / 3.0;
    if (J) J[0] = 1.0;
    return DM_OK;
}

static void accepts_what_rounding_allows(void) {
    double x = 0.0, size = 0.0, work[16];
    dm_newton_report report;
    dm_newton_problem p = problem(1, rounded);
    p.ctx = &size;
    p.size = &size;
    CHECK(dm_newton(&x, &p, work, &report) == DM_OK);
    CHECK_NEAR(x, 1.0 / 3.0, 2e-10);
}

static dm_status no_root(void *ctx, double *r, double *J, const double *x) {
    (void)ctx;
    r[0] = x[0] * x[0] + 1.0;
    if (J) J[0] = 2.0 * x[0];
    return DM_OK;
}

static dm_status flat(void *ctx, double *r, double *J, const double *x) {
    (void)ctx, (void)x;
    r[0] = 1.0;
    if (J) J[0] = 0.0;
    return DM_OK;
}

static dm_status broken(void *ctx, double *r, double *J, const double *x) {
    (void)ctx, (void)x;
    r[0] = NAN;
    if (J) J[0] = 1.0;
    return DM_OK;
}

static dm_status refused(void *ctx, double *r, double *J, const double *x) {
    (void)ctx, (void)r, (void)J, (void)x;
    evaluations++;
    return DM_CALLBACK;
}

static void fails_by_name(void) {
    double x = 0.7, work[16];
    dm_newton_report report;
    dm_newton_problem p = problem(1, no_root);
    CHECK(dm_newton(&x, &p, work, &report) == DM_NO_CONVERGENCE);
    CHECK(report.iterations > 0 && report.iterations <= 50 && report.residual >= 1.0);
    p = problem(1, flat);
    CHECK(dm_newton(&x, &p, work, &report) == DM_SINGULAR);
    p = problem(1, broken);
    CHECK(dm_newton(&x, &p, work, &report) == DM_NOT_FINITE);
    p = problem(1, refused);
    CHECK(dm_newton(&x, &p, work, &report) == DM_CALLBACK && evaluations == 1);
    p = problem(1, square_root);
    p.max_iterations = 2;
    x = 100.0;
    CHECK(dm_newton(&x, &p, work, &report) == DM_NO_CONVERGENCE && report.iterations == 2);
}

int main(void) {
    RUN(finds_a_square_root, "finds a square root to round-off");
    RUN(finds_a_point_and_tells_the_last_increment, "tells where it evaluated last");
    RUN(substitutes_where_that_is_enough, "takes no Jacobian while substitution converges");
    RUN(steps_back_into_the_domain, "steps back into the domain of the equation");
    RUN(damps_where_full_steps_diverge, "damps where full steps diverge");
    RUN(knows_a_root_at_the_start, "knows a root at the start");
    RUN(accepts_what_rounding_allows, "accepts what rounding allows");
    RUN(fails_by_name, "fails by name: no root, singular, NaN, callback, too few iterations");
    return check_finish();
}
