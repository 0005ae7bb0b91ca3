/* curve segments: tableaux and the exact derivatives of a segment. */
#include "curves.h"
#include "integ/curve/curve_choice.h"

#include <gsl/gsl_errno.h>
#include <gsl/gsl_odeiv2.h>

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
    CHECK(!dm_curve_find(&c, "rk5") && !dm_curve_find(&c, "gsl-") && !dm_curve_find(&c, ""));
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
    double G = dm_segment_action(&b->segment);
    for (uint32_t k = 0; k < b->n; k++)
        G += P0[k] * b->segment.minus[k] - P1[k] * b->segment.plus[k];
    return G;
}

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
    dm_segment_gradient(&b->segment, P1, P0);
    memcpy(slope, b->segment.slope, 2 * b->n * sizeof *slope);
    for (uint32_t i = 0; i < 2 * b->n; i++) CHECK_NEAR(slope[i], slope_by_difference(b, i), 2e-10);
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
        dm_segment_gradient(&b->segment, P1, P0);
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
    dm_segment_gradient(&b->segment, P1, P0);
    dm_segment_hessian(&b->segment, 0);
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

/* distance of the estimate of G_yy from G_yy itself, at the momenta of the flow, in units of h */
static double estimate_defect(bench *b, double h) {
    const uint32_t n = b->n, N = 2 * n;
    const dm_segment_place at = {.q = b->y, .v = b->y + n, .t = T0, .h = h};
    double p0[16], p1[16], exact[32 * 32], worst = 0.0;
    CHECK(dm_segment_run(&b->segment, &at) == DM_OK);
    for (uint32_t k = 0; k < n; k++) { /* masses are 1 */
        p1[k] = b->segment.arrival[k];
        p0[k] = b->y[n + k] + b->segment.arrival[k] - b->segment.next[k];
    }
    dm_segment_gradient(&b->segment, p1, p0);
    dm_segment_hessian(&b->segment, 0);
    memcpy(exact, b->segment.hessian, N * N * sizeof *exact);
    dm_segment_estimate(&b->segment, 0);
    for (uint32_t i = 0; i < N * N; i++)
        worst = fmax(worst, fabs(b->segment.hessian[i] - exact[i]) / h);
    return worst;
}

static void the_estimate_errs_by_the_order(void) {
    const struct {
        const char *method;
        double bias;
    } rows[] = {{"kutta3", 1.0}, {"rk4", 1.0}, {"rk4", 0.4}, {"gsl-rkck", 0.7}};
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
        bench b;
        CHECK(bench_open(&b, models + 1, rows[i].method, rows[i].bias));
        const double coarse = estimate_defect(&b, 0.04), fine = estimate_defect(&b, 0.02);
        CHECK(log2(coarse / fine) > b.curve.order - 0.4 && coarse < 1e-2);
        bench_close(&b);
    }
}

/* ---- substeps that are chosen ---- */

/* two weights, 1 + q0^2 and 2 */
static void models_have_choices_of_their_own(void) {
    bench one, other;
    dm_kernel first, second;
    dm_arena arena;
    double x[6] = {2.0, 0.0, 0.0, 0.0, 0.1, 0.0}, out[2] = {0.0, 0.0};
    CHECK(bench_open(&one, &curved, "rk4", 1.0) && bench_open(&other, &curved, "rk4", 1.0));
    dm_arena_init(&arena, problem_allocate, NULL);
    dm_graph *g = dm_graph_new(&arena, 6);
    const dm_node square = square_of(g, dm_input(g, 0));
    const dm_node weights[2] = {dm_add(g, dm_constant(g, 1.0), square), dm_constant(g, 2.0)};
    const dm_curve_choice choice = {.n = 2, .serial = 1, .outputs = 2, .graph = g, .out = weights};
    CHECK(dm_curve_choice_build(&first, &choice, &one.model) == DM_OK);
    CHECK(dm_curve_choice_build(&second, &choice, &other.model) == DM_OK);
    CHECK(first.pool != second.pool);
    dm_kernel_prepare(&second, out);
    dm_kernel_eval(&second, x, out);
    CHECK(out[0] == 5.0 && out[1] == 2.0);
    dm_arena_release(&arena);
    bench_close(&one);
    bench_close(&other);
}

int main(void) {
    RUN(tableaux_satisfy_their_order_conditions, "tableaux satisfy their order conditions");
    RUN(tableaux_of_gsl_step_as_gsl_does, "tableaux read off GSL step as GSL does");
    RUN(a_bias_runs_the_method_to_both_sides, "a bias runs the method to both sides");
    RUN(derivatives_of_a_segment_are_exact, "derivatives of a segment are exact");
    RUN(the_estimate_errs_by_the_order, "the estimated matrix errs by the order of the method");
    RUN(models_have_choices_of_their_own, "each model has its own kernel of a choice of substeps");
    return check_finish();
}
