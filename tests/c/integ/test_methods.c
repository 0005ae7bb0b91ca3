/* what a step keeps: the symplectic form, momentum maps, energy. */
#include "check.h"
#include "problems.h"
#include "run/drift.h"

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

/* ---- symplecticity ---- */

/* one step of `rule` from z0 + delta e_i; 0 on failure */
static int shifted_step(double *z1, const problem *p, const char *rule, double h,
                        const double *shift) {
    session x;
    const uint32_t m = 2 * p->n;
    int fine = session_open(&x, p, rule, h);
    for (uint32_t i = 0; i < m; i++) x.state[i] += shift[i];
    fine = fine && session_run(&x, 1) == DM_OK;
    for (uint32_t i = 0; i < m; i++) z1[i] = x.state[i] + x.state[m + i];
    session_close(&x);
    return fine;
}

/* column i of the tangent map by a central difference of order 6 */
static int tangent(double *column, const problem *p, const char *rule, double h, uint32_t i) {
    static const double weight[3] = {45.0, -9.0, 1.0};
    const double delta = 2e-3;
    const uint32_t m = 2 * p->n;
    memset(column, 0, m * sizeof *column);
    for (int k = 1; k <= 3; k++)
        for (int sign = -1; sign <= 1; sign += 2) {
            double shift[2 * PROBLEM_SIZE] = {0}, z[2 * PROBLEM_SIZE];
            shift[i] = sign * k * delta;
            if (!shifted_step(z, p, rule, h, shift)) return 0;
            for (uint32_t j = 0; j < m; j++)
                column[j] += sign * weight[k - 1] * z[j] / (60.0 * delta);
        }
    return 1;
}

/* max |D^T J D - J| of one step */
static double symplectic_defect(const problem *p, const char *rule, double h) {
    const uint32_t n = p->n, m = 2 * n;
    double D[2 * PROBLEM_SIZE][2 * PROBLEM_SIZE], worst = 0.0;
    for (uint32_t i = 0; i < m; i++)
        if (!tangent(D[i], p, rule, h, i)) return NAN;
    for (uint32_t i = 0; i < m; i++)
        for (uint32_t j = 0; j < m; j++) {
            double sum = (i + n == j) ? -1.0 : (j + n == i) ? 1.0 : 0.0;
            for (uint32_t k = 0; k < n; k++) sum += D[i][k] * D[j][n + k] - D[i][n + k] * D[j][k];
            worst = fmax(worst, fabs(sum));
        }
    return worst;
}

/* steps so large that a method which only approximates the flow shows it */
static void steps_are_symplectic(void) {
    static const double h[MAKERS] = {0.1, 0.1, 0.5, 0.5, 0.02};
    for (int k = 0; k < MAKERS; k++) {
        problem p;
        makers[k](&p);
        for (int i = 0; i < VARIATIONAL; i++)
            if (!CHECK_NEAR(symplectic_defect(&p, variational[i], h[k]), 0.0, 2e-9))
                printf("# problem %d, %s\n", k, variational[i]);
        problem_close(&p);
    }
}

static void the_test_of_symplecticity_has_teeth(void) {
    problem p;
    kepler(&p);
    CHECK(symplectic_defect(&p, "rk4", 0.1) > 1e-5);
    CHECK(symplectic_defect(&p, "rkf45", 0.1) > 1e-5);
}

/* ---- momentum and energy ---- */

static double angular_momentum(const double *z) {
    return (z[0] * z[3] - z[1] * z[2]) + (z[0] * z[7] - z[1] * z[6]) + (z[4] * z[3] - z[5] * z[2]);
}

static void angular_momentum_is_kept(void) {
    for (int k = 0; k < 2; k++)
        for (int i = 0; i < VARIATIONAL; i++) {
            problem p;
            session x;
            const long steps = check_count(k ? 20000 : 100000);
            double worst = 0.0;
            makers[k](&p);
            CHECK(session_open(&x, &p, variational[i], 0.02));
            for (long done = 0; done < steps; done += 1000) {
                CHECK(session_run(&x, 1000) == DM_OK);
                worst = fmax(worst, fabs(angular_momentum(x.state) / 0.8 - 1.0));
            }
            if (!CHECK_NEAR(worst, 0.0, 1e-13)) printf("# %s\n", variational[i]);
            session_close(&x);
        }
}

/* with long steps a rounded coefficient would show: its error is the same in every step */
static void angular_momentum_walks_at_random(void) {
    static const char *const rules[] = {"gauss(2)", "gauss(3)", "gauss(4)", "lobatto(3)"};
    for (int k = 0; k < 2; k++)
        for (int i = 0; i < 4; i++) {
            problem p;
            session x;
            makers[k](&p);
            CHECK(session_open(&x, &p, rules[i], 0.1));
            CHECK(session_run(&x, check_count(100000)) == DM_OK);
            CHECK_NEAR(angular_momentum(x.state) / 0.8, 1.0, 3e-14);
            session_close(&x);
        }
}

/* the rotation about the vertical acts on angles by shifts: p_phi1 + p_phi2 */
static void vertical_angular_momentum_is_kept(void) {
    problem p;
    whirling_pendulum(&p);
    for (int i = 0; i < VARIATIONAL; i++) {
        session x;
        CHECK(session_open(&x, &p, variational[i], 0.01));
        const double before = x.state[5] + x.state[7];
        CHECK(session_run(&x, check_count(10000)) == DM_OK);
        CHECK_NEAR((x.state[5] + x.state[7]) / before, 1.0, 1e-13);
        session_close(&x);
    }
    problem_close(&p);
}

enum { SAMPLES = 400 };

/* fit the energy along a run: drift of E against time */
static dm_drift energy_drift(const problem *p, const char *rule, double h) {
    static double t[SAMPLES + 1], E[SAMPLES + 1];
    const long stride = check_count(100);
    dm_drift fit;
    session x;
    CHECK(session_open(&x, p, rule, h));
    for (int i = 0; i <= SAMPLES; i++) {
        t[i] = (double)(i * stride) * h;
        E[i] = problem_energy_of(p, x.state);
        if (i < SAMPLES) CHECK(session_run(&x, stride) == DM_OK);
    }
    dm_drift_fit(&fit, t, 1, E, SAMPLES + 1);
    session_close(&x);
    return fit;
}

/* over 40000 steps the fitted change stays far below the oscillation of the energy */
static void energy_does_not_drift(void) {
    static const struct {
        maker *make;
        double h;
    } cases[] = {{kepler, 0.05}, {henon_heiles, 0.2}, {pendulum, 0.2}, {whirling_pendulum, 0.02}};
    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++)
        for (int i = 0; i < VARIATIONAL; i++) {
            problem p;
            cases[k].make(&p);
            const dm_drift fit = energy_drift(&p, variational[i], cases[k].h);
            const double change = fabs(fit.slope) * SAMPLES * (double)check_count(100) * cases[k].h;
            const double rounding = 1e-12 * (1.0 + fabs(fit.mean));
            if (!CHECK(change < 0.1 * fit.largest + rounding) ||
                !CHECK(fabs(fit.slope) < 5.0 * fit.error || change < rounding))
                printf("# problem %zu, %s: slope %g +- %g, largest %g\n", k, variational[i],
                       fit.slope, fit.error, fit.largest);
            CHECK(fit.largest > 0.0 && fit.largest < 0.1 * fabs(fit.mean));
            problem_close(&p);
        }
}

static void energy_of_an_explicit_method_does(void) {
    problem p;
    kepler(&p);
    const dm_drift fit = energy_drift(&p, "rk4", 0.1);
    CHECK(fabs(fit.slope) > 20.0 * fit.error);
}

int main(void) {
    RUN(steps_are_symplectic, "steps are symplectic");
    RUN(the_test_of_symplecticity_has_teeth, "and explicit Runge-Kutta is seen not to be");
    RUN(angular_momentum_is_kept, "angular momentum is kept over 10^5 steps");
    RUN(vertical_angular_momentum_is_kept, "and that of the double spherical pendulum");
    if (!doubles_only())
        RUN(angular_momentum_walks_at_random, "the error is a random walk, not a drift");
    RUN(energy_does_not_drift, "energy does not drift");
    RUN(energy_of_an_explicit_method_does, "and that of explicit Runge-Kutta is seen to drift");
    return check_finish();
}
