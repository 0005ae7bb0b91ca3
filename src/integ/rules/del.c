/* del.c - the discrete Euler-Lagrange equations of a user's Ld(q0, q1), position-momentum form,
 * with holonomic constraints. */
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
 * taken up by the next lambda (Marsden-West 2001 sec. 3.5, Leok 2.8.1). Row c is in units of
 * momentum and lambda_c in those of z by unit_c, the largest entry of D1D2 over that of row c of
 * G. */
enum { COUNT, END, KEPT = 4 };

typedef struct {
    const dm_model *m;
    const double *state;
    uint32_t n, k, N; /* dim Q, constraints, unknowns */
    double *x, *out, *z, *next, *memory, *roots, *scratch;
    double *constraint_x, *here, *there, *unit; /* (q, v, t); g, G, g_t at q0 and at q1; [k] */
    double stiffness;                           /* largest entry of D1D2 */
    double size;
    long evaluations;
} pair;

/* Holonomic ones alone are known. */
static uint32_t constraints(const dm_model *m) {
    return m->constraints ? m->constraints->holonomic : 0;
}

/* Derivatives of Ld, and g, G, g_t. */
static unsigned wants(const dm_rule *rule, const dm_model *m) {
    (void)rule;
    return DM_WANT_PAIR | (constraints(m) ? DM_WANT_HOLONOMIC : 0);
}

/* g, G, g_t */
static size_t constraint_outputs(const dm_model *m) {
    return constraints(m) * ((size_t)m->n + 2);
}

/* with what the kernel remembers */
static size_t memory_size(const dm_model *m) {
    const size_t N = (size_t)m->n + constraints(m);
    return END + 4 * (size_t)m->n + KEPT * N + m->pair.memory_size;
}

static size_t work(const dm_rule *rule, const dm_model *m) {
    const size_t n = m->n, k = constraints(m);
    (void)rule;
    return 2 * n + (2 * n + n * n) + (n + k) + 4 * n + memory_size(m) + 2 * n + 1 +
           2 * constraint_outputs(m) + k + dm_newton_work((uint32_t)(n + k));
}

/* No struct in the workspace: its places follow from the sizes. */
static pair lay_out(const dm_stepper *s) {
    const size_t n = s->model->n, outputs = constraint_outputs(s->model);
    pair e = {.m = s->model, .x = s->work, .n = s->model->n};
    e.k = constraints(s->model);
    e.N = e.n + e.k;
    e.out = e.x + 2 * n;
    e.z = e.out + 2 * n + n * n;
    e.next = e.z + e.N;
    e.memory = e.next + 4 * n;
    e.roots = e.memory + END + 4 * n + KEPT * (size_t)e.N;
    e.constraint_x = e.memory + memory_size(s->model);
    e.here = e.constraint_x + 2 * n + 1;
    e.there = e.here + outputs;
    e.unit = e.there + outputs;
    e.scratch = e.unit + e.k;
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
    dm_kernel_prepare(&s->model->pair, e.out);
    memset(e.constraint_x, 0, (2 * (size_t)e.n + 1) * sizeof *e.constraint_x);
    if (e.k) dm_kernel_prepare(&s->model->constraints->holonomic_kernel, e.here);
    if (e.k) dm_kernel_prepare(&s->model->constraints->holonomic_kernel, e.there);
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

/* D1, D2, D1D2 at (q0, q0 + z), with g and G of the end. */
static void evaluate(pair *e, const double *z) {
    const uint32_t n = e->n;
    const double *low = e->state + 2 * n;
    for (uint32_t i = 0; i < n; i++) {
        e->x[i] = e->state[i];
        e->x[n + i] = e->state[i] + (low[i] + z[i]);
    }
    dm_kernel_eval(&e->m->pair, e->x, e->out);
    evaluate_constraints(e, e->there, e->x + n);
    e->evaluations++;
}

/* r += G^T lambda */
static void add_impulse(const pair *e, double *r, const double *z) {
    const double *G = e->here + e->k;
    for (uint32_t c = 0; c < e->k; c++)
        for (uint32_t i = 0; i < e->n; i++)
            r[i] += G[c * (size_t)e->n + i] * (e->unit[c] * z[e->n + c]);
}

/* rounding q moves g by about G q, which is no error of the step */
static void constrain(pair *e, double *r, const double *z) {
    for (uint32_t c = 0; c < e->k; c++) {
        r[e->n + c] = e->there[c] * e->unit[c];
        e->size = fmax(e->size, e->stiffness * fabs(z[e->n + c]));
    }
    for (uint32_t i = 0; i < e->n && e->k; i++)
        e->size = fmax(e->size, e->stiffness * fabs(e->state[i]));
}

/* [D1D2, G(q0)^T; G(q1), 0] in its units */
static void lay_matrix(const pair *e, double *J) {
    const size_t n = e->n, N = e->N;
    const double *G0 = e->here + e->k, *G1 = e->there + e->k;
    memset(J, 0, N * N * sizeof *J);
    for (size_t i = 0; i < n; i++) memcpy(J + i * N, e->out + 2 * n + i * n, n * sizeof *J);
    for (size_t c = 0; c < e->k; c++)
        for (size_t i = 0; i < n; i++) {
            J[i * N + n + c] = e->unit[c] * G0[c * n + i];
            J[(n + c) * N + i] = e->unit[c] * G1[c * n + i];
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
    add_impulse(e, r, z);
    constrain(e, r, z);
    if (J) lay_matrix(e, J);
    return DM_OK;
}

/* q1 = q0 + z; p1 = D2 Ld, written p0 + (D1 + D2 + G^T lambda): velocity terms cancel before
 * they are rounded */
static dm_status finish(pair *e) {
    const uint32_t n = e->n;
    evaluate(e, e->z);
    add_impulse(e, e->out, e->z);
    memcpy(e->next, e->state, 4 * (size_t)n * sizeof *e->next);
    dm_sum_add_n(e->next, e->next + 2 * n, e->z, n);
    for (uint32_t i = 0; i < n; i++)
        dm_sum_add(e->next + n + i, e->next + 3 * n + i, e->out[i] + e->out[n + i]);
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
    if (!e->k) return;
    evaluate(e, e->z);
    e->stiffness = norm(e->out + 2 * n, (uint32_t)(n * n));
    if (!isfinite(e->stiffness) || e->stiffness == 0.0) e->stiffness = 1.0;
    for (uint32_t c = 0; c < e->k; c++) {
        const double row = norm(e->here + e->k + c * n, (uint32_t)n);
        e->unit[c] = row > 0.0 ? e->stiffness / row : 1.0;
    }
}

/* Newton's method from the continued z with the exact matrix at every iterate, which the kernel
 * gives anyway. Errors are squared: the last increment need not be small, but the next one,
 * foretold by the last two. 0: it does not go that well. */
static int solve_near(pair *e, const dm_stepper *s, dm_newton_report *report) {
    enum { MOST = 6 };
    static const double FAST = 0.1, NEGLIGIBLE = 1e-17;
    const uint32_t n = e->N;
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
        for (uint32_t i = 0; i < n; i++) e->z[i] -= r[i];
        report->iterations++;
        if (step <= s->tolerance * size || rate * rate * step <= NEGLIGIBLE * size ||
            (rate > 0.5 && noise))
            return 1;
        before = step;
    }
    return 0;
}

/* from z = h v for a v[n], or from z = 0 */
static dm_status solve_from(pair *e, const dm_stepper *s, const double *v, double h,
                            dm_newton_report *report) {
    const dm_newton_problem problem = {.m = e->N,
                                       .equation = equation,
                                       .ctx = e,
                                       .size = &e->size,
                                       .tolerance = s->tolerance,
                                       .max_iterations = s->max_iterations};
    memset(e->z, 0, e->N * sizeof *e->z);
    for (uint32_t i = 0; v && i < e->n; i++) e->z[i] = h * v[i];
    find_units(e);
    return dm_newton(e->z, &problem, e->scratch, report);
}

/* From z = 0, where one iteration finds h M^-1 p0 whatever the masses; where that fails, as where
 * Ld(q, q) is not defined or has a kink, from z = h p0. Where both do, the failure of the one that
 * stays where Ld is defined is told. */
static dm_status solve_far(pair *e, const dm_stepper *s, double h, dm_newton_report *report) {
    const dm_status first = solve_from(e, s, NULL, h, report);
    if (first == DM_OK) return first;
    const dm_status status = solve_from(e, s, e->state + e->n, h, report);
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
    return DM_OK;
}

/* the discrete equations put all of it at the start of the step */
static void impulses(const dm_stepper *s, double *out) {
    const pair e = lay_out(s);
    for (uint32_t c = 0; c < e.k; c++) {
        out[c] = e.unit[c] * e.z[e.n + c];
        out[e.k + c] = 0.0;
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
    .doc = "Discrete Euler-Lagrange equations of a discrete Lagrangian: p0 = -D1 Ld(q0, q1), p1 = "
           "D2 Ld(q0, q1); n unknowns a step (Marsden-West 2001 sec. 1.5, Leok 2.2). With a "
           "constraint g: p0 = -D1 Ld - G^T lambda, g(q1) = 0, one more unknown for each.",
    .orders = "that of Ld: Ld:order()",
    .stages = "-",
    .cost = "n unknowns",
    .instances = "",
    .traits = DM_SYMPLECTIC | DM_FOR_PAIRS | DM_HOLONOMIC | DM_LOOSE_MOMENTUM,
    .engine = &engine,
};
