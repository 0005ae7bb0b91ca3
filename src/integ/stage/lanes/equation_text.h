/* equation_text.h - the step equation of stage.h for W members, unknown velocities V[s][n][W]; a
 * text for files that have numbers/lanes_text.h, which for one member is stage_newton.c. */
#ifndef DM_EQUATION_TEXT_H
#define DM_EQUATION_TEXT_H

#include "integ/stage/lanes/group_text.h"

/* n, s and r are constants where they are few, so that all loops over them are written out: what
 * a short step costs are otherwise loops of three rounds and sums that go through memory. */
typedef struct {
    const dm_stage *g;
    const dm_stage_group *group;
    const dm_stage_newton *at;
    double *other; /* room for a curve and slopes of lanes apart from the rest; W > 1 */
    uint32_t n, s, r;
} step_equation;

/* outputs of the kernel `stage` */
INLINE size_t curve_size(uint32_t n) {
    return 2 * (size_t)n + 3 * (size_t)n * n;
}

/* arguments of the kernels at point i: Q = q0 + h sum_j a_ij V_j, Qdot = sum_j d_ij V_j */
INLINE void place_point(const step_equation *e, const double *velocities, uint32_t i) {
    const dm_stage_group *x = e->group;
    const uint32_t n = e->n, s = e->s;
    const dm_weight *ha = e->g->weights.ha + i * s, *d = e->g->table.d + i * s;
#pragma GCC unroll 4
    for (uint32_t k = 0; k < n; k++) {
        V v = load(velocities + k * W), shift = weighted(weight_of(x, ha), v);
        if (s > 1) v = d->top != 0.0 ? weighted(fixed_weight(*d), v) : (V){0};
#pragma GCC unroll 4
        for (uint32_t j = 1; j < s; j++) {
            const V more = load(velocities + (j * n + k) * W);
            shift += weighted(weight_of(x, ha + j), more);
            if (d[j].top != 0.0) v += weighted(fixed_weight(d[j]), more);
        }
        store(e->at->x + k * W,
              load(x->state + k * W) + (load(x->state + (2 * n + k) * W) + shift));
        store(e->at->x + (n + k) * W, v);
    }
    store(e->at->x + 2 * n * W, x->t + weight_sum(x, e->g->weights.hc + i));
}

/* slopes at all points of the lanes of fresh and old, and curves of those that are fresh; all:
 * that is every lane */
INLINE void evaluate_points(const step_equation *e, const double *velocities, I fresh, I old,
                            int all) {
    const dm_stage_newton *at = e->at;
    const uint32_t n = e->n;
    const int renews = some(fresh), goes_on_as_before = some(old);
#pragma GCC unroll 4
    for (uint32_t i = 0; i < e->r; i++) {
        double *curve = at->curve + i * curve_size(n) * W, *slopes = at->slopes + i * 2 * n * W;
        place_point(e, velocities, i);
        if (renews) {
            dm_kernel_eval(at->stage, at->x, all ? curve : e->other);
            if (!all) copy_where(fresh, curve, e->other, (uint32_t)curve_size(n));
            copy_where(fresh, slopes, curve, 2 * n);
        }
        if (goes_on_as_before) {
            double *out = W == 1 ? slopes : e->other + curve_size(n) * W;
            dm_kernel_eval(at->slope, at->x, out);
            if (W > 1) copy_where(old, slopes, out, 2 * n);
        }
    }
}

/* b_i [h (a_ij - beta_j) L_q + d_ij L_v] of coordinate k */
INLINE V term_of(const step_equation *e, uint32_t i, uint32_t j, uint32_t k) {
    const dm_stage_weights *w = &e->g->weights;
    const double *slope = e->at->slopes + (i * 2 * e->n + k) * W;
    return weighted(weight_of(e->group, w->wq + i * e->s + j), load(slope)) +
           weighted(weight_of(e->group, w->wv + i * e->s + j), load(slope + e->n * W));
}

/* R_j = sum_i (term of i, j) - beta_j p0; the size of the terms */
INLINE V find_residual(const step_equation *e, double *R) {
    const double *p0 = e->group->state + e->n * W, *low = p0 + 2 * e->n * W;
    V size = {0};
#pragma GCC unroll 4
    for (uint32_t j = 0; j < e->s; j++)
#pragma GCC unroll 4
        for (uint32_t k = 0; k < e->n; k++) {
            const dm_weight beta = e->g->table.beta[j];
            V sum = term_of(e, 0, j, k);
            size = larger_of(magnitude(sum), size);
#pragma GCC unroll 4
            for (uint32_t i = 1; i < e->r; i++) {
                const V term = term_of(e, i, j, k);
                sum += term;
                size = larger_of(magnitude(term), size);
            }
            sum -= weighted(fixed_weight(beta), load(p0 + k * W));
            store(R + (j * e->n + k) * W, sum - beta.top * load(low + k * W));
        }
    return size;
}

/* block += c0 L_qq + c1 L_qv + c2 L_qv^T + c3 L_vv, which lie behind each other from A on; half:
 * c1 = c3 = 0; first: nothing is in it yet. Rows of the block are m entries apart */
INLINE void add_block(double *block, size_t m, const V c[4], int half, int first, const double *A,
                      uint32_t n) {
    const double *B = A + n * n * W, *C = B + n * n * W;
#pragma GCC unroll 4
    for (uint32_t i = 0; i < n; i++)
#pragma GCC unroll 4
        for (uint32_t j = 0; j < n; j++) {
            const size_t at = (i * n + j) * W, across = (j * n + i) * W;
            double *to = block + (i * m + j) * W;
            V sum = c[0] * load(A + at);
            if (half)
                sum += c[2] * load(B + across);
            else
                sum = (sum + c[3] * load(C + at)) + (c[1] * load(B + at) + c[2] * load(B + across));
            store(to, first ? sum : load(to) + sum);
        }
}

/* dR_j/dV_k = sum_i b_i [h (a_ij - beta_j) (h a_ik L_qq + d_ik L_qv)
 *                        + d_ij (h a_ik L_vq + d_ik L_vv)] */
INLINE void find_matrix(const step_equation *e, double *J) {
    const dm_stage_weights *w = &e->g->weights;
    const uint32_t n = e->n, s = e->s;
    const size_t m = (size_t)s * n;
    const int first = s == 1 && e->r == 1;
    for (size_t k = 0; k < m * m && !first; k++) store(J + k * W, (V){0});
    for (uint32_t i = 0; i < e->r; i++) {
        const double *second = e->at->curve + (i * curve_size(n) + 2 * n) * W;
        for (uint32_t j = 0; j < s; j++)
#pragma GCC unroll 4
            for (uint32_t k = 0; k < s; k++) {
                const V wq = weight_sum(e->group, w->wq + i * s + j);
                const V wv = weight_sum(e->group, w->wv + i * s + j);
                const V ha = weight_sum(e->group, w->ha + i * s + k);
                const double d = s == 1 ? 1.0 : dm_weight_double(e->g->table.d[i * s + k]);
                const V c[4] = {wq * ha, wq * d, wv * ha, wv * d};
                if (d == 0.0 && !some(WHERE(c[0] != (V){0}) | WHERE(c[2] != (V){0}))) continue;
                add_block(J + (j * n * m + k * n) * W, m, c, d == 0.0, first, second, n);
            }
    }
}

#endif
