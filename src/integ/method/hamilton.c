#include "integ/method/hamilton.h"

#include "algebra/compact.h"
#include "algebra/contract.h"
#include "algebra/derive.h"
#include "algebra/implicit.h"
#include "code/native/jit.h"
#include "integ/method/elimination.h"
#include "mech/constraints.h"

#include <string.h>

/* Products are written out, hence few coordinates; a degenerate L has no M to eliminate. */
int dm_hamilton_fits(const dm_model *m) {
    return m->source.graph && m->n <= DM_HAMILTON_LARGEST && (m->structure & DM_QUADRATIC_IN_V) &&
           !(m->structure & DM_LINEAR_IN_V);
}

/* As it stands: vectors as wide as there are stages for, else one at a time. */
static uint32_t build_lanes(dm_kernel *out, const dm_model *m, dm_graph *g, const dm_node *roots,
                            uint32_t count, uint32_t stages) {
    const dm_source *s = &m->source;
    const uint32_t most = s->compile == dm_native_build ? dm_jit_lanes() : 1;
    const uint32_t lanes = stages > 4 && most >= 8 ? 8 : stages > 1 && most >= 4 ? 4 : 1;
    if (!g || dm_graph_status(g) != DM_OK) return 0;
    if (lanes > 1 && dm_jit_build_lanes(out, g, roots, count, lanes, s->arena) == DM_OK)
        return lanes;
    return s->compile(out, g, roots, count, s->arena) == DM_OK ? 1 : 0;
}

/* Products are contracted before the kernel is made. */
uint32_t dm_lanes_build_compacted(dm_kernel *out, const dm_model *m, dm_graph *g,
                                  const dm_node *roots, uint32_t count, uint32_t stages) {
    dm_node *small = dm_arena_take(m->source.arena, count * sizeof *small);
    if (!small || dm_graph_status(g) != DM_OK) return 0;
    g = dm_contract_all(g, roots, count, small);
    return build_lanes(out, m, g, small, count, stages);
}

/* Implicit functions are left alone: each sweep waits for the one before. */
uint32_t dm_lanes_build(dm_kernel *out, const dm_model *m, dm_graph *g, const dm_node *roots,
                        uint32_t count, uint32_t stages) {
    dm_node *small = dm_arena_take(m->source.arena, count * sizeof *small);
    if (!small || dm_graph_status(g) != DM_OK) return 0;
    if (dm_has_roots(g, roots, count)) /* each sweep waits for the one before */
        return build_lanes(out, m, g, roots, count, stages);
    g = dm_compact_graph(g, roots, count, small);
    return g ? dm_lanes_build_compacted(out, m, g, small, count, stages) : 0;
}

/* what the kernel is made of, in a graph of its own */
typedef struct {
    dm_elimination e;
    dm_node *with;  /* [2n+1] what stands for q, v, t */
    dm_node *roots; /* [3n] v, L_q, pivots */
} writing;

/* M and p - b in the new graph, where v stands for 0 */
static void carry_mass(writing *w, const dm_model *m, const dm_node *hessian) {
    dm_elimination *e = &w->e;
    const uint32_t n = e->n;
    dm_graph *from = m->source.graph;
    dm_transplant(e->g, from, hessian, n * n, w->with, e->mass);
    dm_transplant(e->g, from, m->source.gradient + n, n, w->with, e->shift);
    for (uint32_t i = 0; i < n; i++) {
        const dm_node p = dm_input(e->g, n + i);
        e->shift[i] = dm_sub(e->g, p, e->shift[i]);
    }
}

/* f(q, v, t) of a model that has a force is added to L_q, with v as it stands in `with`; 0: no
 * memory */
static int add_force(writing *w, const dm_model *m) {
    const dm_constraints *constraints = m->constraints;
    const uint32_t n = m->n;
    if (!constraints || !constraints->forced) return 1;
    const uint32_t inputs = dm_graph_inputs(constraints->graph);
    dm_node *with = dm_arena_take(m->source.arena, (inputs + n) * sizeof *with);
    if (!with) return 0;
    memset(with, 0, inputs * sizeof *with);
    memcpy(with, w->with, (2 * n + 1) * sizeof *with);
    dm_transplant(w->e.g, constraints->graph, constraints->f, n, with, with + inputs);
    for (uint32_t i = 0; i < n; i++)
        w->roots[n + i] = dm_add(w->e.g, w->roots[n + i], with[inputs + i]);
    return 1;
}

/* v by elimination, then L_q at that v in the same graph, so that they share what they can. */
static int write_out(writing *w, const dm_model *m, const dm_node *hessian) {
    dm_elimination *e = &w->e;
    const uint32_t n = e->n;
    memset(w->with, 0, (2 * n + 1) * sizeof *w->with);
    for (uint32_t i = 0; i < n; i++) w->with[i] = dm_input(e->g, i);
    w->with[2 * n] = dm_input(e->g, 2 * n);
    carry_mass(w, m, hessian);
    if (!dm_elimination_factor(e)) return 0;
    dm_elimination_solve(e);
    memcpy(w->roots, e->shift, n * sizeof *w->roots);
    memcpy(w->with + n, e->shift, n * sizeof *w->with);
    dm_transplant(e->g, m->source.graph, m->source.gradient, n, w->with, w->roots + n);
    return add_force(w, m) && dm_graph_status(e->g) == DM_OK;
}

/* The Hessian is made in the graph of the model, everything else in one of its own. */
uint32_t dm_hamilton_build(dm_kernel *out, const dm_model *m, uint32_t stages) {
    const uint32_t n = m->n;
    const dm_source *s = &m->source;
    if (!dm_hamilton_fits(m) || !s->compile) return 0;
    const size_t nn = (size_t)n * n;
    dm_node *memory = dm_arena_take(s->arena, (3 * nn + 6 * n + 1) * sizeof *memory);
    dm_graph *g = dm_graph_new(s->arena, 2 * n + 1);
    if (!memory || !g) return 0;
    dm_node *hessian = memory + 2 * n + 1, *roots = hessian + 3 * nn + n;
    writing w = {.with = memory, .roots = roots};
    w.e = (dm_elimination){.g = g,
                           .n = n,
                           .mass = hessian + nn,
                           .lower = hessian + 2 * nn,
                           .shift = hessian + 3 * nn,
                           .pivot = roots + 2 * n};
    dm_jacobian(s->graph, s->gradient + n, n, n, n, hessian);
    if (dm_graph_status(s->graph) != DM_OK || !write_out(&w, m, hessian)) return 0;
    return dm_lanes_build(out, m, g, roots, 3 * n, stages);
}
