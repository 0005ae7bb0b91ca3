/* curve_solve.c - Newton's method for the step equation of curve segments: where it begins, with
 * which matrix. */
#include "integ/curve/curve_inside.h"

#include "base/largest.h"
#include "linalg/lu.h"
#include "linalg/solve/newton.h"

#include <math.h>
#include <string.h>

static const double SLOW = 0.1;        /* rate of increments that one matrix must beat */
static const double STALE = 3e-2;      /* rate from which the next step takes its own matrix */
static const double ROUND_OFF = 1e-12; /* an increment that small may stall */
static const double NEGLIGIBLE = 6e-9; /* of the tolerance: an increment not worth a step */
enum { CHORDS = 10 };
/* A step drawn out from a part of it: the first part, the least; how much longer parts become at
 * first, and at least. By long parts, and by short ones. */
static const double LEAST_PART = 0x1p-16, SHORT = 1.02;
typedef struct {
    double first, factor, least;
} parts;
static const parts by_long = {0x1p-4, 2.0, 1.02}, by_short = {0x1p-8, 1.02, 1.0002};
/* velocities to those that were foretold on a line, beside the velocities */
static const double CLOSE = 0.05;

/* ---- the start of the iteration ---- */

/* It was left by the step that ended here, and was as long. */
static int fits_memory(const dm_curve_step *e) {
    return e->memory[0] == e->h &&
           memcmp(e->memory + 1, e->state, 4 * e->n * sizeof *e->state) == 0;
}

/* the velocity at the end of the last segment is that of this one to the order of the method and
 * one more */
static dm_status guess_velocity(dm_curve_step *e, const dm_stepper *s, double *v) {
    const size_t n = e->n;
    const double t0 = e->t - (1.0 - e->curve.bias) * e->h;
    if (fits_memory(e)) {
        memcpy(v, e->memory + 1 + 4 * n, n * sizeof *v);
        return DM_OK;
    }
    memset(v, 0, n * sizeof *v);
    const dm_status status =
        dm_legendre_inverse(s->model, v, e->state, e->state + n, e->t, e->scratch);
    return e->tie.m ? dm_curve_tie_hide(e, s, v, e->state + n, e->state, t0) : status;
}

/* rows of M, by their largest entries */
static void measure_mass(dm_curve_step *e, const dm_model *m) {
    const size_t n = e->n;
    const int diagonal = (m->structure & DM_DIAGONAL_MASS) != 0;
    const double *M = m->mass_matrix;
    double *x = e->scratch, *out = e->slope + 2 * n;
    if (!M) {
        memcpy(x, e->state, n * sizeof *x);
        memcpy(x + n, e->z, n * sizeof *x);
        x[2 * n] = e->t;
        dm_kernel_prepare(&m->mass, out);
        dm_kernel_eval(&m->mass, x, out);
        M = out + n;
    }
    for (size_t i = 0; i < n; i++) {
        e->mass[i] = diagonal ? fabs(M[i]) : 0.0;
        for (size_t j = 0; j < n && !diagonal; j++)
            e->mass[i] = fmax(e->mass[i], fabs(M[i * n + j]));
        if (!(e->mass[i] > 0.0)) e->mass[i] = 1.0;
    }
}

/* p1 = L_v where the segment of the guess ends */
static dm_status guess(dm_curve_step *e, const dm_stepper *s) {
    const size_t n = e->n;
    const dm_model *m = s->model;
    dm_status status = guess_velocity(e, s, e->z);
    if (status != DM_OK) return status;
    measure_mass(e, m);
    status = dm_curve_tie_begin(e, e->z);
    if (status != DM_OK) return status;
    memset(e->z + e->unknowns - e->tie.m, 0, e->tie.m * sizeof *e->z);
    for (size_t k = 0; k < n && e->curve.centred; k++)
        e->z[2 * n + k] = (1.0 - e->curve.bias) * e->z[k];
    status = dm_curve_place(e, e->z);
    if (status != DM_OK) return status;
    double *x = e->scratch;
    for (size_t k = 0; k < n; k++) {
        x[k] = e->state[k] + (e->y[k] + e->segment.plus[k]);
        x[n + k] = e->segment.arrival[k];
    }
    x[2 * n] = e->t + e->h;
    dm_kernel_eval(&m->slope, x, e->slope);
    for (size_t k = 0; k < n; k++) e->z[n + k] = (e->slope[n + k] - e->state[n + k]) / e->mass[k];
    return DM_OK;
}

/* ---- iterations ---- */

/* NaN where there is one. */
static double norm(const double *x, size_t n) {
    double largest = 0.0;
    for (size_t i = 0; i < n; i++) largest = dm_largest(largest, x[i]);
    return largest;
}

/* dx = -J^-1 r, where J is taken anew at z or is that of an earlier step */
static dm_status find_increment(dm_curve_step *e, double *dx, int fresh) {
    const uint32_t m = (uint32_t)e->unknowns;
    double *valid = e->memory + 1 + 5 * e->n, *J = valid + 1;
    uint32_t *pivot = (uint32_t *)(void *)(J + (size_t)m * m);
    dm_status status = dm_curve_equation(e, dx, fresh ? J : NULL, e->z);
    if (status != DM_OK) return status;
    e->residual = norm(dx, m);
    e->matrices += fresh;
    if (fresh) status = dm_lu_factor(J, pivot, m);
    if (fresh) *valid = status == DM_OK;
    if (status != DM_OK) return status;
    for (uint32_t i = 0; i < m; i++) dx[i] = -dx[i];
    dm_lu_solve(dx, J, pivot, m);
    return DM_OK;
}

/* All unknowns are velocities, but for the multipliers. */
static dm_newton_problem problem_of(dm_curve_step *e, const dm_stepper *s) {
    return (dm_newton_problem){.m = (uint32_t)e->unknowns,
                               .equation = dm_curve_equation,
                               .ctx = e,
                               .size = &e->size,
                               .place = e->state,
                               .places = (uint32_t)e->n,
                               .shared = (uint32_t)e->tie.m,
                               .over = e->h,
                               .tolerance = s->tolerance,
                               .max_iterations = s->max_iterations};
}

/* one matrix for a whole step; DM_NO_CONVERGENCE where increments do not shrink tenfold */
static dm_status chord(dm_curve_step *e, const dm_stepper *s, int *iterations, int fresh) {
    const size_t m = e->unknowns;
    dm_newton_wait wait = {0};
    double *dx = e->scratch, last = INFINITY, rate, least = SLOW;
    for (int k = 0; k < CHORDS && k < s->max_iterations; k++) {
        const dm_status status = find_increment(e, dx, fresh && k == 0);
        if (status != DM_OK) return status;
        const double step = norm(dx, m), size = norm(e->z, m) + step;
        ++*iterations;
        if (!isfinite(step)) return DM_NOT_FINITE;
        rate = k ? step / last : SLOW; /* not known yet */
        const int stalled = k && rate > SLOW && step <= ROUND_OFF * size;
        if (k) least = fmin(least, rate); /* at the end rates are noise */
        const int small = least * step <= NEGLIGIBLE * s->tolerance * size;
        const int all = step == 0.0 || stalled || small;
        int done = all;
        if (all && dm_newton_has_small(e->z, dx, (uint32_t)(m - e->tie.m), size)) {
            const dm_newton_problem problem = problem_of(e, s);
            done = dm_newton_small_settled(&wait, &problem, e->z, dx);
        }
        for (size_t i = 0; i < m; i++) e->z[i] += dx[i];
        if (done) {
            e->settled = step <= s->tolerance * size && wait.step <= s->tolerance;
            if (k > 3) e->memory[1 + 5 * e->n] = 0.0;
            return DM_OK;
        }
        if (k && rate > SLOW && !all) return DM_NO_CONVERGENCE;
        if (k && rate > STALE) e->memory[1 + 5 * e->n] = 0.0;
        last = step;
    }
    return DM_NO_CONVERGENCE;
}

/* Newton's method with all its care */
static dm_status newton(dm_curve_step *e, const dm_stepper *s, int *iterations) {
    const dm_newton_problem problem = problem_of(e, s);
    dm_newton_report report = {0};
    const dm_status status = dm_newton(e->z, &problem, e->scratch, &report);
    *iterations += report.iterations;
    e->matrices += report.jacobians;
    e->residual = report.residual;
    return status;
}

/* Are there factors of an earlier step of this length? Pivots are looked at, since the memory may
 * come from a file. */
static int has_factors(const dm_curve_step *e) {
    const size_t m = e->unknowns;
    const double *J = e->memory + 2 + 5 * e->n;
    const uint32_t *pivot = (const uint32_t *)(const void *)(J + m * m);
    int fits = e->memory[0] == e->h && e->memory[1 + 5 * e->n] == 1.0;
    for (size_t i = 0; fits && i < m; i++) fits = pivot[i] < m;
    return fits;
}

/* with the matrix of an earlier step, with one of this step, with care */
static dm_status search(dm_curve_step *e, const dm_stepper *s, int *iterations) {
    const int known = has_factors(e);
    const size_t size = e->unknowns * sizeof *e->z;
    double *start = e->z + e->unknowns;
    memcpy(start, e->z, size);
    dm_status status = known ? chord(e, s, iterations, 0) : DM_NO_CONVERGENCE;
    if (status == DM_OK) return status;
    memcpy(e->z, start, size);
    e->estimate = e->curve.order > 2 && !e->tie.k;
    status = chord(e, s, iterations, 1);
    e->estimate = 0;
    if (status == DM_OK) return status;
    e->memory[1 + 5 * e->n] = 0.0;
    memcpy(e->z, start, size);
    return newton(e, s, iterations);
}

/* a step of length h from time t; the segment is at another one */
static void take_length(dm_curve_step *e, double t, double h) {
    e->h = h;
    e->t = t + (1.0 - e->curve.bias) * h; /* of y */
    e->ran = 0;
}

/* the root of a step so short that its guess leads there */
static dm_status begin_short(dm_curve_step *e, const dm_stepper *s, double t, double h,
                             double *part, int *iterations) {
    dm_status status = DM_NO_CONVERGENCE;
    for (; status != DM_OK && *part >= LEAST_PART; *part *= 0.25) {
        take_length(e, t, *part * h);
        status = guess(e, s);
        if (status == DM_OK) status = newton(e, s, iterations);
        if (status == DM_OK) return status;
    }
    return status;
}

/* z on the line through the roots of two parts of a step, its velocities in e->next too; p1 - p0 is
 * that over h, from 0 */
static void predict(dm_curve_step *e, double next, double part, double before) {
    const size_t n = e->n, m = e->unknowns;
    const double *root = e->z + m, *old = root + m, on = (next - part) / (part - before);
    for (size_t k = 0; k < m; k++) {
        const int momentum = n <= k && k < 2 * n;
        const double last = before > 0.0 ? momentum ? old[k] * part / before : old[k] : root[k];
        e->z[k] = (root[k] + on * (root[k] - last)) * (momentum ? next / part : 1.0);
    }
    memcpy(e->next, e->z, n * sizeof *e->z);
}

/* the root of a part, if its velocities are near those that were foretold: else it may be that of
 * another step */
static dm_status draw_out(dm_curve_step *e, const dm_stepper *s, int *iterations) {
    const dm_status status = newton(e, s, iterations);
    const size_t n = e->n;
    double apart = 0.0;
    for (size_t k = 0; k < n; k++) apart = fmax(apart, fabs(e->z[k] - e->next[k]));
    const double size = fmax(norm(e->z, n), norm(e->z + n, n));
    return status == DM_OK && apart > CLOSE * size ? DM_NO_CONVERGENCE : status;
}

/* A short step drawn out to h, each part from the roots before, longer by the factor and, where it
 * fails, by less. What fails then has no root that is the one of a small step. */
static dm_status by_parts(dm_curve_step *e, const dm_stepper *s, double t, double h,
                          const parts *by, int *iterations) {
    const size_t size = e->unknowns * sizeof *e->z;
    double *root = e->z + e->unknowns, part = by->first, before = 0.0, factor = by->factor;
    dm_status status = begin_short(e, s, t, h, &part, iterations);
    memcpy(root, e->z, size);
    while (status == DM_OK && part < 1.0) {
        const double next = fmin(part * factor, 1.0);
        take_length(e, t, next * h);
        predict(e, next, part, before);
        const dm_status there = draw_out(e, s, iterations);
        if (there == DM_OK) {
            memcpy(root + e->unknowns, root, size);
            memcpy(root, e->z, size);
            before = part;
            part = next;
            if (factor < SHORT) factor *= sqrt(factor);
            continue;
        }
        factor = sqrt(factor);
        if (factor < by->least) status = there;
    }
    return status;
}

/* Where Newton's method fails from the guess, as where explicit methods leave the domain of L (a
 * speed limit). Where the root turns so fast that long parts fail, one of them may have gone over
 * to another root: all of it is done again by short ones. */
static dm_status by_continuation(dm_curve_step *e, const dm_stepper *s, double t, double h,
                                 int *iterations) {
    dm_status status = by_parts(e, s, t, h, &by_long, iterations);
    if (status != DM_OK) status = by_parts(e, s, t, h, &by_short, iterations);
    take_length(e, t, h);
    return status;
}

/* from the guess, and where that fails by way of shorter steps */
static dm_status find_root(dm_curve_step *e, const dm_stepper *s, double t, double h,
                           int *iterations) {
    dm_status status = guess(e, s);
    if (status == DM_OK) status = search(e, s, iterations);
    if (status == DM_OK || status == DM_CALLBACK) return status;
    return by_continuation(e, s, t, h, iterations) == DM_OK ? DM_OK : status;
}

/* The unknowns begin at a guess; the number of iterations is that of all tries. */
dm_status dm_curve_solve(dm_stepper *s, const double *state, double t, double h) {
    dm_curve_step *e = (dm_curve_step *)(void *)s->work;
    int iterations = 0;
    e->state = state;
    take_length(e, t, h);
    e->evaluations = e->matrices = 0;
    e->residual = 0.0;
    e->settled = 0;
    if (!fits_memory(e)) e->memory[0] = 0.0;
    const dm_curve *own = s->rule->data;
    dm_status status = own && own->choice ? dm_curve_choose(e, s, own) : DM_OK;
    if (status == DM_OK) status = find_root(e, s, t, h, &iterations);
    s->report.iterations = iterations;
    s->report.residual = e->residual;
    s->report.solves++;
    s->report.newton += iterations;
    s->report.matrices += e->matrices;
    return status;
}
