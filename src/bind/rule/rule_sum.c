#include "bind/rule/rule_sum.h"

#include "algebra/derive.h"
#include "base/random.h"
#include "bind/core/state.h"
#include "bind/rule/bind_step.h"
#include "code/tape/tape.h"
#include "integ/curve/curve.h"
#include "integ/curve/curve_choice.h"
#include "integ/curve/curve_recipe.h"
#include "integ/method/stage_table.h"
#include "integ/split/splitting.h"
#include "integ/trial/trial.h"

#include <math.h>

enum { POINTS = 12 };

/* count numbers of list `which`, each with a weight; 1 of what is no number */
static double weighted(uint64_t which, const double *x, size_t count) {
    double sum = 0.0;
    for (size_t i = 0; i < count; i++)
        sum += (1 + dm_random_uniform(8, which, (uint32_t)i)) *
               (isfinite(x[i]) ? x[i] / (1 + fabs(x[i])) : 1.0);
    return sum;
}

/* of a kernel whose inputs `first` and `second` are times: not negative; x[inputs + outputs] */
static double values(const dm_kernel *k, uint64_t which, size_t first, size_t second, double *x) {
    double sum = 0.0;
    if (k->outputs) dm_kernel_prepare(k, x + k->inputs);
    for (uint32_t p = 0; p < POINTS && k->outputs; p++) {
        for (uint32_t i = 0; i < k->inputs; i++)
            x[i] = (1 << p % 4) * (2 * dm_random_uniform(9, p, i) - 1); /* up to 1, 2, 4, 8 */
        x[first] = fabs(x[first]);
        x[second] = fabs(x[second]);
        dm_kernel_eval(k, x, x + k->inputs);
        sum += weighted(which + p, x + k->inputs, k->outputs);
    }
    return sum;
}

/* room for its inputs and outputs, on the stack */
static double *room(lua_State *L, const dm_kernel *k) {
    return lua_newuserdatauv(L, ((size_t)k->inputs + k->outputs + 1) * sizeof(double), 0);
}

/* curves in a space of one's own: nodes, weights, and the functions at (t, phase, h, ...) */
static double of_trial(lua_State *L, const dm_trial_row *row, const dm_trial_kernels *k) {
    double x[2 * DM_QUADRATURE_NODES + 3] = {row->pieces, row->phases, row->frequency};
    size_t count = 3;
    for (int i = 0; i < row->q.r; i++) {
        x[count++] = (double)row->q.c[i];
        x[count++] = (double)row->q.b[i];
    }
    double sum = weighted(0, x, count) + values(&k->point, 100, 0, 2, room(L, &k->point));
    if (k->start.outputs)
        sum += values(&k->start, 200, k->start.inputs - 1, k->start.inputs - 1, room(L, &k->start));
    return sum;
}

/* of a graph, which stays as it is: its inputs are x[at], h and more */
static double of_graph(lua_State *L, uint64_t which, dm_graph *from, const dm_node *out,
                       uint32_t at, uint32_t count) {
    dm_kernel k = {.outputs = 0};
    const uint32_t inputs = dm_graph_inputs(from);
    dm_arena *arena = dml_pusharena(L);
    dm_graph *g = dm_graph_new(arena, inputs);
    dm_node *with = dm_arena_take(arena, inputs * sizeof *with);
    dm_node *roots = dm_arena_take(arena, count * sizeof *roots);
    if (!g || !with || !roots) luaL_error(L, "the rule: %s", dm_status_text(DM_NO_MEMORY));
    dm_inputs(g, with, 0, inputs);
    dm_transplant(g, from, out, count, with, roots);
    dm_status status = dm_graph_status(g);
    if (status == DM_OK) status = dm_tape_build(&k, g, roots, count, arena);
    if (status != DM_OK) luaL_error(L, "the rule: %s", dm_status_text(status));
    return values(&k, which, at, at, room(L, &k));
}

/* the methods that have names are told by them */
static double of_curve(lua_State *L, const dm_curve *c) {
    dm_curve named;
    const dm_curve_recipe *r = c->recipe;
    if (!c->choice && dm_curve_find(&named, c->name)) return 1.0;
    double sum = c->bias + c->s + 3.0 * c->substeps;
    for (int i = 0; i < c->s; i++) {
        const size_t s = (size_t)c->s, place = 12 * (size_t)i;
        sum += weighted(place, c->a[i], s) + weighted(place + 1, c->push[i], s) +
               weighted(place + 2, c->lift[i], s);
        sum += weighted(place + 3,
                        (double[]){c->plus[i], c->minus[i], c->weight[i], c->plus_lift[i],
                                   c->minus_lift[i], c->arrival[i], c->departure[i], c->c[i]},
                        8);
    }
    if (r) {
        uint32_t outputs = 2 * r->n;
        for (int i = 0; i < r->calls; i++)
            outputs += (2 * r->n + 1) * (1 + (uint32_t)r->directions[i]); /* curve_recipe.h */
        sum += of_graph(L, 300, r->graph, r->out, 2 * r->n, outputs);
    }
    if (c->choice)
        sum += of_graph(L, 400, c->choice->graph, c->choice->out, 2 * c->choice->n,
                        (uint32_t)c->choice->outputs);
    return sum;
}

/* nodes and quadrature, and a tableau that is not of them */
static double of_stages(const dm_galerkin *g) {
    double x[DM_STAGE_KEY] = {0};
    const uint32_t count = dm_stage_key(x, g);
    double sum = weighted(500, x, count);
    for (int i = 0; g->tableau && i < g->s * g->s; i++) {
        x[0] = (double)g->a[i / g->s][i % g->s];
        sum += weighted(600 + (uint64_t)i, x, 1);
    }
    return sum;
}

/* a rule of a table of numbers: stages, or kicks and drifts where it is none */
static double of_table(const dm_rule *rule) {
    dm_galerkin g = {.s = 0};
    dm_splitting kicks = {.stages = 0};
    if (rule->method->basis) rule->method->basis(&g, rule);
    double sum = g.s ? of_stages(&g) : 0.0;
    if (rule->method->splitting && rule->method->splitting(&kicks, rule))
        sum += weighted(700, kicks.b, (size_t)kicks.stages + 1) +
               weighted(701, kicks.a, (size_t)kicks.stages);
    return sum;
}

double dml_rule_sum(lua_State *L, int at, const dm_rule *rule, const void *brought) {
    const int top = lua_gettop(L);
    double sum = 1.0;
    if (rule->method == &dm_method_trial)
        sum = of_trial(L, rule->data, brought);
    else if (rule->method->traits & DM_OF_FUNCTIONS)
        sum = dml_step_sum(L, at, rule->method);
    else if (rule->method->engine == &dm_engine_curve && rule->data)
        sum = of_curve(L, rule->data);
    else if (rule->data)
        sum = of_table(rule);
    lua_settop(L, top);
    return sum;
}
