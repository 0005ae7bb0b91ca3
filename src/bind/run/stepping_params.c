/* stepping_params.c - a run steps the model whose parameters are inputs where its rule can. */
#include "bind/run/stepping.h"

#include "bind/model/model_params.h"

#include "integ/split/splitting.h"

#include <math.h>
#include <string.h>

/* the rule makes kicks and drifts of this model */
static int takes_inputs(const dml_stepping *r) {
    const dm_model *model = &r->model->model;
    return dm_rule_engine(r->solver->nodes, model) == &dm_engine_splitting && !r->model->callback &&
           dml_issplit(model);
}

/* (system, model with inputs) -> does L do what it did when the model was traced? Raises what L
 * raises. */
static int trace_again(lua_State *L) {
    const dml_model *m = lua_touserdata(L, 2);
    const dml_signature sig = dml_withsignature(m->n, m->params);
    dml_traced traced;
    lua_getiuservalue(L, 2, 4);
    dml_pushwith(L, 1, -1);
    const int fn = lua_gettop(L);
    dml_retrace(L, fn, &sig, dml_pusharena(L), &m->trace, &traced);
    const int same = traced.graph == m->graph;
    if (same) dml_sparearena(L, fn + 1);
    lua_pushboolean(L, same);
    return 1;
}

/* have the parameters the values that they had when *m was traced, whose names are on top of the
 * stack and dropped? */
static int has_values(lua_State *L, int system, const dml_model *m) {
    double now[DML_MOST_PARAMS];
    dml_readparams(L, system, now);
    return memcmp(now, m->values, m->params * sizeof *now) == 0;
}

/* Is the model on top of the stack, with inputs, still that of L? Where the parameters are what
 * they were, it is, for the trace of L with numbers is the same; other values may show what
 * these hid: g in 1 + (k - 1) g, where k was 1. */
static int is_current(lua_State *L, const dml_stepping *r) {
    lua_getiuservalue(L, -1, 4);
    if (has_values(L, r->system, lua_touserdata(L, -2)) && !r->varied) return 1;
    lua_pushcfunction(L, trace_again);
    lua_pushvalue(L, r->system);
    lua_pushvalue(L, -3);
    const int current = dml_try(L, 2, 1) && lua_toboolean(L, -1);
    lua_pop(L, 1);
    return current;
}

/* push what the model keeps: the one with inputs, false where there is none */
static void push_kept(lua_State *L, const dml_stepping *r) {
    const int kept = lua_getiuservalue(L, r->model_at, 4);
    if (kept != LUA_TNIL && (kept != LUA_TUSERDATA || is_current(L, r))) return;
    lua_pop(L, 1);
    if (!dml_pushinputs(L, r->system)) {
        lua_pop(L, 1);
        lua_pushboolean(L, 0);
    }
    lua_pushvalue(L, -1);
    lua_setiuservalue(L, r->model_at, 4);
}

/* User value 4 of the model with inputs; of one without: nil. */
void dml_pushnames(lua_State *L, const dml_stepping *r) {
    lua_getiuservalue(L, r->model_at, 4);
    lua_getiuservalue(L, -1, 4);
    lua_remove(L, -2);
}

/* r->given holds (q, v, t, values) for as long as what is left on the stack. */
void dml_stepping_inputs(lua_State *L, dml_stepping *r) {
    if (r->numbers || !takes_inputs(r)) return;
    push_kept(L, r);
    dml_model *m = lua_touserdata(L, -1);
    if (!m) return lua_pop(L, 1);
    m->compile = r->model->compile;
    r->inputs = m;
    const uint32_t first = 2 * m->n + 1;
    r->given = lua_newuserdatauv(L, (first + m->params) * sizeof(double), 0);
    lua_getiuservalue(L, -2, 4);
    dml_readparams(L, r->system, r->given + first);
}

/* L by both kernels at x: tracing changes round-off only, `==` on a parameter would change more.
 * Where it is no number, only the start tells. */
static int agrees_at(const dml_stepping *r, const double *x, int is_start) {
    const dm_kernel *with = &r->inputs->model.value, *plain = &r->model->model.value;
    double a = 0.0, b = 0.0;
    dm_kernel_prepare(with, &a);
    dm_kernel_eval(with, x, &a);
    dm_kernel_prepare(plain, &b);
    dm_kernel_eval(plain, x, &b);
    if (!isfinite(a) || !isfinite(b)) return !is_start || a == b || (a != a && b != b);
    return fabs(a - b) <= 1e-8 * fmax(fabs(a), fabs(b));
}

/* the start at rest, or (k > 0) a point around it */
static void make_point(const dml_stepping *r, double *x, uint32_t k) {
    const uint32_t n = r->model->n;
    memcpy(x, r->state, n * sizeof *x);
    memset(x + n, 0, n * sizeof *x);
    x[2 * n] = r->t0;
    for (uint32_t i = 0; k && i <= 2 * n; i++)
        x[i] += 0.1 * (1 + fabs(x[i])) * sin(12.9898 * (k * (2 * n + 1) + i));
}

/* Not at the start alone: in an equilibrium many an L has the same value. */
int dml_stepping_agrees(dml_stepping *r) {
    enum { POINTS = 3 };
    int same = 1;
    for (uint32_t k = 0; same && k <= POINTS; k++) {
        make_point(r, r->given, k);
        same = agrees_at(r, r->given, k == 0);
    }
    return same;
}
