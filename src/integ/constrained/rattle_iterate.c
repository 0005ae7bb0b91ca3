/* rattle_iterate.c - Newton's iterations of a constrained step, as graphs. */
#include "integ/constrained/rattle_inside.h"

#include <string.h>

typedef dm_rattle_frame frame;

/* sum_c x_c^2 */
static dm_node square(const frame *b, const dm_node *x) {
    dm_node sum = 0;
    for (uint32_t c = 0; c < b->at.n; c++) sum = dm_rattle_add_product(b, sum, x[c], x[c]);
    return sum;
}

/* the least |x_c|; of squares it would keep those of the sums from being fused */
static dm_node least(const frame *b, const dm_node *x) {
    dm_graph *g = b->f.graph;
    dm_node so_far = dm_apply(g, DM_OP_ABS, x[0], 0, 0);
    for (uint32_t c = 1; c < b->at.n; c++)
        so_far = dm_apply(g, DM_OP_MIN, so_far, dm_apply(g, DM_OP_ABS, x[c], 0, 0), 0);
    return so_far;
}

/* entry (c, d) of the mass matrix, node 0 where it is zero */
static dm_node mass(const frame *b, uint32_t c, uint32_t d) {
    const double *M = b->model->mass_matrix;
    const uint32_t n = b->at.n;
    if (b->model->structure & DM_DIAGONAL_MASS) return c == d ? dm_constant(b->f.graph, M[c]) : 0;
    return dm_constant(b->f.graph, M[c * (size_t)n + d]);
}

/* what an iteration works on: y[n], lambda[m], norms are its outputs; B = h W G0^T; units of the
 * pivots of its matrix: of masses, which come first where a force sees v, there is none */
typedef struct {
    dm_node *y, *lambda, *norms, *B, *G0, *units;
} iterate;

/* Room, and B = h W G0^T of the start, which all iterations have. */
static int begin_iterate(frame *b, iterate *x) {
    const size_t n = b->at.n, m = b->at.m;
    x->G0 = dm_rattle_take(b, b->at.nonzeros);
    x->y = dm_rattle_take(b, n + m + DM_RATTLE_NORMS);
    x->B = dm_rattle_take(b, n * m);
    x->units = dm_rattle_take(b, n + m);
    if (!x->G0 || !x->y || !x->B || !x->units) return 0;
    x->lambda = x->y + n;
    x->norms = x->lambda + m;
    dm_rattle_inputs(b, x->units + (b->drag ? n : 0), b->at.unit, b->at.m);
    dm_rattle_inputs(b, x->G0, b->at.G, b->at.nonzeros);
    dm_rattle_spread(b, x->B, x->G0, b->h);
    return 1;
}

/* y += B dlambda, where J dlambda = -g(y) */
static int iteration(frame *b, iterate *x) {
    const uint32_t n = b->at.n, m = b->at.m;
    const size_t count = m + (size_t)b->at.nonzeros;
    dm_node *roots = dm_rattle_take(b, count), *values = dm_rattle_take(b, count);
    dm_node *J = dm_rattle_take(b, (size_t)m * m), *change = dm_rattle_take(b, n);
    if (!roots || !values || !J || !change) return 0;
    memcpy(roots, b->g, m * sizeof *roots);
    memcpy(roots + m, b->G, b->at.nonzeros * sizeof *roots);
    dm_rattle_evaluate(b, values, roots, count, &(dm_rattle_point){x->y, NULL, b->t});
    dm_rattle_multiply(b, J, values + m, x->B, 0);
    dm_node *minus = values; /* -dlambda */
    x->norms[3] = dm_graph_solve(b->f.graph, J, minus, m, 0, x->units);
    for (uint32_t j = 0; j < m; j++) x->lambda[j] = dm_sub(b->f.graph, x->lambda[j], minus[j]);
    for (uint32_t c = 0; c < n; c++) {
        for (uint32_t j = 0; j < m; j++)
            change[c] = dm_rattle_add_product(b, change[c], x->B[c * (size_t)m + j], minus[j]);
        if (change[c]) x->y[c] = dm_sub(b->f.graph, x->y[c], change[c]);
    }
    x->norms[0] = x->norms[1];
    x->norms[1] = square(b, change);
    x->norms[2] = square(b, x->y);
    return 1;
}

/* q + h W (p + h/2 F - shift) + B lambda, lambda as guessed */
static int predict(frame *b, iterate *x) {
    const uint32_t n = b->at.n;
    dm_node *F = dm_rattle_take(b, n), *shift = dm_rattle_take(b, n);
    if (!F || !shift) return 0;
    dm_rattle_inputs(b, F, b->at.force, n);
    dm_rattle_inputs(b, x->lambda, b->at.guess, b->at.m);
    if (!dm_rattle_displace(b, shift, F, x->B, x->lambda)) return 0;
    for (uint32_t c = 0; c < n; c++) x->y[c] = dm_add(b->f.graph, b->q[c], shift[c]);
    return 1;
}

/* ---- with a force that sees v, which is that of the step, (q1 - q0)/h: unknowns v (in the
 * place of y) and lambda ---- */

/* v = W (p + h/2 F - shift + G^T lambda), without the force */
static int predict_velocity(frame *b, iterate *x) {
    const uint32_t n = b->at.n;
    dm_node *kicked = dm_rattle_take(b, n);
    if (!kicked) return 0;
    for (uint32_t c = 0; c < n; c++)
        kicked[c] =
            dm_multiply_add(b->f.graph, b->half, dm_input(b->f.graph, b->at.force + c), b->p[c]);
    dm_rattle_inputs(b, x->lambda, b->at.guess, b->at.m);
    for (uint32_t j = 0; j < b->at.m; j++)
        for (uint32_t e = b->row[j]; e < b->row[j + 1]; e++)
            kicked[b->column[e]] =
                dm_rattle_add_product(b, kicked[b->column[e]], x->G0[e], x->lambda[j]);
    dm_fusion_velocity(&b->f, x->y, NULL, kicked);
    return 1;
}

/* r[n] = M v + shift - p - h/2 (F + f) - G0^T lambda */
static void momentum_defect(frame *b, const iterate *x, dm_node *r, const dm_node *f) {
    const uint32_t n = b->at.n;
    const dm_node less = dm_neg(b->f.graph, b->half);
    for (uint32_t c = 0; c < n; c++) {
        const dm_node F = dm_input(b->f.graph, b->at.force + c);
        r[c] = 0;
        for (uint32_t d = 0; d < n; d++)
            r[c] = dm_rattle_add_product(b, r[c], mass(b, c, d), x->y[d]);
        if (b->model->momentum_shift[c] != 0.0) {
            const dm_node shift = dm_constant(b->f.graph, b->model->momentum_shift[c]);
            r[c] = dm_add(b->f.graph, r[c], shift);
        }
        r[c] = dm_sub(b->f.graph, r[c], b->p[c]);
        r[c] = dm_rattle_add_product(b, r[c], less, F);
        r[c] = dm_rattle_add_product(b, r[c], less, f[c]);
    }
    for (uint32_t j = 0; j < b->at.m; j++)
        for (uint32_t e = b->row[j]; e < b->row[j + 1]; e++)
            r[b->column[e]] =
                dm_subtract_product(b->f.graph, r[b->column[e]], x->G0[e], x->lambda[j]);
}

/* K = (M - h/2 f_v, -G0^T; h G, 0) */
static void lay_matrix(frame *b, const iterate *x, dm_node *K, const dm_node *f_v,
                       const dm_node *G) {
    const uint32_t n = b->at.n, N = n + b->at.m;
    for (uint32_t c = 0; c < n; c++)
        for (uint32_t d = 0; d < n; d++)
            K[c * (size_t)N + d] =
                dm_subtract_product(b->f.graph, mass(b, c, d), b->half, f_v[c * (size_t)n + d]);
    for (uint32_t j = 0; j < b->at.m; j++)
        for (uint32_t e = b->row[j]; e < b->row[j + 1]; e++) {
            const uint32_t c = b->column[e];
            K[c * (size_t)N + n + j] = dm_neg(b->f.graph, x->G0[e]);
            K[(n + j) * (size_t)N + c] = dm_mul(b->f.graph, b->h, G[e]);
        }
}

/* q + h v */
static void move(frame *b, const iterate *x, dm_node *y) {
    for (uint32_t c = 0; c < b->at.n; c++) {
        const dm_node dq = dm_multiply_add(b->f.graph, b->h, x->y[c], b->lq[c]);
        y[c] = dm_add(b->f.graph, b->q[c], dq);
    }
}

/* One Newton step for (v, lambda) together, with the exact matrix; f is taken at q0, v and t0, g at
 * the end. */
static int iteration_with_drag(frame *b, iterate *x) {
    const size_t n = b->at.n, m = b->at.m, z = b->at.nonzeros, N = n + m;
    dm_node *roots = dm_rattle_take(b, n + n * n + m + z);
    dm_node *f = dm_rattle_take(b, n + n * n), *values = dm_rattle_take(b, m + z);
    dm_node *K = dm_rattle_take(b, N * N), *r = dm_rattle_take(b, N);
    dm_node *y = dm_rattle_take(b, n);
    if (!roots || !f || !values || !K || !r || !y) return 0;
    memcpy(roots, b->drag, n * sizeof *roots);
    memcpy(roots + n, b->drag_v, n * n * sizeof *roots);
    dm_rattle_evaluate(b, f, roots, n + n * n, &(dm_rattle_point){b->q, x->y, b->t0});
    move(b, x, y);
    memcpy(roots, b->g, m * sizeof *roots);
    memcpy(roots + m, b->G, z * sizeof *roots);
    dm_rattle_evaluate(b, values, roots, m + z, &(dm_rattle_point){y, NULL, b->t});
    momentum_defect(b, x, r, f);
    memcpy(r + n, values, m * sizeof *r);
    lay_matrix(b, x, K, f + n, values + m);
    x->norms[3] = dm_graph_solve(b->f.graph, K, r, (uint32_t)N, 0, x->units);
    for (size_t i = 0; i < N; i++)
        if (r[i]) x->y[i] = dm_sub(b->f.graph, x->y[i], r[i]); /* lambda is behind y */
    x->norms[0] = x->norms[1];
    x->norms[1] = dm_mul(b->f.graph, dm_mul(b->f.graph, b->h, b->h), square(b, r));
    x->norms[2] = square(b, y);
    return 1;
}

/* ---- kernels ---- */

/* `first` has two iterations behind its prediction, as most steps need no more; `newton` is one of
 * them, on what the last one left. */
dm_status dm_rattle_make_iterate(frame *b, dm_kernel *out, int first) {
    const size_t n = b->at.n, m = b->at.m;
    iterate x;
    if (!dm_rattle_begin(b) || !begin_iterate(b, &x)) return DM_NO_MEMORY;
    if (first && !(b->drag ? predict_velocity(b, &x) : predict(b, &x))) return DM_NO_MEMORY;
    if (!first) dm_rattle_inputs(b, x.y, b->at.y, (uint32_t)(n + m + 2));
    x.norms[3] = dm_constant(b->f.graph, 0.0);
    for (int i = 0; i < (first ? 2 : 1) && (m || b->drag); i++)
        if (!(b->drag ? iteration_with_drag(b, &x) : iteration(b, &x))) return DM_NO_MEMORY;
    x.norms[4] = least(b, x.y);
    return dm_rattle_end(b, out, x.y, n + m + DM_RATTLE_NORMS);
}
