#include "linalg/solve/newton.h"

#include "linalg/lu.h"

#include <math.h>
#include <string.h>

/* one system: a lane alone */
#define W 1
#define HOW
#define DM_LANES_FUSED 0
#include "linalg/solve/newton_text.h"

enum {
    HALVINGS = 12,
    HALVINGS_TO_DOMAIN = 60 /* an increment may be that much longer than what is left to its edge */
};

typedef struct {
    const dm_newton_problem *p;
    chord it;
    double *trial, *start, *J;     /* [m], [m], [m*m] */
    uint32_t *pivot;               /* [m] */
    const dm_newton_factors *kept; /* of an earlier solve, which alone are used; NULL: none */
    dm_newton_report *report;
    dm_status status; /* of the last evaluation */
} solver;

size_t dm_newton_work(uint32_t m) {
    return 4 * (size_t)m + (size_t)m * m + (m + 1) / 2;
}

INLINE dm_status factor(solver *s, uint32_t m) {
    s->report->jacobians++;
    const dm_status status =
        s->p->band ? dm_band_factor(s->J, s->pivot, s->p->band) : dm_lu_factor(s->J, s->pivot, m);
    if (s->p->constant) s->p->constant->made = status == DM_OK;
    return status;
}

/* m of the problem, which is a constant for small ones, here and below */
INLINE dm_status evaluate_at(solver *s, const double *x, int with_jacobian, uint32_t m) {
    chord *it = &s->it;
    const dm_status status = s->p->equation(s->p->ctx, it->r, with_jacobian ? s->J : NULL, x);
    if (status != DM_OK) return status;
    it->residual = norm_of(it->r, m);
    if (!isfinite(it->residual)) return DM_NOT_FINITE;
    it->terms = s->p->size ? *s->p->size : -1.0;
    if (!with_jacobian) return DM_OK;
    it->factored = 1;
    it->age = 0;
    return s->p->constant && s->p->constant->made ? DM_OK : factor(s, m);
}

/* for the text of the iterations, which has one lane here: `all` is always true of it */
INLINE void evaluate(chord *it, void *ctx, uint32_t m, int all) {
    solver *s = ctx;
    (void)all;
    if (s->kept && it->fresh) { /* increments shrink too slowly, unless that is rounding */
        it->fresh = 0;
        it->todo = it->all.step <= DM_NEWTON_ROUND_OFF * norm_of(it->x, m);
        if (!it->todo) return;
    }
    s->status = evaluate_at(s, it->x, it->fresh, m);
    if (s->status != DM_OK) it->todo = it->fresh = 0;
}

/* before the first matrix it is 1, and x stays as it is */
INLINE void solve(const chord *it, void *ctx, double *x, uint32_t m) {
    const solver *s = ctx;
    const double *J = s->kept ? s->kept->J : s->J;
    const uint32_t *pivot = s->kept ? s->kept->pivot : s->pivot;
    if (it->factored && s->p->band)
        dm_band_solve(x, J, pivot, s->p->band, s->trial);
    else if (it->factored)
        dm_lu_solve(x, J, pivot, m);
}

INLINE I chord_of(solver *s, uint32_t m) {
    s->it.todo = 1;
    s->it.fresh = !s->p->near_identity;
    return iterate_chord(&s->it, evaluate, solve, s, m, s->p->max_iterations, s->start);
}

static I chord_iterations(solver *s) {
    switch (s->p->m) {
    case 1:
        return chord_of(s, 1);
    case 2:
        return chord_of(s, 2);
    case 3:
        return chord_of(s, 3);
    case 4:
        return chord_of(s, 4);
    default:
        return chord_of(s, s->p->m);
    }
}

/* the largest of dx, dx/2, dx/4, ... that stays in the domain and makes |r| smaller, or all of dx
 * where `whole` asks for no less; leaves r there, x moved */
static dm_status search(solver *s, int whole) {
    chord *it = &s->it;
    const uint32_t m = s->p->m;
    const double before = it->residual;
    double part = 1.0;
    int outside = 0, larger = 0;
    const int most = s->p->inside ? HALVINGS_TO_DOMAIN : HALVINGS;
    while (outside < most && larger < HALVINGS) {
        for (uint32_t i = 0; i < m; i++) s->trial[i] = it->x[i] + part * it->dx[i];
        const dm_status status = evaluate_at(s, s->trial, 0, m);
        if (status != DM_OK && status != DM_NOT_FINITE) return status;
        const int smaller = it->residual <= (1.0 - 0.25 * part) * before;
        if (status == DM_OK && (smaller || (whole && part == 1.0))) {
            memcpy(it->x, s->trial, m * sizeof *it->x);
            it->all.step *= part; /* what was taken of it */
            return DM_OK;
        }
        larger += status == DM_OK;
        outside += status != DM_OK;
        s->report->outside += status != DM_OK;
        part *= 0.5;
    }
    it->residual = before;
    return DM_NO_CONVERGENCE;
}

/* |J_ij|, J as `equation` has left it */
static double entry(const solver *s, uint32_t i, uint32_t j) {
    const dm_band *b = s->p->band;
    if (!b) return fabs(s->J[(size_t)i * s->p->m + j]);
    const uint32_t from = b->order[i], to = b->order[j];
    const uint32_t apart = from > to ? from - to : to - from;
    return apart > b->width ? 0.0 : fabs(s->J[dm_band_row(b, i) + dm_band_column(b, j)]);
}

/* Is every row of r no more than what it moves by where all places, and the unknowns that are no
 * displacements, are rounded? Row by row, since coordinates may have unlike units. */
static int is_rounding(solver *s) {
    const dm_newton_problem *p = s->p;
    const double *x = s->it.x;
    if (p->equation(p->ctx, s->it.r, s->J, x) != DM_OK) return 0;
    for (uint32_t i = 0; i < p->m; i++) {
        double terms = 0.0;
        for (uint32_t j = 0; j < p->m; j++) {
            const int moves = j + p->shared < p->m;
            const double place = moves ? p->place[j % p->places] / p->over : 0.0;
            terms += entry(s, i, j) * (fabs(x[j]) + fabs(place));
        }
        if (!(fabs(s->it.r[i]) <= DM_NEWTON_UNSEEN * terms)) return 0;
    }
    return 1;
}

/* Are displacements that no place shows left, as of a body that friction has brought to rest away
 * from 0? A constant J leaves nothing else. */
static int is_unseen(solver *s) {
    const dm_newton_problem *p = s->p;
    if (!p->place) return 0;
    const double most = DM_NEWTON_UNSEEN * norm_of(p->place, p->places);
    return s->it.all.step * fabs(p->over) <= most && (p->constant || is_rounding(s));
}

/* No part of a Newton step makes the residual smaller, and the step is small: what is left is
 * the noise of the residual, which cancellation inside L (a stiff k (r - 1)) makes larger than
 * its terms tell. With the exact Jacobian of this very point there is nothing nearer to be had. */
static int is_floor(const solver *s) {
    const chord *it = &s->it;
    return it->all.step <= DM_NEWTON_FLOOR * (norm_of(it->x, s->p->m) + it->all.step);
}

/* A start outside of the domain: half of the way to where r has a value, and half of that. */
static dm_status enter_domain(solver *s) {
    const dm_newton_problem *p = s->p;
    double *x = s->it.x;
    dm_status status = evaluate_at(s, x, 0, p->m);
    double part = 0.5;
    for (int k = 0; status == DM_NOT_FINITE && p->inside && k <= HALVINGS; k++, part *= 0.5) {
        for (uint32_t i = 0; i < p->m; i++) {
            const double to = p->inside[i % p->period], away = s->start[i] - to;
            x[i] = k < HALVINGS && isfinite(away) ? to + part * away : to;
        }
        status = evaluate_at(s, x, 0, p->m);
    }
    return status;
}

/* Is the increment as small as what ends at the noise of the residual, and less than half of the
 * last one of that kind, `least`? Then it is taken whole: where the largest row is noise, as of a
 * stiff spring, |r| does not tell that the others are not solved yet. */
static int is_whole(const solver *s, double *least) {
    if (!is_floor(s) || !(s->it.all.step < 0.5 * *least)) return 0;
    *least = s->it.all.step;
    return 1;
}

/* No iteration is left and the last increment was that small: r was last evaluated at x. Where
 * smaller unknowns were waited for they come first. */
static dm_status end_in_noise(solver *s) {
    if (s->it.waited) return DM_NO_CONVERGENCE;
    memset(s->it.dx, 0, s->p->m * sizeof *s->it.dx);
    return DM_OK;
}

/* Have chord iterations come to their end among increments that small, two at least? */
static int is_noise(const solver *s) {
    const chord *it = &s->it;
    const double most = DM_NEWTON_FLOOR * norm_of(it->x, s->p->m);
    return s->status == DM_OK && it->factored && it->count == s->p->max_iterations &&
           it->all.step <= most && it->all.last <= most;
}

/* Newton with a Jacobian at every iterate and a line search */
static dm_status damped(solver *s) {
    chord *it = &s->it;
    const uint32_t m = s->p->m;
    waiting w = {0};
    double least = INFINITY;
    int small = 0; /* the last increment, as what ends at the noise of the residual */
    it->todo = 1;
    it->all.step = INFINITY;
    if (s->status == DM_NOT_FINITE) {
        const dm_status entered = enter_domain(s);
        if (entered != DM_OK) return entered;
    }
    while (it->count < s->p->max_iterations) {
        dm_status status = evaluate_at(s, it->x, 1, m);
        if (status != DM_OK) return status;
        find_increment(it, solve, s, m);
        if (!isfinite(it->all.step)) return DM_NOT_FINITE;
        int waits;
        const int last = is_last(it, &w, m, &waits) || (!waits && is_unseen(s));
        if (last || waits) advance_iterates(it, m);
        if (last) return DM_OK;
        small = is_floor(s);
        status = waits ? DM_OK : search(s, is_whole(s, &least));
        if (status == DM_NO_CONVERGENCE && is_floor(s)) return DM_OK;
        if (status != DM_OK) return status;
    }
    return small ? end_in_noise(s) : DM_NO_CONVERGENCE;
}

/* chord iterations, and damped ones from the same start where they fail */
static dm_status attempt(solver *s) {
    if (chord_iterations(s)) return DM_OK;
    if (s->status == DM_CALLBACK) return DM_CALLBACK;
    if (s->status == DM_OK && is_unseen(s)) return DM_OK;
    if (is_noise(s) && end_in_noise(s) == DM_OK) return DM_OK;
    memcpy(s->it.x, s->start, s->p->m * sizeof *s->start);
    return damped(s);
}

/* A root that is only missed by unknowns that never settle is one by the largest. */
static dm_status find_root(solver *s) {
    for (;;) {
        const dm_status status = attempt(s);
        if (status == DM_OK || status == DM_CALLBACK || !s->it.waited) return status;
        s->it.own.shared = s->p->m;
        s->it.waited = s->it.factored = 0;
        memcpy(s->it.x, s->start, s->p->m * sizeof *s->start);
    }
}

/* with its workspace laid out, at x; in place, entry by entry: zeros all over and a copy of the
 * whole take a twelfth of a step of lie(1) */
INLINE void open_solver(solver *s, double *x, const dm_newton_problem *problem, double *work,
                        dm_newton_report *report) {
    const uint32_t m = problem->m;
    chord *it = &s->it;
    s->p = problem;
    s->report = report;
    s->kept = NULL;
    s->status = DM_OK;
    it->x = x;
    it->dx = work;
    it->r = work + m;
    it->tolerance = problem->tolerance;
    it->exact = problem->exact;
    it->factored = it->count = it->age = it->waited = 0;
    it->todo = it->fresh = 0;
    it->residual = it->terms = 0.0;
    it->own = (own_sizes){problem->place, problem->places, problem->over, problem->shared};
    s->trial = it->r + m;
    s->start = s->trial + m;
    s->J = problem->constant ? problem->constant->J : s->start + m;
    s->pivot =
        problem->constant ? problem->constant->pivot : (uint32_t *)(void *)(s->J + (size_t)m * m);
    *report = (dm_newton_report){0};
    for (uint32_t i = 0; i < m; i++) s->start[i] = x[i];
}

dm_status dm_newton(double *x, const dm_newton_problem *problem, double *work,
                    dm_newton_report *report) {
    solver s;
    open_solver(&s, x, problem, work, report);
    const dm_status status = find_root(&s);
    report->iterations = s.it.count;
    report->residual = s.it.residual;
    return status;
}

dm_status dm_newton_kept(double *x, const dm_newton_problem *problem,
                         const dm_newton_factors *factors, double *work, dm_newton_report *report) {
    solver s;
    open_solver(&s, x, problem, work, report);
    s.kept = factors;
    s.it.factored = s.it.todo = 1;
    const int found =
        iterate_chord(&s.it, evaluate, solve, &s, problem->m, problem->max_iterations, NULL) != 0;
    report->iterations = s.it.count;
    report->residual = s.it.residual;
    return found ? DM_OK : s.status == DM_CALLBACK ? DM_CALLBACK : DM_NO_CONVERGENCE;
}

int dm_newton_small_settled(dm_newton_wait *wait, const dm_newton_problem *problem, const double *x,
                            const double *dx) {
    chord it = {.x = (double *)x, .dx = (double *)dx};
    const double before = wait->step;
    it.own = (own_sizes){problem->place, problem->places, problem->over, problem->shared};
    wait->step = own_step(&it, problem->m);
    if (wait->step <= problem->tolerance) return 1;
    return wait->waited++ >= DM_NEWTON_PATIENCE && wait->step > 0.5 * before;
}
