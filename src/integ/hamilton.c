#include "integ/hamilton.h"

#include "expr/derive.h"
#include "expr/jit.h"

#include <string.h>

/* nodes of the new graph; M = l D l^T with blocks of two (the last may be one), det = a c - b^2 of each:
** half as many divisions wait for each other as with single pivots */
typedef struct {
    dm_graph *g;
    uint32_t n;
    dm_node *with;          /* [2n+1] what stands for q, v, t */
    dm_node *mass, *shift;  /* [n*n], [n]: M and what is left of it, p - b and then v */
    dm_node *lower, *roots; /* [n*n]; [3n] v, L_q, pivots: leading minors of the blocks */
} elimination;

int dm_hamilton_fits(const dm_model *m) {
    return m->source.graph && m->n <= DM_HAMILTON_LARGEST &&
           (m->structure & DM_QUADRATIC_IN_V) && !(m->structure & DM_LINEAR_IN_V);
}

uint32_t dm_lanes_build(dm_kernel *out, const dm_model *m, dm_graph *g,
                        const dm_node *roots, uint32_t count, uint32_t stages) {
    const dm_source *s = &m->source;
    const uint32_t most = s->compile == dm_native_build ? dm_jit_lanes() : 1;
    const uint32_t lanes = stages > 4 && most >= 8 ? 8 : stages > 1 && most >= 4 ? 4 : 1;
    if (lanes > 1 && dm_jit_build_lanes(out, g, roots, count, lanes, s->arena) == DM_OK)
        return lanes;
    return s->compile(out, g, roots, count, s->arena) == DM_OK ? 1 : 0;
}

/* x -= factor * y */
static void subtract(dm_graph *g, dm_node *x, dm_node factor, dm_node y) {
    const dm_node product = dm_mul(g, factor, y);
    *x = dm_sub(g, *x, product);
}

/* a c - b d */
static dm_node cross(dm_graph *g, dm_node a, dm_node c, dm_node b, dm_node d) {
    dm_node x = dm_mul(g, a, c);
    subtract(g, &x, b, d);
    return x;
}

/* (x, y) = D^-1 (x, y) for the block at j; y is nothing where that is one row */
static void divide(const elimination *e, uint32_t j, dm_node *x, dm_node *y) {
    const dm_node *M = e->mass + j * (size_t)e->n + j, *pivot = e->roots + 2 * e->n + j;
    dm_graph *g = e->g;
    if (j + 1 == e->n) {
        *x = dm_div(g, *x, *pivot);
        return;
    }
    const dm_node a = M[0], b = M[e->n], c = M[e->n + 1];
    const dm_node first = cross(g, c, *x, b, *y), second = cross(g, a, *y, b, *x);
    *x = dm_div(g, first, pivot[1]);
    *y = dm_div(g, second, pivot[1]);
}

/* the block at j, its rows of l, and what is left of M below; 0 at a pivot that vanishes everywhere */
static int eliminate(elimination *e, uint32_t j) {
    const uint32_t n = e->n, wide = j + 1 < n ? 2 : 1;
    dm_node *M = e->mass, *pivot = e->roots + 2 * n + j;
    pivot[0] = M[j * n + j];
    if (wide == 2)
        pivot[1] = cross(e->g, M[j * n + j], M[(j + 1) * n + j + 1], M[(j + 1) * n + j],
                         M[(j + 1) * n + j]);
    for (uint32_t i = j + wide; i < n; i++) {
        dm_node *l = e->lower + i * n + j;
        memcpy(l, M + i * n + j, wide * sizeof *l);
        divide(e, j, l, l + 1);
        for (uint32_t k = j + wide; k <= i; k++)
            for (uint32_t w = 0; w < wide; w++)
                subtract(e->g, M + i * n + k, l[w], M[k * n + j + w]);
    }
    return pivot[0] && pivot[wide - 1];
}

static int factor(elimination *e) {
    for (uint32_t j = 0; j < e->n; j += 2)
        if (!eliminate(e, j)) return 0;
    return 1;
}

/* v = l^-T D^-1 l^-1 (p - b) */
static void solve(elimination *e) {
    const uint32_t n = e->n;
    dm_node *v = e->shift;
    for (uint32_t i = 2; i < n; i++)
        for (uint32_t k = 0; k < (i & ~1u); k++)
            subtract(e->g, v + i, e->lower[i * n + k], v[k]);
    for (uint32_t j = 0; j < n; j += 2) divide(e, j, v + j, v + j + 1);
    for (uint32_t j = n; j-- > 0;)
        for (uint32_t i = (j & ~1u) + 2; i < n; i++)
            subtract(e->g, v + j, e->lower[i * n + j], v[i]);
}

/* M and p - b in the new graph, where v stands for 0 */
static void carry_mass(elimination *e, const dm_model *m, const dm_node *hessian) {
    const uint32_t n = e->n;
    dm_graph *from = m->source.graph;
    dm_transplant(e->g, from, hessian, n * n, e->with, e->mass);
    dm_transplant(e->g, from, m->source.gradient + n, n, e->with, e->shift);
    for (uint32_t i = 0; i < n; i++) {
        const dm_node p = dm_input(e->g, n + i);
        e->shift[i] = dm_sub(e->g, p, e->shift[i]);
    }
}

static int write_out(elimination *e, const dm_model *m, const dm_node *hessian) {
    const uint32_t n = e->n;
    memset(e->with, 0, (2 * n + 1) * sizeof *e->with);
    for (uint32_t i = 0; i < n; i++) e->with[i] = dm_input(e->g, i);
    e->with[2 * n] = dm_input(e->g, 2 * n);
    carry_mass(e, m, hessian);
    if (!factor(e)) return 0;
    solve(e);
    memcpy(e->roots, e->shift, n * sizeof *e->roots);
    memcpy(e->with + n, e->shift, n * sizeof *e->with);
    dm_transplant(e->g, m->source.graph, m->source.gradient, n, e->with, e->roots + n);
    return dm_graph_status(e->g) == DM_OK;
}

uint32_t dm_hamilton_build(dm_kernel *out, const dm_model *m, uint32_t stages) {
    const uint32_t n = m->n;
    const dm_source *s = &m->source;
    if (!dm_hamilton_fits(m) || !s->compile) return 0;
    const size_t nn = (size_t)n * n;
    dm_node *memory = dm_arena_take(s->arena, (3 * nn + 6 * n + 1) * sizeof *memory);
    dm_graph *g = dm_graph_new(s->arena, 2 * n + 1);
    if (!memory || !g) return 0;
    elimination e = {.g = g, .n = n, .with = memory};
    dm_node *hessian = memory + 2 * n + 1;
    e.mass = hessian + nn;
    e.lower = e.mass + nn;
    e.shift = e.lower + nn;
    e.roots = e.shift + n;
    dm_jacobian(s->graph, s->gradient + n, n, n, n, hessian);
    if (dm_graph_status(s->graph) != DM_OK || !write_out(&e, m, hessian)) return 0;
    return dm_lanes_build(out, m, g, e.roots, 3 * n, stages);
}

/* L_q, the lower triangle of M and b, all in the model's graph; mass[n*n] of that graph */
static uint32_t build_force(dm_kernel *out, const dm_model *m, const dm_node *mass,
                            uint32_t stages) {
    const dm_source *s = &m->source;
    const uint32_t n = m->n, triangle = n * (n + 1) / 2,
                   inputs = dm_graph_inputs(s->graph);
    dm_node *roots = dm_arena_take(s->arena, (2 * n + triangle + inputs) * sizeof *roots);
    if (!roots) return 0;
    dm_node *with = roots + 2 * n + triangle;
    for (uint32_t i = 0; i < inputs; i++)
        with[i] = i >= n && i < 2 * n ? 0 : dm_input(s->graph, i);
    memcpy(roots, s->gradient, n * sizeof *roots);
    for (uint32_t i = 0, at = n; i < n; i++)
        for (uint32_t j = 0; j <= i; j++) roots[at++] = mass[i * n + j];
    dm_substitute(s->graph, s->gradient + n, n, with, roots + n + triangle);
    if (dm_graph_status(s->graph) != DM_OK) return 0;
    return dm_lanes_build(out, m, s->graph, roots, 2 * n + triangle, stages);
}

/* entries of M as inputs; constants and entries that are the same expression are known as such */
static void read_triangle(elimination *e, const dm_model *m, const dm_node *mass) {
    const uint32_t n = e->n;
    for (uint32_t i = 0, at = 0; i < n; i++)
        for (uint32_t j = 0; j <= i; j++, at++) {
            const dm_node x = mass[i * n + j];
            const dm_expr *expr = dm_graph_at(m->source.graph, x);
            dm_node *to = e->mass + i * n + j;
            *to = expr->op == DM_OP_CONSTANT ? dm_constant(e->g, expr->as.value)
                                             : dm_input(e->g, at);
            for (uint32_t k = 0; k < i; k++)
                for (uint32_t l = 0; l <= k; l++)
                    if (mass[k * n + l] == x) *to = e->mass[k * n + l];
        }
}

/* v and pivots from the triangle, b and p, which are inputs */
static uint32_t build_velocity(dm_kernel *out, const dm_model *m, const dm_node *mass,
                               uint32_t stages) {
    const uint32_t n = m->n, triangle = n * (n + 1) / 2;
    const size_t nn = (size_t)n * n;
    dm_node *memory = dm_arena_take(m->source.arena, (2 * nn + 4 * n) * sizeof *memory);
    dm_graph *g = dm_graph_new(m->source.arena, triangle + 2 * n);
    if (!memory || !g) return 0;
    elimination e = {.g = g, .n = n, .mass = memory, .lower = memory + nn};
    e.shift = e.lower + nn;
    e.roots = e.shift + n;
    read_triangle(&e, m, mass);
    for (uint32_t i = 0; i < n; i++) {
        const dm_node b = dm_input(g, triangle + i), p = dm_input(g, triangle + n + i);
        e.shift[i] = dm_sub(g, p, b);
    }
    if (!factor(&e)) return 0;
    solve(&e);
    memcpy(e.roots + n, e.shift, n * sizeof *e.roots); /* beside the pivots */
    if (dm_graph_status(g) != DM_OK) return 0;
    return dm_lanes_build(out, m, g, e.roots + n, 2 * n, stages);
}

uint32_t dm_hamilton_split(dm_kernel *force, dm_kernel *velocity, const dm_model *m,
                           uint32_t stages) {
    const dm_source *s = &m->source;
    const uint32_t n = m->n;
    if (!dm_hamilton_fits(m) || !s->compile) return 0;
    dm_node *mass = dm_arena_take(s->arena, (size_t)n * n * sizeof *mass);
    if (!mass) return 0;
    dm_jacobian(s->graph, s->gradient + n, n, n, n, mass);
    if (dm_graph_status(s->graph) != DM_OK) return 0;
    const uint32_t lanes = build_force(force, m, mass, stages);
    return lanes && build_velocity(velocity, m, mass, stages) == lanes ? lanes : 0;
}
