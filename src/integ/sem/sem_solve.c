/* sem_solve.c - the velocities and the length of a symplectic-energy-momentum step. */
#include "integ/sem/sem_inside.h"
#include "integ/sem/sem_warm.h"
#include "linalg/lu.h"
#include "linalg/solve/newton.h"

#include <float.h>
#include <math.h>
#include <string.h>

static const double ROUND = 4 * DBL_EPSILON; /* of the terms: what is left is round-off */
static const double SMALL = 3e-14;           /* of the terms: may be round-off, if it stays */
enum { ITERATIONS = 30, SCAN = 24, TRIES = 100 };

/* largest entry of R[s n] */
static double largest(const dm_sem *e) {
    double out = 0.0;
    for (uint32_t i = 0; i < e->velocities; i++) out = fmax(out, fabs(e->R[i]));
    return out;
}

/* At rest all terms vanish, and nothing is left of them. */
static double part(double left, double size) {
    return left == 0.0 ? 0.0 : left / size;
}

/* what is left of all equations at z, each by the size of its terms */
static double left(const dm_sem *e) {
    const double sum = e->R[e->velocities];
    return fmax(part(largest(e), e->size), part(fabs(sum), e->size_of));
}

/* z less J^-1 R; the factors stay for the conditioning */
static dm_status improve(dm_sem *e) {
    double *J = e->J;
    e->J = e->LU, e->LU = J;
    const dm_status status = dm_lu_factor(e->LU, e->pivot, e->unknowns);
    if (status != DM_OK) return status;
    e->factored = 1;
    memcpy(e->dz, e->R, e->unknowns * sizeof *e->dz);
    dm_lu_solve(e->dz, e->LU, e->pivot, e->unknowns);
    for (uint32_t i = 0; i < e->unknowns; i++) e->z[i] -= e->dz[i];
    return DM_OK;
}

/* back to the best z, where E_d and the gain of momentum are taken */
static void go_back(dm_sem *e) {
    memcpy(e->z, e->kept, e->unknowns * sizeof *e->z);
    dm_sem_equation(e, e->R, NULL, e->z, e->unknowns);
}

/* Newton's method with a matrix of its own every time: near h the equation for it is so flat that
 * no other does. It ends when what is left is round-off or no longer shrinks. */
static dm_status iterate(dm_sem *e, dm_stepper *s) {
    double last = INFINITY;
    e->factored = 0, e->slope = 0.0;
    for (int k = 0; k < ITERATIONS; k++) {
        dm_sem_equation(e, e->R, e->J, e->z, e->unknowns);
        const double rest = left(e);
        if (!isfinite(rest)) return DM_NOT_FINITE;
        if (rest <= ROUND) return DM_OK;
        if (rest >= 0.5 * last && last <= SMALL) return go_back(e), DM_OK;
        memcpy(e->kept, e->z, e->unknowns * sizeof *e->z);
        last = rest;
        const dm_status status = improve(e);
        s->report.newton++, s->report.matrices++, s->report.iterations = k + 1;
        if (status != DM_OK) return status;
        if (!(e->z[e->velocities] > 0.0)) return DM_NO_CONVERGENCE;
    }
    return DM_NO_CONVERGENCE;
}

void dm_sem_begin(dm_sem *e, const double *state) {
    e->state = state;
    e->begun_at = 0;
}

/* V_j = v0, which is found when it is asked for first */
dm_status dm_sem_guess(dm_sem *e, double h) {
    if (!e->begun_at) {
        memset(e->v0, 0, e->n * sizeof *e->v0);
        const dm_status status =
            dm_legendre_inverse(e->m, e->v0, e->state, e->state + e->n, 0.0, e->scratch);
        if (status != DM_OK) return status;
    }
    e->begun_at = 1;
    for (uint32_t j = 0; j < e->table.s; j++)
        memcpy(e->z + j * (size_t)e->n, e->v0, e->n * sizeof *e->z);
    e->z[e->velocities] = h;
    return DM_OK;
}

/* ---- a given length ---- */

/* For dm_newton: V alone, h being the one behind it in e->z. */
static dm_status momentum_equation(void *ctx, double *R, double *J, const double *V) {
    dm_sem *e = ctx;
    memcpy(e->kept, V, e->velocities * sizeof *V);
    e->kept[e->velocities] = e->z[e->velocities];
    dm_sem_equation(e, R, J, e->kept, e->velocities);
    return DM_OK;
}

/* From V = v0 by the damped method; once more at the root, so that all is what belongs to it. */
dm_status dm_sem_fixed(dm_sem *e, dm_stepper *s, double h) {
    const dm_newton_problem problem = {.m = e->velocities,
                                       .equation = momentum_equation,
                                       .ctx = e,
                                       .size = &e->size,
                                       .tolerance = s->tolerance,
                                       .max_iterations = s->max_iterations};
    dm_newton_report report;
    dm_status status = dm_sem_guess(e, h);
    if (status != DM_OK) return status;
    if (e->sweeps.bend.eval && dm_sem_fixed_swept(e, s)) return DM_OK;
    status = dm_sem_prepare(e);
    if (status != DM_OK) return status;
    status = dm_newton(e->z, &problem, e->scratch, &report);
    s->report.newton += report.iterations, s->report.iterations = report.iterations;
    s->report.matrices += report.jacobians;
    if (status != DM_OK) return status;
    dm_sem_equation(e, e->R, NULL, e->z, e->velocities);
    return isfinite(e->energy) ? DM_OK : DM_NOT_FINITE;
}

/* ---- the length, too ---- */

/* Is h = z[s n] what was asked for? */
static int is_within(const dm_sem *e, double low, double high) {
    const double h = e->z[e->velocities];
    return h >= low && h <= high;
}

/* The steps before tell of both. Without them curves of degree 1 are found with h; of others E_d is
 * so flat in h that V must be right before h is moved. */
dm_status dm_sem_solve(dm_sem *e, dm_stepper *s, double h, double low, double high, int goes_on) {
    dm_status status = dm_sem_prepare(e);
    if (status != DM_OK) return status;
    if (goes_on) {
        memcpy(e->z, e->warm + DM_SEM_NEXT, e->unknowns * sizeof *e->z);
        if (iterate(e, s) == DM_OK && is_within(e, low, high)) return DM_OK;
    }
    status = dm_sem_guess(e, h);
    if (status != DM_OK) return status;
    if (e->table.s == 1 && iterate(e, s) == DM_OK && is_within(e, low, high)) return DM_OK;
    status = dm_sem_fixed(e, s, h);
    if (status == DM_OK) status = iterate(e, s);
    if (status != DM_OK) return status;
    return is_within(e, low, high) ? DM_OK : DM_NO_CONVERGENCE;
}

/* dh/dE is the last entry of J^-1 */
double dm_sem_conditioning(dm_sem *e) {
    if (e->factored) {
        memset(e->dz, 0, e->unknowns * sizeof *e->dz);
        e->dz[e->velocities] = 1.0;
        dm_lu_solve(e->dz, e->LU, e->pivot, e->unknowns);
        e->slope = e->dz[e->velocities];
    }
    return 0.5 * DBL_EPSILON * e->size_of * fabs(e->slope);
}

/* ---- where Newton's method for both fails ---- */

/* E_d - E of the step h, NaN where there is none */
static double excess(dm_sem *e, dm_stepper *s, double h) {
    return dm_sem_fixed(e, s, h) == DM_OK ? e->energy - e->E : NAN;
}

/* an interval, and E_d - E at its ends */
typedef struct {
    double a, fa, b, fb;
} bracket;

/* bisection, and in between the chord (Illinois): to the last bit of h, or to round-off of E_d */
static dm_status find_root(dm_sem *e, dm_stepper *s, bracket k) {
    for (int tries = 0; tries < TRIES; tries++) {
        const double chord = k.b - k.fb * (k.b - k.a) / (k.fb - k.fa), middle = 0.5 * (k.a + k.b);
        const int inside = chord > fmin(k.a, k.b) && chord < fmax(k.a, k.b);
        const double h = tries % 3 == 2 || !inside ? middle : chord, f = excess(e, s, h);
        if (isnan(f)) return DM_NO_CONVERGENCE;
        if (fabs(f) <= ROUND * e->size_of || h == k.a || h == k.b) return DM_OK;
        if ((f < 0.0) != (k.fb < 0.0))
            k.a = k.b, k.fa = k.fb;
        else
            k.fa *= 0.5;
        k.b = h, k.fb = f;
    }
    return DM_OK;
}

/* by golden sections, where |E_d - E| has no zero; a sign that changes shows that it has one */
static dm_status find_least(dm_sem *e, dm_stepper *s, double a, double b, double sign,
                            int *flagged) {
    static const double golden = 0.38196601125010515, close = 1e-9;
    double x = a + golden * (b - a), y = b - golden * (b - a);
    double fx = sign * excess(e, s, x), fy = sign * excess(e, s, y);
    for (int tries = 0; tries < TRIES && b - a > close * b; tries++) {
        if (fx < 0.0 || fy < 0.0) break;
        if (fx <= fy || isnan(fy))
            b = y, y = x, fy = fx, x = a + golden * (b - a), fx = sign * excess(e, s, x);
        else
            a = x, x = y, fx = fy, y = b - golden * (b - a), fy = sign * excess(e, s, y);
    }
    *flagged = !(fx < 0.0 || fy < 0.0);
    if (*flagged) return DM_OK;
    const double h = fx < 0.0 ? x : y, fa = excess(e, s, a);
    return isnan(fa) ? DM_NO_CONVERGENCE
                     : find_root(e, s, (bracket){a, fa, h, fx < 0.0 ? sign * fx : sign * fy});
}

/* E_d - E at SCAN lengths from low to high; where it is least, -1 where no step can be made */
static int scan(dm_sem *e, dm_stepper *s, double low, double high, double *h, double *f) {
    int least = -1;
    for (int k = 0; k < SCAN; k++) {
        h[k] = k == SCAN - 1 ? high : low + (high - low) * k / (SCAN - 1);
        f[k] = excess(e, s, h[k]);
        if (!isnan(f[k]) && (least < 0 || fabs(f[k]) < fabs(f[least]))) least = k;
    }
    return least;
}

/* the change of sign next to h; SCAN: there is none */
static int find_change(const double *at, const double *f, double h) {
    int best = SCAN;
    for (int k = 0; k + 1 < SCAN; k++) {
        const int changes = f[k] * f[k + 1] <= 0.0; /* NaN is none */
        if (changes && (best == SCAN || fabs(at[k] - h) < fabs(at[best] - h))) best = k;
    }
    return best;
}

/* A root that Newton's method did not find makes the step a usual one. */
dm_status dm_sem_fallback(dm_sem *e, dm_stepper *s, double h, double low, double high,
                          int *flagged) {
    double at[SCAN], f[SCAN];
    const int least = scan(e, s, low, high, at, f);
    if (least < 0) return DM_NO_CONVERGENCE;
    const int k = find_change(at, f, h);
    *flagged = 0;
    if (k + 1 < SCAN) return find_root(e, s, (bracket){at[k], f[k], at[k + 1], f[k + 1]});
    const double a = at[least ? least - 1 : 0], b = at[least < SCAN - 1 ? least + 1 : least];
    dm_status status = find_least(e, s, a, b, f[least] < 0.0 ? -1.0 : 1.0, flagged);
    if (status != DM_OK || !*flagged) return status;
    /* the minimum of the sections is the one of the scan or better; an end is taken itself */
    const double found = e->energy - e->E;
    if (!(fabs(found) < fabs(f[least])) || least == 0 || least == SCAN - 1)
        status = dm_sem_fixed(e, s, at[least]);
    return status;
}
