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

/* the field at stage i, displaced by Z; with its derivatives where `curved` */
static void evaluate(dm_phase *g, uint32_t i, const double *Z, int curved) {
    const uint32_t n = g->n;
    const double *low = g->state + 2 * n;
    for (uint32_t k = 0; k < 2 * n; k++) g->at[k] = g->state[k] + (low[k] + Z[k]);
    g->at[2 * n] = g->t + dm_weight_double(g->hc[i]);
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

/* R, and J where it is asked for; what R is compared with is the size of the sums */
static dm_status equation(void *ctx, double *R, double *J, const double *Z) {
    dm_phase *g = ctx;
    const size_t n2 = 2 * (size_t)g->n;
    g->size = 0.0;
    for (uint32_t i = 0; i < g->r; i++) evaluate(g, i, Z + i * n2, J != NULL);
    for (uint32_t i = 0; i < g->r; i++)
        for (uint32_t k = 0; k < n2; k++) {
            double sum = 0.0;
            for (uint32_t j = 0; j < g->r; j++)
                sum += dm_weighted(weight(g, i, j, k), g->curve[j * curve_size(g) + k]);
            R[i * n2 + k] = Z[i * n2 + k] - sum;
            g->size = fmax(g->size, fabs(sum));
        }
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

/* from the guess, or in continuation from the root of a shorter step */
static dm_status solve(dm_phase *g, dm_stepper *stepper) {
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
    if (g->ratio > 0.0)
        for (uint32_t k = 0; k < problem.m; k++) g->root[k] = g->ratio * g->shorter[k];
    else
        guess(g);
    const dm_status status = dm_newton(g->root, &problem, g->scratch, &report);
    stepper->report.iterations = report.iterations;
    stepper->report.matrices += report.jacobians;
    stepper->report.residual = report.residual;
    return status;
}

/* from h/16, h/8, ... h, each from the root before: what fails then has no root that is the one
 * of a small step */
static dm_status by_continuation(dm_phase *g, dm_stepper *stepper) {
    const double h = g->h;
    const size_t unknowns = 2 * (size_t)g->n * g->r;
    dm_status status = DM_OK;
    for (double part = 1.0 / 16.0; part <= 1.0 && status == DM_OK; part *= 2.0) {
        dm_phase_scale(g, part * h);
        status = solve(g, stepper);
        memcpy(g->shorter, g->root, unknowns * sizeof *g->root);
        g->ratio = 2.0;
    }
    g->ratio = 0.0;
    if (g->h != h) dm_phase_scale(g, h);
    return status;
}

/* The field is evaluated once more at the root: its last evaluation was an increment before. */
dm_status dm_phase_newton(dm_phase *g, dm_stepper *stepper) {
    const uint32_t n2 = 2 * g->n, w = g->width;
    dm_status status;
    for (uint32_t i = 0; i < g->r; i++) {
        double *out = g->curve + i * curve_size(g);
        dm_kernel_prepare(&g->m->field, out);
        dm_kernel_prepare(&g->m->field_curve, out);
    }
    status = solve(g, stepper);
    if (status == DM_NO_CONVERGENCE || status == DM_SINGULAR) status = by_continuation(g, stepper);
    if (status != DM_OK) return status;
    for (uint32_t i = 0; i < g->r; i++) {
        evaluate(g, i, g->root + i * (size_t)n2, 0);
        for (uint32_t k = 0; k < n2; k++) g->u[(size_t)k * w + i] = g->curve[i * curve_size(g) + k];
    }
    return DM_OK;
}
