/* phase_newton.c - the stages of a step on H by Newton's method: displacements Z_i of (q, p) with
 *   Z_i - h sum_j (a_ij V_j, A_ij F_j) = 0,
 * where sweeps contract too slowly or there are more stages than lanes. */
#include "integ/phase/phase_inside.h"
#include "linalg/solve/newton.h"

#include <math.h>
#include <string.h>

/* doubles of the field and its derivatives at a stage */
static size_t curve_size(const dm_phase *g) {
    const size_t n = g->n;
    return 2 * n + 4 * n * n;
}

/* the arguments of the field at the state displaced by Z */
static void place(dm_phase *g, const double *Z, double after) {
    const uint32_t n = g->n;
    const double *low = g->state + 2 * n;
    for (uint32_t k = 0; k < 2 * n; k++) g->at[k] = g->state[k] + (low[k] + Z[k]);
    g->at[2 * n] = g->t + after;
}

const double *dm_phase_derivative(dm_phase *g, const double *Z, double after) {
    place(g, Z, after);
    dm_kernel_eval(&g->m->field_curve, g->at, g->curve);
    g->evaluations++;
    return g->curve + 2 * (size_t)g->n;
}

/* the field at stage i, displaced by Z; with its derivatives where `curved` */
static void evaluate(dm_phase *g, uint32_t i, const double *Z, int curved) {
    place(g, Z, dm_weight_double(g->hc[i]));
    dm_kernel_eval(curved ? &g->m->field_curve : &g->m->field, g->at, g->curve + i * curve_size(g));
    g->evaluations++;
}

/* coefficient of stage j in entry k of stage i */
static dm_weight weight(const dm_phase *g, uint32_t i, uint32_t j, uint32_t k) {
    return (k < g->n ? g->ha : g->hA)[i * g->r + j];
}

/* I - h (a, A) x field' */
static void fill_matrix(const dm_phase *g, double *J) {
    const size_t n2 = 2 * (size_t)g->n, all = n2 * g->r;
    for (uint32_t i = 0; i < g->r; i++)
        for (uint32_t k = 0; k < n2; k++) {
            double *row = J + (i * n2 + k) * all;
            for (uint32_t j = 0; j < g->r; j++) {
                const double *slope = g->curve + j * curve_size(g) + n2 + k * n2;
                const double w = dm_weight_double(weight(g, i, j, k));
                for (size_t l = 0; l < n2; l++) row[j * n2 + l] = -w * slope[l];
            }
            row[i * n2 + k] += 1.0;
        }
}

/* at the fields of all stages */
static double find_residual(dm_phase *g, double *R, const double *Z) {
    const size_t n2 = 2 * (size_t)g->n;
    double largest = 0.0;
    g->size = 0.0;
    for (uint32_t i = 0; i < g->r; i++)
        for (uint32_t k = 0; k < n2; k++) {
            double sum = 0.0;
            for (uint32_t j = 0; j < g->r; j++)
                sum += dm_weighted(weight(g, i, j, k), g->curve[j * curve_size(g) + k]);
            R[i * n2 + k] = Z[i * n2 + k] - sum;
            g->size = fmax(g->size, fabs(sum));
            largest = fmax(largest, fabs(R[i * n2 + k]));
        }
    return largest;
}

double dm_phase_residual(dm_phase *g, double *R, const double *Z) {
    for (uint32_t i = 0; i < g->r; i++) evaluate(g, i, Z + i * 2 * (size_t)g->n, 0);
    return find_residual(g, R, Z);
}

/* R, and J where it is asked for; what R is compared with is the size of the sums */
static dm_status equation(void *ctx, double *R, double *J, const double *Z) {
    dm_phase *g = ctx;
    for (uint32_t i = 0; i < g->r; i++) evaluate(g, i, Z + i * 2 * (size_t)g->n, J != NULL);
    find_residual(g, R, Z);
    if (J) fill_matrix(g, J);
    return DM_OK;
}

/* Z of the polynomials through the stages of the last step, or c h times the field at the start;
 * both depend on the state and the memory alone */
static void guess(dm_phase *g) {
    const uint32_t n2 = 2 * g->n, w = g->width;
    const double *u = g->memory + DM_SWEPT_END + 2 * (size_t)n2;
    const int warm = g->field.lanes && dm_phase_memory_fits(g);
    if (!warm) {
        memset(g->root, 0, n2 * sizeof *g->root);
        evaluate(g, 0, g->root, 0);
    }
    for (uint32_t i = g->r; i-- > 0;) /* stage 0, where the slope at the start lies, last */
        for (uint32_t k = 0; k < n2; k++) {
            double sum = warm ? 0.0 : dm_weight_double(g->hc[i]) * g->curve[k];
            const double *ahead = g->further[k >= g->n];
            for (uint32_t j = 0; warm && j < g->r; j++)
                sum += ahead[j * w + i] * u[(size_t)k * w + j];
            g->root[i * (size_t)n2 + k] = sum;
        }
}

/* from what is in g->root */
static dm_status solve_densely(dm_phase *g, dm_stepper *stepper) {
    dm_newton_report report = {0};
    const dm_newton_problem problem = {.m = 2 * g->n * g->r,
                                       .equation = equation,
                                       .ctx = g,
                                       .size = &g->size,
                                       .place = g->state,
                                       .places = 2 * g->n,
                                       .over = 1.0,
                                       .tolerance = stepper->tolerance,
                                       .max_iterations = stepper->max_iterations};
    const dm_status status = dm_newton(g->root, &problem, g->scratch, &report);
    stepper->report.iterations = report.iterations;
    stepper->report.matrices += report.jacobians;
    stepper->report.residual = report.residual;
    return status;
}

static dm_status solve_by_chords(dm_phase *g, dm_stepper *stepper) {
    return dm_phase_chords(g, stepper, g->root);
}

/* from the guess or, where that is too far away, from h/16, h/8, ... h, each from twice the root
 * before: what fails then has no root that is the one of a small step */
static dm_status solve(dm_phase *g, dm_stepper *stepper,
                       dm_status (*solve_from)(dm_phase *g, dm_stepper *stepper)) {
    const double h = g->h;
    const size_t unknowns = 2 * (size_t)g->n * g->r;
    guess(g);
    dm_status status = solve_from(g, stepper);
    if (status == DM_OK || status == DM_CALLBACK) return status;
    if (status == DM_NOT_FINITE && solve_from == solve_densely) return status;
    for (double part = 1.0 / 16.0; part <= 1.0; part *= 2.0) {
        dm_phase_scale(g, part * h);
        if (part == 1.0 / 16.0) guess(g);
        status = solve_from(g, stepper);
        if (status != DM_OK) break;
        for (size_t k = 0; k < unknowns && part < 1.0; k++) g->root[k] *= 2.0;
    }
    if (g->h != h) dm_phase_scale(g, h);
    return status;
}

/* The field is evaluated once more at the root: its last evaluation was an increment before. */
dm_status dm_phase_newton(dm_phase *g, dm_stepper *stepper) {
    const uint32_t n2 = 2 * g->n, w = g->width;
    dm_status status = DM_NO_CONVERGENCE;
    for (uint32_t i = 0; i < g->r; i++) {
        double *out = g->curve + i * curve_size(g);
        dm_kernel_prepare(&g->m->field, out);
        dm_kernel_prepare(&g->m->field_curve, out);
    }
    if (dm_phase_has_chords(g)) status = solve(g, stepper, solve_by_chords);
    if (status != DM_OK) status = solve(g, stepper, solve_densely);
    if (status != DM_OK) return status;
    for (uint32_t i = 0; i < g->r; i++) {
        evaluate(g, i, g->root + i * (size_t)n2, 0);
        for (uint32_t k = 0; k < n2; k++) g->u[(size_t)k * w + i] = g->curve[i * curve_size(g) + k];
    }
    return DM_OK;
}
