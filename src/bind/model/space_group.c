/* space_group.c - systems on groups: calls of lua/dm/group/place.lua and starts.lua, where
 * elements become flat coordinates and back. */
#include "bind/model/space_group.h"
#include "bind/core/state.h"
#include "bind/model/bind_space.h"
#include "bind/trace/backend.h"
#include "integ/method/lift.h"
#include "integ/registry.h"

#include <string.h>

/* function `name` of a module of Lua */
static void push_function(lua_State *L, const char *module, const char *name) {
    lua_getglobal(L, "require");
    lua_pushstring(L, module);
    lua_call(L, 1, 1);
    lua_getfield(L, -1, name);
    lua_remove(L, -2);
}
static void push_module(lua_State *L, const char *name) {
    push_function(L, "dm.group.place", name);
}

/* Spheres are unfolded before. */
void dml_unfold_group(lua_State *L) {
    lua_getfield(L, 1, "Q");
    const dml_space *Q = luaL_testudata(L, -1, "dm.space");
    lua_pop(L, 1);
    if (!Q || Q->chart) {
        lua_pushnil(L);
        return;
    }
    push_module(L, "unfold");
    lua_pushvalue(L, 1);
    lua_call(L, 1, 2);
    lua_insert(L, -2);
    lua_replace(L, 1);
}

/* What reads an L of elements finds it as if it had been given. */
void dml_place_lagrangian(lua_State *L, int place) {
    const int top = lua_gettop(L);
    lua_getfield(L, 1, "H");
    lua_getfield(L, 1, "L");
    if (!lua_isnil(L, -1) && !lua_isnil(L, -2)) {
        lua_getfield(L, place, "given");
        push_module(L, "on_elements");
        lua_pushvalue(L, place);
        lua_call(L, 1, 1);
        lua_setfield(L, -2, "L");
    }
    lua_settop(L, top);
}

/* a whole number among the fields of the place on top */
static uint32_t field(lua_State *L, const char *key, uint32_t otherwise) {
    if (!lua_istable(L, -1)) return otherwise;
    lua_getfield(L, -1, key);
    const lua_Integer value = lua_tointeger(L, -1);
    lua_pop(L, 1);
    return (uint32_t)value;
}

/* Of velocities and momenta; n where the place is nil. */
uint32_t dml_place_dimension(lua_State *L, uint32_t n) {
    return field(L, "dimension", n);
}

/* Of flat coordinates. */
uint32_t dml_place_size(lua_State *L, uint32_t n) {
    return field(L, "size", n);
}

/* Told by the userdata alone. */
int dml_placed(lua_State *L, int arg) {
    return dml_checksystem(L, arg)->placed;
}

/* A copy takes their place; what is wrong is raised at the line of the script. */
void dml_place_options(lua_State *L, int arg, int options, const char *how) {
    if (!dml_placed(L, arg)) return;
    arg = lua_absindex(L, arg), options = lua_absindex(L, options);
    push_function(L, "dm.group.starts", "ask");
    lua_pushstring(L, how);
    dml_systemfield(L, arg, "place");
    lua_pushvalue(L, options);
    lua_call(L, 3, 2);
    if (!lua_toboolean(L, -2)) luaL_error(L, "%s", lua_tostring(L, -1));
    lua_replace(L, options);
    lua_pop(L, 1);
}

/* how(place, f) in place of f on top: f is written for elements, and sees coordinates. */
void dml_place_function(lua_State *L, int arg, const char *how) {
    if (!dml_placed(L, arg)) return;
    const int f = lua_gettop(L);
    arg = lua_absindex(L, arg);
    push_module(L, how);
    dml_systemfield(L, arg, "place");
    lua_pushvalue(L, f);
    lua_call(L, 2, 1);
    lua_replace(L, f);
}

/* The kit makes the element when somebody asks for it. */
void dml_pushposition(lua_State *L, int arg, const double *q) {
    const uint32_t n = dml_checksystem(L, arg)->n;
    arg = lua_absindex(L, arg);
    memcpy(dml_pushvector(L, n), q, n * sizeof *q);
    if (!dml_placed(L, arg)) return;
    dml_systemfield(L, arg, "place");
    lua_getfield(L, -1, "element");
    lua_pushvalue(L, -3);
    lua_call(L, 1, 1);
    lua_replace(L, -3);
    lua_pop(L, 1);
}

/* Elements are made row by row: this is for plots and tests. */
int dml_place_column(lua_State *L, int arg, const char *name) {
    if (!dml_placed(L, arg)) return 0;
    arg = lua_absindex(L, arg);
    push_module(L, "column");
    dml_systemfield(L, arg, "place");
    lua_pushvalue(L, 1);
    lua_pushstring(L, name);
    lua_call(L, 3, 1);
    if (!lua_isnil(L, -1)) return 1;
    lua_pop(L, 1);
    return 0;
}

/* Of the group itself, of others that act, of a generator (lua/dm/group/momentum.lua). */
int dml_place_momentum(lua_State *L, int arg) {
    arg = lua_absindex(L, arg);
    lua_getglobal(L, "require");
    lua_pushliteral(L, "dm.group.momentum");
    lua_call(L, 1, 1);
    lua_getfield(L, -1, "momentum");
    lua_remove(L, -2);
    dml_systemfield(L, arg, "place");
    for (int i = 1; i <= 3; i++) lua_pushvalue(L, i);
    lua_call(L, 4, 1);
    return 1;
}

/* ---- the homogeneous lift ---- */

/* functions rates and momenta at fn and fn + 1 */
static void trace_homogeneous(lua_State *L, const dml_system *s, int fn, dm_arena *arena,
                              dm_homogeneous *out) {
    const int N = (int)s->n;
    const dml_signature signature = {.what = "coordinates of a group",
                                     .arguments = 2,
                                     .length = {N, N}};
    dml_traced traced;
    dml_trace(L, fn, &signature, arena, &traced);
    out->rates = traced.graph;
    out->rate = traced.out;
    out->scales = traced.outputs - s->n - s->momenta;
    dml_trace(L, fn + 1, &signature, arena, &traced);
    out->momenta = traced.graph;
    out->momentum = traced.out;
}

/* The traces of the place, made when a rule first asks for them; nothing where its coordinates are
 * not homogeneous. */
static void place_homogeneous(lua_State *L, int arg, dm_homogeneous *out) {
    const int top = lua_gettop(L);
    dml_systemfield(L, arg, "place");
    if (lua_getfield(L, -1, "homogeneous") == LUA_TNIL) {
        dm_homogeneous *made = lua_newuserdatauv(L, sizeof *made, 1);
        memset(made, 0, sizeof *made);
        dm_arena *arena = dml_pusharena(L);
        lua_setiuservalue(L, -2, 1);
        push_module(L, "homogeneous");
        lua_pushvalue(L, top + 1);
        lua_call(L, 1, 2);
        if (!lua_isnil(L, -2))
            trace_homogeneous(L, dml_checksystem(L, arg), lua_gettop(L) - 1, arena, made);
        lua_settop(L, top + 3);
        lua_setfield(L, top + 1, "homogeneous");
        lua_getfield(L, top + 1, "homogeneous");
    }
    *out = *(const dm_homogeneous *)lua_touserdata(L, -1);
    lua_settop(L, top);
}

/* The model, or kernels of it that are missing. */
static void want_homogeneous(lua_State *L, dml_model *m, unsigned want, const char *backend) {
    dm_compile *compile = dml_findbackend(L, dml_arenalost(m->arena) ? "tape" : backend)->compile;
    if (m->compile) m->model.source.cache = &m->cache;
    const dm_status status = dm_group_homogeneous(&m->group, &m->model, want, compile);
    if (status == DM_TOO_LARGE)
        luaL_error(L,
                   "the system in coordinates of the group has more than %d operations: too many "
                   "to trace; lie(s) needs far fewer",
                   DM_GRAPH_LIMIT);
    if (status != DM_OK)
        luaL_error(L, "the system in coordinates of the group: %s", dm_status_text(status));
}

/* The homogeneous lift with the kernels that the rule asks for, where it is the one to step;
 * complete: none is left for later. */
static void lift_homogeneous(lua_State *L, int arg, dml_model *m, const dm_rule *rule,
                             const char *backend, int complete) {
    const dm_model *now = dm_lifted_model(rule, &m->model);
    if (now && now == m->group.lifted) return;
    if (!m->group.homogeneous.rates) place_homogeneous(L, arg, &m->group.homogeneous);
    if (!m->group.homogeneous.rates) return;
    want_homogeneous(L, m, 0, backend);
    now = m->group.homogeneous.lifted;
    if (dm_rule_fits(rule, now)) return;
    unsigned want = dm_rule_engine(rule, now)->wants(rule, now);
    if (complete && want & DM_WANT_STAGE_LATER) want |= DM_WANT_STAGE;
    want_homogeneous(L, m, want | (now->structure & DM_HAMILTONIAN ? DM_WANT_FIELD : DM_WANT_MASS),
                     backend);
}

/* L is quadratic in xi, with a mass that can be inverted */
static int has_lift(const dml_model *m) {
    const unsigned structure = m->model.structure;
    if (structure & DM_CONSTANT_MASS && !m->model.inverse_mass) return 0;
    return m->graph && structure & (DM_QUADRATIC_IN_V | DM_HAMILTONIAN);
}

/* Rules of coordinates step the lift, where there is one. */
void dml_refuse_group(lua_State *L, int arg, dml_model *model, const dm_rule *rule,
                      const char *backend, int complete) {
    luaL_Buffer b;
    const char *separator = "";
    if (rule->method->traits & (DM_ON_GROUPS | DM_OF_FUNCTIONS | DM_OWN_TIME)) return;
    if (model->group.liftable && has_lift(model)) dml_want(L, model, DM_WANT_LIFT, backend);
    lift_homogeneous(L, arg, model, rule, backend, complete);
    if (model->group.liftable || model->group.homogeneous.rates) return;
    luaL_buffinit(L, &b);
    for (const dm_method *const *m = dm_methods; *m; m++) {
        if (!((*m)->traits & DM_ON_GROUPS)) continue;
        luaL_addstring(&b, separator);
        luaL_addstring(&b, (*m)->signature);
        separator = ", ";
    }
    luaL_pushresult(&b);
    const char *known = lua_tostring(L, -1);
    dml_systemfield(L, arg, "Q");
    const char *Q = luaL_tolstring(L, -1, NULL);
    luaL_error(L, "rule '%s' cannot step a system on %s; rules that step groups: %s", rule->name, Q,
               known);
}

/* ---- charts ---- */

static const char *const taus[] = {"exp", "cayley", "pade(2)", "pade(3)", "pade(4)"};

/* The end of a step from flat coordinates, xi and mu. */
static dml_traced trace_end(lua_State *L, int fn, int N, int D, dm_arena *arena) {
    const dml_signature end = {.what = "the end of a step on a group",
                               .arguments = 3,
                               .length = {N, D, D}};
    dml_traced traced;
    dml_trace(L, fn, &end, arena, &traced);
    return traced;
}

/* chart, finish and turns of one tau are at fn, fn + 1 and fn + 2, nil where there is none */
static void trace_chart(lua_State *L, int fn, uint32_t n, uint32_t d, dm_arena *arena,
                        dm_chart_trace *out) {
    const int N = (int)n, D = (int)d;
    const dml_signature chart = {.what = "the chart of a group",
                                 .arguments = 4,
                                 .length = {N, D, D, D},
                                 .outputs = N + D};
    const dml_signature turns = {.what = "the turns of a group",
                                 .arguments = 3,
                                 .length = {N, D, DML_SCALAR_ARGUMENT},
                                 .outputs = D * (N + D) + N};
    dml_traced traced;
    if (lua_isnil(L, fn)) return;
    dml_trace(L, fn, &chart, arena, &traced);
    out->chart = traced.graph;
    out->place = traced.out;
    traced = trace_end(L, fn + 1, N, D, arena);
    out->end = traced.graph;
    out->carried = traced.out;
    out->arcs = traced.outputs - n - d;
    if (lua_isnil(L, fn + 2)) return;
    dml_trace(L, fn + 2, &turns, arena, &traced);
    out->axes = traced.graph;
    out->turned = traced.out;
}

/* of one tau, with the place at an index and the arena on top */
static void make_trace(lua_State *L, const dml_system *s, int place, int tau, dm_arena *arena,
                       dm_chart_trace *out) {
    push_module(L, "chart");
    lua_pushvalue(L, place);
    lua_pushstring(L, taus[tau]);
    lua_call(L, 2, 3);
    trace_chart(L, lua_gettop(L) - 2, s->n, s->momenta, arena, out);
    lua_pop(L, 3);
}

/* The same of what a step adds to a state, which one engine asks for. */
static void make_change(lua_State *L, const dml_system *s, int place, int tau, dm_arena *arena,
                        dm_chart_trace *out) {
    out->looked = 1;
    push_module(L, "change");
    lua_pushvalue(L, place);
    lua_pushstring(L, taus[tau]);
    lua_call(L, 2, 1);
    if (!lua_isnil(L, -1)) {
        const dml_traced traced = trace_end(L, lua_gettop(L), (int)s->n, (int)s->momenta, arena);
        out->change = traced.graph;
        out->changed = traced.out;
    }
    lua_pop(L, 1);
}

/* a userdata with the trace of exp; the place is on top */
static void make_traces(lua_State *L, const dml_system *s) {
    const int place = lua_gettop(L);
    dm_chart_trace *out = lua_newuserdatauv(L, DM_TAUS * sizeof *out, 1 + 2 * DM_TAUS);
    memset(out, 0, DM_TAUS * sizeof *out);
    dm_arena *arena = dml_pusharena(L);
    lua_setiuservalue(L, -2, 1);
    make_trace(L, s, place, DM_TAU_EXP, arena, out);
    lua_setfield(L, place, "traces");
}

/* An arena on top that the traces at an index keep as their number `which`. */
static dm_arena *keep_arena(lua_State *L, int traces, int which) {
    dm_arena *arena = dml_pusharena(L);
    lua_pushvalue(L, -1);
    lua_setiuservalue(L, traces, which);
    return arena;
}

/* The traces of the place are those of all models that come later. Of every tau the chart and what
 * a step adds have arenas of their own: they are not always made together. */
void dml_place_taus(lua_State *L, int arg, dm_group *out, unsigned wants) {
    const dml_system *s = dml_checksystem(L, arg);
    const int place = lua_gettop(L) + 1;
    for (int tau = 0; tau < DM_TAUS; tau++, lua_settop(L, place - 1)) {
        if (!(wants & (unsigned)DM_WANT_CHART << tau) || out->trace[tau].looked) continue;
        dml_systemfield(L, arg, "place");
        lua_getfield(L, place, "traces");
        dm_chart_trace *traces = lua_touserdata(L, -1), *t = traces + tau;
        if (!t->chart) make_trace(L, s, place, tau, keep_arena(L, place + 1, 2 + 2 * tau), t);
        if (t->chart && !t->looked && !(wants & DM_WANT_JOINTS))
            make_change(L, s, place, tau, keep_arena(L, place + 1, 3 + 2 * tau), t);
        out->trace[tau] = *t;
    }
}

/* The kit has no upvalue of the user's, so one trace serves for ever. */
void dml_place_charts(lua_State *L, int arg, dm_group *out) {
    const dml_system *s = dml_checksystem(L, arg);
    const int top = lua_gettop(L);
    dml_systemfield(L, arg, "place");
    if (lua_getfield(L, -1, "traces") == LUA_TNIL) {
        lua_pop(L, 1);
        make_traces(L, s);
        lua_getfield(L, -1, "traces");
    }
    memcpy(out->trace, lua_touserdata(L, -1), sizeof out->trace);
    lua_getfield(L, top + 1, "liftable");
    out->liftable = lua_toboolean(L, -1);
    lua_settop(L, top);
}

/* Once a model. */
static void want_lift(lua_State *L, dml_model *m, dm_compile *compile) {
    if (m->group.lifted) return;
    if (m->compile) m->model.source.cache = &m->cache;
    const dm_status status = dm_group_lift(&m->group, &m->model, compile);
    if (status != DM_OK) luaL_error(L, "the lift of the system: %s", dm_status_text(status));
}

/* The lift, one chart or both. */
void dml_want_chart(lua_State *L, dml_model *m, unsigned chart, dm_compile *compile) {
    if (chart & DM_WANT_LIFT) want_lift(L, m, compile);
    if (!(chart & DM_WANT_CHARTS)) return;
    dm_tau tau = DM_TAU_EXP;
    while (!(chart & (unsigned)DM_WANT_CHART << tau)) tau++;
    if (!m->group.trace[tau].chart)
        luaL_error(L, "this group has no %s that stays on it; take \"exp\"",
                   tau == DM_TAU_CAYLEY ? "Cayley map" : "Pade approximant of exp");
    const int straight = (chart & DM_WANT_STRAIGHT) != 0;
    const dm_status status =
        chart & DM_WANT_JOINTS ? dm_group_want_joints(&m->group, &m->model, tau, straight, compile)
                               : dm_group_want(&m->group, &m->model, tau, straight, compile);
    if (status == DM_TOO_LARGE)
        luaL_error(L, "the chart of this group has more than %d operations: too many to trace%s",
                   DM_GRAPH_LIMIT,
                   tau == DM_TAU_EXP
                       ? "; lie(s, cayley) needs far fewer, where the group has a Cayley map"
                       : "");
    if (status != DM_OK) luaL_error(L, "the chart of the group: %s", dm_status_text(status));
}
