/* group.c - L in the chart g0 tau(xi): the traces of the group are joined with that of L in one
 * graph, whose derivatives are those of the natural chart (Leok 5.3.2). */
#include "mech/group.h"

#include "algebra/derive.h"
#include "mech/constraints.h"

#include <string.h>

/* inputs of the joined graph: q0[n], xi[d], rate[d], t, e[d] */
typedef struct {
    const dm_model *m;
    const dm_chart_trace *trace;
    dm_arena *arena;
    dm_graph *g;
    uint32_t n, d;
    dm_node *q0, *xi, *rate, *e; /* inputs */
    dm_node t;
    dm_node *place; /* [n] coordinates of the element, [d] its velocity */
    dm_node *slope; /* [3d] L_e, L_xi, L_rate */
} joining;

/* One more than asked for: none is empty. */
static dm_node *take(const joining *j, size_t count) {
    return dm_arena_take(j->arena, (count + 1) * sizeof(dm_node));
}

/* Nodes of all inputs; 0: no memory. */
static int lay_out(joining *j) {
    const uint32_t n = j->n, d = j->d;
    j->q0 = take(j, n + 3 * (size_t)d);
    j->place = take(j, n + (size_t)d);
    j->slope = take(j, 3 * (size_t)d);
    if (!j->q0 || !j->place || !j->slope) return 0;
    j->xi = j->q0 + n;
    j->rate = j->xi + d;
    j->e = j->rate + d;
    dm_inputs(j->g, j->q0, 0, n + 2 * d);
    j->t = dm_input(j->g, n + 2 * d);
    dm_inputs(j->g, j->e, n + 2 * d + 1, d);
    return 1;
}

/* the element and its velocity */
static void join_chart(joining *j) {
    dm_node *with = take(j, j->n + 3 * (size_t)j->d);
    if (!with) return;
    memcpy(with, j->q0, j->n * sizeof *with);
    memcpy(with + j->n, j->e, j->d * sizeof *with);
    memcpy(with + j->n + j->d, j->xi, 2 * j->d * sizeof *with);
    dm_transplant(j->g, j->trace->chart, j->trace->place, j->n + j->d, with, j->place);
}

/* inputs (q, v, t) of L at the element, zeros behind the velocity, for a graph of so many inputs */
static dm_node *at_element(const joining *j, uint32_t inputs) {
    const uint32_t n = j->n, d = j->d;
    dm_node *with = take(j, inputs > 2 * n + 1 ? inputs : 2 * n + 1);
    if (!with) return NULL;
    memset(with, 0, (inputs > 2 * n + 1 ? inputs : 2 * n + 1) * sizeof *with);
    memcpy(with, j->place, n * sizeof *with);
    memcpy(with + n, j->place + n, d * sizeof *with);
    with[2 * n] = j->t;
    return with;
}

/* f is added where it works: on e by way of the adjoint action of 1/tau(xi), on xi by dtau */
static int add_force(joining *j) {
    const dm_constraints *c = j->m->constraints;
    const uint32_t n = j->n, d = j->d;
    if (!c || !c->forced) return 1;
    dm_node *f = take(j, n), *with = at_element(j, dm_graph_inputs(c->graph));
    dm_node *back = take(j, n + 2 * (size_t)d), *moved = take(j, d), *slope = take(j, d);
    if (!f || !with || !back || !moved || !slope) return 0;
    dm_transplant(j->g, c->graph, c->f, n, with, f);
    memset(back, 0, n * sizeof *back);
    for (uint32_t a = 0; a < d; a++) back[n + a] = dm_neg(j->g, j->xi[a]);
    memcpy(back + n + d, f, d * sizeof *back);
    dm_transplant(j->g, j->trace->end, j->trace->carried + n, d, back, moved);
    for (uint32_t a = 0; a < d; a++) j->slope[a] = dm_add(j->g, j->slope[a], moved[a]);
    for (uint32_t a = 0; a < d; a++) {
        dm_gradient(j->g, j->place[n + a], n + d, d, slope);
        for (uint32_t b = 0; b < d; b++)
            j->slope[d + b] = dm_add(j->g, j->slope[d + b], dm_mul(j->g, f[a], slope[b]));
    }
    return 1;
}

/* L_e, L_xi, L_rate, with e still an input */
static int differentiate(joining *j) {
    const uint32_t n = j->n, d = j->d;
    dm_node L, *with = at_element(j, dm_graph_inputs(j->m->source.graph));
    if (!with) return 0;
    dm_transplant(j->g, j->m->source.graph, &j->m->source.lagrangian, 1, with, &L);
    dm_gradient(j->g, L, n + 2 * d + 1, d, j->slope);
    dm_gradient(j->g, L, n, 2 * d, j->slope + d);
    return add_force(j);
}

/* in a graph without e */
static dm_status make_slopes(joining *j, dm_group *out, dm_compile *compile) {
    const uint32_t n = j->n, d = j->d, inputs = n + 2 * d + 1;
    dm_graph *g = dm_graph_new(j->arena, inputs);
    dm_node *with = take(j, inputs + (size_t)d), *roots = take(j, 3 * (size_t)d * (2 * d + 1));
    if (!g || !with || !roots) return DM_NO_MEMORY;
    dm_inputs(g, with, 0, inputs);
    memset(with + inputs, 0, d * sizeof *with);
    dm_transplant(g, j->g, j->slope, 3 * d, with, roots);
    dm_jacobian(g, roots, 3 * d, n, 2 * d, roots + 3 * d);
    dm_status status = dm_graph_status(g);
    if (status == DM_OK) status = compile(&out->slope, g, roots, 3 * d, j->arena);
    if (status == DM_OK) status = compile(&out->curve, g, roots, 3 * d * (2 * d + 1), j->arena);
    return status;
}

/* dtau_R(xi)^T mu: since tau(-xi) = 1/tau(xi), the velocity of the chart at -xi is the other
 * trivialization */
static dm_status make_pull(joining *j, dm_group *out, dm_compile *compile) {
    const uint32_t n = j->n, d = j->d;
    dm_graph *g = dm_graph_new(j->arena, 3 * d), *last = dm_graph_new(j->arena, 2 * d);
    dm_node *with = take(j, n + 3 * (size_t)d), *velocity = take(j, d);
    dm_node *b = take(j, d), *roots = take(j, (size_t)d * (2 * d + 1));
    if (!g || !last || !with || !velocity || !b || !roots) return DM_NO_MEMORY;
    memset(with, 0, (n + d) * sizeof *with);
    for (uint32_t a = 0; a < d; a++) {
        with[n + d + a] = dm_neg(g, dm_input(g, a));
        with[n + 2 * d + a] = dm_input(g, 2 * d + a);
    }
    dm_transplant(g, j->trace->chart, j->trace->place + n, d, with, velocity);
    dm_node sum = 0;
    for (uint32_t a = 0; a < d; a++)
        sum = dm_add(g, sum, dm_mul(g, dm_input(g, d + a), velocity[a]));
    dm_gradient(g, sum, 2 * d, d, b);
    dm_inputs(last, with, 0, 2 * d);
    memset(with + 2 * d, 0, d * sizeof *with);
    dm_transplant(last, g, b, d, with, roots);
    dm_jacobian(last, roots, d, 0, 2 * d, roots + d);
    const dm_status status = dm_graph_status(g);
    if (status != DM_OK || dm_graph_status(last) != DM_OK)
        return status != DM_OK ? status : dm_graph_status(last);
    return compile(&out->pull, last, roots, d * (2 * d + 1), j->arena);
}

/* in a graph of its own, since compilers may add nodes and the trace serves other models */
static dm_status make_finish(joining *j, dm_group *out, dm_compile *compile) {
    const uint32_t inputs = j->n + 2 * j->d, outputs = j->n + j->d + j->trace->arcs;
    dm_graph *g = dm_graph_new(j->arena, inputs);
    dm_node *with = take(j, inputs), *roots = take(j, outputs);
    if (!g || !with || !roots) return DM_NO_MEMORY;
    dm_inputs(g, with, 0, inputs);
    dm_transplant(g, j->trace->end, j->trace->carried, outputs, with, roots);
    const dm_status status = dm_graph_status(g);
    return status == DM_OK ? compile(&out->finish, g, roots, outputs, j->arena) : status;
}

/* What was made for another tau stays in the arena of the model. */
dm_status dm_group_want(dm_group *out, const dm_model *m, dm_tau tau, dm_compile *compile) {
    const dm_chart_trace *trace = out->trace + tau;
    joining j = {.m = m,
                 .trace = trace,
                 .arena = m->source.arena,
                 .n = m->n,
                 .d = out->momenta,
                 .g = dm_graph_new(m->source.arena, m->n + 3 * out->momenta + 1)};
    if (out->ready && out->tau == tau) return DM_OK;
    out->ready = 0;
    if (!j.g || !lay_out(&j)) return DM_NO_MEMORY;
    join_chart(&j);
    if (!differentiate(&j)) return DM_NO_MEMORY;
    dm_status status = dm_graph_status(j.g);
    if (status == DM_OK) status = make_slopes(&j, out, compile);
    if (status == DM_OK) status = make_pull(&j, out, compile);
    if (status == DM_OK) status = make_finish(&j, out, compile);
    if (status != DM_OK) return status;
    out->arcs = trace->arcs;
    out->tau = tau;
    out->ready = 1;
    return DM_OK;
}
