/* sem_kernel.c - the nodes of a step of one point whose energy chooses its length. */
#include "integ/sem/sem_kernel.h"
#include "integ/sem/sem_factor.h"

#include "algebra/compact.h"
#include "algebra/derive.h"
#include "algebra/implicit.h"
#include "integ/method/cache.h"
#include "integ/method/hamilton.h"

enum { N = DM_SEM_MOST, SIZE = N + 1 };

/* The derivatives of L at a point; qv: row q, column v. */
typedef struct {
    dm_node energy, q[N], v[N], qq[N * N], qv[N * N], vv[N * N];
} slopes;

typedef struct {
    dm_graph *g;
    const dm_model *m;
    uint32_t n;
    int simple;     /* L is separable with a mass that is constant */
    dm_graph *from; /* of the energy, L_q, L_v and the second derivatives, compacted */
    dm_node *at;    /* them, in this order */
    dm_node q0[N], low[N], p0[N], E, half;
    slopes L; /* at the last point */
    dm_node half_h, fall[N], twice, energy;
    dm_node matrix[SIZE * SIZE]; /* of (R, energy) by (v, h); then its factors */
} writing;

enum { GENERAL = 8, MANY = 5, LONGEST = 2000 }; /* coordinates: a mass that varies; operations */

static int is_simple(const dm_model *m) {
    const unsigned simple = DM_SEPARABLE | DM_CONSTANT_MASS;
    return (m->structure & simple) == simple && m->inverse_mass != NULL;
}

static int fits(const dm_model *m) {
    const uint32_t most = is_simple(m) ? N : GENERAL;
    return m->n <= most && m->source.graph && m->source.compile && !m->params;
}

/* Sweeps take less than a long kernel. */
static int is_short(const dm_kernel *kernel, const dm_model *m) {
    return kernel->operations <= LONGEST || m->n <= DM_SEM_FEW || !is_simple(m);
}

/* Roots of `at`: values alone, or second derivatives as well. */
static uint32_t values_of(uint32_t n) {
    return 1 + 2 * n;
}
static uint32_t all_of(uint32_t n) {
    return values_of(n) + 3 * n * n;
}

/* From a graph of its own, so that it rounds alike whatever the model's graph holds by then. */
static int find_slopes(writing *x, const dm_model *m) {
    const uint32_t n = x->n;
    dm_node L, roots[1 + 2 * N + 3 * N * N], *values = roots + 1, *second = values + 2 * n;
    dm_graph *g = dm_graph_copy(m->source.graph, &m->source.lagrangian, 1, &L);
    if (!g || dm_has_roots(g, &L, 1)) return 0;
    dm_gradient(g, L, 0, 2 * n, values);
    dm_jacobian(g, values, n, 0, n, second);
    dm_jacobian(g, values, n, n, n, second + n * n);
    dm_jacobian(g, values + n, n, n, n, second + 2 * n * n);
    roots[0] = dm_neg(g, L);
    for (uint32_t k = 0; k < n; k++)
        roots[0] = dm_add(g, roots[0], dm_mul(g, values[n + k], dm_input(g, n + k)));
    x->at = dm_arena_take(m->source.arena, all_of(n) * sizeof *x->at);
    if (!x->at || dm_graph_status(g) != DM_OK) return 0;
    x->from = dm_compact_graph(g, roots, all_of(n), x->at);
    return x->from != NULL;
}

/* At (q0 + h v/2, v), v = 0 where L is separable; the second derivatives where they are wanted. */
static void evaluate(writing *x, const dm_node *z, int wants_second) {
    const uint32_t n = x->n, count = wants_second ? all_of(n) : values_of(n);
    dm_node with[2 * N + 1] = {0}, out[1 + 2 * N + 3 * N * N];
    slopes *L = &x->L;
    x->half_h = dm_mul(x->g, x->half, z[n]);
    for (uint32_t k = 0; k < n; k++) {
        const dm_node low = dm_add(x->g, x->low[k], dm_mul(x->g, x->half_h, z[k]));
        with[k] = dm_add(x->g, x->q0[k], low);
        if (!x->simple) with[n + k] = z[k];
    }
    dm_transplant(x->g, x->from, x->at, count, with, out);
    L->energy = out[0];
    for (uint32_t k = 0; k < n; k++) L->q[k] = out[1 + k], L->v[k] = out[1 + n + k];
    for (uint32_t k = 0; wants_second && k < n * n; k++) {
        const dm_node *second = out + values_of(n) + k;
        L->qq[k] = second[0], L->qv[k] = second[n * n], L->vv[k] = second[2 * n * n];
    }
}

/* sum_j B_ij x_j, or of B^T */
static dm_node product(const writing *x, const dm_node *B, uint32_t i, const dm_node *v,
                       int transposed) {
    dm_node sum = 0;
    for (uint32_t j = 0; j < x->n; j++) {
        const dm_node b = B[transposed ? j * x->n + i : i * x->n + j];
        sum = dm_add(x->g, sum, dm_mul(x->g, b, v[j]));
    }
    return sum;
}

/* p0 + h/2 L_q */
static dm_node momentum(const writing *x, uint32_t k) {
    return dm_add(x->g, x->p0[k], dm_mul(x->g, x->half_h, x->L.q[k]));
}

/* M^-1_ij */
static dm_node inverse_mass(const writing *x, uint32_t i, uint32_t j) {
    const double *w = x->m->inverse_mass;
    if (x->m->structure & DM_DIAGONAL_MASS) return dm_constant(x->g, i == j ? w[i] : 0.0);
    return dm_constant(x->g, w[i * x->n + j]);
}

/* out[n] = M^-1 a */
static void divide_by_mass(const writing *x, dm_node *out, const dm_node *a) {
    for (uint32_t i = 0; i < x->n; i++) {
        out[i] = 0;
        for (uint32_t j = 0; j < x->n; j++) {
            const dm_node w = inverse_mass(x, i, j);
            out[i] = dm_add(x->g, out[i], dm_mul(x->g, w, a[j]));
        }
    }
}

/* right[n+1] = (R, E_d - E), and L_v . v */
static void find_residual(writing *x, dm_node *right, const dm_node *v) {
    dm_graph *g = x->g;
    const uint32_t n = x->n;
    dm_node pull[N] = {0};
    x->twice = 0;
    for (uint32_t k = 0; k < n; k++) pull[k] = dm_sub(g, momentum(x, k), x->L.v[k]);
    if (x->simple) divide_by_mass(x, x->fall, pull);
    for (uint32_t k = 0; k < n; k++) {
        const dm_node p = x->simple ? pull[k] : x->L.v[k], u = x->simple ? x->fall[k] : v[k];
        right[k] = x->simple ? dm_sub(g, v[k], u) : dm_neg(g, pull[k]);
        x->twice = dm_add(g, x->twice, dm_mul(g, p, u));
    }
    x->energy = x->L.energy;
    if (x->simple) x->energy = dm_add(g, x->energy, dm_mul(g, x->half, x->twice));
    right[n] = dm_sub(g, x->energy, x->E);
}

/* dR/dv = L_vv + h/2 (L_vq - L_qv) - h^2/4 L_qq,  dR/dh = (L_vq v - L_q)/2 - h/4 L_qq v,
 * dE_d/dv = L_vv v + h/2 (L_qv v - L_q),  dE_d/dh = v . (L_qv v - L_q)/2 */
static void find_matrix(writing *x, const dm_node *v) {
    dm_graph *g = x->g;
    const slopes *L = &x->L;
    const uint32_t n = x->n, size = n + 1;
    const dm_node half = x->half_h, quarter = dm_mul(g, half, half);
    dm_node slope[N], *last = x->matrix + n * size, along = 0;
    for (uint32_t i = 0; i < n; i++) {
        for (uint32_t j = 0; j < n; j++) {
            const dm_node turn = dm_sub(g, L->qv[j * n + i], L->qv[i * n + j]);
            const dm_node bend = dm_mul(g, quarter, L->qq[i * n + j]);
            const dm_node inner = dm_sub(g, L->vv[i * n + j], bend);
            x->matrix[i * size + j] = dm_add(g, inner, dm_mul(g, half, turn));
        }
        const dm_node bend = dm_mul(g, half, product(x, L->qq, i, v, 0));
        const dm_node force = dm_sub(g, product(x, L->qv, i, v, 1), L->q[i]);
        x->matrix[i * size + n] = dm_mul(g, x->half, dm_sub(g, force, bend));
        slope[i] = dm_sub(g, product(x, L->qv, i, v, 0), L->q[i]);
    }
    for (uint32_t j = 0; j < n; j++) {
        last[j] = dm_add(g, product(x, L->vv, j, v, 0), dm_mul(g, half, slope[j]));
        along = dm_add(g, along, dm_mul(g, slope[j], v[j]));
    }
    last[n] = dm_mul(g, x->half, along);
}

/* The same where R = v - w,  E_d = w . M w/2 + V,  w = M^-1 (p0 + h/2 L_q): what v is off by
 * enters the energy with h^2.  dw/dv = h^2/4 M^-1 L_qq,  dw/dh = M^-1 (L_q + h/2 L_qq v)/2 */
static void find_simple_matrix(writing *x, const dm_node *v) {
    dm_graph *g = x->g;
    const slopes *L = &x->L;
    const uint32_t n = x->n, size = n + 1;
    const dm_node half = x->half_h, quarter = dm_mul(g, half, half);
    dm_node column[N] = {0}, moved[N] = {0}, *last = x->matrix + n * size;
    for (uint32_t j = 0; j < n; j++) {
        for (uint32_t i = 0; i < n; i++) column[i] = dm_mul(g, quarter, L->qq[i * n + j]);
        divide_by_mass(x, moved, column);
        for (uint32_t i = 0; i < n; i++)
            x->matrix[i * size + j] = dm_sub(g, dm_constant(g, i == j), moved[i]);
        last[j] =
            dm_mul(g, half, dm_sub(g, dm_mul(g, half, product(x, L->qq, j, x->fall, 0)), L->q[j]));
    }
    for (uint32_t i = 0; i < n; i++) {
        const dm_node bend = dm_mul(g, half, product(x, L->qq, i, v, 0));
        column[i] = dm_mul(g, x->half, dm_add(g, L->q[i], bend));
    }
    divide_by_mass(x, moved, column);
    last[n] = 0;
    for (uint32_t i = 0; i < n; i++) {
        x->matrix[i * size + n] = dm_neg(g, moved[i]);
        const dm_node fall = dm_mul(g, x->half, dm_mul(g, L->q[i], v[i]));
        last[n] = dm_add(g, last[n], dm_sub(g, dm_mul(g, column[i], x->fall[i]), fall));
    }
}

/* Does the matrix of the first iteration serve the second? Where L_qq is constant it changes with h
 * alone; and where there are many coordinates a new one costs more than the steps, rough motion's,
 * that then need another two iterations. */
static int serves_twice(const writing *x) {
    int constant = x->simple;
    double value;
    for (uint32_t k = 0; k < x->n * x->n; k++)
        constant = constant && dm_is_constant(x->g, x->L.qq[k], &value);
    return constant || x->n >= MANY;
}

/* z[n+1] -= A^-1 (R, E_d - E), as if h^2 were the unknown, since E_d - H = C h^2 + O(h^3); of a
 * fresh A, or of the one before. */
static int advance(writing *x, dm_node *z, int fresh) {
    dm_graph *g = x->g;
    dm_node y[SIZE];
    const dm_node part = dm_div(g, x->half, z[x->n]);
    evaluate(x, z, fresh);
    find_residual(x, y, z);
    if (fresh) {
        (x->simple ? find_simple_matrix : find_matrix)(x, z);
        if (!dm_sem_factor(x->g, x->matrix, x->n + 1)) return 0;
    }
    dm_sem_solve_factored(x->g, x->matrix, x->n + 1, y);
    const dm_node more = dm_mul(g, dm_mul(g, y[x->n], y[x->n]), part);
    for (uint32_t k = 0; k <= x->n; k++) z[k] = dm_sub(g, z[k], y[k]);
    z[x->n] = dm_sub(g, z[x->n], more);
    return 1;
}

/* dh/dE, the last entry of the inverse */
static dm_node find_slope(const writing *x) {
    dm_node y[SIZE] = {0};
    y[x->n] = dm_constant(x->g, 1.0);
    dm_sem_solve_factored(x->g, x->matrix, x->n + 1, y);
    return y[x->n];
}

static void read_inputs(writing *x, dm_node *z) {
    const uint32_t n = x->n;
    for (uint32_t k = 0; k < n; k++) {
        x->q0[k] = dm_input(x->g, k);
        x->low[k] = dm_input(x->g, n + k);
        x->p0[k] = dm_input(x->g, 2 * n + k);
        z[k] = dm_input(x->g, 3 * n + k);
    }
    z[n] = dm_input(x->g, 4 * n);
    x->E = dm_input(x->g, 4 * n + 1);
    x->half = dm_constant(x->g, 0.5);
}

/* To first order in what is left at the end, with the matrix of the last iteration: z, and L_q
 * there. Residuals of one sign, small as they are, would be a drift of momentum. Where R = v - w
 * that matrix is nearly one, and v = w. */
static void settle(const writing *x, dm_node *z, dm_node *force, const dm_node *right) {
    dm_graph *g = x->g;
    const uint32_t n = x->n;
    dm_node y[SIZE], moved[N];
    for (uint32_t k = 0; k < n; k++) y[k] = right[k];
    y[n] = x->simple ? 0 : right[n];
    if (!x->simple) dm_sem_solve_factored(x->g, x->matrix, x->n + 1, y);
    const dm_node half = dm_mul(g, x->half, y[n]);
    for (uint32_t k = 0; k < n; k++)
        moved[k] = dm_add(g, dm_mul(g, x->half_h, y[k]), dm_mul(g, half, z[k]));
    for (uint32_t k = 0; k < n; k++) {
        const dm_node by_place = product(x, x->L.qq, k, moved, 0);
        const dm_node by_velocity = product(x, x->L.qv, k, y, 0);
        force[k] = dm_sub(g, dm_sub(g, x->L.q[k], by_place), by_velocity);
    }
    for (uint32_t k = 0; k <= n; k++) z[k] = dm_sub(g, z[k], y[k]);
}

/* out as dm_sem_outputs says; 0: the matrix is singular everywhere */
static int write_out(writing *x, dm_node *out) {
    const uint32_t n = x->n;
    dm_node z[SIZE], right[SIZE] = {0};
    read_inputs(x, z);
    if (!advance(x, z, 1) || !advance(x, z, !serves_twice(x))) return 0;
    const dm_node slope = find_slope(x);
    evaluate(x, z, 0);
    find_residual(x, right, z);
    for (uint32_t k = 0; k < n; k++) out[2 * n + 1 + k] = right[k];
    out[3 * n + 1] = x->twice, out[3 * n + 2] = x->energy, out[3 * n + 3] = slope;
    settle(x, z, out + n + 1, right);
    for (uint32_t k = 0; k <= n; k++) out[k] = z[k];
    return dm_graph_status(x->g) == DM_OK;
}

static int build(dm_kernel *out, const dm_model *m) {
    writing x = {.m = m, .n = m->n, .simple = is_simple(m)};
    dm_node roots[3 * N + 4];
    if (!fits(m) || !find_slopes(&x, m)) return 0;
    x.g = dm_graph_new(m->source.arena, dm_sem_inputs(m->n));
    if (!x.g || !write_out(&x, roots)) return 0;
    return dm_lanes_build_compacted(out, m, x.g, roots, dm_sem_outputs(m->n), 1) == 1 &&
           is_short(out, m);
}

/* that there is none is kept, too */
int dm_sem_kernel(dm_kernel *out, const dm_model *m, int *by_velocity) {
    static const char maker;
    *by_velocity = is_simple(m);
    if (dm_cache_find(out, m, &maker, 1)) return out->eval != NULL;
    *out = (dm_kernel){0};
    if (!build(out, m)) *out = (dm_kernel){0};
    dm_cache_add(m, &maker, 1, out, 1);
    return out->eval != NULL;
}
