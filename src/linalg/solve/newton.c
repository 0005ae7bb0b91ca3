#include "linalg/solve/newton.h"

#include "base/written_out.h"
#include "linalg/lu.h"
#include "linalg/solve/newton_limits.h"

#include <math.h>
#include <string.h>

enum { HALVINGS = 12 };

typedef struct {
    const dm_newton_problem *p;
    double *x, *dx, *r, *trial, *start, *J;
    uint32_t *pivot;
    dm_newton_report *report;
    double step, last; /* |dx| of this iteration and the one before */
    double rate;       /* of the iteration before, 1 when not known */
} solver;

size_t dm_newton_work(uint32_t m) {
    return 4 * (size_t)m + (size_t)m * m + (m + 1) / 2;
}

/* max |a|, NaN when there is one or an infinity; which is the largest cannot be foreseen, so
 * there are no branches */
DM_WRITTEN_OUT double norm(const double *a, uint32_t m) {
    double largest = 0.0, bad = 0.0;
#pragma GCC unroll 4
    for (uint32_t i = 0; i < m; i++) {
        const double size = fabs(a[i]);
        largest = size > largest ? size : largest;
        bad += 0.0 * size;
    }
    return largest + bad;
}

/* m of the problem, which is a constant for small ones, here and below */
DM_WRITTEN_OUT dm_status evaluate(solver *s, const double *x, int with_jacobian, uint32_t m) {
    const dm_status status = s->p->equation(s->p->ctx, s->r, with_jacobian ? s->J : NULL, x);
    if (status != DM_OK) return status;
    s->report->residual = norm(s->r, m);
    if (!isfinite(s->report->residual)) return DM_NOT_FINITE;
    if (!with_jacobian) return DM_OK;
    s->report->jacobians++;
    if (s->p->band) return dm_band_factor(s->J, s->pivot, s->p->band);
    return dm_lu_factor(s->J, s->pivot, m);
}

/* dx = -J^-1 r, with J = 1 when none was taken */
DM_WRITTEN_OUT void find_increment(solver *s, uint32_t m) {
#pragma GCC unroll 4
    for (uint32_t i = 0; i < m; i++) s->dx[i] = -s->r[i];
    if (s->report->jacobians && s->p->band)
        dm_band_solve(s->dx, s->J, s->pivot, s->p->band, s->trial);
    else if (s->report->jacobians)
        dm_lu_solve(s->dx, s->J, s->pivot, m);
    s->rate = s->step < INFINITY && s->last < INFINITY ? s->step / s->last : 1.0;
    s->last = s->step;
    s->step = norm(s->dx, m);
    s->report->iterations++;
}

/* the residual is what rounding its terms leaves */
static int is_noise(const solver *s) {
    return s->p->size && s->report->residual <= DM_NEWTON_NOISE * *s->p->size;
}

/* By the rate so far, which one Jacobian does not lose (from its first increment to the second
 * it may double), what dx leaves does not count; what makes |dx| larger than foretold is the
 * noise of the residual, of which the next one would be made as well. */
static int is_drowned(const solver *s, double size) {
    const double rate = 2.0 * s->rate;
    return rate < DM_NEWTON_SLOW && s->step <= DM_NEWTON_ROUND_OFF * size &&
           rate * rate * s->last <= DM_NEWTON_NEGLIGIBLE * s->p->tolerance * size;
}

/* x + dx is the root to round-off: the error that dx leaves, rate * |dx|, does not count.
 * A first-order correction of results needs a Jacobian; without one |dx| itself must stall. */
DM_WRITTEN_OUT int is_last(const solver *s, uint32_t m) {
    const double size = norm(s->x, m) + s->step;
    const double rate = s->last < INFINITY ? s->step / s->last : DM_NEWTON_SLOW; /* not known yet */
    const int stalled = rate > 0.5;
    if (s->step == 0.0) return 1;
    if (s->report->jacobians && s->step <= s->p->tolerance * size) return 1;
    if (s->report->jacobians && is_drowned(s, size)) return 1;
    if (rate < DM_NEWTON_SLOW && rate * s->step <= DM_NEWTON_NEGLIGIBLE * s->p->tolerance * size)
        return 1;
    return stalled && (s->step <= DM_NEWTON_ROUND_OFF * size || is_noise(s));
}

DM_WRITTEN_OUT void move(double *to, const double *x, const double *dx, double part, uint32_t m) {
#pragma GCC unroll 4
    for (uint32_t i = 0; i < m; i++) to[i] = x[i] + part * dx[i];
}

/* chord iterations; DM_NO_CONVERGENCE asks for the damped ones */
DM_WRITTEN_OUT dm_status iterate(solver *s, uint32_t m) {
    int fresh = !s->p->near_identity;
    dm_status status = evaluate(s, s->x, fresh, m);
    s->step = INFINITY;
    while (status == DM_OK && s->report->iterations < s->p->max_iterations) {
        find_increment(s, m);
        if (!isfinite(s->step)) return DM_NO_CONVERGENCE;
        const int last = is_last(s, m);
        move(s->x, s->x, s->dx, 1.0, m);
        if (last) return DM_OK;
        const int slow = s->step > DM_NEWTON_SLOW * s->last;
        if (fresh && slow && s->step > s->last) return DM_NO_CONVERGENCE;
        fresh = slow;
        if (!s->report->jacobians && s->step > s->last)
            memcpy(s->x, s->start, m * sizeof *s->x); /* J = 1 led away */
        status = evaluate(s, s->x, fresh, m);
    }
    return status == DM_OK ? DM_NO_CONVERGENCE : status;
}

static dm_status chord(solver *s) {
    switch (s->p->m) {
    case 1:
        return iterate(s, 1);
    case 2:
        return iterate(s, 2);
    case 3:
        return iterate(s, 3);
    case 4:
        return iterate(s, 4);
    default:
        return iterate(s, s->p->m);
    }
}

/* the largest of dx, dx/2, dx/4, ... that makes |r| smaller; leaves r there, x moved */
static dm_status search(solver *s) {
    const double before = s->report->residual;
    double part = 1.0;
    for (int k = 0; k < HALVINGS; k++, part *= 0.5) {
        move(s->trial, s->x, s->dx, part, s->p->m);
        const dm_status status = evaluate(s, s->trial, 0, s->p->m);
        if (status != DM_OK && status != DM_NOT_FINITE) return status;
        if (status == DM_OK && s->report->residual <= (1.0 - 0.25 * part) * before) {
            memcpy(s->x, s->trial, s->p->m * sizeof *s->x);
            return DM_OK;
        }
    }
    s->report->residual = before;
    return DM_NO_CONVERGENCE;
}

/* No part of a Newton step makes the residual smaller, and the step is small: what is left is
 * the noise of the residual, which cancellation inside L (a stiff k (r - 1)) makes larger than
 * its terms tell. With the exact Jacobian of this very point there is nothing nearer to be had. */
static int is_floor(const solver *s) {
    return s->step <= DM_NEWTON_FLOOR * (norm(s->x, s->p->m) + s->step);
}

/* Newton with a Jacobian at every iterate and a line search */
static dm_status damped(solver *s) {
    s->step = INFINITY;
    while (s->report->iterations < s->p->max_iterations) {
        dm_status status = evaluate(s, s->x, 1, s->p->m);
        if (status != DM_OK) return status;
        find_increment(s, s->p->m);
        if (!isfinite(s->step)) return DM_NOT_FINITE;
        if (is_last(s, s->p->m)) {
            move(s->x, s->x, s->dx, 1.0, s->p->m);
            return DM_OK;
        }
        status = search(s);
        if (status == DM_NO_CONVERGENCE && is_floor(s)) return DM_OK;
        if (status != DM_OK) return status;
    }
    return DM_NO_CONVERGENCE;
}

dm_status dm_newton(double *x, const dm_newton_problem *problem, double *work,
                    dm_newton_report *report) {
    const uint32_t m = problem->m;
    solver s = {.p = problem, .x = x, .dx = work, .r = work + m, .report = report};
    s.trial = s.r + m;
    s.start = s.trial + m;
    s.J = s.start + m;
    s.last = INFINITY;
    s.pivot = (uint32_t *)(void *)(s.J + (size_t)m * m);
    *report = (dm_newton_report){0};
    memcpy(s.start, x, m * sizeof *x);
    dm_status status = chord(&s);
    if (status == DM_OK || status == DM_CALLBACK) return status;
    memcpy(x, s.start, m * sizeof *x);
    return damped(&s);
}
