/* legendre.c - the Legendre transform p = dL/dv and its inverse. With a constant mass both are
 * products; else the inverse is Newton's method with L_vv, to round-off, from the guess that
 * the caller brings, and where that leads nowhere from others (solve_along). */
#include "linalg/solve/newton.h"
#include "mech/model.h"
#include "numbers/small_copy.h"

#include <math.h>
#include <string.h>

enum { SIGNS = 6 }; /* of guesses, repeated behind so many coordinates */

/* the equation dL/dv(q, v, t) - p = 0 for v; x = (q, v, t), out = L_v[n], L_vv[n*n]. Of an H it is
 * dH/dp(q, p, t) - v = 0, with p and v in each other's places and out as the kernel gives it. */
typedef struct {
    const dm_model *m;
    const double *p;
    double *x, *out;
    double size;
} equation;

/* x, L_v, L_vv, the root, the way to it, and what Newton's method wants */
size_t dm_legendre_work(const dm_model *m) {
    const size_t n = m->n;
    if (m->structure & DM_HAMILTONIAN)
        return 2 * n + 1 + 2 * n + 4 * n * n + n + dm_newton_work(m->n);
    if (m->structure & DM_DIAGONAL_MASS) return 3 * n + 1;
    return 2 * n + 1 + n + n * n + 2 * n + dm_newton_work(m->n);
}

/* L_v and L_vv at v */
static void evaluate(const dm_model *m, double *x, double *out, const double *v) {
    dm_small_copy(x + m->n, v, m->n);
    dm_kernel_eval(&m->mass, x, out);
}

/* q and t are laid out once for all iterations */
static equation prepare(const dm_model *m, const double *q, double t, double *work) {
    equation e = {.m = m, .x = work, .out = work + 2 * (size_t)m->n + 1};
    dm_small_copy(e.x, q, m->n);
    e.x[2 * (size_t)m->n] = t;
    dm_kernel_prepare(&m->mass, e.out);
    return e;
}

static int all_finite(const double *a, uint32_t n) {
    for (uint32_t i = 0; i < n; i++)
        if (!isfinite(a[i])) return 0;
    return 1;
}

/* p = M v, M diagonal */
static dm_status by_mass(const dm_model *m, double *p, const double *v) {
    if (!m->mass_matrix) return DM_SINGULAR;
    for (uint32_t i = 0; i < m->n; i++) p[i] = m->mass_matrix[i] * v[i];
    return all_finite(p, m->n) ? DM_OK : DM_NOT_FINITE;
}

/* r[n] = out - p, of an H H_p - v, and the largest of these terms. Speed: P4 by rk8pd */
static inline void find_defect(equation *e, double *r) {
    double size = 0.0;
    for (uint32_t i = 0; i < e->m->n; i++) {
        const double found = fabs(e->out[i]), given = fabs(e->p[i]);
        r[i] = e->out[i] - e->p[i];
        size = found > size ? found : size;
        size = given > size ? given : size;
    }
    e->size = size;
}

/* r = H_p - v, J = H_pp at p */
static dm_status velocity_defect(void *ctx, double *r, double *J, const double *p) {
    equation *e = ctx;
    const size_t n = e->m->n;
    dm_small_copy(e->x + n, p, e->m->n);
    dm_kernel_eval(&e->m->field_curve, e->x, e->out);
    find_defect(e, r);
    for (size_t i = 0; J && i < n; i++)
        memcpy(J + i * n, e->out + 2 * n + i * 2 * n + n, n * sizeof *J);
    return DM_OK;
}

/* p with H_p(q, p, t) = v, from v on */
static dm_status momentum_of(const dm_model *m, double *p, const double *q, const double *v,
                             double t, double *work) {
    const size_t n = m->n;
    equation e = {.m = m, .p = v, .x = work, .out = work + 2 * n + 1};
    double *root = e.out + 2 * n + 4 * n * n;
    dm_newton_report report;
    const dm_newton_problem problem = {.m = m->n,
                                       .equation = velocity_defect,
                                       .ctx = &e,
                                       .size = &e.size,
                                       .tolerance = 4e-15,
                                       .max_iterations = 100};
    dm_small_copy(e.x, q, m->n);
    e.x[2 * n] = t;
    dm_kernel_prepare(&m->field_curve, e.out);
    memcpy(root, v, n * sizeof *v);
    const dm_status status = dm_newton(root, &problem, root + n, &report);
    if (status == DM_OK) memcpy(p, root, n * sizeof *p);
    return status;
}

/* v = H_p(q, p, t); p may be v */
static dm_status velocity_of(const dm_model *m, double *v, const double *q, const double *p,
                             double t, double *work) {
    const size_t n = m->n;
    double *out = work + 2 * n + 1;
    dm_small_copy(work, q, m->n);
    dm_small_copy(work + n, p, m->n);
    work[2 * n] = t;
    dm_kernel_prepare(&m->field, out);
    dm_kernel_eval(&m->field, work, out);
    if (!all_finite(out, m->n)) return DM_NOT_FINITE;
    memcpy(v, out, n * sizeof *v);
    return DM_OK;
}

/* one evaluation; what is not finite is told, not handed on */
dm_status dm_legendre(const dm_model *m, double *p, const double *q, const double *v, double t,
                      double *work) {
    if (m->structure & DM_HAMILTONIAN) return momentum_of(m, p, q, v, t, work);
    if (m->structure & DM_DIAGONAL_MASS) return by_mass(m, p, v);
    equation e = prepare(m, q, t, work);
    evaluate(m, e.x, e.out, v);
    if (!all_finite(e.out, m->n)) return DM_NOT_FINITE;
    dm_small_copy(p, e.out, m->n);
    return DM_OK;
}

/* r = L_v - p, J = L_vv; e->size is what r is to be compared with */
static dm_status momentum_defect(void *ctx, double *r, double *J, const double *v) {
    equation *e = ctx;
    const uint32_t n = e->m->n;
    evaluate(e->m, e->x, e->out, v);
    find_defect(e, r);
    if (J) memcpy(J, e->out + n, (size_t)n * n * sizeof *J);
    return DM_OK;
}

/* Newton's method from v; v = 0 is in the domain of most L */
static dm_status solve(const dm_model *m, equation *e, double *v, double *work) {
    static const double rest = 0.0;
    dm_newton_report report;
    const dm_newton_problem problem = {.m = m->n,
                                       .equation = momentum_defect,
                                       .ctx = e,
                                       .size = &e->size,
                                       .inside = &rest,
                                       .period = 1,
                                       .tolerance = 4e-15,
                                       .max_iterations = 100};
    return dm_newton(v, &problem, work, &report);
}

/* v = M^-1 (p - shift), by way of sum[n] */
static dm_status by_inverse(const dm_model *m, double *v, const double *p, double *sum) {
    const uint32_t n = m->n;
    const int diagonal = (m->structure & DM_DIAGONAL_MASS) != 0;
    for (uint32_t i = 0; i < n; i++) {
        const double *row = m->inverse_mass + (diagonal ? 0 : i * (size_t)n);
        sum[i] = diagonal ? row[i] * p[i] : 0.0;
        for (uint32_t j = 0; j < n && !diagonal; j++)
            sum[i] += row[j] * (p[j] - m->momentum_shift[j]);
    }
    if (!all_finite(sum, n)) return DM_NOT_FINITE;
    memcpy(v, sum, n * sizeof *v);
    return DM_OK;
}

/* The way d = p - L_v(0), by which v goes from rest; p, and 0, where L_v has no value there. */
static int find_way(equation *e, double *d) {
    const uint32_t n = e->m->n;
    memset(d, 0, n * sizeof *d);
    evaluate(e->m, e->x, e->out, d);
    for (uint32_t i = 0; i < n; i++) d[i] = e->p[i] - e->out[i];
    if (all_finite(d, n)) return 1;
    memcpy(d, e->p, n * sizeof *d);
    return 0;
}

/* v[n] of these signs, and of one size */
static void place_velocity(double *v, uint32_t n, unsigned signs, double size) {
    for (uint32_t i = 0; i < n; i++) v[i] = signs >> (i % SIGNS) & 1u ? -size : size;
}

/* max |L_v - p| at v; infinite where L_v has no value */
static double miss(equation *e, const double *v) {
    double out = 0.0;
    evaluate(e->m, e->x, e->out, v);
    for (uint32_t i = 0; i < e->m->n; i++) {
        const double off = fabs(e->out[i] - e->p[i]);
        if (!(off <= out)) out = isnan(off) ? INFINITY : off;
    }
    return out;
}

/* Of velocities of all signs and sizes the one with a momentum next to p, where L_v has no value at
 * rest, as that of v log v: then p does not say where v points. 0: it has one nowhere. */
static int guess_anywhere(equation *e, double *v) {
    enum { LEAST = -40, MOST = 40, APART = 2 };
    const uint32_t n = e->m->n, all = 1u << (n < SIGNS ? n : SIGNS);
    double least = INFINITY, size = 0.0;
    unsigned signs = 0;
    for (unsigned k = 0; k < all; k++)
        for (int power = LEAST; power <= MOST; power += APART) {
            place_velocity(v, n, k, ldexp(1.0, power));
            const double off = miss(e, v);
            if (off < least) least = off, signs = k, size = ldexp(1.0, power);
        }
    place_velocity(v, n, signs, size);
    return least < INFINITY;
}

/* Coordinates from `first` on. */
typedef struct {
    uint32_t first, count;
} span;

/* (L_v(unit d) - L_v(0)) . d over |d|^2 of these, at rest in all others, by way of v[n] */
static double growth(equation *e, const double *d, span s, double unit, double *v) {
    const uint32_t end = s.first + s.count;
    double along = 0.0, squares = 0.0, size = 0.0;
    memset(v, 0, e->m->n * sizeof *v);
    for (uint32_t i = s.first; i < end; i++) {
        v[i] = unit * d[i];
        size = fmax(size, fabs(d[i]));
    }
    evaluate(e->m, e->x, e->out, v);
    for (uint32_t i = s.first; i < end; i++) {
        const double part = d[i] / size;
        along += (e->out[i] - e->p[i] + d[i]) / size * part;
        squares += part * part;
    }
    return along / squares;
}

/* The power of 2 by which d is a velocity of about the momentum p, in whatever units: what it makes
 * of the momentum grows along d where L is convex, and against d, where the power has a minus,
 * where -L is. */
static double velocity_along(equation *e, const double *d, span s, double *v) {
    int low = -256, high = 256;
    while (high - low > 1) {
        const int middle = (low + high) / 2;
        if (fabs(growth(e, d, s, ldexp(1.0, middle), v)) <= 1.0)
            low = middle;
        else
            high = middle; /* also where there is no value */
    }
    const double unit = ldexp(1.0, low);
    return copysign(unit, growth(e, d, s, unit, v));
}

/* v[n] = so far along d, in units of that: of all coordinates together, or of `each` by its own,
 * where some have hardly a momentum, as v1^4 + v2^2 at v1 = 1e-4 */
static void guess(equation *e, double *v, const double *d, int each, double far, double *room) {
    const uint32_t n = e->m->n, count = each ? 1 : n;
    for (uint32_t i = 0; i < n; i += count) {
        const double unit = velocity_along(e, d, (span){i, count}, room);
        for (uint32_t k = i; k < i + count; k++) v[k] = far * unit * d[k];
    }
}

/* Other guesses where d2L/dv2 is singular at the first one, as that of v^4 is at v = 0, or it
 * leads nowhere. */
static const double along[] = {1.0, 0.125, 8.0};

/* from these, by way of d[n] */
static dm_status solve_along(const dm_model *m, equation *e, double *root, double *d,
                             double *work) {
    static const size_t ways = sizeof along / sizeof *along;
    const size_t all = m->n > 1 ? 2 * ways : ways;
    dm_status status = DM_SINGULAR;
    if (!find_way(e, d) && guess_anywhere(e, root)) status = solve(m, e, root, work);
    for (size_t k = 0; status != DM_OK && status != DM_CALLBACK && k < all; k++) {
        guess(e, root, d, k >= ways, along[k % ways], work);
        status = solve(m, e, root, work);
    }
    return status;
}

/* v stays as it is where there is no answer */
dm_status dm_legendre_inverse(const dm_model *m, double *v, const double *q, const double *p,
                              double t, double *work) {
    if (m->structure & DM_HAMILTONIAN) return velocity_of(m, v, q, p, t, work);
    if (m->structure & DM_LINEAR_IN_V) return DM_OK;
    const unsigned simple = DM_SEPARABLE | DM_CONSTANT_MASS;
    const uint32_t n = m->n;
    if (m->structure & DM_CONSTANT_MASS && !m->inverse_mass) return DM_SINGULAR;
    if ((m->structure & simple) == simple) return by_inverse(m, v, p, work);
    equation e = prepare(m, q, t, work);
    double *root = e.out + n + (size_t)n * n;
    e.p = p;
    memcpy(root, v, n * sizeof *v);
    dm_status status = solve(m, &e, root, root + 2 * n);
    if (status != DM_OK && status != DM_CALLBACK)
        status = solve_along(m, &e, root, root + n, root + 2 * n);
    if (status == DM_OK) memcpy(v, root, n * sizeof *v);
    return status;
}
