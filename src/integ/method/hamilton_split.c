#include "integ/method/hamilton_inside.h"

#include "algebra/derive.h"

#include <string.h>

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

uint32_t dm_hamilton_known(const dm_model *m) {
    const dm_extremum *e = dm_split_extremum(m);
    return dm_known(m->n + (e ? 1 : 0));
}

void dm_split_momentum(dm_node *M, dm_node *b, dm_graph *from, const dm_node *momentum, uint32_t n,
                       uint32_t wide) {
    const uint32_t inputs = dm_graph_inputs(from);
    dm_node *with = dm_arena_take(dm_graph_arena(from), inputs * sizeof *with);
    memset(M, 0, (size_t)wide * wide * sizeof *M);
    memset(b, 0, wide * sizeof *b);
    if (!with) return;
    for (uint32_t i = 0; i < inputs; i++) with[i] = i >= n && i < n + wide ? 0 : dm_input(from, i);
    dm_jacobian(from, momentum, wide, n, wide, M);
    dm_substitute(from, momentum, wide, with, b);
}

/* L_q, the lower triangle of M and b, all in the model's graph */
static uint32_t build_force(dm_kernel *out, dm_splitting *x) {
    const dm_source *s = &x->m->source;
    const uint32_t n = x->m->n, known = dm_known(n);
    const size_t nn = (size_t)n * n;
    dm_node *roots = dm_arena_take(s->arena, (n + known + nn) * sizeof *roots);
    if (!roots) return 0;
    dm_node *M = roots + n + known;
    dm_split_momentum(M, M - n, s->graph, s->gradient + n, n, n);
    memcpy(roots, s->gradient, n * sizeof *roots);
    dm_pack(roots + n, M, n);
    x->wide = n;
    x->graph = s->graph;
    x->known = roots + n;
    if (dm_graph_status(s->graph) != DM_OK) return 0;
    return dm_lanes_build(out, x->m, s->graph, roots, n + known, x->stages);
}

/* M[n*n] of the elimination and b in place, from what the kernel of forces gives */
static void read_known(dm_elimination *e, dm_node *b, const dm_splitting *x, dm_node *inputs) {
    const uint32_t n = e->n, wide = x->wide;
    dm_node *M = inputs + dm_known(wide);
    read_inputs(e->g, inputs, x->graph, x->known, dm_known(wide));
    dm_unpack(M, inputs, wide);
    dm_node *all = inputs + dm_known(wide) - wide;
    if (wide > n) e->scale = dm_split_eliminate(e->g, M, all, n);
    memcpy(b, all, n * sizeof *b);
    for (uint32_t i = 0; i < n; i++)
        memcpy(e->mass + i * (size_t)n, M + i * (size_t)wide, n * sizeof *M);
}

/* pivots, the triangle of factors and b, from the triangle of M and b */
static uint32_t build_factors(dm_kernel *out, dm_splitting *x) {
    const uint32_t n = x->m->n, wide = x->wide, known = dm_known(wide);
    const uint32_t made = n + dm_known(n);
    const size_t nn = (size_t)n * n, square = (size_t)wide * wide;
    dm_arena *arena = x->m->source.arena;
    dm_node *roots = dm_arena_take(arena, (made + 2 * nn + known + square) * sizeof *roots);
    dm_graph *g = dm_graph_new(arena, known);
    if (!roots || !g) return 0;
    dm_elimination e = {.g = g, .n = n, .pivot = roots, .mass = roots + made};
    e.lower = e.mass + nn;
    read_known(&e, roots + made - n, x, e.lower + nn);
    if (!dm_elimination_factor(&e)) return 0;
    dm_pack(roots + n, e.lower, n);
    x->wide = n;
    x->graph = g;
    x->known = roots + n;
    if (dm_graph_status(g) != DM_OK) return 0;
    return dm_lanes_build(out, x->m, g, roots, made, x->stages);
}

/* v from the factors, b and p, which are inputs */
static uint32_t build_velocity(dm_kernel *out, const dm_splitting *x) {
    const uint32_t n = x->m->n, known = dm_known(n);
    const size_t nn = (size_t)n * n;
    dm_arena *arena = x->m->source.arena;
    dm_node *memory = dm_arena_take(arena, (nn + n + (size_t)known) * sizeof *memory);
    dm_graph *g = dm_graph_new(arena, known + n);
    if (!memory || !g) return 0;
    dm_elimination e = {.g = g, .n = n, .lower = memory, .shift = memory + nn};
    dm_node *inputs = e.shift + n;
    read_inputs(g, inputs, x->graph, x->known, known);
    dm_unpack(e.lower, inputs, n);
    for (uint32_t i = 0; i < n; i++) {
        const dm_node p = dm_input(g, known + i);
        e.shift[i] = dm_sub(g, p, inputs[known - n + i]);
    }
    dm_elimination_solve(&e);
    if (dm_graph_status(g) != DM_OK) return 0;
    return dm_lanes_build(out, x->m, g, e.shift, n, x->stages);
}

uint32_t dm_hamilton_split(dm_hamilton *out, const dm_model *m, uint32_t stages) {
    dm_splitting x = {.m = m, .stages = stages};
    if (!dm_hamilton_fits(m) || !m->source.compile) return 0;
    const dm_extremum *e = dm_split_extremum(m);
    uint32_t lanes = e ? dm_split_extremum_force(&out->force, &x, e) : 0;
    if (!lanes) lanes = build_force(&out->force, &x);
    if (lanes == 1) x.stages = 1; /* implicit functions have no lanes: then none */
    if (!lanes || build_factors(&out->factors, &x) != lanes) return 0;
    return build_velocity(&out->velocity, &x) == lanes ? lanes : 0;
}
