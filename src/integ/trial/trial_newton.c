/* trial_newton.c - Newton's method for a step. Parameters have different units and may cancel, so
 * that the curve itself says when it ends: how far its points move. */
#include "integ/trial/trial_inside.h"
#include "linalg/lu.h"

#include <math.h>
#include <string.h>

static const double SQUARED = 1e-8; /* the next increment, of its square, is round-off */
static const double ROUND = 1e-9;   /* may be round-off of an ill-conditioned space, if it stays */
static const double BESIDE = 1e-10; /* of the largest coordinate: smaller ones do not count */
static const double EXACT = 4e-15;

/* the largest |q_i| of the points and the largest displacement of it by dz, the worst quotient */
static double displacement(dm_trial *e, const double *dz) {
    const uint32_t n = e->n, K = e->K;
    double *size = e->A, *moved = e->A + n, all = 0.0, worst = 0.0;
    memset(size, 0, 2 * (size_t)n * sizeof *size);
    for (uint32_t j = 0; j < e->points; j++) {
        const dm_trial_point c = dm_trial_at(e, j, e->z, NULL);
        for (uint32_t i = 0; i < n; i++) {
            double d = 0.0;
            for (uint32_t a = 0; a < K; a++) d += c.q_z[i * (size_t)K + a] * dz[a];
            size[i] = fmax(size[i], fabs(c.q[i]));
            moved[i] = fmax(moved[i], fabs(d));
            if (isnan(d)) return NAN;
        }
    }
    for (uint32_t i = 0; i < n; i++) all = fmax(all, size[i]);
    for (uint32_t i = 0; i < n; i++)
        if (moved[i] > 0.0) worst = fmax(worst, moved[i] / fmax(size[i], BESIDE * all));
    return worst;
}

/* z less J^-1 R, and how far that moves the curve */
static dm_status improve(dm_trial *e, dm_stepper *s, double *moved) {
    const uint32_t m = e->unknowns;
    double *J = e->scratch, *R = J + (size_t)m * m;
    uint32_t *pivot = (uint32_t *)(void *)(R + m);
    dm_trial_equation(e, R, J, e->z);
    s->report.residual = 0.0;
    for (uint32_t i = 0; i < m; i++) s->report.residual = fmax(s->report.residual, fabs(R[i]));
    const dm_status status = dm_lu_factor(J, pivot, m);
    if (status != DM_OK) return status;
    dm_lu_solve(R, J, pivot, m);
    *moved = displacement(e, R);
    for (uint32_t i = 0; i < m; i++) e->z[i] -= R[i];
    return isfinite(*moved) ? DM_OK : DM_NOT_FINITE;
}

/* It ends where the next increment, of the square of this one, would be round-off, or where
 * increments are small and no longer shrink, as in spaces whose functions are nearly dependent. A
 * curve that moves further and further is left to the damped method. */
dm_status dm_trial_iterate(dm_trial *e, dm_stepper *s) {
    enum { ITERATIONS = 20 };
    double last = INFINITY, moved = INFINITY;
    for (int k = 0; k < ITERATIONS; k++) {
        const dm_status status = improve(e, s, &moved);
        s->report.newton++, s->report.matrices++, s->report.iterations = k + 1;
        if (status != DM_OK) return status;
        if (moved <= EXACT || (moved <= SQUARED && moved <= last * last * 1e4)) return DM_OK;
        if (moved >= 0.5 * last && last <= ROUND) return DM_OK;
        if (moved > 4.0 * last) return DM_NO_CONVERGENCE;
        last = moved;
    }
    return DM_NO_CONVERGENCE;
}
