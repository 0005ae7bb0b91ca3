#include "integ/stage/lanes/one_point.h"

#include "algebra/compact.h"
#include "algebra/derive.h"
#include "algebra/implicit.h"
#include "integ/method/cache.h"
#include "integ/method/elimination.h"
#include "integ/method/hamilton.h"

#include <string.h>

typedef struct {
    dm_graph *g;
    uint32_t n;
    dm_graph *from;  /* of L_q and the lower triangle of L_qq, compacted */
    dm_node *slopes; /* [n] and [n(n+1)/2] there */
    const double *mass;
    int diagonal;
    dm_node q0[DM_ONE_POINT_MOST], base[DM_ONE_POINT_MOST], w, t;
    dm_node inverse[DM_ONE_POINT_MOST * DM_ONE_POINT_MOST]; /* of M - w L_qq, lower triangle */
} writing;

static int fits(const dm_model *m) {
    const unsigned simple = DM_SEPARABLE | DM_CONSTANT_MASS;
    return (m->structure & simple) == simple && m->n <= DM_ONE_POINT_MOST && m->source.graph &&
           !m->params && m->inverse_mass;
}

static uint32_t triangle(uint32_t n) {
    return n * (n + 1) / 2;
}

/* From a graph of its own, so that it rounds alike whatever the model's graph holds by then. */
static int find_slopes(writing *x, const dm_model *m) {
    const uint32_t n = x->n;
    dm_node L, H[DM_ONE_POINT_MOST * DM_ONE_POINT_MOST],
        roots[DM_ONE_POINT_MOST + DM_ONE_POINT_MOST * DM_ONE_POINT_MOST];
    dm_graph *g = dm_graph_copy(m->source.graph, &m->source.lagrangian, 1, &L);
    if (!g || dm_has_roots(g, &L, 1)) return 0;
    dm_gradient(g, L, 0, n, roots);
    dm_jacobian(g, roots, n, 0, n, H);
    dm_node *lower = roots + n;
    for (uint32_t i = 0; i < n; i++)
        for (uint32_t j = 0; j <= i; j++) *lower++ = H[i * n + j];
    x->slopes = dm_arena_take(m->source.arena, (n + triangle(n)) * sizeof *x->slopes);
    if (!x->slopes || dm_graph_status(g) != DM_OK) return 0;
    x->from = dm_compact_graph(g, roots, n + triangle(n), x->slopes);
    return x->from != NULL;
}

/* M_ij */
static double mass_at(const writing *x, uint32_t i, uint32_t j) {
    if (x->diagonal) return i == j ? x->mass[i] : 0.0;
    return x->mass[i * x->n + j];
}

/* r = sum_j a_ij x_j of a symmetric matrix, whose lower triangle is there */
static dm_node product(const writing *x, const dm_node *a, uint32_t i, const dm_node *v) {
    dm_node sum = 0;
    for (uint32_t j = 0; j < x->n; j++) {
        const uint32_t at = i >= j ? i * x->n + j : j * x->n + i;
        sum = dm_add(x->g, sum, dm_mul(x->g, a[at], v[j]));
    }
    return sum;
}

/* L_q[n], and w L_qq as a lower triangle of [n*n] where that is wanted, at q0 + Z */
static void evaluate(const writing *x, dm_node *force, dm_node *curve, const dm_node *Z) {
    const uint32_t n = x->n;
    dm_node with[2 * DM_ONE_POINT_MOST + 1] = {0}, H[DM_ONE_POINT_MOST * DM_ONE_POINT_MOST];
    for (uint32_t k = 0; k < n; k++) with[k] = dm_add(x->g, x->q0[k], Z[k]);
    with[2 * n] = x->t;
    dm_transplant(x->g, x->from, x->slopes, n, with, force);
    if (!curve) return;
    dm_transplant(x->g, x->from, x->slopes + n, triangle(n), with, H);
    for (uint32_t i = 0, at = 0; i < n; i++)
        for (uint32_t j = 0; j <= i; j++) curve[i * n + j] = dm_mul(x->g, x->w, H[at++]);
}

/* by columns; 0 at a pivot that vanishes everywhere */
static int invert(writing *x, const dm_node *curve) {
    const uint32_t n = x->n;
    dm_node K[DM_ONE_POINT_MOST * DM_ONE_POINT_MOST],
        lower[DM_ONE_POINT_MOST * DM_ONE_POINT_MOST] = {0}, pivot[DM_ONE_POINT_MOST],
                                  column[DM_ONE_POINT_MOST];
    dm_elimination e = {.g = x->g, .n = n, .mass = K, .lower = lower, .pivot = pivot};
    for (uint32_t i = 0; i < n; i++)
        for (uint32_t j = 0; j <= i; j++) {
            const dm_node M = dm_constant(x->g, mass_at(x, i, j));
            K[i * n + j] = dm_sub(x->g, M, curve[i * n + j]);
        }
    if (!dm_elimination_factor(&e)) return 0;
    e.shift = column;
    for (uint32_t j = 0; j < n; j++) {
        for (uint32_t i = 0; i < n; i++) column[i] = dm_constant(x->g, i == j);
        dm_elimination_solve(&e);
        for (uint32_t i = j; i < n; i++) x->inverse[i * n + j] = column[i];
    }
    return 1;
}

/* d = (M - w L_qq)^-1 (force - M u) */
static void find_increment(const writing *x, dm_node *d, const dm_node *force, const dm_node *u) {
    const uint32_t n = x->n;
    dm_node r[DM_ONE_POINT_MOST];
    for (uint32_t i = 0; i < n; i++) {
        r[i] = force[i];
        for (uint32_t j = 0; j < n; j++) {
            const dm_node M = dm_constant(x->g, mass_at(x, i, j));
            r[i] = dm_sub(x->g, r[i], dm_mul(x->g, M, u[j]));
        }
    }
    for (uint32_t i = 0; i < n; i++) d[i] = product(x, x->inverse, i, r);
}

/* u[n] += d, Z = b + w u */
static void advance(const writing *x, dm_node *u, dm_node *Z, const dm_node *d) {
    for (uint32_t k = 0; k < x->n; k++) {
        u[k] = dm_add(x->g, u[k], d[k]);
        Z[k] = dm_add(x->g, x->base[k], dm_mul(x->g, x->w, u[k]));
    }
}

static void read_inputs(writing *x, dm_node *u, dm_node *Z) {
    const uint32_t n = x->n;
    x->w = dm_input(x->g, 3 * n + DM_ONE_POINT_WEIGHT);
    x->t = dm_input(x->g, 3 * n + DM_ONE_POINT_TIME);
    const dm_node over = dm_input(x->g, 3 * n + DM_ONE_POINT_OVER);
    for (uint32_t k = 0; k < n; k++) {
        x->q0[k] = dm_input(x->g, k);
        x->base[k] = dm_input(x->g, n + k);
        Z[k] = dm_input(x->g, 2 * n + k);
        u[k] = dm_mul(x->g, dm_sub(x->g, Z[k], x->base[k]), over);
    }
}

/* out[3n] as dm_one_point_outputs says; 0: the matrix is singular everywhere */
static int write_out(writing *x, dm_node *out) {
    const uint32_t n = x->n;
    dm_node u[DM_ONE_POINT_MOST] = {0}, Z[DM_ONE_POINT_MOST] = {0}, force[DM_ONE_POINT_MOST],
            curve[DM_ONE_POINT_MOST * DM_ONE_POINT_MOST];
    dm_node *first = out + n, *second = first + n;
    read_inputs(x, u, Z);
    evaluate(x, force, curve, Z);
    if (!invert(x, curve)) return 0;
    find_increment(x, first, force, u);
    advance(x, u, Z, first);
    evaluate(x, force, NULL, Z);
    find_increment(x, second, force, u);
    for (uint32_t k = 0; k < n; k++) out[k] = dm_add(x->g, force[k], product(x, curve, k, second));
    return dm_graph_status(x->g) == DM_OK;
}

static int build(dm_kernel *out, const dm_model *m, uint32_t lanes) {
    writing x = {.n = m->n,
                 .mass = m->mass_matrix,
                 .diagonal = (m->structure & DM_DIAGONAL_MASS) != 0};
    dm_node roots[3 * DM_ONE_POINT_MOST];
    if (!fits(m) || !find_slopes(&x, m)) return 0;
    x.g = dm_graph_new(m->source.arena, dm_one_point_inputs(m->n));
    if (!x.g || !write_out(&x, roots)) return 0;
    return dm_lanes_build_compacted(out, m, x.g, roots, dm_one_point_outputs(m->n), lanes) == lanes;
}

/* that there is none is kept, too */
int dm_one_point_kernel(dm_kernel *out, const dm_model *m, uint32_t lanes) {
    static const char maker;
    if (dm_cache_find(out, m, &maker, lanes)) return out->eval != NULL;
    *out = (dm_kernel){0};
    if (!build(out, m, lanes)) *out = (dm_kernel){0};
    dm_cache_add(m, &maker, lanes, out, lanes);
    return out->eval != NULL;
}
