/* stage_newton.c - the step of the general form by Newton's method, unknown velocities V[s][n]. Its
 * equation, warm start and end are the texts of lanes/ for one member; here are the first guess
 * and who calls whom. */
#include "integ/stage/stage_inside.h"

#include "linalg/lu.h"
#include "linalg/solve/newton.h"

#include <math.h>
#include <string.h>

#define W 1
#define HOW
#define DM_LANES_FUSED 0
#include "integ/stage/lanes/end_text.h"
#include "integ/stage/lanes/warm_text.h"

/* ---- a quadratic L ---- */

/* The matrix is one of h alone then, and its factors stay behind what the first guess and the
 * iteration work on. Speed: steps, chain of 12, magnetic field, by gauss(4): 4x. */
void dm_stage_general_open(dm_stage *g) {
    dm_stage_newton *w = &g->newton;
    const dm_kernel *stage = w->stage;
    const size_t n = g->n, m = g->table.s * n;
    w->factored = NAN;
    w->linear = stage->fixed != NULL;
    for (size_t k = 2 * n; k < stage->outputs && w->linear; k++) w->linear = stage->fixed[k];
    w->factors = g->scratch + dm_legendre_work(g->m) + n * n + n + 4 * m;
    w->pivot = (uint32_t *)(void *)(w->factors + m * m);
}

/* ---- the texts for one member ---- */

/* a part of the step, of which `at` is what the caller has beside g */
typedef int part(dm_stage *g, const void *at, const step_equation *e);

/* with one velocity at one point, as of the midpoint rule, few coordinates are written out */
INLINE int written_out(part *f, dm_stage *g, const void *at) {
    const uint32_t n = g->n, s = g->table.s, r = g->table.r;
    step_equation e = {.g = g, .group = &g->group, .at = &g->newton, .n = 1, .s = 1, .r = 1};
    const int one = s == 1 && r == 1;
    if (one && n == 1) return f(g, at, &e);
    e.n = 2;
    if (one && n == 2) return f(g, at, &e);
    e.n = 3;
    if (one && n == 3) return f(g, at, &e);
    e.n = 4;
    if (one && n == 4) return f(g, at, &e);
    e.n = n;
    if (one) return f(g, at, &e);
    e.s = s;
    e.r = r;
    return f(g, at, &e);
}

/* R and, unless NULL, J at these V */
typedef struct {
    double *R, *J;
    const double *at;
} place;

INLINE int evaluate(dm_stage *g, const void *at, const step_equation *e) {
    const place *x = at;
    const I fresh = x->J != NULL;
    evaluate_points(e, x->at, fresh, !fresh, 1);
    g->evaluations += e->r;
    g->size = find_residual(e, x->R);
    if (fresh && !(g->newton.constant && g->newton.constant->made)) find_matrix(e, x->J);
    return 1;
}

static dm_status equation(void *ctx, double *R, double *J, const double *x) {
    written_out(evaluate, ctx, &(place){R, J, x});
    return DM_OK;
}

INLINE int guess_root(dm_stage *g, const void *at, const step_equation *e) {
    (void)g, (void)at;
    return guess_velocities(e);
}

/* the last increment is the first of the scratch that dm_newton had */
INLINE int end_step(dm_stage *g, const void *at, const step_equation *e) {
    (void)at;
    return find_end(e, g->newton.root, g->scratch);
}

INLINE int keep_root(dm_stage *g, const void *at, const step_equation *e) {
    (void)at;
    if (g->group.memory[DM_WARM_STEP] == g->weights.h)
        keep_velocities(e, 1, goes_on(&g->group, e->n));
    return 1;
}

/* ---- the first guess ---- */

/* a0 = L_vv^-1 (L_q - L_vq v0) at the start; L_vt is left out, it is a guess */
static dm_status find_acceleration(dm_stage *g) {
    const uint32_t n = g->n;
    const size_t nn = (size_t)n * n;
    const double *out = g->newton.curve, *qv = out + 2 * n + nn, *v0 = g->points.v0;
    double *M = g->scratch, *a0 = g->points.a0;
    uint32_t *pivot = (uint32_t *)(void *)(M + nn);
    memset(g->points.base, 0, n * sizeof *g->points.base);
    dm_stage_at(g, g->points.base, v0, 0.0);
    dm_kernel_eval(g->newton.stage, g->newton.x, g->newton.curve);
    g->evaluations++;
    memcpy(M, qv + nn, nn * sizeof *M);
    for (uint32_t i = 0; i < n; i++) {
        a0[i] = out[i];
        for (uint32_t j = 0; j < n; j++) a0[i] -= qv[j * (size_t)n + i] * v0[j];
    }
    const dm_status status = dm_lu_factor(M, pivot, n);
    if (status == DM_OK) dm_lu_solve(a0, M, pivot, n);
    return status;
}

/* V_j = v0 + gamma_j h a0: a function of the state alone, so that a restart gives the same bits */
static dm_status first_guess(dm_stage *g) {
    const uint32_t n = g->n;
    const double *state = g->group.state, h = g->weights.h;
    double *v0 = g->points.v0, *a0 = g->points.a0;
    memset(v0, 0, n * sizeof *v0);
    dm_status status = dm_legendre_inverse(g->m, v0, state, state + n, g->group.t, g->scratch);
    if (status == DM_OK) status = find_acceleration(g);
    for (uint32_t j = 0; j < g->table.s && status == DM_OK; j++)
        for (uint32_t k = 0; k < n; k++)
            g->newton.root[j * (size_t)n + k] = v0[k] + g->table.node[j].top * h * a0[k];
    return status;
}

/* ---- the step ---- */

/* from a shorter step, from the steps before or from the state alone */
static dm_status find_root(dm_stage *g, const dm_newton_problem *problem,
                           dm_newton_report *report) {
    double *root = g->newton.root;
    const int continued = g->before.ratio > 0.0;
    const int warm = continued || (g->ahead && written_out(guess_root, g, NULL));
    if (continued) memcpy(root, g->before.root, problem->m * sizeof *root);
    dm_status status = warm ? dm_newton(root, problem, g->scratch, report) : DM_OK;
    if (warm && (status == DM_OK || continued)) return status;
    status = first_guess(g);
    return status == DM_OK ? dm_newton(root, problem, g->scratch, report) : status;
}

dm_status dm_stage_general(dm_stage *g, dm_stepper *stepper) {
    dm_newton_report report = {0};
    dm_stage_newton *w = &g->newton;
    dm_newton_constant constant = {w->factors, w->pivot, w->factored == g->weights.h};
    w->constant = w->linear ? &constant : NULL;
    const dm_newton_problem problem = {.m = g->table.s * g->n,
                                       .equation = equation,
                                       .ctx = g,
                                       .size = &g->size,
                                       .inside = g->m->structure & DM_QUADRATIC_IN_V ? NULL
                                                                                     : g->points.v0,
                                       .period = g->n,
                                       .constant = w->constant,
                                       .place = g->group.state,
                                       .places = g->n,
                                       .over = g->weights.h,
                                       .tolerance = stepper->tolerance,
                                       .max_iterations = stepper->max_iterations};
    const dm_status status = find_root(g, &problem, &report);
    w->factored = constant.made ? g->weights.h : NAN;
    w->constant = NULL;
    stepper->report.iterations = report.iterations;
    stepper->report.matrices += report.jacobians;
    stepper->report.trouble.outside = report.outside;
    stepper->report.residual = report.residual;
    if (status != DM_OK) return status;
    if (!written_out(end_step, g, NULL)) return DM_NOT_FINITE;
    if (g->ahead) written_out(keep_root, g, NULL);
    return DM_OK;
}
