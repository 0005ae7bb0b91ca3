/* bind_trial.c - spaces of curves as rules: their options, and their curve traced for the system
 * that it is stepped on. What is said in Lua of them stands in lua/dm/trial. */
#include "algebra/derive.h"
#include "bind/core/state.h"
#include "bind/model/bind_system.h"
#include "bind/rule/bind_rule.h"
#include "bind/trace/backend.h"
#include "integ/multiscale/filon.h"
#include "integ/trial/trial.h"

#include <math.h>
#include <string.h>

enum { MOST = 400, FIRST_PARAMETER = 3 };

/* what is made for one system */
typedef struct {
    dm_trial_kernels k;
    double frequency;
    dm_arena *arena;
    dm_compile *compile;
} maker;

/* Raise what a kernel of the curve could not be made for. */
static void check_status(lua_State *L, dm_status status) {
    if (status != DM_OK) luaL_error(L, "a space of curves: %s", dm_status_text(status));
}

/* Nodes in the arena of the kernels. */
static dm_node *take(lua_State *L, const maker *made, size_t count) {
    dm_node *nodes = dm_arena_take(made->arena, count * sizeof *nodes);
    if (!nodes) luaL_error(L, "not enough memory");
    return nodes;
}

/* qdot[n] = dq/dt + w dq/dphase */
static void velocities(lua_State *L, const maker *made, dm_graph *g, const dm_node *q,
                       dm_node *out) {
    const uint32_t n = made->k.n;
    dm_node *by_phase = take(L, made, n);
    dm_jacobian(g, q, n, 0, 1, out);
    dm_jacobian(g, q, n, 1, 1, by_phase);
    const dm_node w = dm_constant(g, made->frequency);
    for (uint32_t i = 0; i < n; i++) out[i] = dm_add(g, out[i], dm_mul(g, w, by_phase[i]));
}

/* second[K*K] of l . (q, qdot); 1: all of it is zero */
static int curvature(lua_State *L, const maker *made, dm_graph *g, const dm_node *q,
                     dm_node *second) {
    const uint32_t n = made->k.n, K = made->k.parameters;
    dm_node sum = dm_constant(g, 0.0), *gradient = take(L, made, K);
    double value;
    int zero = 1;
    for (uint32_t i = 0; i < 2 * n; i++)
        sum = dm_add(g, sum, dm_mul(g, dm_input(g, FIRST_PARAMETER + K + i), q[i]));
    dm_hessian(g, sum, FIRST_PARAMETER, K, gradient, second);
    for (uint32_t i = 0; i < K * K; i++)
        zero &= dm_is_constant(g, second[i], &value) && value == 0.0;
    return zero;
}

/* the kernel of a point from the function at `fn` */
static void build_point(lua_State *L, maker *made, int fn) {
    const uint32_t n = made->k.n, K = made->k.parameters, width = 2 * n + 2 * n * K;
    const dml_signature s = {.what = "the curve",
                             .arguments = 5,
                             .length = {DML_SCALAR_ARGUMENT, DML_SCALAR_ARGUMENT,
                                        DML_SCALAR_ARGUMENT, (int)K, (int)(2 * n)},
                             .outputs = (int)n};
    dml_traced t;
    dml_trace(L, fn, &s, made->arena, &t);
    dm_node *nodes = take(L, made, width + (size_t)K * K);
    memcpy(nodes, t.out, n * sizeof *nodes);
    velocities(L, made, t.graph, nodes, nodes + n);
    dm_jacobian(t.graph, nodes, 2 * n, FIRST_PARAMETER, K, nodes + 2 * n);
    made->k.linear = curvature(L, made, t.graph, nodes, nodes + width);
    check_status(L, dm_graph_status(t.graph));
    check_status(L, made->compile(&made->k.point, t.graph, nodes,
                                  width + (made->k.linear ? 0 : K * K), made->arena));
}

/* the kernel of a first guess from the function at `fn` */
static void build_start(lua_State *L, maker *made, int fn) {
    const int n = (int)made->k.n;
    const dml_signature s = {.what = "'start'",
                             .arguments = 3,
                             .length = {n, n, DML_SCALAR_ARGUMENT},
                             .outputs = (int)made->k.parameters};
    dml_traced t;
    dml_trace(L, fn, &s, made->arena, &t);
    check_status(L, made->compile(&made->k.start, t.graph, t.out, t.outputs, made->arena));
}

/* push curve and start (or nil) of the options of the rule at `object` */
static void push_curve(lua_State *L, int object, int system, double h) {
    lua_getglobal(L, "require");
    lua_pushliteral(L, "dm.trial.space");
    lua_call(L, 1, 1);
    lua_getfield(L, -1, "curve");
    lua_remove(L, -2);
    lua_getiuservalue(L, object, 1);
    lua_getiuservalue(L, -1, 1);
    lua_remove(L, -2);
    lua_pushvalue(L, system);
    lua_pushnumber(L, h);
    lua_call(L, 3, 2);
}

/* dml_rule.bring: the curve is traced for this system and length of step, which the checks of
 * functions want. What keeps the kernels stays on the stack. */
static const void *bring(lua_State *L, int object, int system, const char *backend, double h) {
    object = lua_absindex(L, object);
    system = lua_absindex(L, system);
    const dml_system *s = dml_checksystem(L, system);
    const dml_rule *rule = dml_torule(L, object);
    const dm_trial_row *row = rule->rule.data;
    if (s->pair || s->placed)
        luaL_error(L, "a space of curves steps a dm.system on free coordinates");
    maker *made = lua_newuserdatauv(L, sizeof *made, 1);
    *made = (maker){.k = {.n = s->n, .parameters = dm_trial_parameters(row, s->n)},
                    .frequency = row->frequency,
                    .compile = dml_findbackend(L, backend)->compile};
    made->arena = dml_pusharena(L);
    lua_setiuservalue(L, -2, 1);
    push_curve(L, object, system, h);
    build_point(L, made, lua_gettop(L) - 1);
    if (!lua_isnil(L, -1)) build_start(L, made, lua_gettop(L));
    lua_pop(L, 2);
    return &made->k;
}

/* numbers of the list in field `key` as nodes or weights */
static int read_list(lua_State *L, const char *key, long double *out) {
    double x[DM_QUADRATURE_NODES];
    lua_getfield(L, 1, key);
    const int count = (int)dml_length(L, -1);
    lua_pop(L, 1);
    if (count < 1 || count > DM_QUADRATURE_NODES)
        luaL_error(L, "field '%s' must be a list of 1 to %d numbers", key, DM_QUADRATURE_NODES);
    dml_numbers(L, 1, key, x, (uint32_t)count);
    for (int i = 0; i < count; i++) out[i] = (long double)x[i];
    return count;
}

/* field `named` is the name of a quadrature; else nodes and weights */
static void read_quadrature(lua_State *L, dm_quadrature *q) {
    dm_rule nodes[DM_RULE_NODES];
    if (!dml_field(L, 1, "named")) {
        lua_pop(L, 1);
        q->r = read_list(L, "nodes", q->c);
        if (read_list(L, "weights", q->b) != q->r)
            luaL_error(L, "fields 'nodes' and 'weights' must have as many numbers");
        return;
    }
    const char *text = luaL_checkstring(L, -1), *wrong = dm_rule_parse(nodes, text);
    const dm_quadrature_row *row = wrong ? NULL : dm_quadrature_find(nodes[0].name);
    const double r = wrong ? 0.0 : nodes[0].arg[0].number;
    if (!row || nodes[0].count != 1 || nodes[0].arg[0].rule || r != floor(r) || r < row->least ||
        r > DM_QUADRATURE_NODES)
        luaL_error(L,
                   "unknown quadrature '%s': gauss(r), lobatto(r), radau(r), radau-left(r), "
                   "clenshaw-curtis(r) with 1 to %d nodes (lobatto and clenshaw-curtis: from 2), { "
                   "nodes =, weights = }, or { \"gauss(4)\", pieces = 5 }",
                   text, DM_QUADRATURE_NODES);
    row->fill(q, (int)r);
    lua_pop(L, 1);
}

/* On the stack, with room for a user value: Lua aligns to 8 bytes, a long double wants 16. */
static dm_trial_row *new_row(lua_State *L) {
    const size_t step = _Alignof(dm_trial_row);
    char *memory = lua_newuserdatauv(L, sizeof(dm_trial_row) + step, 1);
    return (dm_trial_row *)(void *)(memory + (step - (uintptr_t)memory % step) % step);
}

/* Everything else in the options is for Lua, which reads them again when the rule meets a system.
 */
static int trial_rule(lua_State *L) {
    lua_settop(L, 1);
    luaL_checktype(L, 1, LUA_TTABLE);
    dm_trial_row *row = new_row(L);
    *row = (dm_trial_row){.each = (uint32_t)dml_count(L, 1, "each", 0, 0),
                          .parameters = (uint32_t)dml_count(L, 1, "parameters", 0, 0),
                          .pieces = (uint32_t)dml_count(L, 1, "pieces", 1, 1),
                          .phases = (uint32_t)dml_count(L, 1, "phases", 0, 0),
                          .frequency = dml_number(L, 1, "frequency", 0.0)};
    read_quadrature(L, &row->q);
    if (row->parameters > MOST || row->each > MOST || row->pieces > MOST || row->phases > MOST)
        luaL_error(L, "a space of curves has at most %d parameters, pieces and phases", MOST);
    lua_pushvalue(L, 1);
    lua_setiuservalue(L, -2, 1);
    lua_getfield(L, 1, "text");
    const char *text = luaL_checkstring(L, -1);
    lua_insert(L, -2);
    dml_pushrule(L, "trial", row, text)->bring = bring;
    return 1;
}

/* (options with named, or nodes and weights) -> nodes, weights */
static int quadrature(lua_State *L) {
    dm_quadrature q;
    lua_settop(L, 1);
    luaL_checktype(L, 1, LUA_TTABLE);
    read_quadrature(L, &q);
    double *c = dml_pushvector(L, (uint32_t)q.r), *b = dml_pushvector(L, (uint32_t)q.r);
    for (int i = 0; i < q.r; i++) c[i] = (double)q.c[i], b[i] = (double)q.b[i];
    return 2;
}

/* (options with named or nodes, z) -> re, im, nodes */
static int filon(lua_State *L) {
    dm_quadrature q;
    lua_settop(L, 2);
    luaL_checktype(L, 1, LUA_TTABLE);
    const double z = dml_checknumber(L, 2);
    luaL_argcheck(L, isfinite(z), 2, "z must be finite");
    read_quadrature(L, &q);
    if (q.r > DM_FILON_NODES)
        luaL_error(L,
                   "dm.filon: at most %d nodes (got %d): the moments of more are not "
                   "distinguished in double precision",
                   DM_FILON_NODES, q.r);
    double *re = dml_pushvector(L, (uint32_t)q.r), *im = dml_pushvector(L, (uint32_t)q.r);
    dm_filon_weights(re, im, &q, z);
    double *c = dml_pushvector(L, (uint32_t)q.r);
    for (int i = 0; i < q.r; i++) c[i] = (double)q.c[i];
    return 3;
}

static const dml_row functions[] = {
    {"trial_rule", trial_rule,
     "core.trial_rule{text=, each= | parameters=, named= | nodes=, weights=, pieces=, phases=, "
     "frequency=} -> dm.rule\n"
     "A space of curves as a rule: `each` parameters for every coordinate, or `parameters` in all, "
     "and its quadrature; lua/dm/trial/space.lua makes the curve from the other options."},
    {"quadrature", quadrature,
     "core.quadrature{named= | nodes=, weights=} -> dm.vector, dm.vector\n"
     "Nodes in [0, 1] and weights of a quadrature. Raises for a name that there is not."},
    {"filon_weights", filon,
     "core.filon_weights({named= | nodes=, weights=}, z) -> dm.vector, dm.vector, dm.vector\n"
     "Real and imaginary parts of the weights of dm.filon, and the nodes."},
    {NULL, NULL, NULL}};

const dml_class dml_class_trial = {
    .functions = functions,
};
