/* stage_one_point.c - the step of one stage for L = T(v) - V(q, t) with constant mass and few
 * coordinates (push.h): M u = L_q(Q, t + c h), Q = q0 + h reach v0 + h^2 A u,  q1 = q0 + h v0 +
 * h^2 mean u,  p1 = p0 + h b M u. It begins at the displacements Z = Q - q0 of the steps before,
 * continued. With P_0 the last Z and P_j the polynomial of degree j through j + 1 of them at the
 * next point, a new Z has the differences D_j = Z - P_(j-1) and the new P_j = P_(j-1) + D_j; so
 * that (K + 1) Z - sum of P_i, i < K, is the new P_K, and waits for nothing but Z. Differences
 * are taken up to the parabola's and then as long as they get much smaller. Where increments do
 * not shrink at once, from a poor guess on rough motion, there may be another root than the one
 * of a small step: such a step is left to continuation in h (stage.c). */
#include "base/largest.h"
#include "base/written_out.h"
#include "integ/stage/lanes/one_point.h"
#include "integ/stage/stage_inside.h"
#include "linalg/solve/newton_limits.h"
#include "numbers/compensated.h"

#include <math.h>

/* ---- memory ---- */

size_t dm_stage_push_size(const dm_model *m) {
    if (m->n > DM_PUSH_MOST) return 0;
    return DM_PUSHED_END + (4 + 1 + DM_PUSHED_TERMS) * (size_t)m->n + dm_push_inputs(m->n) +
           dm_push_outputs(m->n);
}

size_t dm_stage_push_memory(const dm_stage *g) {
    return DM_PUSHED_END + (4 + 1 + DM_PUSHED_TERMS) * (size_t)g->n;
}

int dm_stage_push_open(dm_stage *g, double *memory) {
    dm_stage_pushes *w = &g->pushes;
    const int one = g->table.s == 1 && g->table.r == 1 && g->table.A->top != 0.0;
    if (!g->separable || !one || !dm_push_kernel(&w->kernel, g->m, 1)) return 0;
    w->memory = memory;
    w->heaviest = dm_stage_heaviest(g);
    w->in = memory + dm_stage_push_memory(g);
    w->out = w->in + dm_push_inputs(g->n);
    dm_kernel_prepare(&w->kernel, w->out);
    dm_stage_push_clear(g, g->h);
    return 1;
}

void dm_stage_push_clear(dm_stage *g, double h) {
    memset(g->pushes.memory, 0, dm_stage_push_memory(g) * sizeof *g->pushes.memory);
    g->pushes.memory[DM_PUSHED_STEP] = h;
}

/* the last step ended where this one begins, and was as long */
DM_WRITTEN_OUT int continues(const dm_stage *g, uint32_t n) {
    const double *memory = g->pushes.memory, *end = memory + DM_PUSHED_END;
    const double count = memory[DM_PUSHED_COUNT]; /* 0, or what stands in a checkpoint */
    int differs = memory[DM_PUSHED_STEP] != g->h || !(count >= 1.0 && count <= DM_PUSHED_TERMS);
#pragma GCC unroll 16
    for (uint32_t k = 0; k < 4 * n; k++) differs |= end[k] != g->state[k];
    return !differs;
}

/* how many of the differences D[count] are taken, by their sizes */
DM_WRITTEN_OUT int terms_of(const double *size, int count) {
    int K = 0;
    for (; K < count; K++) {
        const double left = K + 1 < count ? size[K + 1] : size[K];
        if (K >= DM_WARM_PARABOLA && !(left <= DM_WARM_NEARER * size[K])) break;
    }
    return K;
}

/* P and the next guess, from Z of the step that ended at g->state; known: P are those of the
 * step before it */
DM_WRITTEN_OUT void keep(dm_stage *g, const double *Z, int known, uint32_t n) {
    double *memory = g->pushes.memory, *end = memory + DM_PUSHED_END;
    double *guess = end + 4 * n, *P = guess + n, size[DM_PUSHED_TERMS] = {0.0};
    if (memory[DM_PUSHED_STEP] != g->h) return;
    const int count = known ? (int)memory[DM_PUSHED_COUNT] : 0; /* continues() has looked at it */
#pragma GCC unroll 6
    for (uint32_t j = 0; j < DM_PUSHED_TERMS; j++)
#pragma GCC unroll 4
        for (uint32_t k = 0; k < n; k++) {
            const double D = fabs(Z[k] - P[j * n + k]);
            size[j] = D > size[j] ? D : size[j];
        }
    const int K = terms_of(size, count);
#pragma GCC unroll 4
    for (uint32_t k = 0; k < n; k++) {
        double sum = 0.0, next = Z[k];
        for (int j = 0; j < K; j++) sum += P[(uint32_t)j * n + k];
        guess[k] = (K + 1) * Z[k] - sum;
#pragma GCC unroll 6
        for (uint32_t j = 0; j < DM_PUSHED_TERMS; j++) {
            const double D = Z[k] - P[j * n + k];
            P[j * n + k] = next;
            next += D;
        }
    }
    memory[DM_PUSHED_COUNT] = count < DM_PUSHED_TERMS ? count + 1 : DM_PUSHED_TERMS;
    dm_stage_copy(end, g->state, 4 * n);
}

/* ---- the step ---- */

/* out = M^-1 (x - shift); shift NULL: none */
DM_WRITTEN_OUT void divide_by_mass(const dm_model *m, double *out, const double *x,
                                   const double *shift, uint32_t n) {
    const double *w = m->inverse_mass;
    if (m->structure & DM_DIAGONAL_MASS) {
#pragma GCC unroll 4
        for (uint32_t i = 0; i < n; i++) out[i] = w[i] * x[i];
        return;
    }
#pragma GCC unroll 4
    for (uint32_t i = 0; i < n; i++) {
        double sum = 0.0;
#pragma GCC unroll 4
        for (uint32_t j = 0; j < n; j++) sum += w[i * n + j] * (shift ? x[j] - shift[j] : x[j]);
        out[i] = sum;
    }
}

/* By the rate from one increment to the next, what the second leaves does not count; or it is
 * the noise of Q. */
static inline int is_root(double first, double second, double small) {
    if (second * second <= DM_NEWTON_NEGLIGIBLE * small * first) return 1;
    return second <= small && (second <= DM_NEWTON_SLOW * first || first <= small);
}

/* The root from the guess among the arguments; there Z is renewed, and u = M^-1 L_q. */
DM_WRITTEN_OUT dm_status iterate(dm_stage *g, dm_stepper *stepper, double *u, uint32_t n) {
    dm_stage_pushes *p = &g->pushes;
    const double *force = p->out, *base = p->in + n, w = p->in[3 * n + DM_PUSH_WEIGHT];
    double *Z = p->in + 2 * n;
    const double small = stepper->tolerance * (dm_largest_of(p->in, n) + dm_largest_of(Z, n));
    for (int i = 0; i < DM_PUSHED_CALLS; i++) {
        dm_kernel_eval(&p->kernel, p->in, p->out);
        const double first = fabs(w) * dm_largest_of(force + n, n);
        const double second = fabs(w) * dm_largest_of(force + 2 * n, n);
        g->evaluations += 2;
        stepper->report.iterations += 2;
        stepper->report.residual = second * p->heaviest / fabs(g->h);
        divide_by_mass(g->m, u, force, NULL, n);
#pragma GCC unroll 4
        for (uint32_t k = 0; k < n; k++) Z[k] = base[k] + w * u[k];
        if (is_root(first, second, small)) return DM_OK;
        if (!(second <= DM_NEWTON_SLOW * first)) return DM_NO_CONVERGENCE;
    }
    return DM_NO_CONVERGENCE;
}

/* the end in g->state, where it is finite */
DM_WRITTEN_OUT dm_status finish(dm_stage *g, const double *v0, const double *u, uint32_t n) {
    const double *force = g->pushes.out;
    double next[4 * DM_PUSH_MOST], bad = 0.0;
#pragma GCC unroll 16
    for (uint32_t k = 0; k < 4 * n; k++) next[k] = g->state[k];
#pragma GCC unroll 4
    for (uint32_t k = 0; k < n; k++) {
        const double dq = g->h * v0[k] + dm_weighted(*g->hmean, u[k]);
        dm_sum_add(next + k, next + 2 * n + k, dq);
        dm_sum_add(next + n + k, next + 3 * n + k, dm_weighted(*g->hb, force[k]));
        bad += 0.0 * next[2 * n + k] + 0.0 * next[3 * n + k];
    }
    if (bad != 0.0) return DM_NO_CONVERGENCE;
#pragma GCC unroll 16
    for (uint32_t k = 0; k < 4 * n; k++) g->state[k] = next[k];
    return DM_OK;
}

/* arguments of the kernel, but for the guess */
DM_WRITTEN_OUT void place(dm_stage *g, const double *v0, uint32_t n) {
    const double *low = g->state + 2 * n;
    double *x = g->pushes.in, *numbers = x + 3 * n;
#pragma GCC unroll 4
    for (uint32_t k = 0; k < n; k++) {
        x[k] = g->state[k];
        x[n + k] = low[k] + dm_weighted(*g->hreach, v0[k]);
    }
    numbers[DM_PUSH_WEIGHT] = dm_weight_double(*g->hA);
    numbers[DM_PUSH_OVER] = g->pushes.over;
    numbers[DM_PUSH_TIME] = g->t + dm_weight_double(*g->hc);
}

/* from a straight line, where there are no steps before or they lead elsewhere */
DM_WRITTEN_OUT dm_status step(dm_stage *g, dm_stepper *stepper, uint32_t n) {
    dm_stage_pushes *p = &g->pushes;
    const double *guess = p->memory + DM_PUSHED_END + 4 * n;
    double v0[DM_PUSH_MOST], u[DM_PUSH_MOST], *Z = p->in + 2 * n;
    dm_status status = DM_NO_CONVERGENCE;
    const int known = p->known = continues(g, n);
    divide_by_mass(g->m, v0, g->state + n, g->m->momentum_shift, n);
    place(g, v0, n);
    if (known) {
        dm_stage_copy(Z, guess, n);
        status = iterate(g, stepper, u, n);
    }
    if (status != DM_OK) {
        dm_stage_copy(Z, Z - n, n);
        status = iterate(g, stepper, u, n);
    }
    if (status == DM_OK) status = finish(g, v0, u, n);
    if (status == DM_OK) keep(g, Z, known, n);
    return status;
}

dm_status dm_stage_push(dm_stage *g, dm_stepper *stepper) {
    stepper->report.iterations = 0;
    if (!g->weighed) dm_stage_weights_complete(g);
    switch (g->n) {
    case 1:
        return step(g, stepper, 1);
    case 2:
        return step(g, stepper, 2);
    case 3:
        return step(g, stepper, 3);
    default:
        return step(g, stepper, 4);
    }
}

/* its root is Z without what the state lacks */
void dm_stage_push_newton(dm_stage *g) {
    keep(g, g->root, g->pushes.known, g->n);
}
