#include "integ/stage/stage_inside.h"

#include "linalg/lu.h"
#include "linalg/solve/newton.h"
#include "numbers/compensated.h"

#include <math.h>
#include <string.h>

dm_status dm_stage_start(dm_stepper *stepper, double *state, double t, double h) {
    dm_stage *g = (dm_stage *)(void *)stepper->work;
    (void)state, (void)t;
    if (g->sweeps.row) dm_stage_memory_clear(g, h);
    if (g->warm) dm_stage_warm_clear(g, h);
    if (g->pushes.memory) dm_stage_push_clear(g, h);
    return DM_OK;
}

size_t dm_stage_memory(dm_stepper *stepper, double **place) {
    dm_stage *g = (dm_stage *)(void *)stepper->work;
    *place = g->sweeps.row ? g->sweeps.memory : g->pushes.memory ? g->pushes.memory : g->warm;
    if (g->sweeps.row) return dm_stage_memory_size(g);
    if (g->pushes.memory) return dm_stage_push_memory(g);
    return g->warm ? dm_stage_warm_memory(g) : 0;
}

void dm_stage_at(dm_stage *g, const double *shift, const double *v, double after) {
    const uint32_t n = g->n;
    const double *low = g->state + 2 * n;
    for (uint32_t i = 0; i < n; i++) {
        g->x[i] = g->state[i] + (low[i] + shift[i]);
        g->x[n + i] = v ? v[i] : g->v0[i];
    }
    g->x[2 * n] = g->t + after;
}

dm_status dm_stage_update(dm_stage *g, const double *dq, const double *dp) {
    const uint32_t n = g->n;
    double *high = g->next, *low = g->next + 2 * n, bad = 0.0;
    dm_stage_copy(g->next, g->state, 4 * n);
    dm_sum_add_n(high, low, dq, n);
    dm_sum_add_n(high + n, low + n, dp, n);
    for (uint32_t i = 0; i < 2 * n; i++) bad += 0.0 * low[i]; /* NaN where high is infinite */
    return bad == 0.0 ? DM_OK : DM_NOT_FINITE;
}

/* ---- the general form: unknown velocities V[s][n] ---- */

/* x at point i for the velocities V; Q_i - q0 is in x[0..n) on the way */
static void place_point(dm_stage *g, uint32_t i, const double *V) {
    const uint32_t n = g->n, s = g->table.s;
    double *shift = g->base, *v = g->push;
    memset(shift, 0, n * sizeof *shift);
    memset(v, 0, n * sizeof *v);
    for (uint32_t j = 0; j < s; j++) {
        const double *Vj = V + j * (size_t)n;
        dm_weighted_add(shift, g->ha[i * s + j], Vj, n);
        if (g->table.d[i * s + j].top != 0.0) dm_weighted_add(v, g->table.d[i * s + j], Vj, n);
    }
    dm_stage_at(g, shift, v, dm_weight_double(g->hc[i]));
}

static void evaluate(dm_stage *g, const double *V, int with_curve) {
    const size_t n = g->n, width = 2 * n + 3 * n * n;
    for (uint32_t i = 0; i < g->table.r; i++) {
        double *slope = g->slope + i * 2 * n, *curve = g->curve + i * width;
        place_point(g, i, V);
        if (with_curve) {
            dm_kernel_eval(g->stage, g->x, curve);
            memcpy(slope, curve, 2 * n * sizeof *slope);
        } else {
            dm_kernel_eval(&g->m->slope, g->x, slope);
        }
    }
    g->evaluations += g->table.r;
}

/* R_j = sum_i b_i [h (a_ij - beta_j) L_q(i) + d_ij L_v(i)] - beta_j p0 */
static void residual(dm_stage *g, double *R) {
    const uint32_t n = g->n, s = g->table.s;
    const double *p0 = g->state + n, *low = g->state + 3 * n;
    double largest = 0.0;
    for (uint32_t j = 0; j < s; j++) {
        double *Rj = R + j * (size_t)n;
        const dm_weight beta = g->table.beta[j];
        for (uint32_t k = 0; k < n; k++) Rj[k] = 0.0;
        for (uint32_t i = 0; i < g->table.r; i++) {
            const double *slope = g->slope + i * 2 * (size_t)n;
            const dm_weight wq = g->wq[i * s + j], wv = g->wv[i * s + j];
            for (uint32_t k = 0; k < n; k++) {
                const double term = dm_weighted(wq, slope[k]) + dm_weighted(wv, slope[n + k]);
                const double size = fabs(term);
                Rj[k] += term;
                largest = size > largest ? size : largest;
            }
        }
        for (uint32_t k = 0; k < n; k++)
            Rj[k] = (Rj[k] - dm_weighted(beta, p0[k])) - beta.top * low[k];
    }
    g->size = largest;
}

/* block += w0 A + w1 B + w2 B^T + w3 C for the second derivatives A = L_qq, B = L_qv, C = L_vv,
 * in that order behind each other; rows of J are m long */
static void add_block(double *J, size_t m, const double w[4], const double *A, uint32_t n) {
    const double *B = A + (size_t)n * n, *C = B + (size_t)n * n;
    for (uint32_t i = 0; i < n; i++)
        for (uint32_t j = 0; j < n; j++) {
            const size_t at = i * (size_t)n + j;
            const double mixed = w[1] * B[at] + w[2] * B[j * (size_t)n + i];
            J[i * m + j] += (w[0] * A[at] + w[3] * C[at]) + mixed;
        }
}

/* the same for w1 = w3 = 0 */
static void add_half(double *J, size_t m, const double w[4], const double *A, uint32_t n) {
    const double *B = A + (size_t)n * n;
    if (w[0] == 0.0 && w[2] == 0.0) return;
    for (uint32_t i = 0; i < n; i++)
        for (uint32_t j = 0; j < n; j++)
            J[i * m + j] += w[0] * A[i * (size_t)n + j] + w[2] * B[j * (size_t)n + i];
}

/* dR_j/dV_k = sum_i b_i [h (a_ij - beta_j) (h a_ik L_qq + d_ik L_qv)
 *                        + d_ij (h a_ik L_vq + d_ik L_vv)] */
static void jacobian(const dm_stage *g, double *J) {
    const dm_stage_table *t = &g->table;
    const uint32_t n = g->n, s = t->s;
    const size_t m = (size_t)s * n, nn = (size_t)n * n, width = 2 * n + 3 * nn;
    memset(J, 0, m * m * sizeof *J);
    for (uint32_t i = 0; i < t->r; i++) {
        const double *second = g->curve + i * width + 2 * n;
        for (uint32_t j = 0; j < s; j++) {
            const double wq = dm_weight_double(g->wq[i * s + j]);
            const double wv = dm_weight_double(g->wv[i * s + j]);
            for (uint32_t k = 0; k < s; k++) {
                double *block = J + j * n * m + k * n;
                const double ha = dm_weight_double(g->ha[i * s + k]);
                const double d = dm_weight_double(t->d[i * s + k]);
                const double w[4] = {wq * ha, wq * d, wv * ha, wv * d};
                if (d == 0.0)
                    add_half(block, m, w, second, n);
                else
                    add_block(block, m, w, second, n);
            }
        }
    }
}

static dm_status equation(void *ctx, double *R, double *J, const double *V) {
    dm_stage *g = ctx;
    evaluate(g, V, J != NULL);
    residual(g, R);
    if (J) jacobian(g, J);
    return DM_OK;
}

/* a0 = L_vv^-1 (L_q - L_vq v0) at the start; L_vt is left out, it is a guess */
static dm_status find_acceleration(dm_stage *g) {
    const uint32_t n = g->n;
    const size_t nn = (size_t)n * n;
    const double *out = g->curve, *qv = out + 2 * n + nn;
    double *M = g->scratch;
    uint32_t *pivot = (uint32_t *)(void *)(M + nn);
    memset(g->base, 0, n * sizeof *g->base);
    dm_stage_at(g, g->base, g->v0, 0.0);
    dm_kernel_eval(g->stage, g->x, g->curve);
    g->evaluations++;
    memcpy(M, qv + nn, nn * sizeof *M);
    for (uint32_t i = 0; i < n; i++) {
        g->a0[i] = out[i];
        for (uint32_t j = 0; j < n; j++) g->a0[i] -= qv[j * (size_t)n + i] * g->v0[j];
    }
    const dm_status status = dm_lu_factor(M, pivot, n);
    if (status == DM_OK) dm_lu_solve(g->a0, M, pivot, n);
    return status;
}

/* V_j = v0 + gamma_j h a0: a function of the state alone, so that a restart gives the same bits */
static dm_status guess(dm_stage *g) {
    const uint32_t n = g->n;
    memset(g->v0, 0, n * sizeof *g->v0);
    dm_status status = dm_legendre_inverse(g->m, g->v0, g->state, g->state + n, g->t, g->scratch);
    if (status == DM_OK) status = find_acceleration(g);
    for (uint32_t j = 0; j < g->table.s && status == DM_OK; j++)
        for (uint32_t k = 0; k < n; k++)
            g->root[j * (size_t)n + k] = g->v0[k] + g->table.node[j].top * g->h * g->a0[k];
    return status;
}

/* L_q(i) at the root from its value one increment dV before: + L_qq dQ_i + L_qv dQdot_i */
static void correct_force(dm_stage *g, uint32_t i, const double *dV) {
    const uint32_t n = g->n, s = g->table.s;
    const size_t nn = (size_t)n * n;
    const double *qq = g->curve + i * (2 * n + 3 * nn) + 2 * n, *qv = qq + nn;
    double *force = g->slope + i * 2 * (size_t)n, *dq = g->base, *dv = g->push;
    for (uint32_t k = 0; k < n; k++) {
        dq[k] = dv[k] = 0.0;
        for (uint32_t j = 0; j < s; j++) {
            dq[k] += g->ha[i * s + j].top * dV[j * (size_t)n + k];
            dv[k] += g->table.d[i * s + j].top * dV[j * (size_t)n + k];
        }
    }
    for (uint32_t k = 0; k < n; k++)
        for (uint32_t l = 0; l < n; l++)
            force[k] += qq[k * (size_t)n + l] * dq[l] + qv[k * (size_t)n + l] * dv[l];
}

/* q1 = q0 + h sum_j beta_j V_j, p1 = p0 + h sum_i b_i L_q(i) */
static dm_status finish(dm_stage *g) {
    const uint32_t n = g->n;
    double *dq = g->v0, *dp = g->a0;
    if (g->one) return dm_stage_one_finish(g, g->scratch);
    for (uint32_t i = 0; i < g->table.r; i++) correct_force(g, i, g->scratch);
    memset(dq, 0, n * sizeof *dq);
    memset(dp, 0, n * sizeof *dp);
    for (uint32_t j = 0; j < g->table.s; j++)
        dm_weighted_add(dq, g->hbeta[j], g->root + j * (size_t)n, n);
    for (uint32_t i = 0; i < g->table.r; i++)
        dm_weighted_add(dp, g->hb[i], g->slope + i * 2 * (size_t)n, n);
    return dm_stage_update(g, dq, dp);
}

static dm_status general(dm_stage *g, dm_stepper *stepper) {
    dm_newton_report report = {0};
    const dm_newton_problem problem = {.m = g->table.s * g->n,
                                       .equation = g->one ? dm_stage_one : equation,
                                       .ctx = g,
                                       .size = &g->size,
                                       .tolerance = stepper->tolerance,
                                       .max_iterations = stepper->max_iterations};
    const int continued = g->ratio > 0.0;
    const int warm = continued || (g->warm && dm_stage_warm_guess(g));
    if (continued) memcpy(g->root, g->before, problem.m * sizeof *g->root);
    dm_status status = warm ? dm_newton(g->root, &problem, g->scratch, &report) : DM_OK;
    if (!warm || (status != DM_OK && !continued)) {
        status = guess(g);
        if (status == DM_OK) status = dm_newton(g->root, &problem, g->scratch, &report);
    }
    stepper->report.iterations = report.iterations;
    stepper->report.residual = report.residual;
    if (status == DM_OK) status = finish(g);
    if (status == DM_OK && g->warm) dm_stage_warm_keep(g);
    return status;
}

/* the constant outputs of the kernels for Newton's method, when it is needed first */
static dm_status prepare(dm_stage *g) {
    const size_t n = g->n, curve = 2 * n + 3 * n * n;
    const dm_status status = dm_model_stage(&g->stage, g->m);
    if (status != DM_OK) return status;
    const dm_kernel *slope = g->separable ? &g->m->force : &g->m->slope;
    for (uint32_t i = 0; i < g->table.r; i++) {
        dm_kernel_prepare(g->stage, g->curve + i * curve);
        dm_kernel_prepare(slope, g->slope + i * (size_t)slope->outputs);
    }
    g->prepared = 1;
    return DM_OK;
}

static dm_status by_newton(dm_stage *g, dm_stepper *stepper) {
    if (!g->weighed) dm_stage_weights_complete(g);
    return g->separable ? dm_stage_separable(g, stepper) : general(g, stepper);
}

/* Where Newton's method fails from its guess: h/16, h/8, ... h from the same state, each from
 * the root before. What fails then has no root that is the one of a small step. */
static dm_status by_continuation(dm_stage *g, dm_stepper *stepper) {
    const size_t s = g->table.s, r = g->table.r, unknowns = (s > r ? s : r) * g->n;
    const double h = g->h;
    const dm_report first = stepper->report;
    dm_status status = DM_OK;
    for (double part = 1.0 / 16.0; part <= 1.0 && status == DM_OK; part *= 2.0) {
        dm_stage_weights_scale(g, part * h);
        status = by_newton(g, stepper);
        memcpy(g->before, g->root, unknowns * sizeof *g->root);
        g->ratio = 2.0;
    }
    g->ratio = 0.0;
    if (g->h != h) dm_stage_weights_scale(g, h);
    if (status != DM_OK) stepper->report = first; /* what the first try met */
    return status;
}

/* the end is in g->state */
static dm_status solve(dm_stage *g, dm_stepper *stepper) {
    dm_status status = DM_NO_CONVERGENCE;
    if (g->sweeps.row && !dm_stage_memory_is_stiff(g)) status = dm_stage_sweep(g, stepper);
    if (g->pushes.memory) status = dm_stage_push(g, stepper);
    if (status == DM_OK) return DM_OK;
    status = g->prepared ? DM_OK : prepare(g);
    if (status != DM_OK) return status;
    if (g->pushes.memory) status = by_continuation(g, stepper);
    if (!g->pushes.memory || status != DM_OK) status = by_newton(g, stepper);
    if (!g->pushes.memory && (status == DM_NO_CONVERGENCE || status == DM_SINGULAR)) {
        const dm_status again = by_continuation(g, stepper);
        if (again == DM_OK) status = DM_OK;
    }
    if (status == DM_OK && g->sweeps.row) dm_stage_memory_newton(g);
    if (status != DM_OK) return status;
    dm_stage_copy(g->state, g->next, 4 * g->n);
    if (g->pushes.memory) dm_stage_push_newton(g);
    return DM_OK;
}

dm_status dm_stage_step(dm_stepper *stepper, double *state, double t, double h) {
    dm_stage *g = (dm_stage *)(void *)stepper->work;
    g->state = state;
    g->t = t;
    if (g->h != h) {
        dm_stage_weights_scale(g, h);
        dm_stage_sweeps_scale(g);
    }
    g->evaluations = 0;
    const dm_status status = solve(g, stepper);
    stepper->report.solves++;
    stepper->report.newton += stepper->report.iterations;
    stepper->report.evaluations += g->evaluations;
    return status;
}
