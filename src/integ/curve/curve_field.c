#include "integ/curve/curve_field.h"

#include "algebra/derive.h"
#include "integ/method/cache.h"

#include <string.h>

/* inputs of the graph, by what stands there */
typedef struct {
    dm_graph *g;
    const dm_model *m;
    uint32_t n, t, a, u, l;
    dm_node L, psi;    /* psi = u . E + l L */
    dm_node *gradient; /* [2n+1] of L in (q, v, t) */
    dm_node *roots;
} builder;

enum { FORCE, GRADIENT, CURVE, TANGENT, MOMENTUM };
static const char maker;

/* Nodes in the arena of the model; NULL without memory. */
static dm_node *take(const builder *b, size_t count) {
    return dm_arena_take(b->m->source.arena, count * sizeof(dm_node));
}

/* sum + x y */
static dm_node add_product(dm_graph *g, dm_node sum, dm_node x, dm_node y) {
    const dm_node product = dm_mul(g, x, y);
    return dm_add(g, sum, product);
}

/* sum + input first + i times x[i] */
static dm_node contract(const builder *b, dm_node sum, uint32_t first, const dm_node *x) {
    for (uint32_t i = 0; i < b->n; i++) {
        const dm_node factor = dm_input(b->g, first + i);
        sum = add_product(b->g, sum, factor, x[i]);
    }
    return sum;
}

/* L in the builder's own graph, whose inputs go on behind t; and its gradient there. */
static dm_status carry_lagrangian(builder *b) {
    dm_graph *from = b->m->source.graph;
    const uint32_t inputs = dm_graph_inputs(from);
    dm_node *with = take(b, inputs);
    b->gradient = take(b, 2 * (size_t)b->n + 1);
    if (!with || !b->gradient) return DM_NO_MEMORY;
    for (uint32_t i = 0; i < inputs; i++) with[i] = i <= b->t ? dm_input(b->g, i) : 0;
    dm_transplant(b->g, from, &b->m->source.lagrangian, 1, with, &b->L);
    dm_gradient(b->g, b->L, 0, 2 * b->n + 1, b->gradient);
    return dm_graph_status(b->g);
}

/* u . E by directional derivatives: w = u . L_v, then u . L_q - w_q . v - w_v . a - w_t, and l L */
static dm_status make_psi(builder *b) {
    const uint32_t n = b->n;
    dm_node *slope = take(b, 2 * (size_t)n + 1);
    if (!slope) return DM_NO_MEMORY;
    const dm_node w = contract(b, 0, b->u, b->gradient + n);
    dm_gradient(b->g, w, 0, 2 * n + 1, slope);
    const dm_node moved = contract(b, slope[2 * n], n, slope);
    const dm_node all = contract(b, moved, b->a, slope + n);
    const dm_node pushed = contract(b, 0, b->u, b->gradient);
    const dm_node defect = dm_sub(b->g, pushed, all);
    b->psi = add_product(b->g, defect, dm_input(b->g, b->l), b->L);
    return dm_graph_status(b->g);
}

/* E + M a = L_q - L_vq v - L_vt */
static void write_push(const builder *b, dm_node *out) {
    const uint32_t n = b->n;
    dm_node *mixed = b->roots + n + (size_t)n * n; /* [n][n] row v, column q */
    dm_node *rate = mixed + (size_t)n * n;
    dm_jacobian(b->g, b->gradient + n, n, 0, n, mixed);
    dm_jacobian(b->g, b->gradient + n, n, b->t, 1, rate);
    for (uint32_t i = 0; i < n; i++) {
        const dm_node moved = contract(b, rate[i], n, mixed + i * (size_t)n);
        out[i] = dm_sub(b->g, b->gradient[i], moved);
    }
}

/* x = M^-1 x with the numbers of a constant mass; y[n] is scratch */
static void divide_by_mass(const builder *b, dm_node *x, dm_node *y) {
    const uint32_t n = b->n;
    const int diagonal = (b->m->structure & DM_DIAGONAL_MASS) != 0;
    memcpy(y, x, n * sizeof *y);
    for (uint32_t i = 0; i < n; i++) {
        const double *row = b->m->inverse_mass + (diagonal ? 0 : i * (size_t)n);
        x[i] = 0;
        for (uint32_t j = 0; j < n; j++) {
            if (diagonal && j != i) continue;
            x[i] = add_product(b->g, x[i], dm_constant(b->g, row[j]), y[j]);
        }
    }
}

/* The roots so far as a kernel, which the model keeps. */
static dm_status make(const builder *b, dm_kernel *out, size_t count, uint32_t which) {
    dm_status status = dm_graph_status(b->g);
    if (status == DM_OK)
        status = b->m->source.compile(out, b->g, b->roots, (uint32_t)count, b->m->source.arena);
    if (status == DM_OK) dm_cache_add(b->m, &maker, which, out, 1);
    return status;
}

/* The acceleration itself where M is constant; else M a and M, to be solved at every point. */
static dm_status make_force(const builder *b, dm_kernel *out) {
    const size_t n = b->n;
    write_push(b, b->roots);
    if (b->m->inverse_mass) {
        divide_by_mass(b, b->roots, b->roots + n);
        return make(b, out, n, FORCE);
    }
    dm_jacobian(b->g, b->gradient + n, b->n, b->n, b->n, b->roots + n);
    return make(b, out, n + n * n, FORCE);
}

/* psi_yy, then E_y and (M u)_y, which is psi_ay but for its sign. */
static dm_status make_curve(const builder *b, dm_kernel *out) {
    const uint32_t n = b->n, N = 2 * n;
    dm_node *defect = b->roots + 2 * (size_t)N * N; /* [N] scratch */
    dm_hessian(b->g, b->psi, 0, N, defect, b->roots);
    dm_gradient(b->g, b->psi, b->u, n, defect);
    dm_jacobian(b->g, defect, n, 0, N, b->roots + (size_t)N * N);
    dm_gradient(b->g, b->psi, b->a, n, defect);
    dm_jacobian(b->g, defect, n, 0, N, b->roots + (size_t)N * N + (size_t)n * N);
    return make(b, out, 2 * (size_t)N * N, CURVE);
}

/* E_y alone. */
static dm_status make_tangent(const builder *b, dm_kernel *out) {
    const uint32_t n = b->n, N = 2 * n;
    dm_node *defect = b->roots + (size_t)n * N; /* [n] scratch */
    dm_gradient(b->g, b->psi, b->u, n, defect);
    dm_jacobian(b->g, defect, n, 0, N, b->roots);
    return make(b, out, (size_t)n * N, TANGENT);
}

/* L_vy. */
static dm_status make_momentum(const builder *b, dm_kernel *out) {
    const uint32_t n = b->n, N = 2 * n;
    dm_jacobian(b->g, b->gradient + n, n, 0, N, b->roots);
    return make(b, out, (size_t)n * N, MOMENTUM);
}

/* The roots are overwritten from kernel to kernel. */
static dm_status build(dm_field *out, builder *b) {
    const uint32_t n = b->n;
    dm_status status = carry_lagrangian(b);
    if (status == DM_OK) status = make_psi(b);
    b->roots = take(b, 8 * (size_t)n * n + 4 * (size_t)n);
    if (status == DM_OK && !b->roots) status = DM_NO_MEMORY;
    if (status == DM_OK) status = make_force(b, &out->force);
    if (status != DM_OK) return status;
    dm_gradient(b->g, b->psi, 0, 2 * n, b->roots);
    status = make(b, &out->gradient, 2 * (size_t)n, GRADIENT);
    if (status == DM_OK) status = make_curve(b, &out->curve);
    if (status == DM_OK) status = make_tangent(b, &out->tangent);
    return status == DM_OK ? make_momentum(b, &out->momentum) : status;
}

/* All five or none are found with the model. */
dm_status dm_field_build(dm_field *out, const dm_model *m) {
    const uint32_t n = m->n;
    builder b = {.m = m, .n = n, .t = 2 * n, .a = 2 * n + 1, .u = 3 * n + 1, .l = 4 * n + 1};
    if (!m->source.graph || !m->source.compile) return DM_TOO_LARGE;
    if (dm_cache_find(&out->force, m, &maker, FORCE) &&
        dm_cache_find(&out->gradient, m, &maker, GRADIENT) &&
        dm_cache_find(&out->curve, m, &maker, CURVE) &&
        dm_cache_find(&out->tangent, m, &maker, TANGENT) &&
        dm_cache_find(&out->momentum, m, &maker, MOMENTUM))
        return DM_OK;
    b.g = dm_graph_new(m->source.arena, (uint32_t)dm_field_inputs(n));
    return b.g ? build(out, &b) : DM_NO_MEMORY;
}
