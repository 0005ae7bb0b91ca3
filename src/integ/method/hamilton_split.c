/* hamilton_split.c - Hamilton's equations of a mass that varies in three kernels: forces and M,
 * its factors, velocities. With them stages are found by sweeps where they would need Newton's
 * method.
 * Speed: P4: 43x by gauss(8), 2.8x by gauss(2). */
#include "algebra/derive.h"
#include "integ/method/elimination.h"
#include "integ/method/hamilton.h"

#include <string.h>

/* kernels in the making; `known` are nodes of `graph`: the lower triangle of M[n*n] by rows, then
 * b[n], as the last kernel gives them */
typedef struct {
    const dm_model *m;
    uint32_t stages;
    dm_graph *graph;
    dm_node *known;
} hamilton_parts;

/* the lower triangle by rows, and its place in the square */
static void unpack(dm_node *square, const dm_node *triangle, uint32_t n) {
    for (uint32_t i = 0; i < n; i++)
        for (uint32_t j = 0; j <= i; j++) square[i * n + j] = *triangle++;
}

/* And back. */
static void pack(dm_node *triangle, const dm_node *square, uint32_t n) {
    for (uint32_t i = 0; i < n; i++)
        for (uint32_t j = 0; j <= i; j++) *triangle++ = square[i * n + j];
}

/* the nodes from[count] of another graph as inputs to[count] of g; constants and equal nodes are
 * known as such */
static void read_inputs(dm_graph *g, dm_node *to, const dm_graph *other, const dm_node *from,
                        uint32_t count) {
    for (uint32_t i = 0; i < count; i++) {
        const dm_expr *x = dm_graph_at(other, from[i]);
        to[i] = x->op == DM_OP_CONSTANT ? dm_constant(g, x->as.value) : dm_input(g, i);
        for (uint32_t k = 0; k < i; k++)
            if (from[k] == from[i]) to[i] = to[k];
    }
}

/* M[n*n] = dp/dv and b[n], the momentum at v = 0, in the model's graph, whose velocities are
 * the inputs from n on */
static void split_momentum(dm_node *M, dm_node *b, const dm_model *m) {
    const uint32_t n = m->n;
    const dm_node *momentum = m->source.gradient + n;
    dm_graph *from = m->source.graph;
    const uint32_t inputs = dm_graph_inputs(from);
    dm_node *with = dm_arena_take(dm_graph_arena(from), inputs * sizeof *with);
    memset(M, 0, (size_t)n * n * sizeof *M);
    memset(b, 0, n * sizeof *b);
    if (!with) return;
    for (uint32_t i = 0; i < inputs; i++) with[i] = i >= n && i < 2 * n ? 0 : dm_input(from, i);
    dm_jacobian(from, momentum, n, n, n, M);
    dm_substitute(from, momentum, n, with, b);
}

/* L_q, the lower triangle of M and b, all in the model's graph */
static uint32_t build_force(dm_kernel *out, hamilton_parts *x) {
    const dm_source *s = &x->m->source;
    const uint32_t n = x->m->n, known = dm_hamilton_known(n);
    const size_t nn = (size_t)n * n;
    dm_node *roots = dm_arena_take(s->arena, (n + known + nn) * sizeof *roots);
    if (!roots) return 0;
    dm_node *M = roots + n + known;
    split_momentum(M, M - n, x->m);
    memcpy(roots, s->gradient, n * sizeof *roots);
    pack(roots + n, M, n);
    x->graph = s->graph;
    x->known = roots + n;
    if (dm_graph_status(s->graph) != DM_OK) return 0;
    return dm_lanes_build(out, x->m, s->graph, roots, n + known, x->stages);
}

/* M[n*n] of the elimination and b in place, from what the kernel of forces gives */
static void read_known(dm_elimination *e, dm_node *b, const hamilton_parts *x, dm_node *inputs) {
    const uint32_t n = e->n, known = dm_hamilton_known(n);
    read_inputs(e->g, inputs, x->graph, x->known, known);
    unpack(e->mass, inputs, n);
    memcpy(b, inputs + known - n, n * sizeof *b);
}

/* pivots, the triangle of factors and b, from the triangle of M and b */
static uint32_t build_factors(dm_kernel *out, hamilton_parts *x) {
    const uint32_t n = x->m->n, known = dm_hamilton_known(n), made = n + known;
    const size_t nn = (size_t)n * n;
    dm_arena *arena = x->m->source.arena;
    dm_node *roots = dm_arena_take(arena, (made + 2 * nn + known) * sizeof *roots);
    dm_graph *g = dm_graph_new(arena, known);
    if (!roots || !g) return 0;
    dm_elimination e = {.g = g, .n = n, .pivot = roots, .mass = roots + made};
    e.lower = e.mass + nn;
    read_known(&e, roots + made - n, x, e.lower + nn);
    if (!dm_elimination_factor(&e)) return 0;
    pack(roots + n, e.lower, n);
    x->graph = g;
    x->known = roots + n;
    if (dm_graph_status(g) != DM_OK) return 0;
    return dm_lanes_build(out, x->m, g, roots, made, x->stages);
}

/* v from the factors, b and p, which are inputs */
static uint32_t build_velocity(dm_kernel *out, const hamilton_parts *x) {
    const uint32_t n = x->m->n, known = dm_hamilton_known(n);
    const size_t nn = (size_t)n * n;
    dm_arena *arena = x->m->source.arena;
    dm_node *memory = dm_arena_take(arena, (nn + n + (size_t)known) * sizeof *memory);
    dm_graph *g = dm_graph_new(arena, known + n);
    if (!memory || !g) return 0;
    dm_elimination e = {.g = g, .n = n, .lower = memory, .shift = memory + nn};
    dm_node *inputs = e.shift + n;
    read_inputs(g, inputs, x->graph, x->known, known);
    unpack(e.lower, inputs, n);
    for (uint32_t i = 0; i < n; i++) {
        const dm_node p = dm_input(g, known + i);
        e.shift[i] = dm_sub(g, p, inputs[known - n + i]);
    }
    dm_elimination_solve(&e);
    if (dm_graph_status(g) != DM_OK) return 0;
    return dm_lanes_build(out, x->m, g, e.shift, n, x->stages);
}

/* Each kernel reads what the one before it gives, node for node; all of the same width or none. */
uint32_t dm_hamilton_split(dm_hamilton *out, const dm_model *m, uint32_t stages) {
    hamilton_parts x = {.m = m, .stages = stages};
    if (!dm_hamilton_fits(m) || !m->source.compile) return 0;
    const uint32_t lanes = build_force(&out->force, &x);
    if (lanes == 1) x.stages = 1; /* implicit functions have no lanes: then none */
    if (!lanes || build_factors(&out->factors, &x) != lanes) return 0;
    return build_velocity(&out->velocity, &x) == lanes ? lanes : 0;
}
