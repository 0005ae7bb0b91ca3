/* curve_equation.c - the step equation of curve segments and the exact tangent map of a step. */
#include "integ/curve/curve_inside.h"

#include "linalg/lu.h"

#include <math.h>
#include <string.h>

/* points and ends for the unknowns z, unless they are there already */
dm_status dm_curve_place(dm_curve_step *e, const double *z) {
    const size_t n = e->n;
    const double *w = e->curve.centred ? z + 2 * n : NULL, *low = e->state + 2 * n;
    double y[2] = {0};
    int same = e->ran;
    for (size_t k = 0; k < n; k++) {
        y[0] = low[k] + (w ? e->h * w[k] : 0.0);
        y[1] = z[k];
        same = same && e->y[k] == y[0] && e->y[n + k] == y[1];
        e->y[k] = y[0];
        e->y[n + k] = y[1];
    }
    if (same) return DM_OK;
    const dm_segment_place at = {.q = e->state, .shift = e->y, .v = e->y + n, .t = e->t, .h = e->h};
    const dm_status status = dm_segment_run(&e->segment, &at);
    e->ran = status == DM_OK;
    e->evaluations += (long)e->segment.points;
    return status;
}

/* J for r = (r1, r2, r3) and z = (v, (p1 - p0) / m, (q - q0) / h), without constraints */
static void fill_jacobian(const dm_curve_step *e, double *J) {
    const size_t n = e->n, N = 2 * n, m = e->unknowns;
    const double *G = e->segment.hessian, *Dp = e->segment.plus_tangent;
    const double *Dm = e->segment.minus_tangent, h = e->h;
    for (size_t i = 0; i < n; i++)
        for (size_t j = 0; j < n; j++) {
            const double one = i == j;
            J[i * m + j] = G[i * N + n + j];
            J[(n + i) * m + j] = G[(n + i) * N + n + j] / h;
            J[i * m + n + j] = -(one + Dp[j * N + i]) * e->mass[j];
            J[(n + i) * m + n + j] = -Dp[j * N + n + i] * e->mass[j] / h;
            if (!e->curve.centred) continue;
            J[i * m + N + j] = G[i * N + j] * h;
            J[(n + i) * m + N + j] = G[(n + i) * N + j];
            J[(N + i) * m + j] = Dm[i * N + n + j] / h;
            J[(N + i) * m + n + j] = 0.0;
            J[(N + i) * m + N + j] = one + Dm[i * N + j];
        }
}

/* Residuals of the three parts in units of momenta, of momenta by h, and of velocities; the segment
 * is run at most once for the same unknowns. */
dm_status dm_curve_equation(void *ctx, double *r, double *J, const double *z) {
    dm_curve_step *e = ctx;
    const size_t n = e->n;
    const int tied = e->tie.m > 0;
    const double *p0 = e->state + n, *low = e->state + 3 * n;
    dm_status status = dm_curve_place(e, z);
    if (status != DM_OK) return status;
    e->size = 0.0;
    for (size_t k = 0; k < n; k++) {
        e->p1[k] = p0[k] + (low[k] + e->mass[k] * z[n + k]);
        e->size = fmax(e->size, fabs(p0[k]) + fabs(e->p1[k]));
    }
    if (tied) dm_curve_tie_react(e, z);
    dm_segment_gradient(&e->segment, e->p1, e->curve.centred ? (tied ? e->tie.p0 : p0) : NULL);
    for (size_t k = 0; k < n; k++) {
        r[k] = e->segment.slope[k] - e->mass[k] * z[n + k];
        if (tied) r[k] += e->tie.reaction[k];
        r[n + k] = e->segment.slope[n + k] / e->h;
        /* as rounded in the segment: (q - q0) / h + minus / h has a mean by a decimal h */
        if (e->curve.centred) r[2 * n + k] = (e->h * z[2 * n + k] + e->segment.minus[k]) / e->h;
    }
    if (tied) dm_curve_tie_residual(e, r);
    if (J) {
        if (e->estimate)
            dm_segment_estimate(&e->segment, e->columns);
        else
            dm_segment_hessian(&e->segment, e->columns);
        fill_jacobian(e, J);
        if (tied) dm_curve_tie_matrix(e, J);
    }
    return DM_OK;
}

/* ---- the tangent map ---- */

/* The matrix, a column and its pivots. */
size_t dm_curve_tangent_work(const dm_stepper *s) {
    const dm_curve_step *e = (const dm_curve_step *)(const void *)s->work;
    const size_t m = e->unknowns;
    return e->tie.m ? 0 : m * m + 2 * m + m;
}

/* change of r with entry `which` of (q0, p0), z held */
static void push_start(const dm_curve_step *e, double *r, size_t which) {
    const size_t n = e->n, N = 2 * n, k = which % n;
    const double *Dp = e->segment.plus_tangent, *Dm = e->segment.minus_tangent;
    const int moved = which < n;
    for (size_t i = 0; i < N; i++) {
        const double pulled = Dm[k * N + i] - Dp[k * N + i];
        r[i] = moved ? e->segment.hessian[i * N + k] : pulled;
        if (i >= n) r[i] /= e->h;
    }
    for (size_t i = 0; i < n && e->curve.centred; i++)
        r[N + i] = moved ? Dm[i * N + k] / e->h : 0.0;
}

/* column `which` of the tangent from the change -dz of the unknowns */
static void write_column(const dm_curve_step *e, double *D, const double *dz, size_t which) {
    const size_t n = e->n, N = 2 * n;
    const double *Dp = e->segment.plus_tangent;
    for (size_t i = 0; i < n; i++) {
        double dq = 0.0;
        for (size_t j = 0; j < n; j++) {
            const double y = (j == which) - (e->curve.centred ? e->h * dz[N + j] : 0.0);
            dq += ((i == j) + Dp[i * N + j]) * y - Dp[i * N + n + j] * dz[j];
        }
        D[i * N + which] = dq;
        D[(n + i) * N + which] = (n + i == which) - e->mass[i] * dz[n + i];
    }
}

/* By the implicit function theorem: J dz = -(change of r), with all columns of the Hessian, also
 * those that the step itself does not need. */
dm_status dm_curve_tangent(dm_stepper *s, double *D, const double *state, double t, double h,
                           double *memory) {
    dm_curve_step *e = (dm_curve_step *)(void *)s->work;
    const size_t m = e->unknowns;
    double *J = memory, *r = J + m * m;
    uint32_t *pivot = (uint32_t *)(void *)(r + m);
    dm_status status = dm_curve_solve(s, state, t, h);
    const uint32_t columns = e->columns;
    e->columns = 0; /* all */
    if (status == DM_OK) status = dm_curve_equation(e, r, J, e->z);
    e->columns = columns;
    if (status == DM_OK) status = dm_lu_factor(J, pivot, (uint32_t)m);
    for (size_t k = 0; status == DM_OK && k < 2 * e->n; k++) {
        push_start(e, r, k);
        dm_lu_solve(r, J, pivot, (uint32_t)m);
        write_column(e, D, r, k);
    }
    return status;
}
