/* del_step.c - the equations of a step of a discrete Lagrangian, where Newton's method begins and
 * how it goes, and what the step arrives at. */
#include "integ/rules/del.h"

#include "linalg/lu.h"
#include "numbers/compensated.h"

#include <string.h>

/* ---- the equations ---- */

/* g, G at q */
void dm_del_constrain_at(dm_del *e, double *out, const double *q) {
    if (!e->k) return;
    memcpy(e->constraint_x, q, e->n * sizeof *q);
    dm_kernel_eval(&e->m->constraints->holonomic_kernel, e->constraint_x, out);
}

/* what is seen at both ends: phi, E^T mu with its derivatives, F1 and F2 */
static void evaluate_pair(dm_del *e, const double *z) {
    const dm_constraints *c = e->m->constraints;
    if (!(c->rolling || c->forced)) return;
    memcpy(e->constraint_x, e->x, 2 * (size_t)e->n * sizeof *e->x);
    if (c->forced) dm_kernel_eval(&c->force_curve, e->constraint_x, e->push);
    if (!e->l) return;
    double *mu = e->constraint_x + 2 * (size_t)e->n + 1 + e->k;
    dm_kernel_eval(&c->rolling_kernel, e->constraint_x, e->roll);
    for (uint32_t i = 0; i < e->l; i++) mu[i] = e->pull[e->k + i] * z[e->n + e->k + i];
    dm_kernel_eval(&c->reaction, e->constraint_x, e->turn);
}

/* (q0, q0 + z) */
static inline void place_pair(dm_del *e, const double *z) {
    const uint32_t n = e->n;
    const double *low = e->state + 2 * n;
    for (uint32_t i = 0; i < n; i++) {
        e->x[i] = e->state[i];
        e->x[n + i] = e->state[i] + (low[i] + z[i]);
    }
}

/* What stands beside Ld, with g and G of the end. */
static inline void evaluate_beside(dm_del *e, const double *z) {
    if (!e->m->constraints) return;
    dm_del_constrain_at(e, e->there, e->x + e->n);
    evaluate_pair(e, z);
}

/* D1, D2, D1D2 at (q0, q0 + z), and that. */
static inline void evaluate(dm_del *e, const double *z) {
    place_pair(e, z);
    dm_kernel_eval(&e->m->pair, e->x, e->out);
    evaluate_beside(e, z);
    e->evaluations++;
}

/* r += F1 + G^T lambda + E^T mu */
static void add_impulse(const dm_del *e, double *r, const double *z) {
    const double *G = e->here + e->k, *E = e->roll + e->l;
    for (uint32_t i = 0; i < e->n && dm_del_is_forced(e->m); i++) r[i] += e->push[i];
    for (uint32_t c = 0; c < e->k; c++)
        for (uint32_t i = 0; i < e->n; i++)
            r[i] += G[c * (size_t)e->n + i] * (e->pull[c] * z[e->n + c]);
    for (uint32_t c = 0; c < e->l; c++)
        for (uint32_t i = 0; i < e->n; i++)
            r[i] += E[c * (size_t)e->n + i] * (e->pull[e->k + c] * z[e->n + e->k + c]);
}

/* rounding q moves g by about G q, which is no error of the step */
static void constrain(dm_del *e, double *r, const double *z) {
    const uint32_t all = e->k + e->l;
    for (uint32_t c = 0; c < all; c++) {
        r[e->n + c] = (c < e->k ? e->there[c] : e->roll[c - e->k]) * e->unit[c];
        e->size = fmax(e->size, e->stiffness * fabs(z[e->n + c]));
    }
    for (uint32_t i = 0; i < e->n && all; i++)
        e->size = fmax(e->size, e->stiffness * fabs(e->state[i]));
}

/* J += of the first n rows: matrix[n][n] */
static void add_block(const dm_del *e, double *J, const double *matrix) {
    const size_t n = e->n;
    for (size_t i = 0; i < n; i++)
        for (size_t j = 0; j < n; j++) J[i * e->N + j] += matrix[i * n + j];
}

/* [D1D2 + dF1/dq1 + d(E^T mu)/dq1, G(q0)^T, E^T; G(q1), 0, 0; dphi/dq1, 0, 0] in its units */
static void lay_matrix(const dm_del *e, double *J) {
    const size_t n = e->n, N = e->N;
    if (!e->m->constraints) {
        memcpy(J, e->out + 2 * n, n * n * sizeof *J);
        return;
    }
    memset(J, 0, N * N * sizeof *J);
    for (size_t i = 0; i < n; i++) memcpy(J + i * N, e->out + 2 * n + i * n, n * sizeof *J);
    if (dm_del_is_forced(e->m)) add_block(e, J, e->push + 2 * n + 2 * n * n);
    if (e->l) add_block(e, J, e->turn + n + n * n);
    for (uint32_t c = 0; c < e->k + e->l; c++) {
        const double *pull = dm_del_pull_row(e, c), *slope = dm_del_slope_row(e, c);
        for (size_t i = 0; i < n; i++) {
            J[i * N + n + c] = e->pull[c] * pull[i];
            J[(n + c) * N + i] = e->unit[c] * slope[i];
        }
    }
}

/* r += D1D2 (z - (x1 - x0)): the kernel sees positions that are rounded, and Newton's method would
 * stop up to half a unit of the last place of q1 from the root, always on the side that it comes
 * from: momentum maps drifted by that times p a step. The difference q1 - q0 is z exactly, and
 * D11 + D1D2, the rest, is of the order of h. */
static inline void add_rounded(const dm_del *e, double *r, const double *z) {
    const size_t n = e->n;
    const double *D12 = e->out + 2 * n;
    for (size_t j = 0; j < n; j++) {
        const double rest = z[j] - (e->x[n + j] - e->x[j]);
        if (rest == 0.0) continue;
        for (size_t i = 0; i < n; i++) r[i] += D12[i * n + j] * rest;
    }
}

static dm_status equation(void *ctx, double *r, double *J, const double *z) {
    dm_del *e = ctx;
    const uint32_t n = e->n;
    const double *p0 = e->state + n, *low = e->state + 3 * n;
    evaluate(e, z);
    const double ours = dm_largest_of(p0, n), theirs = dm_largest_of(e->out, n);
    e->size = ours > theirs ? ours : theirs;
    for (uint32_t i = 0; i < n; i++) r[i] = (p0[i] + e->out[i]) + low[i];
    add_rounded(e, r, z);
    if (e->m->constraints) {
        add_impulse(e, r, z);
        constrain(e, r, z);
    }
    if (J) lay_matrix(e, J);
    return DM_OK;
}

/* D1 Ld + D2 Ld into e->sum, and what acts between both ends, at the end of a step */
static void evaluate_end(dm_del *e) {
    const dm_kernel *sum = &e->m->pair_sum;
    if (!sum->eval) {
        evaluate(e, e->z);
        for (uint32_t i = 0; i < e->n; i++) e->sum[i] = e->out[i] + e->out[e->n + i];
        return;
    }
    place_pair(e, e->z);
    /* constants, to which impulses were added; no roots of before */
    if (e->m->constraints || sum->memory_size) dm_kernel_prepare(sum, e->sum);
    dm_kernel_eval(sum, e->x, e->sum);
    evaluate_beside(e, e->z);
    e->evaluations++;
}

/* next = state + d of a quarter of the state, whose low parts stand two quarters on; NaN where
 * that is not finite */
static inline double add_up(double *next, const double *state, const double *d, uint32_t n) {
    double bad = 0.0;
    for (uint32_t i = 0; i < n; i++) {
        double high = state[i], low = state[2 * (size_t)n + i];
        dm_sum_add(&high, &low, d[i]);
        next[i] = high, next[2 * (size_t)n + i] = low;
        bad += 0.0 * low;
    }
    return bad;
}

/* q1 = q0 + z; p1 = D2 Ld + F2, written p0 + (D1 + F1 + G^T lambda + E^T mu + D2 + F2): velocity
 * terms cancel before they are rounded, in a kernel of its own */
dm_status dm_del_finish(dm_del *e) {
    const uint32_t n = e->n;
    evaluate_end(e);
    if (e->m->constraints) add_impulse(e, e->sum, e->z);
    for (uint32_t i = 0; i < n && dm_del_is_forced(e->m); i++) e->sum[i] += e->push[n + i];
    const double bad = add_up(e->next, e->state, e->z, n);
    return bad + add_up(e->next + n, e->state + n, e->sum, n) == 0.0 ? DM_OK : DM_NOT_FINITE;
}

/* ---- their root ---- */

/* z by the cubic, the parabola, the line or the value of the last steps; 0: there are none */
static int continued(dm_del *e) {
    static const double weight[DM_DEL_KEPT][DM_DEL_KEPT] = {{1},
                                                            {2, -1},
                                                            {3, -3, 1},
                                                            {4, -6, 4, -1}};
    const uint32_t n = e->n, N = e->N;
    const double *end = e->memory + DM_DEL_END, *last = end + 4 * (size_t)n;
    const double count = e->memory[DM_DEL_COUNT]; /* 0, or anything in a file that was written to */
    if (!(count >= 1.0 && count <= DM_DEL_KEPT) || memcmp(end, e->state, 4 * n * sizeof *end) != 0)
        return 0;
    const double *w = weight[(int)count - 1];
    for (uint32_t i = 0; i < N; i++)
        e->z[i] = (w[0] * last[i] + w[1] * last[N + i]) +
                  (w[2] * last[2 * N + i] + w[3] * last[3 * N + i]);
    return 1;
}

/* The newest z first; the count begins again where the step did not follow another. */
void dm_del_keep(dm_del *e, int follows) {
    const uint32_t n = e->n, N = e->N;
    double *end = e->memory + DM_DEL_END, *last = end + 4 * (size_t)n;
    const double count = follows ? e->memory[DM_DEL_COUNT] + 1.0 : 1.0;
    e->memory[DM_DEL_COUNT] = fmin(count, DM_DEL_KEPT);
    for (uint32_t i = 0; i < N; i++, last++) {
        last[3 * N] = last[2 * N], last[2 * N] = last[N], last[N] = last[0];
        last[0] = e->z[i];
    }
    dm_del_copy_state(end, e->next, n);
    dm_del_leave_roots(e);
}

/* is an increment that does not shrink what rounding leaves? */
static int is_noise(const dm_del *e, double step, double size, double residual) {
    static const double ROUND_OFF = 1e-12, NOISE = 1e-13;
    return step <= ROUND_OFF * size || residual <= NOISE * e->size;
}

/* units of constraints from the matrix at the guess z */
static void find_units(dm_del *e) {
    const size_t n = e->n;
    if (e->k + e->l == 0) return;
    for (uint32_t c = 0; c < e->k + e->l; c++) e->pull[c] = 0.0; /* multipliers are not known yet */
    evaluate(e, e->z);
    e->stiffness = dm_del_norm(e->out + 2 * n, (uint32_t)(n * n));
    if (!isfinite(e->stiffness) || e->stiffness == 0.0) e->stiffness = 1.0;
    for (uint32_t c = 0; c < e->k + e->l; c++) {
        const double pull = dm_del_norm(dm_del_pull_row(e, c), (uint32_t)n);
        const double slope = c < e->k ? pull : dm_del_norm(dm_del_slope_row(e, c), (uint32_t)n);
        e->pull[c] = pull > 0.0 ? e->stiffness / pull : 1.0;
        e->unit[c] = slope > 0.0 ? e->stiffness / slope : 1.0;
    }
}

/* z are displacements, and multipliers behind them. */
static dm_newton_problem problem_of(dm_del *e, const dm_stepper *s) {
    return (dm_newton_problem){.m = e->N,
                               .equation = equation,
                               .ctx = e,
                               .size = &e->size,
                               .place = e->state,
                               .places = e->n,
                               .shared = e->N - e->n,
                               .over = 1.0,
                               .tolerance = s->tolerance,
                               .max_iterations = s->max_iterations};
}

static int have_small_settled(dm_del *e, const dm_stepper *s, dm_newton_wait *wait,
                              const double *r) {
    const dm_newton_problem problem = problem_of(e, s);
    return dm_newton_small_settled(wait, &problem, e->z, r);
}

/* Newton's method from the continued z with the exact matrix at every iterate, which the kernel
 * gives anyway. Errors are squared: the last increment need not be small, but the next one,
 * foretold by the last two. 0: it does not go that well. */
static int solve_near(dm_del *e, const dm_stepper *s, dm_newton_report *report) {
    enum { MOST = 6 };
    static const double FAST = 0.1, NEGLIGIBLE = 1e-17;
    const uint32_t n = e->N;
    dm_newton_wait wait = {0};
    double *r = e->scratch, *J = r + n, before = INFINITY;
    uint32_t *pivot = (uint32_t *)(void *)(J + n * (size_t)n);
    find_units(e);
    for (int k = 0; k < MOST; k++) {
        if (equation(e, r, J, e->z) != DM_OK) return 0;
        report->jacobians++;
        report->residual = dm_del_norm(r, n);
        if (!isfinite(report->residual) || dm_lu_factor(J, pivot, n) != DM_OK) return 0;
        dm_lu_solve(r, J, pivot, n);
        const double step = dm_del_norm(r, n), size = dm_del_norm(e->z, n) + step;
        const double rate = before < INFINITY ? step / before : 1.0;
        const int noise = is_noise(e, step, size, report->residual);
        if (!(step <= FAST * before || noise)) return 0;
        const int all = step <= s->tolerance * size || rate * rate * step <= NEGLIGIBLE * size ||
                        (rate > 0.5 && noise);
        const int done = all && (!dm_newton_has_small(e->z, r, e->n, size) ||
                                 have_small_settled(e, s, &wait, r));
        for (uint32_t i = 0; i < n; i++) e->z[i] -= r[i];
        report->iterations++;
        if (done) dm_del_note(e, J, pivot);
        if (done) return 1;
        before = step;
    }
    return 0;
}

/* What Newton's method does not tell. */
static void find_determinant(dm_del *e) {
    double *r = e->scratch, *J = r + e->N;
    uint32_t *pivot = (uint32_t *)(void *)(J + e->N * (size_t)e->N);
    e->sign = 0.0;
    if (equation(e, r, J, e->z) == DM_OK && dm_lu_factor(J, pivot, e->N) == DM_OK)
        dm_del_note(e, J, pivot);
}

/* from z = h v for a v[n], or from z = 0 */
static dm_status solve_from(dm_del *e, const dm_stepper *s, const double *v, double h,
                            dm_newton_report *report) {
    const dm_newton_problem problem = problem_of(e, s);
    memset(e->z, 0, e->N * sizeof *e->z);
    for (uint32_t i = 0; v && i < e->n; i++) e->z[i] = h * v[i];
    find_units(e);
    return dm_newton(e->z, &problem, e->scratch, report);
}

/* What is left of the equations at z, beside p0, without add_rounded: near a kink of Ld, or where
 * Ld(q, q) has no value but for rounding (0/0), terms and D1D2 are so large that a z which no place
 * shows solves them by that alone, and is no root. Multipliers have units of their own. */
static double imbalance(dm_del *e) {
    const uint32_t n = e->n;
    const double *p0 = e->state + n;
    double *r = e->scratch;
    if (e->N > n) return 0.0;
    evaluate(e, e->z);
    for (uint32_t i = 0; i < n; i++) r[i] = p0[i] + e->out[i];
    if (e->m->constraints) add_impulse(e, r, e->z);
    return dm_del_norm(r, n) / dm_del_norm(p0, n);
}

/* From z = 0, where one iteration finds h M^-1 p0 whatever the masses; where that fails, as where
 * Ld(q, q) is not defined or has a kink, from z = h p0; where it is not defined from -h p0, too,
 * since v may point against p, as that of v log v. Where both do, the failure of the one that stays
 * where Ld is defined is told. A start at rest, which all that rounding leaves is large beside, has
 * the same root by both. */
static dm_status solve_far(dm_del *e, const dm_stepper *s, double h, dm_newton_report *report) {
    static const double LEFT = 1e-6, NO_ROOT = 1.0;
    const double *p = e->state + e->n;
    const dm_status first = solve_from(e, s, NULL, h, report);
    const double left = first == DM_OK ? imbalance(e) : 0.0;
    if (first == DM_OK && left <= LEFT) return first;
    dm_status status = solve_from(e, s, p, h, report);
    if (status != DM_OK && first == DM_NOT_FINITE && solve_from(e, s, p, -h, report) == DM_OK)
        status = DM_OK;
    if (status == DM_OK) return status;
    if (first == DM_OK && left <= NO_ROOT) return solve_from(e, s, NULL, h, report);
    return first == DM_OK || first == DM_NOT_FINITE || first == DM_SINGULAR ? status : first;
}

/* Near the z that steps before foretell, or a root that may be far from it: where that one is on
 * another branch, as the determinant tells, the one from z = 0, if there is one. */
dm_status dm_del_solve(dm_del *e, const dm_stepper *s, double h, dm_newton_report *report,
                       int *follows) {
    *follows = continued(e);
    const int near = *follows && solve_near(e, s, report);
    if (near && !dm_del_has_turned(e)) return DM_OK;
    const dm_status status = solve_far(e, s, h, report);
    if (status == DM_OK) find_determinant(e);
    if (status == DM_OK || !near) return status;
    continued(e);
    return solve_near(e, s, report) ? DM_OK : status;
}
