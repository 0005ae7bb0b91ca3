/* del.c - the discrete Euler-Lagrange equations of a user's Ld(q0, q1), position-momentum form,
 * with holonomic constraints, rolling constraints on pairs and discrete forces. Long because it is
 * one step equation, from its workspace to its Newton method. */
#include "base/largest.h"
#include "integ/method/method.h"
#include "linalg/lu.h"
#include "linalg/solve/newton.h"
#include "mech/constraints.h"
#include "numbers/compensated.h"

#include <math.h>
#include <string.h>

/* p0 + D1 Ld(q0, q0 + z) = 0 for z[n]; out = D1[n], D2[n], D1D2[n*n]. What a step leaves to the
 * next one: how many steps there are, the state at the end of the last [4n], the last four z,
 * the last first, and what the kernel remembers of its implicit functions; the cubic through the
 * z is where Newton's method begins. With constraints g: p0 + D1 Ld + G(q0)^T lambda = 0, g(q0 +
 * z) = 0 for (z, lambda), and p1 = D2 Ld is left as it is: what it has across the constraint is
 * taken up by the next lambda (Marsden-West 2001 sec. 3.5, Leok 2.8.1). Rolling constraints
 * phi(q0, q1) = 0 react along the rows of E: E^T mu stands beside G^T lambda, phi beside g
 * (Cuell-Patrick 2009, 3). Discrete forces F1, F2 are added to D1 Ld and D2 Ld (Leok 2.8.2).
 *
 * Rows of G and phi are one list here. Row c is in units of momentum by unit_c, the largest entry
 * of D1D2 over that of row c of the derivative in q1; its multiplier is in units of z by unit_c
 * too, with G(q0) or E in place of that derivative (pull_c). */
enum { COUNT, END, KEPT = 4 };

typedef struct {
    const dm_model *m;
    const double *state;
    uint32_t n, k, l, N; /* dim Q, holonomic and rolling constraints, unknowns */
    double *x, *out, *sum, *z, *next, *memory, *roots, *scratch;
    /* (q, v, t, lambda, mu); g, G, g_t at q0 and at q1; [k + l] each */
    double *constraint_x, *here, *there, *unit, *pull;
    double *roll;     /* phi[l], E[l*n], dphi/dq1[l*n], dphi/dq0[l*n] */
    double *turn;     /* E^T mu, its derivatives in q0 and in q1: [n + 2 n*n] */
    double *push;     /* F1, F2, their derivatives in q0 and in q1 */
    double stiffness; /* largest entry of D1D2 */
    double size;
    long evaluations;
} pair;

/* Holonomic ones alone are known. */
static uint32_t constraints(const dm_model *m) {
    return m->constraints ? m->constraints->holonomic : 0;
}

static uint32_t rolling(const dm_model *m) {
    return m->constraints ? m->constraints->rolling : 0;
}

static uint32_t rows(const dm_model *m) {
    return constraints(m) + rolling(m);
}

static int is_forced(const dm_model *m) {
    return m->constraints && m->constraints->forced;
}

/* Derivatives of Ld; g, G, g_t; what a model does not have is not made. */
static unsigned wants(const dm_rule *rule, const dm_model *m) {
    (void)rule;
    if (!m->constraints) return DM_WANT_PAIR;
    return DM_WANT_PAIR | DM_WANT_HOLONOMIC | DM_WANT_ROLLING | DM_WANT_FORCE_CURVE |
           (rolling(m) ? DM_WANT_REACTION : 0);
}

/* g, G, g_t */
static size_t constraint_outputs(const dm_model *m) {
    return constraints(m) * ((size_t)m->n + 2);
}

/* phi, E and derivatives; E^T mu and derivatives; F1, F2 and derivatives */
static size_t roll_outputs(const dm_model *m) {
    return rolling(m) * (1 + 3 * (size_t)m->n);
}

static size_t turn_outputs(const dm_model *m) {
    return rolling(m) ? m->n + 2 * (size_t)m->n * m->n : 0;
}

static size_t push_outputs(const dm_model *m) {
    return is_forced(m) ? 2 * (size_t)m->n * (1 + 2 * (size_t)m->n) : 0;
}

/* with what the kernel remembers */
static size_t memory_size(const dm_model *m) {
    const size_t N = (size_t)m->n + rows(m);
    return END + 4 * (size_t)m->n + KEPT * N + m->pair.memory_size;
}

static size_t work(const dm_rule *rule, const dm_model *m) {
    const size_t n = m->n, r = rows(m);
    (void)rule;
    return 2 * n + (2 * n + n * n) + n + (n + r) + 4 * n + memory_size(m) + 2 * n + 1 + r +
           2 * constraint_outputs(m) + 2 * r + roll_outputs(m) + turn_outputs(m) + push_outputs(m) +
           dm_newton_work((uint32_t)(n + r));
}

/* No struct in the workspace: its places follow from the sizes. */
static pair lay_out(const dm_stepper *s) {
    const size_t n = s->model->n, outputs = constraint_outputs(s->model);
    pair e = {.m = s->model, .x = s->work, .n = s->model->n};
    e.k = constraints(s->model);
    e.l = rolling(s->model);
    e.N = e.n + e.k + e.l;
    e.out = e.x + 2 * n;
    e.sum = e.out + 2 * n + n * n;
    e.z = e.sum + n;
    e.next = e.z + e.N;
    e.memory = e.next + 4 * n;
    e.roots = e.memory + END + 4 * n + KEPT * (size_t)e.N;
    e.constraint_x = e.memory + memory_size(s->model);
    e.here = e.constraint_x + 2 * n + 1 + e.k + e.l;
    e.there = e.here + outputs;
    e.unit = e.there + outputs;
    e.pull = e.unit + e.k + e.l;
    e.roll = e.pull + e.k + e.l;
    e.turn = e.roll + roll_outputs(s->model);
    e.push = e.turn + turn_outputs(s->model);
    e.scratch = e.push + push_outputs(s->model);
    return e;
}

/* what the kernel remembers is that of the last step, whatever it was asked for since */
static void take_roots(const pair *e) {
    const dm_kernel *k = &e->m->pair;
    if (k->memory) memcpy(k->memory, e->roots, k->memory_size * sizeof *k->memory);
}

static void leave_roots(const pair *e) {
    const dm_kernel *k = &e->m->pair;
    if (k->memory) memcpy(e->roots, k->memory, k->memory_size * sizeof *k->memory);
}

/* Memory begins empty, and roots of implicit functions at those that the kernel has. */
static dm_status open(dm_stepper *s) {
    const pair e = lay_out(s);
    const dm_constraints *c = s->model->constraints;
    dm_kernel_prepare(&s->model->pair, e.out);
    memset(e.constraint_x, 0, (2 * (size_t)e.n + 1 + e.k + e.l) * sizeof *e.constraint_x);
    if (e.k) dm_kernel_prepare(&c->holonomic_kernel, e.here);
    if (e.k) dm_kernel_prepare(&c->holonomic_kernel, e.there);
    if (e.l) dm_kernel_prepare(&c->rolling_kernel, e.roll);
    if (e.l) dm_kernel_prepare(&c->reaction, e.turn);
    if (c && c->forced) dm_kernel_prepare(&c->force_curve, e.push);
    memset(e.memory, 0, memory_size(s->model) * sizeof *e.memory);
    dm_kernel_remember(&s->model->pair, 1);
    leave_roots(&e);
    return DM_OK;
}

/* a step that is known to lead to q1 begins there, as one that continues others */
static void begin_toward(const dm_stepper *s, const double *state) {
    const uint32_t n = s->model->n;
    double *memory = lay_out(s).memory, *end = memory + END, *last = end + 4 * (size_t)n;
    memory[COUNT] = 1.0;
    memcpy(end, state, 4 * (size_t)n * sizeof *end);
    for (uint32_t i = 0; i < n; i++) last[i] = s->toward[i] - state[i];
}

/* As if it were opened now; steps have the length that is in Ld. */
static dm_status start(dm_stepper *s, double *state, double t, double h) {
    const dm_status status = open(s);
    (void)t, (void)h;
    if (status == DM_OK && s->toward) begin_toward(s, state);
    return status;
}

/* The last steps, then the roots. */
static size_t memory(dm_stepper *s, double **place) {
    *place = lay_out(s).memory;
    return memory_size(s->model);
}

/* g, G at q */
static void evaluate_constraints(pair *e, double *out, const double *q) {
    if (!e->k) return;
    memcpy(e->constraint_x, q, e->n * sizeof *q);
    dm_kernel_eval(&e->m->constraints->holonomic_kernel, e->constraint_x, out);
}

/* what is seen at both ends: phi, E^T mu with its derivatives, F1 and F2 */
static void evaluate_pair(pair *e, const double *z) {
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
static void place_pair(pair *e, const double *z) {
    const uint32_t n = e->n;
    const double *low = e->state + 2 * n;
    for (uint32_t i = 0; i < n; i++) {
        e->x[i] = e->state[i];
        e->x[n + i] = e->state[i] + (low[i] + z[i]);
    }
}

/* What stands beside Ld, with g and G of the end. */
static inline void evaluate_beside(pair *e, const double *z) {
    if (!e->m->constraints) return;
    evaluate_constraints(e, e->there, e->x + e->n);
    evaluate_pair(e, z);
}

/* D1, D2, D1D2 at (q0, q0 + z), and that. */
static void evaluate(pair *e, const double *z) {
    place_pair(e, z);
    dm_kernel_eval(&e->m->pair, e->x, e->out);
    evaluate_beside(e, z);
    e->evaluations++;
}

/* r += F1 + G^T lambda + E^T mu */
static void add_impulse(const pair *e, double *r, const double *z) {
    const double *G = e->here + e->k, *E = e->roll + e->l;
    for (uint32_t i = 0; i < e->n && is_forced(e->m); i++) r[i] += e->push[i];
    for (uint32_t c = 0; c < e->k; c++)
        for (uint32_t i = 0; i < e->n; i++)
            r[i] += G[c * (size_t)e->n + i] * (e->pull[c] * z[e->n + c]);
    for (uint32_t c = 0; c < e->l; c++)
        for (uint32_t i = 0; i < e->n; i++)
            r[i] += E[c * (size_t)e->n + i] * (e->pull[e->k + c] * z[e->n + e->k + c]);
}

/* row c of the derivative in q1 of g and phi, and of what their multipliers pull along */
static const double *slope_row(const pair *e, uint32_t c) {
    const size_t n = e->n;
    return c < e->k ? e->there + e->k + c * n : e->roll + e->l + (e->l + c - e->k) * n;
}

static const double *pull_row(const pair *e, uint32_t c) {
    const size_t n = e->n;
    return c < e->k ? e->here + e->k + c * n : e->roll + e->l + (c - e->k) * n;
}

/* rounding q moves g by about G q, which is no error of the step */
static void constrain(pair *e, double *r, const double *z) {
    const uint32_t all = e->k + e->l;
    for (uint32_t c = 0; c < all; c++) {
        r[e->n + c] = (c < e->k ? e->there[c] : e->roll[c - e->k]) * e->unit[c];
        e->size = fmax(e->size, e->stiffness * fabs(z[e->n + c]));
    }
    for (uint32_t i = 0; i < e->n && all; i++)
        e->size = fmax(e->size, e->stiffness * fabs(e->state[i]));
}

/* J += of the first n rows: matrix[n][n] */
static void add_block(const pair *e, double *J, const double *matrix) {
    const size_t n = e->n;
    for (size_t i = 0; i < n; i++)
        for (size_t j = 0; j < n; j++) J[i * e->N + j] += matrix[i * n + j];
}

/* [D1D2 + dF1/dq1 + d(E^T mu)/dq1, G(q0)^T, E^T; G(q1), 0, 0; dphi/dq1, 0, 0] in its units */
static void lay_matrix(const pair *e, double *J) {
    const size_t n = e->n, N = e->N;
    if (!e->m->constraints) {
        memcpy(J, e->out + 2 * n, n * n * sizeof *J);
        return;
    }
    memset(J, 0, N * N * sizeof *J);
    for (size_t i = 0; i < n; i++) memcpy(J + i * N, e->out + 2 * n + i * n, n * sizeof *J);
    if (is_forced(e->m)) add_block(e, J, e->push + 2 * n + 2 * n * n);
    if (e->l) add_block(e, J, e->turn + n + n * n);
    for (uint32_t c = 0; c < e->k + e->l; c++) {
        const double *pull = pull_row(e, c), *slope = slope_row(e, c);
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
static void add_rounded(const pair *e, double *r, const double *z) {
    const size_t n = e->n;
    const double *D12 = e->out + 2 * n;
    for (size_t j = 0; j < n; j++) {
        const double rest = z[j] - (e->x[n + j] - e->x[j]);
        for (size_t i = 0; i < n && rest != 0.0; i++) r[i] += D12[i * n + j] * rest;
    }
}

static dm_status equation(void *ctx, double *r, double *J, const double *z) {
    pair *e = ctx;
    const uint32_t n = e->n;
    const double *p0 = e->state + n, *low = e->state + 3 * n;
    evaluate(e, z);
    e->size = 0.0;
    for (uint32_t i = 0; i < n; i++) {
        r[i] = (p0[i] + e->out[i]) + low[i];
        e->size = fmax(e->size, fmax(fabs(p0[i]), fabs(e->out[i])));
    }
    add_rounded(e, r, z);
    if (e->m->constraints) {
        add_impulse(e, r, z);
        constrain(e, r, z);
    }
    if (J) lay_matrix(e, J);
    return DM_OK;
}

/* D1 Ld + D2 Ld into e->sum, and what acts between both ends, at the end of a step */
static void evaluate_end(pair *e) {
    const dm_kernel *sum = &e->m->pair_sum;
    if (!sum->eval) {
        evaluate(e, e->z);
        for (uint32_t i = 0; i < e->n; i++) e->sum[i] = e->out[i] + e->out[e->n + i];
        return;
    }
    place_pair(e, e->z);
    dm_kernel_prepare(sum, e->sum); /* constants, to which impulses were added */
    dm_kernel_eval(sum, e->x, e->sum);
    evaluate_beside(e, e->z);
    e->evaluations++;
}

/* q1 = q0 + z; p1 = D2 Ld + F2, written p0 + (D1 + F1 + G^T lambda + E^T mu + D2 + F2): velocity
 * terms cancel before they are rounded, in a kernel of its own */
static dm_status finish(pair *e) {
    const uint32_t n = e->n;
    evaluate_end(e);
    if (e->m->constraints) add_impulse(e, e->sum, e->z);
    for (uint32_t i = 0; i < n && is_forced(e->m); i++) e->sum[i] += e->push[n + i];
    memcpy(e->next, e->state, 4 * (size_t)n * sizeof *e->next);
    dm_sum_add_n(e->next, e->next + 2 * n, e->z, n);
    for (uint32_t i = 0; i < n; i++) dm_sum_add(e->next + n + i, e->next + 3 * n + i, e->sum[i]);
    for (uint32_t i = 0; i < 4 * n; i++)
        if (!isfinite(e->next[i])) return DM_NOT_FINITE;
    return DM_OK;
}

/* z by the cubic, the parabola, the line or the value of the last steps; 0: there are none */
static int continued(pair *e) {
    static const double weight[KEPT][KEPT] = {{1}, {2, -1}, {3, -3, 1}, {4, -6, 4, -1}};
    const uint32_t n = e->n, N = e->N;
    const double *end = e->memory + END, *last = end + 4 * (size_t)n;
    const double count = e->memory[COUNT]; /* 0, or anything in a file that was written to */
    if (!(count >= 1.0 && count <= KEPT) || memcmp(end, e->state, 4 * n * sizeof *end) != 0)
        return 0;
    const double *w = weight[(int)count - 1];
    for (uint32_t i = 0; i < N; i++)
        e->z[i] = (w[0] * last[i] + w[1] * last[N + i]) +
                  (w[2] * last[2 * N + i] + w[3] * last[3 * N + i]);
    return 1;
}

/* The newest z first; the count begins again where the step did not follow another. */
static void keep(pair *e, int follows) {
    const uint32_t n = e->n, N = e->N;
    double *end = e->memory + END, *last = end + 4 * (size_t)n;
    const double count = follows ? e->memory[COUNT] + 1.0 : 1.0;
    e->memory[COUNT] = fmin(count, KEPT);
    memmove(last + N, last, (KEPT - 1) * N * sizeof *last);
    memcpy(last, e->z, N * sizeof *last);
    memcpy(end, e->next, 4 * n * sizeof *end);
    leave_roots(e);
}

/* NaN where there is one. */
static double norm(const double *a, uint32_t n) {
    double largest = 0.0;
    for (uint32_t i = 0; i < n; i++) largest = dm_largest(largest, a[i]);
    return largest;
}

/* is an increment that does not shrink what rounding leaves? */
static int is_noise(const pair *e, double step, double size, double residual) {
    static const double ROUND_OFF = 1e-12, NOISE = 1e-13;
    return step <= ROUND_OFF * size || residual <= NOISE * e->size;
}

/* units of constraints from the matrix at the guess z */
static void find_units(pair *e) {
    const size_t n = e->n;
    if (e->k + e->l == 0) return;
    for (uint32_t c = 0; c < e->k + e->l; c++) e->pull[c] = 0.0; /* multipliers are not known yet */
    evaluate(e, e->z);
    e->stiffness = norm(e->out + 2 * n, (uint32_t)(n * n));
    if (!isfinite(e->stiffness) || e->stiffness == 0.0) e->stiffness = 1.0;
    for (uint32_t c = 0; c < e->k + e->l; c++) {
        const double pull = norm(pull_row(e, c), (uint32_t)n);
        const double slope = c < e->k ? pull : norm(slope_row(e, c), (uint32_t)n);
        e->pull[c] = pull > 0.0 ? e->stiffness / pull : 1.0;
        e->unit[c] = slope > 0.0 ? e->stiffness / slope : 1.0;
    }
}

/* z are displacements, and multipliers behind them. */
static dm_newton_problem problem_of(pair *e, const dm_stepper *s) {
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

/* Newton's method from the continued z with the exact matrix at every iterate, which the kernel
 * gives anyway. Errors are squared: the last increment need not be small, but the next one,
 * foretold by the last two. 0: it does not go that well. */
static int solve_near(pair *e, const dm_stepper *s, dm_newton_report *report) {
    enum { MOST = 6 };
    static const double FAST = 0.1, NEGLIGIBLE = 1e-17;
    const uint32_t n = e->N;
    dm_newton_problem problem = problem_of(e, s);
    dm_newton_wait wait = {0};
    double *r = e->scratch, *J = r + n, before = INFINITY;
    uint32_t *pivot = (uint32_t *)(void *)(J + n * (size_t)n);
    find_units(e);
    for (int k = 0; k < MOST; k++) {
        if (equation(e, r, J, e->z) != DM_OK) return 0;
        report->residual = norm(r, n);
        if (!isfinite(report->residual) || dm_lu_factor(J, pivot, n) != DM_OK) return 0;
        dm_lu_solve(r, J, pivot, n);
        const double step = norm(r, n), size = norm(e->z, n) + step;
        const double rate = before < INFINITY ? step / before : 1.0;
        const int noise = is_noise(e, step, size, report->residual);
        if (!(step <= FAST * before || noise)) return 0;
        const int all = step <= s->tolerance * size || rate * rate * step <= NEGLIGIBLE * size ||
                        (rate > 0.5 && noise);
        const int done = all && (!dm_newton_has_small(e->z, r, e->n, size) ||
                                 dm_newton_small_settled(&wait, &problem, e->z, r));
        for (uint32_t i = 0; i < n; i++) e->z[i] -= r[i];
        report->iterations++;
        if (done) return 1;
        before = step;
    }
    return 0;
}

/* from z = h v for a v[n], or from z = 0 */
static dm_status solve_from(pair *e, const dm_stepper *s, const double *v, double h,
                            dm_newton_report *report) {
    const dm_newton_problem problem = problem_of(e, s);
    memset(e->z, 0, e->N * sizeof *e->z);
    for (uint32_t i = 0; v && i < e->n; i++) e->z[i] = h * v[i];
    find_units(e);
    return dm_newton(e->z, &problem, e->scratch, report);
}

/* Is what is left of the equations small beside p0? Near a kink of Ld their terms are so large that
 * what rounding leaves of them is no root. Multipliers have units of their own. */
static int is_balanced(const pair *e, const dm_newton_report *report) {
    static const double LEFT = 1e-6;
    return e->N > e->n || report->residual <= LEFT * norm(e->state + e->n, e->n);
}

/* From z = 0, where one iteration finds h M^-1 p0 whatever the masses; where that fails, as where
 * Ld(q, q) is not defined or has a kink, from z = h p0. Where both do, the failure of the one that
 * stays where Ld is defined is told. */
static dm_status solve_far(pair *e, const dm_stepper *s, double h, dm_newton_report *report) {
    const double *p = e->state + e->n;
    const dm_status first = solve_from(e, s, NULL, h, report);
    if (first == DM_OK && is_balanced(e, report)) return first;
    const dm_status status = solve_from(e, s, p, h, report);
    if (status != DM_OK && first == DM_OK) return solve_from(e, s, NULL, h, report);
    return status == DM_OK || first == DM_NOT_FINITE || first == DM_SINGULAR ? status : first;
}

/* h is in Ld; it only helps where Ld(q, q) is not defined. */
static dm_status step(dm_stepper *s, double *state, double t, double h) {
    pair e = lay_out(s);
    dm_newton_report report = {0};
    (void)t;
    e.state = state;
    take_roots(&e);
    evaluate_constraints(&e, e.here, state);
    const int follows = continued(&e);
    dm_status status = DM_OK;
    if (!follows || !solve_near(&e, s, &report)) status = solve_far(&e, s, h, &report);
    if (status == DM_OK) status = finish(&e);
    s->report.iterations = report.iterations;
    s->report.residual = report.residual;
    s->report.solves++;
    s->report.newton += report.iterations;
    s->report.evaluations += e.evaluations;
    if (status != DM_OK) return status;
    keep(&e, follows);
    memcpy(state, e.next, 4 * (size_t)e.n * sizeof *state);
    s->report.constraint = fmax(s->report.constraint, norm(e.there, e.k));
    s->report.rolling = fmax(s->report.rolling, norm(e.roll, e.l));
    return DM_OK;
}

/* the discrete equations put all of it at the start of the step */
static void impulses(const dm_stepper *s, double *out) {
    const pair e = lay_out(s);
    const uint32_t all = e.k + e.l;
    for (uint32_t c = 0; c < all; c++) {
        out[c] = e.pull[c] * e.z[e.n + c];
        out[all + c] = 0.0;
    }
}

static const dm_engine engine = {
    .wants = wants,
    .work = work,
    .open = open,
    .start = start,
    .step = step,
    .memory = memory,
    .impulses = impulses,
};

const dm_method dm_method_del = {
    .name = "del",
    .signature = "del",
    .doc =
        "Discrete Euler-Lagrange equations of a discrete Lagrangian: p0 = -D1 Ld(q0, q1), p1 = "
        "D2 Ld(q0, q1); n unknowns a step (Marsden-West 2001 sec. 1.5, Leok 2.2). With a "
        "constraint g: p0 = -D1 Ld - G^T lambda, g(q1) = 0, one more unknown for each; with "
        "rolling "
        "constraints phi(q0, q1) = 0 and the rows E of their reactions: p0 = -D1 Ld - E^T mu; with "
        "discrete forces: p0 = -D1 Ld - F1, p1 = D2 Ld + F2 (Leok 2.8.2; Cuell-Patrick 2009, 3).",
    .orders = "that of Ld: Ld:order()",
    .stages = "-",
    .cost = "n unknowns",
    .instances = "",
    .traits = DM_SYMPLECTIC | DM_FOR_PAIRS | DM_CONSTRAINTS | DM_LOOSE_MOMENTUM,
    .engine = &engine,
};
