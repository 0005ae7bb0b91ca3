/* group.c - L in the chart g0 tau(xi): the traces of the group are joined with that of L in one
 * graph, whose derivatives are those of the natural chart (Leok 5.3.2). */
#include "mech/group_inside.h"

#include "algebra/body_sum.h"
#include "algebra/derive.h"
#include "code/loops/equal_parts.h"
#include "mech/constraints.h"

#include <string.h>

/* One more than asked for: none is empty. */
dm_node *dm_joining_take(const dm_joining *j, size_t count) {
    return dm_arena_take(j->arena, (count + 1) * sizeof(dm_node));
}

/* Nodes of all inputs; 0: no memory. */
static int lay_out(dm_joining *j) {
    const uint32_t n = j->n, d = j->d;
    j->q0 = dm_joining_take(j, n + 3 * (size_t)d);
    j->place = dm_joining_take(j, n + (size_t)d);
    j->slope = dm_joining_take(j, 3 * (size_t)d);
    j->extra = dm_joining_take(j, j->extras);
    if (!j->q0 || !j->place || !j->slope || !j->extra) return 0;
    j->xi = j->q0 + n;
    j->rate = j->xi + d;
    j->e = j->rate + d;
    dm_inputs(j->g, j->q0, 0, n + 2 * d);
    j->t = dm_input(j->g, n + 2 * d);
    dm_inputs(j->g, j->extra, n + 2 * d + 1, j->extras);
    dm_inputs(j->g, j->e, n + 2 * d + 1 + j->extras, d);
    return 1;
}

/* the element and its velocity */
static void join_chart(dm_joining *j) {
    dm_node *with = dm_joining_take(j, j->n + 3 * (size_t)j->d);
    if (!with) return;
    memcpy(with, j->q0, j->n * sizeof *with);
    memcpy(with + j->n, j->e, j->d * sizeof *with);
    memcpy(with + j->n + j->d, j->xi, 2 * j->d * sizeof *with);
    dm_transplant(j->g, j->trace->chart, j->trace->place, j->n + j->d, with, j->place);
}

/* without the element */
static dm_status begin(dm_joining *j, const dm_group *group, const dm_model *m, dm_tau tau,
                       uint32_t extras) {
    *j = (dm_joining){.m = m,
                      .trace = group->trace + tau,
                      .arena = m->source.arena,
                      .n = m->n,
                      .d = group->momenta,
                      .extras = extras};
    j->g = dm_graph_new(j->arena, j->n + 3 * j->d + 1 + extras);
    return j->g && lay_out(j) ? DM_OK : DM_NO_MEMORY;
}

dm_status dm_joining_open(dm_joining *j, const dm_group *group, const dm_model *m, dm_tau tau,
                          uint32_t extras) {
    const dm_status status = begin(j, group, m, tau, extras);
    if (status != DM_OK) return status;
    join_chart(j);
    return dm_graph_status(j->g);
}

/* What stands for xi are products. Those in exp, a series, are fused with 0, which compaction does
 * not take apart: high powers of a and of V overflow in units where those of a V do not. Those in
 * other tau are taken apart, since much of them cancels against V. */
dm_status dm_joining_open_line(dm_joining *j, const dm_group *group, const dm_model *m, dm_tau tau,
                               uint32_t extras, uint32_t a) {
    const dm_status status = begin(j, group, m, tau, extras);
    if (status != DM_OK) return status;
    j->a = dm_input(j->g, a);
    for (uint32_t i = 0; i < j->d; i++)
        j->xi[i] = tau == DM_TAU_EXP ? dm_multiply_add(j->g, j->a, j->rate[i], 0)
                                     : dm_mul(j->g, j->a, j->rate[i]);
    join_chart(j);
    if (tau == DM_TAU_EXP) memcpy(j->place + j->n, j->rate, j->d * sizeof *j->rate);
    return dm_graph_status(j->g);
}

dm_node *dm_joining_at_element(const dm_joining *j, uint32_t inputs) {
    const uint32_t n = j->n, d = j->d;
    const uint32_t room = inputs > 2 * n + 1 ? inputs : 2 * n + 1;
    dm_node *with = dm_joining_take(j, room);
    if (!with) return NULL;
    memset(with, 0, room * sizeof *with);
    memcpy(with, j->place, n * sizeof *with);
    memcpy(with + n, j->place + n, d * sizeof *with);
    with[2 * n] = j->t;
    return with;
}

/* dtau(xi)^T f of the left-trivialized differential, by one reverse sweep */
static int pull_back(const dm_joining *j, const dm_node *f, dm_node *out) {
    const uint32_t n = j->n, d = j->d;
    dm_graph *g = dm_graph_new(j->arena, 3 * d);
    dm_node *with = dm_joining_take(j, n + 3 * (size_t)d), *velocity = dm_joining_take(j, d);
    if (!g || !with || !velocity) return 0;
    memset(with, 0, (n + d) * sizeof *with);
    dm_inputs(g, with + n + d, 0, 2 * d);
    dm_transplant(g, j->trace->chart, j->trace->place + n, d, with, velocity);
    dm_node sum = 0;
    for (uint32_t a = 0; a < d; a++)
        sum = dm_add(g, sum, dm_mul(g, dm_input(g, 2 * d + a), velocity[a]));
    dm_gradient(g, sum, d, d, velocity);
    memcpy(with, j->xi, d * sizeof *with);
    memset(with + d, 0, d * sizeof *with);
    memcpy(with + 2 * d, f, d * sizeof *with);
    dm_transplant(j->g, g, velocity, d, with, out);
    return dm_graph_status(g) == DM_OK;
}

int dm_joining_covector(const dm_joining *j, const dm_node *f, dm_node *of_e, dm_node *of_xi) {
    const uint32_t n = j->n, d = j->d;
    dm_node *back = dm_joining_take(j, n + 2 * (size_t)d), *moved = dm_joining_take(j, d);
    if (!back || !moved) return 0;
    memset(back, 0, n * sizeof *back);
    for (uint32_t a = 0; a < d; a++) back[n + a] = dm_neg(j->g, j->xi[a]);
    memcpy(back + n + d, f, d * sizeof *back);
    dm_transplant(j->g, j->trace->end, j->trace->carried + n, d, back, moved);
    for (uint32_t a = 0; a < d; a++) of_e[a] = dm_add(j->g, of_e[a], moved[a]);
    if (!pull_back(j, f, moved)) return 0;
    for (uint32_t a = 0; a < d; a++) of_xi[a] = dm_add(j->g, of_xi[a], moved[a]);
    return 1;
}

/* f is added where it works; the last extra inputs are its controls, where there are any */
static int add_force(dm_joining *j) {
    const dm_constraints *c = j->m->constraints;
    const uint32_t n = j->n;
    if (!c || !c->forced) return 1;
    const uint32_t inputs = dm_graph_inputs(c->graph);
    dm_node *f = dm_joining_take(j, n), *with = dm_joining_at_element(j, inputs);
    if (!f || !with) return 0;
    if (j->extras >= c->controls)
        memcpy(with + inputs - c->controls, j->extra + j->extras - c->controls,
               c->controls * sizeof *with);
    dm_transplant(j->g, c->graph, c->f, n, with, f);
    return dm_joining_covector(j, f, j->slope, j->slope + j->d);
}

dm_graph *dm_group_graph(const dm_model *m) {
    const dm_source *s = &m->source;
    return s->graph || !s->sums || dm_sums(s->sums) ? s->graph : s->sums;
}

int dm_joining_slopes(dm_joining *j) {
    const uint32_t n = j->n, d = j->d, e = n + 2 * d + 1 + j->extras;
    dm_graph *from = dm_group_graph(j->m);
    dm_node L, *with = dm_joining_at_element(j, dm_graph_inputs(from));
    if (!with) return 0;
    dm_transplant(j->g, from, &j->m->source.lagrangian, 1, with, &L);
    dm_gradient(j->g, L, e, d, j->slope);
    dm_gradient(j->g, L, n, 2 * d, j->slope + d);
    return add_force(j);
}

/* by way of a graph with the inputs q[n], e[d] */
dm_status dm_group_directions(dm_node *X, dm_graph *g, const dm_chart_trace *exp, uint32_t n,
                              uint32_t d, dm_arena *arena) {
    dm_graph *about = dm_graph_new(arena, n + d);
    dm_node *with = dm_arena_take(arena, (n + 3 * (size_t)d) * sizeof *with);
    dm_node *place = dm_arena_take(arena, n * sizeof *place);
    dm_node *slope = dm_arena_take(arena, (size_t)n * d * sizeof *slope);
    if (!about || !with || !place || !slope) return DM_NO_MEMORY;
    dm_inputs(about, with, 0, n + d);
    memset(with + n + d, 0, 2 * d * sizeof *with); /* xi, rate */
    dm_transplant(about, exp->chart, exp->place, n, with, place);
    dm_jacobian(about, place, n, n, d, slope);
    dm_inputs(g, with, 0, n);
    memset(with + n, 0, d * sizeof *with);
    dm_transplant(g, about, slope, n * d, with, X);
    const dm_status status = dm_graph_status(about);
    return status == DM_OK ? dm_graph_status(g) : status;
}

/* in a graph without e */
static dm_status make_points(dm_joining *j, dm_group *out, dm_compile *compile) {
    const uint32_t n = j->n, d = j->d, inputs = n + 2 * d + 1;
    dm_graph *g = dm_graph_new(j->arena, inputs);
    dm_node *with = dm_joining_take(j, inputs + (size_t)d),
            *roots = dm_joining_take(j, 3 * (size_t)d);
    if (!g || !with || !roots) return DM_NO_MEMORY;
    dm_inputs(g, with, 0, inputs);
    memset(with + inputs, 0, d * sizeof *with);
    dm_transplant(g, j->g, j->slope, 3 * d, with, roots);
    return dm_group_map_make(&out->point, g, roots, 3 * d, n, 2 * d, compile, j->arena);
}

/* That of a force along V is a times its work on xi. */
int dm_joining_line_slopes(dm_joining *j) {
    const uint32_t n = j->n, d = j->d;
    dm_graph *from = dm_group_graph(j->m);
    dm_node L, *with = dm_joining_at_element(j, dm_graph_inputs(from));
    if (!with) return 0;
    dm_transplant(j->g, from, &j->m->source.lagrangian, 1, with, &L);
    dm_gradient(j->g, L, n + 2 * d + 1 + j->extras, d, j->slope);
    memset(j->slope + d, 0, d * sizeof *j->slope);
    dm_gradient(j->g, L, n + d, d, j->slope + 2 * d);
    if (!add_force(j)) return 0;
    for (uint32_t a = 0; a < d; a++) {
        const dm_node work = dm_mul(j->g, j->a, j->slope[d + a]);
        j->slope[d + a] = dm_add(j->g, j->slope[2 * d + a], work);
    }
    return 1;
}

/* in a graph without e */
static dm_status make_lines(const dm_model *m, dm_group *out, dm_tau tau, dm_compile *compile) {
    dm_joining j;
    const uint32_t n = m->n, d = out->momenta, inputs = n + 2 * d + 2;
    dm_status status = dm_joining_open_line(&j, out, m, tau, 1, n + 2 * d + 1);
    if (status != DM_OK) return status;
    dm_graph *g = dm_graph_new(j.arena, inputs);
    dm_node *with = dm_joining_take(&j, inputs + (size_t)d),
            *roots = dm_joining_take(&j, 2 * (size_t)d);
    if (!g || !with || !roots || !dm_joining_line_slopes(&j)) return DM_NO_MEMORY;
    dm_inputs(g, with, 0, inputs);
    memset(with + inputs, 0, d * sizeof *with);
    dm_transplant(g, j.g, j.slope, 2 * d, with, roots);
    status = dm_graph_status(j.g);
    if (status == DM_OK)
        status = dm_group_map_make(&out->line, g, roots, 2 * d, n + d, d, compile, j.arena);
    if (status == DM_OK) status = dm_joining_free(&j, out, compile);
    out->straight = status == DM_OK;
    return status;
}

/* dtau_R(xi)^T mu: since tau(-xi) = 1/tau(xi), the velocity of the chart at -xi is the other
 * trivialization */
dm_status dm_joining_pull(const dm_joining *j, dm_graph *last, dm_node *out) {
    const uint32_t n = j->n, d = j->d;
    dm_graph *g = dm_graph_new(j->arena, 3 * d);
    dm_node *with = dm_joining_take(j, n + 3 * (size_t)d), *velocity = dm_joining_take(j, d);
    dm_node *b = dm_joining_take(j, d);
    if (!g || !with || !velocity || !b) return DM_NO_MEMORY;
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
    dm_transplant(last, g, b, d, with, out);
    const dm_status status = dm_graph_status(g);
    return status != DM_OK ? status : dm_graph_status(last);
}

static dm_status make_pull(dm_joining *j, dm_group *out, dm_compile *compile) {
    const uint32_t d = j->d;
    dm_graph *g = dm_graph_new(j->arena, 2 * d);
    dm_node *roots = dm_joining_take(j, d);
    if (!g || !roots) return DM_NO_MEMORY;
    const dm_status status = dm_joining_pull(j, g, roots);
    if (status != DM_OK) return status;
    return dm_group_map_make(&out->pull, g, roots, d, 0, 2 * d, compile, j->arena);
}

/* a trace with the inputs q0[n], xi[d], mu[d] as a kernel, in a graph of its own, since compilers
 * may add nodes and the trace serves other models */
static dm_status make_end(const dm_joining *j, dm_graph *from, const dm_node *nodes, dm_kernel *out,
                          const uint32_t *body, uint32_t bodies, dm_compile *compile) {
    const uint32_t inputs = j->n + 2 * j->d, outputs = j->n + j->d + j->trace->arcs;
    dm_graph *g = dm_graph_new(j->arena, inputs);
    dm_node *with = dm_joining_take(j, inputs), *roots = dm_joining_take(j, outputs);
    if (!g || !with || !roots) return DM_NO_MEMORY;
    dm_inputs(g, with, 0, inputs);
    dm_transplant(g, from, nodes, outputs, with, roots);
    dm_status status = dm_graph_status(g);
    *out = (dm_kernel){0};
    if (status == DM_OK && body)
        status = dm_equal_parts_build(out, g, roots, outputs, body, bodies, compile, j->arena);
    return status == DM_OK && !out->eval ? compile(out, g, roots, outputs, j->arena) : status;
}

dm_status dm_joining_finish(const dm_joining *j, dm_kernel *out, const uint32_t *body,
                            uint32_t bodies, dm_compile *compile) {
    return make_end(j, j->trace->end, j->trace->carried, out, body, bodies, compile);
}

dm_status dm_joining_change(const dm_joining *j, dm_kernel *out, dm_compile *compile) {
    *out = (dm_kernel){0};
    if (!j->trace->change) return DM_OK;
    return make_end(j, j->trace->change, j->trace->changed, out, NULL, 0, compile);
}

/* What was made for another tau stays in the arena of the model. */
static dm_status make_ends(dm_joining *j, dm_group *out, dm_tau tau, dm_compile *compile) {
    out->ready = out->curved = out->straight = 0;
    dm_status status = make_pull(j, out, compile);
    if (status == DM_OK) status = dm_joining_finish(j, &out->finish, NULL, 0, compile);
    if (status == DM_OK) status = dm_joining_change(j, &out->change, compile);
    out->arcs = j->trace->arcs;
    out->tau = tau;
    out->ready = status == DM_OK;
    return status;
}

/* What is there already stays. */
dm_status dm_group_want(dm_group *out, const dm_model *m, dm_tau tau, int straight,
                        dm_compile *compile) {
    dm_joining j;
    const int ends = out->ready && out->tau == tau;
    if (ends && (straight ? out->straight : out->curved)) return DM_OK;
    dm_status status = dm_joining_open(&j, out, m, tau, 0);
    if (status == DM_OK && !ends) status = make_ends(&j, out, tau, compile);
    if (status != DM_OK || straight)
        return status == DM_OK ? make_lines(m, out, tau, compile) : status;
    if (!dm_joining_slopes(&j)) return DM_NO_MEMORY;
    status = dm_graph_status(j.g);
    if (status == DM_OK) status = make_points(&j, out, compile);
    out->curved = status == DM_OK;
    return status;
}
