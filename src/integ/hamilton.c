#include "integ/hamilton.h"

#include "expr/compact.h"
#include "expr/contract.h"
#include "expr/derive.h"
#include "expr/implicit.h"
#include "expr/jit.h"
#include "mech/ties.h"

#include <string.h>

/* nodes of the new graph; M = l D l^T with blocks of two (the last may be one), det = a c - b^2 of each:
** half as many divisions wait for each other as with single pivots */
typedef struct {
    dm_graph *g;
    uint32_t n;
    dm_node *with;          /* [2n+1] what stands for q, v, t */
    dm_node *mass, *shift;  /* [n*n], [n]: M and what is left of it, p - b and then v */
    dm_node *lower, *roots; /* [n*n] rows of l, and D^-1 in the blocks; [3n] v, L_q,
                               pivots: leading minors of the blocks */
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
    dm_node *small = dm_arena_take(s->arena, count * sizeof *small);
    if (!small || dm_graph_status(g) != DM_OK) return 0;
    if (!dm_has_roots(g, roots, count)) { /* each sweep waits for the one before */
        g = dm_compact_graph(g, roots, count, small);
        g = g ? dm_contract_all(g, small, count, small) : NULL;
        roots = small;
    }
    if (!g) return 0;
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

/* rows of the block at j */
static uint32_t rows_at(const elimination *e, uint32_t j) {
    return j + 1 < e->n ? 2 : 1;
}

/* (x[0], x[1]) = D^-1 (x[0], x[1]) for the block at j, where that has two rows */
static void divide(const elimination *e, uint32_t j, dm_node *x) {
    const dm_node *D = e->lower + j * (size_t)e->n + j;
    if (rows_at(e, j) == 1) {
        x[0] = dm_mul(e->g, D[0], x[0]);
        return;
    }
    const dm_node a = D[0], b = D[e->n], c = D[e->n + 1];
    const dm_node first = dm_mul(e->g, a, x[0]), second = dm_mul(e->g, c, x[1]);
    const dm_node to_first = dm_mul(e->g, b, x[1]), to_second = dm_mul(e->g, b, x[0]);
    x[0] = dm_add(e->g, first, to_first);
    x[1] = dm_add(e->g, to_second, second);
}

/* pivots and D^-1 of the block at j; 0 at a pivot that vanishes everywhere */
static int invert(elimination *e, uint32_t j) {
    const uint32_t n = e->n;
    const dm_node *M = e->mass + j * (size_t)n + j;
    dm_node *D = e->lower + j * (size_t)n + j, *pivot = e->roots + 2 * n + j;
    pivot[0] = M[0];
    if (!pivot[0]) return 0;
    if (rows_at(e, j) == 1) {
        const dm_node one = dm_constant(e->g, 1.0);
        D[0] = dm_div(e->g, one, pivot[0]);
        return 1;
    }
    pivot[1] = cross(e->g, M[0], M[n + 1], M[n], M[n]);
    if (!pivot[1]) return 0;
    const dm_node b = dm_neg(e->g, M[n]);
    D[0] = dm_div(e->g, M[n + 1], pivot[1]);
    D[n] = dm_div(e->g, b, pivot[1]);
    D[n + 1] = dm_div(e->g, M[0], pivot[1]);
    return 1;
}

/* the block at j, its rows of l, and what is left of M below */
static int eliminate(elimination *e, uint32_t j) {
    const uint32_t n = e->n, wide = rows_at(e, j);
    dm_node *M = e->mass;
    if (!invert(e, j)) return 0;
    for (uint32_t i = j + wide; i < n; i++) {
        dm_node *l = e->lower + i * n + j;
        memcpy(l, M + i * n + j, wide * sizeof *l);
        divide(e, j, l);
        for (uint32_t k = j + wide; k <= i; k++)
            for (uint32_t w = 0; w < wide; w++)
                subtract(e->g, M + i * n + k, l[w], M[k * n + j + w]);
    }
    return 1;
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
    for (uint32_t j = 0; j < n; j += 2) divide(e, j, v + j);
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

/* f(q, v, t) of a model that has a force is added to L_q, with v as it stands in `with`; 0: no memory */
static int add_force(elimination *e, const dm_model *m) {
    const dm_ties *ties = m->ties;
    const uint32_t n = e->n;
    if (!ties || !ties->forced) return 1;
    const uint32_t inputs = dm_graph_inputs(ties->graph);
    dm_node *with = dm_arena_take(m->source.arena, (inputs + n) * sizeof *with);
    if (!with) return 0;
    memset(with, 0, inputs * sizeof *with);
    memcpy(with, e->with, (2 * n + 1) * sizeof *with);
    dm_transplant(e->g, ties->graph, ties->f, n, with, with + inputs);
    for (uint32_t i = 0; i < n; i++)
        e->roots[n + i] = dm_add(e->g, e->roots[n + i], with[inputs + i]);
    return 1;
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
    return add_force(e, m) && dm_graph_status(e->g) == DM_OK;
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

/* the nodes from[count] of another graph as inputs to[count] of g; constants and equal nodes are known as such */
static void read_inputs(dm_graph *g, dm_node *to, const dm_graph *other,
                        const dm_node *from, uint32_t count) {
    for (uint32_t i = 0; i < count; i++) {
        const dm_expr *x = dm_graph_at(other, from[i]);
        to[i] = x->op == DM_OP_CONSTANT ? dm_constant(g, x->as.value) : dm_input(g, i);
        for (uint32_t k = 0; k < i; k++)
            if (from[k] == from[i]) to[i] = to[k];
    }
}

/* the lower triangle by rows, and its place in the square */
static void unpack(dm_node *square, const dm_node *triangle, uint32_t n) {
    for (uint32_t i = 0; i < n; i++)
        for (uint32_t j = 0; j <= i; j++) square[i * n + j] = *triangle++;
}

static void pack(dm_node *triangle, const dm_node *square, uint32_t n) {
    for (uint32_t i = 0; i < n; i++)
        for (uint32_t j = 0; j <= i; j++) *triangle++ = square[i * n + j];
}

/* the three kernels of dm_hamilton_split; known: what the last one gave, triangle or its factors, and b */
typedef struct {
    const dm_model *m;
    uint32_t stages, triangle;
    dm_graph *graph; /* of what is known */
    dm_node *known;
} splitting;

/* L_q, the lower triangle of M and b, all in the model's graph */
static uint32_t build_force(dm_kernel *out, splitting *x, const dm_node *mass) {
    const dm_source *s = &x->m->source;
    const uint32_t n = x->m->n, inputs = dm_graph_inputs(s->graph);
    dm_node *roots =
        dm_arena_take(s->arena, (2 * n + x->triangle + inputs) * sizeof *roots);
    if (!roots) return 0;
    dm_node *with = roots + 2 * n + x->triangle;
    for (uint32_t i = 0; i < inputs; i++)
        with[i] = i >= n && i < 2 * n ? 0 : dm_input(s->graph, i);
    memcpy(roots, s->gradient, n * sizeof *roots);
    pack(roots + n, mass, n);
    dm_substitute(s->graph, s->gradient + n, n, with, roots + n + x->triangle);
    x->graph = s->graph;
    x->known = roots + n;
    if (dm_graph_status(s->graph) != DM_OK) return 0;
    return dm_lanes_build(out, x->m, s->graph, roots, 2 * n + x->triangle, x->stages);
}

/* pivots, the triangle of factors and b again, from the triangle of M and b */
static uint32_t build_factors(dm_kernel *out, splitting *x) {
    const uint32_t n = x->m->n, known = x->triangle + n;
    const size_t nn = (size_t)n * n;
    dm_arena *arena = x->m->source.arena;
    dm_node *memory =
        dm_arena_take(arena, (2 * nn + 2 * n + 2 * (n + (size_t)known)) * sizeof *memory);
    dm_graph *g = dm_graph_new(arena, known);
    if (!memory || !g) return 0;
    elimination e = {.g = g, .n = n, .mass = memory, .lower = memory + nn};
    e.roots = memory + 2 * nn; /* with pivots behind 2n others */
    dm_node *roots = e.roots + 2 * n, *inputs = roots + n + known;
    read_inputs(g, inputs, x->graph, x->known, known);
    unpack(e.mass, inputs, n);
    if (!factor(&e)) return 0;
    pack(roots + n, e.lower, n);
    memcpy(roots + n + x->triangle, inputs + x->triangle, n * sizeof *roots);
    x->graph = g;
    x->known = roots + n;
    if (dm_graph_status(g) != DM_OK) return 0;
    return dm_lanes_build(out, x->m, g, roots, n + known, x->stages);
}

/* v from the factors, b and p, which are inputs */
static uint32_t build_velocity(dm_kernel *out, const splitting *x) {
    const uint32_t n = x->m->n, known = x->triangle + n;
    const size_t nn = (size_t)n * n;
    dm_arena *arena = x->m->source.arena;
    dm_node *memory = dm_arena_take(arena, (nn + n + (size_t)known) * sizeof *memory);
    dm_graph *g = dm_graph_new(arena, known + n);
    if (!memory || !g) return 0;
    elimination e = {.g = g, .n = n, .lower = memory, .shift = memory + nn};
    dm_node *inputs = e.shift + n;
    read_inputs(g, inputs, x->graph, x->known, known);
    unpack(e.lower, inputs, n);
    for (uint32_t i = 0; i < n; i++) {
        const dm_node p = dm_input(g, known + i);
        e.shift[i] = dm_sub(g, p, inputs[x->triangle + i]);
    }
    solve(&e);
    if (dm_graph_status(g) != DM_OK) return 0;
    return dm_lanes_build(out, x->m, g, e.shift, n, x->stages);
}

uint32_t dm_hamilton_split(dm_hamilton *out, const dm_model *m, uint32_t stages) {
    const dm_source *s = &m->source;
    const uint32_t n = m->n;
    splitting x = {.m = m, .stages = stages, .triangle = n * (n + 1) / 2};
    if (!dm_hamilton_fits(m) || !s->compile) return 0;
    dm_node *mass = dm_arena_take(s->arena, (size_t)n * n * sizeof *mass);
    if (!mass) return 0;
    dm_jacobian(s->graph, s->gradient + n, n, n, n, mass);
    if (dm_graph_status(s->graph) != DM_OK) return 0;
    const uint32_t lanes = build_force(&out->force, &x, mass);
    if (!lanes || build_factors(&out->factors, &x) != lanes) return 0;
    return build_velocity(&out->velocity, &x) == lanes ? lanes : 0;
}
