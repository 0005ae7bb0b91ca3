/* curve segments: tableaux, exact derivatives of a segment, symplectic steps of the right order. */
#include "check.h"
#include "integ/curve_segment.h"
#include "models.h"
#include "problems.h"

#include <gsl/gsl_errno.h>
#include <gsl/gsl_odeiv2.h>

static const char *const methods[] = {
    "euler",     "midpoint", "heun",    "kutta3",  "rk4",       "dopri5",   "butcher6",
    "fehlberg7", "dop853",   "gsl-rk2", "gsl-rk4", "gsl-rkf45", "gsl-rkck", "gsl-rk8pd"};
enum { METHODS = sizeof methods / sizeof *methods };

/* ---- tableaux ---- */

static void tableaux_satisfy_their_order_conditions(void) {
    for (int i = 0; i < METHODS; i++) {
        dm_curve c;
        double defect;
        if (!CHECK(dm_curve_find(&c, methods[i]))) continue;
        const int order = dm_curve_conditions(&c, &defect);
        if (!CHECK(order == c.order)) printf("# %s: order %d\n", methods[i], order);
        CHECK(order == 8 ? defect < 1e-13 : defect > 1e-6);
    }
    dm_curve c;
    CHECK(!dm_curve_find(&c, "rk5") && !dm_curve_find(&c, "gsl-") &&
          !dm_curve_find(&c, ""));
}

/* a Lorenz-like field of 3 entries */
static int flow(double t, const double y[], double slope[], void *params) {
    (void)params;
    slope[0] = 3.0 * (y[1] - y[0]) + sin(t);
    slope[1] = y[0] * (2.0 - y[2]) - y[1];
    slope[2] = y[0] * y[1] - y[2];
    return GSL_SUCCESS;
}

static void tableau_step(double *y, const dm_curve *c, double h) {
    double k[DM_CURVE_STAGES][3];
    for (int i = 0; i < c->s; i++) {
        double x[3] = {y[0], y[1], y[2]};
        for (int j = 0; j < i; j++)
            for (int l = 0; l < 3; l++) x[l] += h * c->a[i][j] * k[j][l];
        flow(h * c->c[i], x, k[i], NULL);
    }
    for (int i = 0; i < c->s; i++)
        for (int l = 0; l < 3; l++) y[l] += h * c->plus[i] * k[i][l];
}

static void tableaux_of_gsl_step_as_gsl_does(void) {
    const struct {
        const char *name;
        const gsl_odeiv2_step_type *type;
    } rows[] = {{"rk2", gsl_odeiv2_step_rk2},
                {"gsl-rk4", gsl_odeiv2_step_rk4},
                {"rkf45", gsl_odeiv2_step_rkf45},
                {"gsl-rkck", gsl_odeiv2_step_rkck},
                {"rk8pd", gsl_odeiv2_step_rk8pd}};
    const gsl_odeiv2_system system = {flow, NULL, 3, NULL};
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
        double y[3] = {1.0, 0.5, -0.3}, mine[3] = {1.0, 0.5, -0.3}, error[3];
        dm_curve c;
        gsl_odeiv2_step *s = gsl_odeiv2_step_alloc(rows[i].type, 3);
        CHECK(dm_curve_find(&c, rows[i].name));
        CHECK(gsl_odeiv2_step_apply(s, 0.0, 0.2, y, error, NULL, NULL, &system) == 0);
        tableau_step(mine, &c, 0.2);
        for (int l = 0; l < 3; l++) CHECK_NEAR(mine[l], y[l], 2e-15);
        gsl_odeiv2_step_free(s);
    }
}

/* both sides together: d+ - d- and Ld are those of steps of bias h and -(1 - bias) h */
static void a_bias_runs_the_method_to_both_sides(void) {
    for (int i = 0; i < METHODS; i++) {
        dm_curve whole, c;
        double sum = 0.0, ends[2] = {0.0, 0.0};
        dm_curve_find(&whole, methods[i]);
        c = whole;
        CHECK(dm_curve_bias(&c, 0.3) && c.centred && c.s == 2 * whole.s - 1);
        for (int k = 0; k < c.s; k++) {
            sum += c.weight[k];
            ends[0] += c.plus[k];
            ends[1] += c.minus[k];
        }
        CHECK_NEAR(sum, 1.0, 1e-13);
        CHECK_NEAR(ends[0], 0.3, 1e-13);
        CHECK_NEAR(ends[1], -0.7, 1e-13);
        c = whole;
        CHECK(dm_curve_bias(&c, 1.0) && !c.centred && c.s == whole.s);
        CHECK(memcmp(c.a, whole.a, sizeof c.a) == 0);
    }
}

/* ---- derivatives ---- */

typedef struct {
    dm_model model;
    dm_arena arena;
    uint32_t n;
    dm_curve curve;
    dm_segment segment;
    double *memory, *y;
} bench;

/* L(q, v, t) with a mass that varies, terms linear in v, and time */
static dm_node crooked(dm_graph *g, const dm_node *q, const dm_node *v) {
    const dm_node t = dm_input(g, 4), one = dm_constant(g, 1.5);
    const dm_node bend = dm_apply(g, DM_OP_COS, q[1], 0, 0);
    const dm_node mass = dm_add(g, one, bend);
    const dm_node cross = graph_product(g, v[0], v[1], q[0], t);
    const dm_node swirl = graph_product(g, v[0], q[1], q[1], one);
    const dm_node quartic = graph_product(g, v[1], v[1], v[1], v[1]);
    const dm_node slow = times_of(g, 0.1, quartic);
    const dm_node T = dm_mul(g, mass, sum_of_squares(g, v, 2));
    const dm_node height = dm_apply(g, DM_OP_SIN, dm_mul(g, q[0], q[1]), 0, 0);
    const dm_node all = dm_add(g, dm_add(g, T, times_of(g, 0.2, cross)), slow);
    return dm_sub(g, dm_add(g, all, swirl), height);
}

static const model curved = {"crooked", 2, crooked};

static int bench_open(bench *b, const model *m, const char *method, double bias) {
    dm_node x[2 * 16];
    *b = (bench){.n = m->n};
    dm_arena_init(&b->arena, problem_allocate, NULL);
    dm_graph *g = dm_graph_new(&b->arena, 2 * m->n + 1);
    for (uint32_t i = 0; i < 2 * m->n; i++) x[i] = dm_input(g, i);
    const dm_node L = m->lagrangian(g, x, x + m->n);
    const unsigned want = DM_WANT_VALUE | DM_WANT_SLOPE | DM_WANT_MASS | DM_WANT_ENERGY;
    if (dm_model_build(&b->model, g, L, m->n, want, dm_tape_build, &b->arena) != DM_OK)
        return 0;
    if (!dm_curve_find(&b->curve, method) || !dm_curve_bias(&b->curve, bias)) return 0;
    b->memory = calloc(dm_segment_work(&b->curve, m->n) + 2 * m->n, sizeof(double));
    b->y = b->memory + dm_segment_work(&b->curve, m->n);
    for (uint32_t i = 0; i < 2 * m->n; i++) b->y[i] = 0.5 + 0.1 * ((7 * i) % 5);
    return dm_segment_open(&b->segment, &b->curve, &b->model, b->memory) == DM_OK;
}

static void bench_close(bench *b) {
    free(b->memory);
    dm_arena_release(&b->arena);
}

static const double H = 0.2, T0 = 0.3;
static const double P1[16] = {0.7, -0.4, 0.3, 1.1, -0.2, 0.9, 0.5, -0.6, 0.8};
static const double P0[16] = {-0.3, 0.6, 0.2, 0.4, 1.2, -0.7, 0.1, 0.3, -0.5};

static int bench_run(bench *b, const double *y) {
    const dm_segment_place at = {.q = y, .v = y + b->n, .t = T0, .h = H};
    return dm_segment_run(&b->segment, &at) == DM_OK;
}

/* Ld - p1 . (d+ - q) + p0 . (d- - q), from values alone */
static double bench_value(bench *b, const double *y) {
    if (!bench_run(b, y)) return NAN;
    double G = dm_segment_action(&b->segment, H);
    for (uint32_t k = 0; k < b->n; k++)
        G += P0[k] * b->segment.minus[k] - P1[k] * b->segment.plus[k];
    return G;
}

/* weights of the central difference of order 6 */
static const double DIFFERENCE[3] = {45.0, -9.0, 1.0};

static double slope_by_difference(bench *b, uint32_t i) {
    const double delta = 5e-3;
    double y[32], sum = 0.0;
    for (int k = -3; k <= 3; k++) {
        if (!k) continue;
        memcpy(y, b->y, 2 * b->n * sizeof *y);
        y[i] += k * delta;
        sum += (k > 0 ? 1.0 : -1.0) * DIFFERENCE[abs(k) - 1] * bench_value(b, y);
    }
    return sum / (60.0 * delta);
}

static void check_gradient(bench *b) {
    double slope[32];
    bench_run(b, b->y);
    dm_segment_gradient(&b->segment, P1, P0, H);
    memcpy(slope, b->segment.slope, 2 * b->n * sizeof *slope);
    for (uint32_t i = 0; i < 2 * b->n; i++)
        CHECK_NEAR(slope[i], slope_by_difference(b, i), 2e-10);
}

/* column i of the derivatives of (slope, d+, d-) by differences of what was checked before */
static void difference_column(bench *b, double *column, uint32_t i) {
    const double delta = 5e-3;
    const uint32_t n = b->n, N = 2 * n;
    double y[32];
    memset(column, 0, 2 * N * sizeof *column);
    for (int k = -3; k <= 3; k++) {
        if (!k) continue;
        memcpy(y, b->y, N * sizeof *y);
        y[i] += k * delta;
        bench_run(b, y);
        dm_segment_gradient(&b->segment, P1, P0, H);
        const double w = (k > 0 ? 1.0 : -1.0) * DIFFERENCE[abs(k) - 1] / (60.0 * delta);
        for (uint32_t j = 0; j < N; j++) column[j] += w * b->segment.slope[j];
        for (uint32_t j = 0; j < n; j++) {
            column[N + j] += w * b->segment.plus[j];
            column[N + n + j] += w * b->segment.minus[j];
        }
    }
}

static void check_hessian(bench *b) {
    const uint32_t n = b->n, N = 2 * n;
    double H2[32 * 32], plus[16 * 32], minus[16 * 32], column[64];
    bench_run(b, b->y);
    dm_segment_gradient(&b->segment, P1, P0, H);
    dm_segment_hessian(&b->segment, H);
    memcpy(H2, b->segment.hessian, N * N * sizeof *H2);
    memcpy(plus, b->segment.plus_tangent, n * N * sizeof *plus);
    memcpy(minus, b->segment.minus_tangent, n * N * sizeof *minus);
    for (uint32_t i = 0; i < N; i++) {
        difference_column(b, column, i);
        for (uint32_t j = 0; j < N; j++) {
            CHECK_NEAR(H2[j * N + i], column[j], 2e-9);
            CHECK_NEAR(H2[j * N + i], H2[i * N + j], 1e-13);
        }
        for (uint32_t j = 0; j < n; j++) {
            CHECK_NEAR(plus[j * N + i], column[N + j], 1e-10);
            CHECK_NEAR(minus[j * N + i], column[N + n + j], 1e-10);
        }
    }
}

static void derivatives_of_a_segment_are_exact(void) {
    const model *some[] = {models, models + 1, models + 2, &curved};
    for (int k = 0; k < 4; k++)
        for (int i = 0; i < METHODS; i += 3) {
            bench b;
            if (CHECK(bench_open(&b, some[k], methods[i], i % 2 ? 0.4 : 1.0))) {
                check_gradient(&b);
                check_hessian(&b);
            }
            bench_close(&b);
        }
}

/* ---- steps ---- */

typedef struct {
    problem p;
    session x;
    double *memory;
} run;

static int run_open(run *r, const model *m, const char *rule, double h) {
    bench b;
    const int fine = bench_open(&b, m, "euler", 1.0);
    r->p = (problem){.n = m->n, .model = b.model, .arena = b.arena};
    memcpy(r->p.q, b.y, m->n * sizeof(double));
    memcpy(r->p.v, b.y + m->n, m->n * sizeof(double));
    free(b.memory);
    return fine && session_open(&r->x, &r->p, rule, h);
}

/* a round orbit of Kepler's problem */
static int run_kepler(run *r, const char *rule, double h) {
    int fine = run_open(r, models, rule, h);
    const double state[4] = {1.0, 0.1, 0.2, 0.9};
    if (fine) memcpy(r->x.state, state, sizeof state);
    return fine;
}

static void run_close(run *r) {
    session_close(&r->x);
    problem_close(&r->p);
}

/* max |D^T J D - J| for the exact tangent map D */
static double symplectic_defect(run *r) {
    const uint32_t n = r->p.n, N = 2 * n;
    double D[64], worst = 0.0;
    double *memory = malloc(dm_curve_tangent_work(&r->x.s) * sizeof *memory);
    const dm_status status = dm_curve_tangent(&r->x.s, D, r->x.state, 0.1, memory);
    free(memory);
    if (status != DM_OK) return NAN;
    for (uint32_t i = 0; i < N; i++)
        for (uint32_t j = 0; j < N; j++) {
            double sum = (i + n == j) ? -1.0 : (j + n == i) ? 1.0 : 0.0;
            for (uint32_t k = 0; k < n; k++)
                sum +=
                    D[k * N + i] * D[(n + k) * N + j] - D[(n + k) * N + i] * D[k * N + j];
            worst = fmax(worst, fabs(sum));
        }
    return worst;
}

/* the exact tangent against differences of steps */
static void check_tangent(run *r) {
    const uint32_t n = r->p.n, N = 2 * n;
    double D[64], start[4 * PROBLEM_SIZE + 8];
    double *memory = malloc(dm_curve_tangent_work(&r->x.s) * sizeof *memory);
    CHECK(dm_curve_tangent(&r->x.s, D, r->x.state, 0.1, memory) == DM_OK);
    free(memory);
    memcpy(start, r->x.state, sizeof start);
    for (uint32_t i = 0; i < N; i++) {
        double column[8] = {0};
        for (int k = -3; k <= 3; k++) {
            if (!k) continue;
            memcpy(r->x.state, start, sizeof start);
            r->x.state[i] += 3e-3 * k;
            CHECK(r->x.s.method->step(&r->x.s, r->x.state, 0.1) == DM_OK);
            for (uint32_t j = 0; j < N; j++)
                column[j] += (k > 0 ? 1.0 : -1.0) * DIFFERENCE[abs(k) - 1] *
                             (r->x.state[j] + r->x.state[N + j]) / 0.18;
        }
        for (uint32_t j = 0; j < N; j++) CHECK_NEAR(D[j * N + i], column[j], 5e-9);
    }
    memcpy(r->x.state, start, sizeof start);
}

static void steps_are_symplectic_whatever_the_method(void) {
    const model *some[] = {models, models + 1, models + 2, &curved};
    for (int k = 0; k < 4; k++)
        for (int i = 0; i < METHODS; i++) {
            run r;
            char rule[64];
            snprintf(rule, sizeof rule, "curve(%s, %s)", methods[i], i % 2 ? "1" : "0.5");
            if (CHECK(run_open(&r, some[k], rule, 0.1))) {
                if (!CHECK_NEAR(symplectic_defect(&r), 0.0, 2e-13))
                    printf("# %s, %s\n", some[k]->name, rule);
                if (i < 4) check_tangent(&r);
            }
            run_close(&r);
        }
}

/* Kepler: q x p to round-off over 2000 steps of every method */
static void angular_momentum_is_kept(void) {
    for (int i = 0; i < METHODS; i++) {
        run r;
        char rule[64];
        snprintf(rule, sizeof rule, "curve(%s)", methods[i]);
        if (CHECK(run_kepler(&r, rule, 0.05))) {
            double *z = r.x.state;
            const double before = z[0] * z[3] - z[1] * z[2];
            CHECK(session_run(&r.x, 2000) == DM_OK);
            if (!CHECK_NEAR(z[0] * z[3] - z[1] * z[2], before, 1e-14))
                printf("# %s\n", rule);
        }
        run_close(&r);
    }
}

/* straight segments: bias 1/2 is the midpoint rule; 0 and 1 are the symplectic Euler methods, explicit here */
static void straight_segments_are_known_methods(void) {
    run a, b;
    CHECK(run_kepler(&a, "curve(euler, 0.5)", 0.1));
    CHECK(run_kepler(&b, "midpoint", 0.1));
    CHECK(session_run(&a.x, 50) == DM_OK && session_run(&b.x, 50) == DM_OK);
    for (int k = 0; k < 4; k++) CHECK_NEAR(a.x.state[k], b.x.state[k], 2e-14);
    run_close(&a);
    run_close(&b);
    CHECK(run_kepler(&a, "curve(euler, 1)", 0.1));
    CHECK(run_kepler(&b, "curve(euler, 0)", 0.1));
    double q[2], p[2], r3 = 0.0;
    memcpy(q, a.x.state, sizeof q);
    memcpy(p, a.x.state + 2, sizeof p);
    CHECK(session_run(&a.x, 1) == DM_OK && session_run(&b.x, 1) == DM_OK);
    /* Ld = h L(q0, v), q1 = q0 + h v: p1 = v, p0 = v - h L_q(q0); and the other end */
    r3 = pow(q[0] * q[0] + q[1] * q[1], 1.5);
    for (int k = 0; k < 2; k++) {
        CHECK_NEAR(a.x.state[2 + k], p[k] - 0.1 * q[k] / r3, 4e-16);
        CHECK_NEAR(a.x.state[k], q[k] + 0.1 * a.x.state[2 + k], 4e-16);
        CHECK_NEAR(b.x.state[k], q[k] + 0.1 * p[k], 4e-16);
    }
    r3 = pow(b.x.state[0] * b.x.state[0] + b.x.state[1] * b.x.state[1], 1.5);
    for (int k = 0; k < 2; k++)
        CHECK_NEAR(b.x.state[2 + k], p[k] - 0.1 * b.x.state[k] / r3, 4e-16);
    run_close(&a);
    run_close(&b);
}

/* bias 1/2 gives a symmetric step: back with -h to the start */
static void half_bias_steps_are_symmetric(void) {
    for (int i = 0; i < METHODS; i += 2) {
        run r;
        char rule[64];
        double start[8];
        snprintf(rule, sizeof rule, "curve(%s, 0.5)", methods[i]);
        if (CHECK(run_open(&r, models + 2, rule, 0.05))) {
            memcpy(start, r.x.state, sizeof start);
            CHECK(session_run(&r.x, 20) == DM_OK);
            r.x.s.h = -0.05;
            CHECK(session_run(&r.x, 20) == DM_OK);
            for (int k = 0; k < 8; k++)
                CHECK_NEAR(r.x.state[k] + r.x.state[8 + k], start[k], 1e-13);
        }
        run_close(&r);
    }
}

/* L = v^2/2 + exp q: from (0, 0) the midpoint velocity V = (h/2) exp(h V/2) has no root for h = 2 */
static dm_node steep(dm_graph *g, const dm_node *q, const dm_node *v) {
    const dm_node hill = dm_apply(g, DM_OP_EXP, q[0], 0, 0);
    return dm_add(g, times_of(g, 0.5, square_of(g, v[0])), hill);
}

static void failure_leaves_the_state_alone(void) {
    const model hill = {"steep", 1, steep};
    const char *rules[] = {"curve(euler, 0.5)", "curve(dop853)"};
    for (int i = 0; i < 2; i++) {
        run r;
        double before[4 * PROBLEM_SIZE + 8];
        CHECK(run_open(&r, &hill, rules[i], 2.0));
        r.x.state[0] = i ? 800.0 : 0.0; /* exp 800 is infinite */
        r.x.state[1] = 0.0;
        memcpy(before, r.x.state, sizeof before);
        const dm_status status = session_run(&r.x, 1);
        CHECK(i ? status == DM_NOT_FINITE
                : status == DM_NO_CONVERGENCE || status == DM_SINGULAR);
        CHECK(memcmp(before, r.x.state, sizeof before) == 0);
        run_close(&r);
    }
}

int main(void) {
    RUN(tableaux_satisfy_their_order_conditions,
        "tableaux satisfy their order conditions");
    RUN(tableaux_of_gsl_step_as_gsl_does, "tableaux read off GSL step as GSL does");
    RUN(a_bias_runs_the_method_to_both_sides, "a bias runs the method to both sides");
    RUN(derivatives_of_a_segment_are_exact, "derivatives of a segment are exact");
    RUN(steps_are_symplectic_whatever_the_method,
        "steps are symplectic whatever the method");
    RUN(angular_momentum_is_kept, "angular momentum is kept to round-off");
    RUN(straight_segments_are_known_methods, "straight segments are known methods");
    RUN(half_bias_steps_are_symmetric, "segments around their middle step back");
    RUN(failure_leaves_the_state_alone,
        "a step that is not found leaves the state alone");
    return check_finish();
}
