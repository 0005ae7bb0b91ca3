#include "base/doubles.h"
#include "integ/constrained/constrained_inside.h"
#include "integ/method/method.h"

#include "linalg/solve/newton.h"

#include <math.h>
#include <string.h>

/* Sweeps have no place for multipliers. */
static const char *fits(const dm_rule *rule, const dm_model *m) {
    dm_galerkin g;
    dm_stage_basis(&g, rule, m);
    return g.sweeps
               ? "a number of sweeps is for systems without constraints and forces; leave it out"
               : NULL;
}

/* Second derivatives of L always; of the constraints what the model has of them. */
static unsigned wants(const dm_rule *rule, const dm_model *m) {
    (void)rule;
    const dm_constraints *constraints = m->constraints;
    return DM_WANT_STAGE | DM_WANT_SLOPE | DM_WANT_MASS |
           (constraints->holonomic ? DM_WANT_HOLONOMIC : 0) |
           (constraints->rolling ? DM_WANT_ROLLING : 0) |
           (constraints->holonomic + constraints->rolling ? DM_WANT_REACTION : 0) |
           (constraints->forced ? DM_WANT_CONSTRAINT_FORCE | DM_WANT_FORCE_CURVE : 0);
}

/* ---- the workspace ---- */

typedef struct {
    size_t n, s, r, K, k, l, m, unknowns;
} sizes;

/* From s velocities and r points of the quadrature; k, l, m as in the header. */
static sizes sizes_of(size_t s, size_t r, size_t K, const dm_model *model) {
    sizes z = {.n = model->n, .s = s, .r = r, .K = K};
    z.k = model->constraints->holonomic;
    z.l = model->constraints->rolling;
    z.m = z.k + z.l;
    z.unknowns = s * z.n + K * z.m;
    return z;
}

/* One block serves both Newton iterations, the elimination for the hidden constraint and the
 * Legendre transform: they never run at the same time. */
static size_t scratch_size(const sizes *z, const dm_model *m) {
    const size_t newton =
        dm_larger(dm_newton_work((uint32_t)z->unknowns), dm_newton_work((uint32_t)(z->n + z->m)));
    const size_t hidden = z->m * (z->m + z->n + 3);
    const size_t crossing = dm_constrained_crossing_work(m->constraints);
    return dm_larger(dm_larger(dm_larger(newton, hidden), dm_legendre_work(m)), crossing);
}

/* outputs of kernels */
static void lay_out_kernels(dm_constrained *g, const sizes *z, dm_layout *to) {
    const size_t n = z->n, nn = n * n;
    g->plain = dm_layout_take(to, z->r * 2 * n);
    g->curve = dm_layout_take(to, z->r * (2 * n + 3 * nn));
    g->drag = dm_layout_take(to, z->r * (n + 2 * nn));
    g->holonomic = dm_layout_take(to, (z->K + 1) * z->k * (n + 2));
    g->rolling = dm_layout_take(to, (z->K + 1) * z->l * (1 + 3 * n));
    g->roll = dm_layout_take(to, z->K * z->l * (1 + 3 * n));
    g->reaction = dm_layout_take(to, (z->K + 1) * (n + 2 * nn));
    g->mass = dm_layout_take(to, n + nn);
}

/* Every array of the struct but the tables; returns how many doubles that took. The memory of a
 * step comes last. */
static size_t lay_out(dm_constrained *g, const sizes *z, double *memory) {
    dm_layout to = {memory, 0};
    const size_t n = z->n, m = z->m;
    lay_out_kernels(g, z, &to);
    g->x = dm_layout_take(&to, 2 * n + 1 + m + g->m->constraints->controls);
    g->shift = dm_layout_take(&to, n);
    g->v = dm_layout_take(&to, n);
    g->slope = dm_layout_take(&to, z->r * 2 * n);
    g->impulse = dm_layout_take(&to, (z->K + 1) * n);
    g->lambda = dm_layout_take(&to, m);
    g->row_unit = dm_layout_take(&to, m);
    g->impulse_unit = dm_layout_take(&to, m);
    g->root = dm_layout_take(&to, z->unknowns);
    g->end = dm_layout_take(&to, n + m);
    g->v0 = dm_layout_take(&to, n);
    g->inner_v = dm_layout_take(&to, z->K * n);
    g->next = dm_layout_take(&to, 4 * n);
    g->dq = dm_layout_take(&to, n);
    g->dp = dm_layout_take(&to, n);
    g->before = dm_layout_take(&to, n);
    g->scratch = dm_layout_take(&to, scratch_size(z, g->m));
    if (m == 0) { /* forces alone: a matrix that may be constant */
        g->constant.J = dm_layout_take(&to, z->unknowns * z->unknowns);
        g->constant.pivot =
            (uint32_t *)(void *)dm_layout_take(&to, dm_doubles(z->unknowns * sizeof(uint32_t)));
    }
    g->memory = dm_layout_take(&to, dm_constrained_memory_size((uint32_t)n, (uint32_t)z->unknowns,
                                                               (uint32_t)m));
    return to.used;
}

/* Doubles: the struct, its tables, the shapes of its matrices, its arrays. K is s or one less, and
 * s is enough for both. */
static size_t work(const dm_rule *rule, const dm_model *m) {
    dm_galerkin basis;
    dm_stage_basis(&basis, rule, m);
    const size_t s = (size_t)basis.s, r = (size_t)basis.q.r;
    const sizes z = sizes_of(s, r, s, m); /* K is s or one less */
    dm_constrained g = {.m = m};
    return dm_doubles(sizeof g) + dm_stage_table_size(s, r) + dm_constrained_weights_size(s, r) +
           dm_constrained_entries_size((uint32_t)z.n, (uint32_t)z.k, (uint32_t)z.l) +
           dm_step_matrix_work((uint32_t)z.unknowns) + dm_step_matrix_work((uint32_t)(z.n + z.m)) +
           lay_out(&g, &z, NULL);
}

/* constant outputs of the kernels, once */
static void prepare(dm_constrained *g) {
    const dm_constraints *constraints = g->constraints;
    const size_t n = g->n, nn = n * n;
    for (uint32_t i = 0; i < g->table.r; i++) {
        dm_kernel_prepare(&g->m->stage, g->curve + i * (2 * n + 3 * nn));
        dm_kernel_prepare(&g->m->slope, g->plain + i * 2 * n);
        if (constraints->forced)
            dm_kernel_prepare(&constraints->force_curve, g->drag + i * (n + 2 * nn));
    }
    for (uint32_t k = 0; k <= g->K && g->k + g->l; k++) {
        if (g->k) dm_kernel_prepare(&constraints->holonomic_kernel, dm_constrained_holonomic(g, k));
        if (g->l) dm_kernel_prepare(&constraints->rolling_kernel, dm_constrained_rolling(g, k));
        dm_kernel_prepare(&constraints->reaction, dm_constrained_curved(g, k));
    }
    for (uint32_t k = 0; k < g->K && g->l; k++)
        dm_kernel_prepare(&constraints->rolling_kernel, g->roll + k * g->l * (1 + 3 * n));
    dm_kernel_prepare(&g->m->mass, g->mass);
}

/* Is the matrix one of h alone? Speed: steps, chain of 6, drag, by gauss(4): 1.8x. */
static int is_linear(const dm_constrained *g) {
    const dm_kernel *stage = &g->m->stage, *drag = &g->constraints->force_curve;
    if (g->k + g->l || !stage->fixed || (g->constraints->forced && !drag->fixed)) return 0;
    for (uint32_t i = 2 * g->n; i < stage->outputs; i++)
        if (!stage->fixed[i]) return 0;
    for (uint32_t i = g->n; i < drag->outputs && g->constraints->forced; i++)
        if (!drag->fixed[i]) return 0;
    return 1;
}

/* dense, and narrow where a look at the entries says that it pays */
static void open_matrices(dm_constrained *g, double *memory) {
    const uint32_t N = dm_constrained_unknowns(g), ends = g->n + g->k + g->l;
    double *J = g->scratch;
    dm_step_matrix_open(&g->step, N, memory);
    dm_step_matrix_open(&g->hidden, ends, memory + dm_step_matrix_work(N));
    dm_constrained_scatter(g);
    dm_constrained_equation_matrix(g, J);
    dm_step_matrix_narrow(&g->step, J, (uint32_t *)(void *)(J + (size_t)N * N));
    dm_constrained_hidden_matrix(g, J);
    dm_step_matrix_narrow(&g->hidden, J, (uint32_t *)(void *)(J + (size_t)ends * ends));
}

/* The tables are scaled by h = 1, since a look at the entries of the matrices needs some h; the
 * first step scales them by its own. */
static dm_status open(dm_stepper *stepper) {
    dm_galerkin basis;
    dm_stage_basis(&basis, stepper->rule, stepper->model);
    dm_constrained *g = (dm_constrained *)(void *)stepper->work;
    const dm_model *m = stepper->model;
    double *memory = stepper->work + dm_doubles(sizeof *g);
    *g = (dm_constrained){.m = m, .constraints = m->constraints, .n = m->n};
    g->k = m->constraints->holonomic;
    g->l = m->constraints->rolling;
    dm_stage_table_fill(&g->table, &basis, memory);
    const size_t s = g->table.s, r = g->table.r;
    memory += dm_stage_table_size(s, r);
    g->K = dm_constrained_count(s, r, &basis);
    dm_constrained_weights_fill(g, &basis, memory);
    dm_constrained_weights_scale(g, 1.0); /* a look at the entries asks for some h */
    const sizes z = sizes_of(s, r, g->K, m);
    memory += dm_constrained_weights_size(s, r);
    dm_constrained_entries_find(g, memory);
    memory += dm_constrained_entries_size(g->n, g->k, g->l);
    double *matrices = memory;
    memory +=
        dm_step_matrix_work((uint32_t)z.unknowns) + dm_step_matrix_work((uint32_t)(z.n + z.m));
    lay_out(g, &z, memory);
    prepare(g);
    open_matrices(g, matrices);
    if (!is_linear(g)) g->constant.J = NULL;
    g->factored = NAN;
    dm_constrained_memory_clear(g, NAN);
    return DM_OK;
}

/* Forget the last step; steps of h will be remembered. */
static dm_status start(dm_stepper *stepper, double *state, double t, double h) {
    dm_constrained *g = (dm_constrained *)(void *)stepper->work;
    (void)state;
    (void)t;
    dm_constrained_memory_clear(g, h);
    return DM_OK;
}

/* All of constrained_memory.c, as one block. */
static size_t memory_of(dm_stepper *stepper, double **place) {
    dm_constrained *g = (dm_constrained *)(void *)stepper->work;
    *place = g->memory;
    return dm_constrained_memory_size(g->n, dm_constrained_unknowns(g), g->k + g->l);
}

/* multipliers of the last step: rows of constraints in their own units */
static void impulses(const dm_stepper *stepper, double *out) {
    const dm_constrained *g = (const dm_constrained *)(const void *)stepper->work;
    const uint32_t m = g->k + g->l;
    const double *inner = g->root + (size_t)g->table.s * g->n, *end = g->end + g->n;
    for (uint32_t k = 0; k <= g->K; k++)
        for (uint32_t c = 0; c < m; c++)
            out[k * m + c] = (k < g->K ? inner[k * m + c] : end[c]) * g->impulse_unit[c];
}

uint32_t dm_constrained_nodes(const dm_galerkin *g) {
    return dm_constrained_count((size_t)g->s, (size_t)g->q.r, g) + 1;
}

/* ---- the step ---- */

/* From the root where it is to the root of the equation; iterations are added up over all tries of
 * a step, the residual is that of the last. */
dm_status dm_constrained_newton(dm_constrained *g, const dm_stepper *stepper) {
    dm_newton_report report = {0};
    g->constant.made = g->constant.J && g->factored == g->h;
    g->position_size = dm_constrained_position_size(g);
    /* none is left out: compilers zero the whole first, which takes 10 ns */
    const dm_newton_problem problem = {.m = dm_constrained_unknowns(g),
                                       .inside = NULL,
                                       .period = 0,
                                       .near_identity = 0,
                                       .exact = 0,
                                       .equation = dm_constrained_equation,
                                       .ctx = g,
                                       .size = &g->size,
                                       .band = dm_step_matrix_band(&g->step),
                                       .constant = g->constant.J ? &g->constant : NULL,
                                       .place = g->state,
                                       .places = g->n,
                                       .shared = dm_constrained_unknowns(g) - g->table.s * g->n,
                                       .over = g->h,
                                       .tolerance = stepper->tolerance,
                                       .max_iterations = stepper->max_iterations};
    const dm_status status = dm_newton(g->root, &problem, g->scratch, &report);
    g->factored = g->constant.made ? g->h : NAN;
    g->iterations += report.iterations;
    g->matrices += report.jacobians;
    g->residual = report.residual;
    return status;
}

/* the equation of a step of h / 16, then of ever longer ones from the root before: the same
 * state, the same constraints */
static dm_status by_continuation(dm_constrained *g, const dm_stepper *stepper) {
    enum { DOUBLINGS = 4 };
    const double h = g->h;
    const size_t V = (size_t)g->table.s * g->n, N = dm_constrained_unknowns(g);
    dm_constrained_weights_scale(g, ldexp(h, -DOUBLINGS));
    dm_constrained_plain_guess(g);
    dm_constrained_turning_guess(g);
    dm_status status = dm_constrained_newton(g, stepper);
    for (int k = DOUBLINGS; status == DM_OK && k > 0; k--) {
        memcpy(g->scratch, g->root, V * sizeof *g->root);
        dm_constrained_longer_guess(g, g->scratch);
        for (size_t i = V; i < N; i++) g->root[i] *= 2.0;
        dm_constrained_weights_scale(g, ldexp(h, 1 - k));
        dm_constrained_turning_guess(g);
        status = dm_constrained_newton(g, stepper);
    }
    if (g->h != h) dm_constrained_weights_scale(g, h);
    return status;
}

/* the residual of the way that came nearest is what a failure tells */
static dm_status solve(dm_constrained *g, const dm_stepper *stepper) {
    const int warm = dm_constrained_guess(g);
    dm_constrained_turning_guess(g);
    dm_status status = dm_constrained_newton(g, stepper);
    double least = g->residual;
    if (status != DM_OK && status != DM_CALLBACK && warm) {
        dm_constrained_plain_guess(g);
        dm_constrained_turning_guess(g);
        status = dm_constrained_newton(g, stepper);
        least = fmin(least, g->residual);
    }
    if (status == DM_OK || status == DM_CALLBACK) return status;
    const dm_status last = by_continuation(g, stepper);
    if (last == DM_OK) return DM_OK;
    g->residual = least;
    return status;
}

/* a step that failed: is it the constraints that lose rank, here or where Newton's method went? */
static dm_status find_lost(dm_constrained *g, dm_status status, int ended) {
    if (status != DM_NO_CONVERGENCE && status != DM_SINGULAR) return status;
    g->lost = dm_constrained_dependent(g, ended);
    return g->lost ? DM_SINGULAR : status;
}

/* |g| and |phi| at the end of the step */
static void report_constraints(const dm_constrained *g, dm_report *report) {
    const double *hol = dm_constrained_holonomic(g, g->K), *phi = dm_constrained_rolling(g, g->K);
    for (uint32_t c = 0; c < g->k; c++) report->constraint = fmax(report->constraint, fabs(hol[c]));
    for (uint32_t c = 0; c < g->l; c++) report->rolling = fmax(report->rolling, fabs(phi[c]));
}

/* The state is overwritten last, when nothing can fail any more; memory is renewed with it. */
static dm_status step(dm_stepper *stepper, double *state, double t, double h) {
    dm_constrained *g = (dm_constrained *)(void *)stepper->work;
    g->state = state;
    g->t = t;
    g->evaluations = 0;
    g->iterations = g->matrices = 0;
    g->residual = 0.0;
    g->volume.part = 0.0;
    g->lost = 0, g->crosses = 0;
    if (g->h != h) dm_constrained_weights_scale(g, h);
    const int loose = (stepper->rule->method->traits & DM_LOOSE_MOMENTUM) != 0;
    dm_status status = dm_constrained_begin(g);
    if (status == DM_OK && loose && dm_constrained_is_lost(g, 0)) status = DM_SINGULAR;
    if (status == DM_OK) status = solve(g, stepper);
    status = find_lost(g, status, 0);
    if (status == DM_OK)
        status = find_lost(g,
                           dm_constrained_turns(g) ? dm_constrained_turning_end(g, stepper)
                                                   : dm_constrained_finish(g, stepper),
                           1);
    if (status == DM_OK && dm_constrained_crosses(g)) status = DM_SINGULAR;
    stepper->report.iterations = g->iterations;
    stepper->report.residual = g->residual;
    stepper->report.trouble.dependent = (int)g->lost;
    stepper->report.trouble.crosses = g->crosses, stepper->report.trouble.at = g->at;
    stepper->report.solves++;
    stepper->report.newton += g->iterations;
    stepper->report.matrices += g->matrices;
    stepper->report.evaluations += g->evaluations;
    if (status != DM_OK) return status;
    report_constraints(g, &stepper->report);
    if (!loose) dm_constrained_memory_keep(g); /* no v1 is known of a loose momentum */
    memcpy(state, g->next, 4 * (size_t)g->n * sizeof *state);
    return DM_OK;
}

const dm_engine dm_engine_constrained = {
    .fits = fits,
    .wants = wants,
    .work = work,
    .open = open,
    .start = start,
    .step = step,
    .memory = memory_of,
    .impulses = impulses,
};
