/* stage_separable.c - the step of a stage method for L = v.M v/2 + b.v - V(q, t), M constant.
 * The velocities are eliminated: with f_m = M^-1 L_q(q0 + Z_m, t + c_m h),
 *   Z_i = h r_i v0 + h^2 sum_m A_im f_m, r_i = sum_j a_ij,  q1 = q0 + h v0 + h^2 sum_m mean_m f_m.
 * Points with a zero row of A come first and are explicit, points with a zero column last;
 * for Lobatto these are the ends, and Stoermer-Verlet is left with no unknown at all. */
#include "integ/stage/stage_inside.h"

#include "linalg/lu.h"
#include "linalg/solve/newton.h"
#include "linalg/solve/newton_limits.h"
#include "numbers/compensated.h"

#include <math.h>
#include <string.h>

static int is_zero_row(const dm_stage_table *t, uint32_t m) {
    for (uint32_t i = 0; i < t->r; i++)
        if (t->A[m * t->r + i].top != 0.0) return 0;
    return 1;
}

static int is_zero_column(const dm_stage_table *t, uint32_t m) {
    for (uint32_t i = 0; i < t->r; i++)
        if (t->A[i * t->r + m].top != 0.0) return 0;
    return 1;
}

void dm_stage_separable_open(dm_stage *g) {
    for (uint32_t m = 0; m < g->table.r; m++)
        g->points.kind[m] = is_zero_row(&g->table, m)      ? DM_POINT_FIRST
                            : is_zero_column(&g->table, m) ? DM_POINT_LAST
                                                           : DM_POINT_SOLVED;
}

/* out = M^-1 f */
static void divide_by_mass(const dm_model *m, double *out, const double *f) {
    const uint32_t n = m->n;
    const double *w = m->inverse_mass;
    if (m->structure & DM_DIAGONAL_MASS) {
        for (uint32_t i = 0; i < n; i++) out[i] = w[i] * f[i];
        return;
    }
    for (uint32_t i = 0; i < n; i++, w += n) {
        out[i] = 0.0;
        for (uint32_t j = 0; j < n; j++) out[i] += w[j] * f[j];
    }
}

static double *slope_of(const dm_stage *g, uint32_t m) {
    return g->newton.slopes + m * (size_t)g->n;
}

/* force and M^-1 force at q0 + Z; with_curve: also L_qq */
static void evaluate(dm_stage *g, uint32_t m, const double *Z, int with_curve) {
    const size_t n = g->n;
    double *force = slope_of(g, m), *curve = g->newton.curve + m * (2 * n + 3 * n * n);
    dm_stage_at(g, Z, NULL, dm_weight_double(g->weights.hc[m]));
    if (with_curve) {
        dm_kernel_eval(g->newton.stage, g->newton.x, curve);
        memcpy(force, curve, n * sizeof *force);
    } else {
        dm_kernel_eval(g->newton.slope, g->newton.x, force);
    }
    divide_by_mass(g->m, g->points.u + m * n, force);
    g->evaluations++;
}

typedef double two __attribute__((vector_size(16), aligned(8), may_alias));

/* dm_weighted_add of many numbers, two at once */
static void add_many(double *out, dm_weight w, const double *x, uint32_t n) {
    uint32_t k = 0;
    for (; k + 2 <= n; k += 2) {
        two *to = (two *)(void *)(out + k);
        const two y = *(const two *)(const void *)(x + k);
        *to += w.top * y + w.rest * y;
    }
    if (k < n) out[k] += dm_weighted(w, x[k]);
}

/* out += h^2 sum of A_im f_m over the points of one kind */
static void add_forces(const dm_stage *g, double *out, uint32_t i, uint32_t kind) {
    const uint32_t n = g->n, r = g->table.r;
    for (uint32_t m = 0; m < r; m++) {
        if (g->points.kind[m] != kind) continue;
        add_many(out, g->weights.hA[i * r + m], g->points.u + m * (size_t)n, n);
    }
}

/* r_i = Z_i - base_i - h^2 sum_m A_im f_m over the points to solve for; returns behind the last */
static const double *residual(dm_stage *g, double *R, const double *Z) {
    const uint32_t n = g->n;
    for (uint32_t i = 0; i < g->table.r; i++) {
        if (g->points.kind[i] != DM_POINT_SOLVED) continue;
        memcpy(R, g->points.base + i * (size_t)n, n * sizeof *R);
        add_forces(g, R, i, DM_POINT_SOLVED);
        for (uint32_t k = 0; k < n; k++) R[k] = Z[k] - R[k];
        R += n;
        Z += n;
    }
    return R;
}

/* Displacements are rounded as positions are: the largest one, where each row of R is noise beside
 * its own, since coordinates may have unlike units; else 0. */
static double size_of_terms(const dm_stage *g, const double *R, const double *end) {
    double most = 0.0;
    for (uint32_t k = 0; R < end; R++, k = k + 1 < g->n ? k + 1 : 0) {
        const double own = fabs(g->group.state[k]);
        if (!(fabs(*R) <= DM_NEWTON_NOISE * own)) return 0.0;
        most = fmax(most, own);
    }
    return most;
}

/* block (i, m) = delta_im - h^2 A_im M^-1 L_qq(m) */
static void jacobian_block(dm_stage *g, double *J, size_t rows, uint32_t i, uint32_t m) {
    const uint32_t n = g->n;
    const double w = dm_weight_double(g->weights.hA[i * g->table.r + m]);
    const double *qq = g->newton.curve + m * (2 * (size_t)n + 3 * (size_t)n * n) + 2 * n;
    double *column = g->points.a0;     /* only the start value needed it */
    for (uint32_t l = 0; l < n; l++) { /* L_qq is symmetric: its row l is its column */
        divide_by_mass(g->m, column, qq + l * (size_t)n);
        for (uint32_t k = 0; k < n; k++)
            J[k * rows + l] = (double)(i == m && k == l) - w * column[k];
    }
}

static void jacobian(dm_stage *g, double *J) {
    const uint32_t r = g->table.r;
    const size_t rows = g->newton.matrix.band.n;
    size_t at = 0;
    for (uint32_t i = 0; i < r; i++) {
        if (g->points.kind[i] != DM_POINT_SOLVED) continue;
        double *block = J + at * rows;
        for (uint32_t m = 0; m < r; m++) {
            if (g->points.kind[m] != DM_POINT_SOLVED) continue;
            jacobian_block(g, block, rows, i, m);
            block += g->n;
        }
        at += g->n;
    }
}

void dm_stage_matrix(dm_stage *g, double *J) {
    if (g->newton.matrix.banded)
        dm_stage_band_fill(g, J);
    else
        jacobian(g, J);
}

/* forces at all points to solve for, which are at Z */
static void evaluate_all(dm_stage *g, const double *Z, int with_curve) {
    size_t at = 0;
    for (uint32_t m = 0; m < g->table.r; m++) {
        if (g->points.kind[m] != DM_POINT_SOLVED) continue;
        evaluate(g, m, Z + at, with_curve);
        at += g->n;
    }
}

static dm_status equation(void *ctx, double *R, double *J, const double *Z) {
    dm_stage *g = ctx;
    evaluate_all(g, Z, J != NULL);
    g->size = size_of_terms(g, R, residual(g, R, Z));
    if (J) dm_stage_matrix(g, J);
    return DM_OK;
}

/* a0 = M^-1 L_q at the start, which a first point at c = 0 has found already */
static void find_acceleration(dm_stage *g) {
    const uint32_t n = g->n;
    if (g->points.kind[0] == DM_POINT_FIRST && g->table.c[0].top == 0.0) {
        memcpy(g->points.a0, g->points.u, n * sizeof *g->points.a0);
        return;
    }
    memset(g->newton.root, 0, n * sizeof *g->newton.root);
    dm_stage_at(g, g->newton.root, NULL, 0.0);
    dm_kernel_eval(g->newton.slope, g->newton.x, slope_of(g, 0));
    divide_by_mass(g->m, g->points.a0, slope_of(g, 0));
    g->evaluations++;
}

/* the points that need no solving, and base_i = h c_i v0 + h^2 (their part) for the others */
static void first_points(dm_stage *g) {
    const uint32_t n = g->n, r = g->table.r;
    for (uint32_t i = 0; i < r; i++) {
        double *base = g->points.base + i * (size_t)n;
        for (uint32_t k = 0; k < n; k++)
            base[k] = dm_weighted(g->weights.reach[i], g->points.v0[k]);
        if (g->points.kind[i] == DM_POINT_FIRST) evaluate(g, i, base, 0);
    }
    for (uint32_t i = 0; i < r; i++)
        if (g->points.kind[i] != DM_POINT_FIRST)
            add_forces(g, g->points.base + i * (size_t)n, i, DM_POINT_FIRST);
}

/* Z_i = h c_i v0 + (h c_i)^2 a0 / 2: a function of the state alone, so that a restart gives the
 * same bits; returns the number of unknowns */
static uint32_t guess(dm_stage *g) {
    const uint32_t n = g->n;
    uint32_t at = 0;
    for (uint32_t i = 0; i < g->table.r; i++) {
        if (g->points.kind[i] != DM_POINT_SOLVED) continue;
        if (at == 0) find_acceleration(g);
        const double hc = dm_weight_double(g->weights.reach[i]);
        for (uint32_t k = 0; k < n; k++)
            g->newton.root[at + k] = hc * (g->points.v0[k] + 0.5 * hc * g->points.a0[k]);
        at += n;
    }
    return at;
}

/* forces at the root from those one increment dZ before: + L_qq dZ */
static void correct_forces(dm_stage *g, const double *dZ) {
    const uint32_t n = g->n;
    const size_t width = 2 * (size_t)n + 3 * (size_t)n * n;
    for (uint32_t m = 0; m < g->table.r; m++) {
        const double *qq = g->newton.curve + m * width + 2 * n;
        double *force = slope_of(g, m);
        if (g->points.kind[m] != DM_POINT_SOLVED) continue;
        for (uint32_t k = 0; k < n; k++)
            for (uint32_t l = 0; l < n; l++) force[k] += qq[k * (size_t)n + l] * dZ[l];
        divide_by_mass(g->m, g->points.u + m * (size_t)n, force);
        dZ += n;
    }
}

static void last_points(dm_stage *g) {
    for (uint32_t i = 0; i < g->table.r; i++) {
        double *Z = g->points.base + i * (size_t)g->n;
        if (g->points.kind[i] != DM_POINT_LAST) continue;
        add_forces(g, Z, i, DM_POINT_SOLVED);
        evaluate(g, i, Z, 0);
    }
}

/* next = state + (dq[n], dp[n]) with compensation; DM_NOT_FINITE when it is not */
static dm_status update(dm_stage *g, const double *dq, const double *dp) {
    const uint32_t n = g->n;
    double *high = g->group.next, *low = high + 2 * n, bad = 0.0;
    dm_stage_copy(high, g->group.state, 4 * n);
    dm_sum_add_n(high, low, dq, n);
    dm_sum_add_n(high + n, low + n, dp, n);
    for (uint32_t i = 0; i < 2 * n; i++) bad += 0.0 * low[i]; /* NaN where high is infinite */
    return bad == 0.0 ? DM_OK : DM_NOT_FINITE;
}

/* q1 = q0 + h v0 + h^2 sum_m mean_m f_m, p1 = p0 + h sum_m b_m L_q(m) */
static dm_status finish(dm_stage *g) {
    const uint32_t n = g->n, r = g->table.r;
    double *dq = g->points.base, *dp = g->points.a0;
    for (uint32_t k = 0; k < n; k++) {
        dq[k] = dm_weighted(*g->weights.flight, g->points.v0[k]);
        dp[k] = 0.0;
    }
    for (uint32_t m = 0; m < r; m++) {
        dm_weighted_add(dq, g->weights.hmean[m], g->points.u + m * (size_t)n, n);
        dm_weighted_add(dp, g->weights.hb[m], slope_of(g, m), n);
    }
    return update(g, dq, dp);
}

enum { MOST_REFINED = 6 };

static const double REFINED = 1e-12; /* an increment that small is what rounding left */

/* max |a|, four at once, since each waits for the one before; NaN where one is not finite */
static double norm(const double *a, uint32_t m) {
    double most[4] = {0.0}, all = 0.0;
    for (uint32_t i = 0; i < m; i += 4)
#pragma GCC unroll 4
        for (uint32_t k = 0; k < 4; k++) {
            const double x = i + k < m ? a[i + k] : 0.0, size = fabs(x);
            most[k] = size > most[k] ? size : most[k];
            all += 0.0 * x;
        }
    return fmax(fmax(most[0], most[1]), fmax(most[2], most[3])) + all;
}

/* V is quadratic: one solution with the factors of h, refined by what rounding left of it; the
 * forces are those at the root then. */
static dm_status solve_linear(dm_stage *g, dm_stepper *stepper, uint32_t unknowns) {
    dm_stage_newton *w = &g->newton;
    double *r = w->factors - 3 * (size_t)unknowns, *scratch = r + unknowns;
    const dm_status status = dm_stage_band_factor(g);
    for (int k = 1; k <= MOST_REFINED && status == DM_OK; k++) {
        equation(g, r, NULL, w->root);
        const double left = norm(r, unknowns);
        if (w->matrix.banded)
            dm_band_solve(r, w->factors, w->pivot, &w->matrix.band, scratch);
        else
            dm_lu_solve(r, w->factors, w->pivot, unknowns);
        const double step = norm(r, unknowns), size = norm(w->root, unknowns) + step;
        if (!isfinite(step)) return DM_NOT_FINITE;
        stepper->report.iterations = k;
        stepper->report.residual = left * dm_stage_heaviest(g->m) / fabs(g->weights.h);
        for (uint32_t i = 0; i < unknowns; i++) w->root[i] += r[i] = -r[i];
        if (step > REFINED * size) continue;
        if (w->matrix.banded)
            evaluate_all(g, w->root, 0);
        else
            correct_forces(g, r);
        return DM_OK;
    }
    return status == DM_OK ? DM_NO_CONVERGENCE : status;
}

static dm_status solve(dm_stage *g, dm_stepper *stepper, uint32_t unknowns) {
    if (g->newton.linear && solve_linear(g, stepper, unknowns) == DM_OK) return DM_OK;
    dm_newton_report report = {0};
    const dm_newton_problem problem = {.m = unknowns,
                                       .equation = equation,
                                       .ctx = g,
                                       .size = &g->size,
                                       .band = dm_step_matrix_band(&g->newton.matrix),
                                       .near_identity = unknowns > g->n, /* one point: J is cheap */
                                       .place = g->group.state,
                                       .places = g->n,
                                       .over = 1.0,
                                       .tolerance = stepper->tolerance,
                                       .max_iterations = stepper->max_iterations};
    dm_status status = dm_stage_kept(g, &problem, &report);
    const int kept = status == DM_OK;
    stepper->report.matrices += report.jacobians;
    if (!kept) {
        g->newton.factored = NAN; /* their room is taken */
        status = dm_newton(g->newton.root, &problem, g->scratch, &report);
        stepper->report.matrices += report.jacobians;
    }
    stepper->report.iterations = report.iterations;
    stepper->report.trouble.outside = report.outside;
    stepper->report.residual = report.residual * dm_stage_heaviest(g->m) / fabs(g->weights.h);
    if (status == DM_OK && (kept || report.jacobians)) correct_forces(g, g->scratch);
    return status;
}

dm_status dm_stage_separable(dm_stage *g, dm_stepper *stepper) {
    dm_status status = dm_legendre_inverse(g->m, g->points.v0, g->group.state,
                                           g->group.state + g->n, g->group.t, g->scratch);
    if (status != DM_OK) return status;
    stepper->report.iterations = 0;
    stepper->report.residual = 0.0;
    first_points(g);
    const uint32_t unknowns = guess(g);
    for (uint32_t k = 0; g->before.ratio > 0.0 && k < unknowns; k++)
        g->newton.root[k] = g->before.ratio * g->before.root[k];
    if (unknowns) status = solve(g, stepper, unknowns);
    if (status != DM_OK) return status;
    last_points(g);
    return finish(g);
}
