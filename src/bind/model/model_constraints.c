/* model_constraints.c - from constraint =, rolling =, force =, reaction = to the constraints of a
 * model. Long because every function of
 * the list is traced, checked and compared alike. */
#include "bind/model/model_constraints.h"
#include "bind/model/named.h"
#include "bind/model/space_group.h"
#include "bind/value/array.h"

#include "algebra/derive.h"
#include "base/random.h"
#include "bind/model/model_cache.h"
#include "code/tape/tape.h"

#include <math.h>
#include <string.h>

static const char *const keys[] = {"constraint", "rolling", "control", "force",
                                   "reaction",   "map",     NULL};

/* constraint(q, t); force(q, v, t, u) where there are controls; map(q, p); all others (q, v, t);
 * rolling, force and reaction of a discrete Lagrangian (q0, q1), with h and params bound */
static dml_signature signature(const dml_model *m, int pair, int which) {
    const int n = (int)m->n;
    if (pair && which != DML_CONSTRAINT)
        return (
            dml_signature){.what = keys[which], .arguments = 2, .length = {n, n}, .may_grow = 1};
    if (which == DML_CONSTRAINT)
        return (dml_signature){.what = keys[which],
                               .arguments = 2,
                               .length = {n, DML_SCALAR_ARGUMENT},
                               .may_grow = 1};
    const int controls = (int)m->constraint[DML_CONTROL].outputs;
    return (dml_signature){.what = keys[which],
                           .arguments = which == DML_FORCE && controls ? 4 : 3,
                           .length = {n, n, DML_SCALAR_ARGUMENT, controls},
                           .may_grow = 1};
}

/* Is it given, of the system at arg? */
static int has_field(lua_State *L, int arg, const char *key) {
    const int there = dml_systemfield(L, arg, key) != LUA_TNIL;
    lua_pop(L, 1);
    return there;
}

/* Forces and controls count, too. */
int dml_isconstrained(lua_State *L, int arg) {
    for (const char *const *key = keys; *key; key++)
        if (has_field(L, arg, *key)) return 1;
    return 0;
}

void dml_check_functions(lua_State *L, int hyperdual, int pair) {
    static const char *const of_pair[] =
        {"function(q) that returns what shall be zero",
         "function(q0, q1) or function(q0, q1, h) that returns what shall be zero",
         "",
         "function of (q0, q1 [, h]) that returns { F1, F2 }, the forces at q0 and at q1",
         "function(q0, q1) or function(q0, q1, h) that returns a row for every rolling one",
         "function of (q, p) at the start of a step that returns q, p at its end as one list"};
    static const char *const of_system[] =
        {"function(q) or function(q, t) that returns what shall be zero",
         "function(q, v) or function(q, v, t) that returns what shall be zero",
         "function(q, v) or function(q, v, t) that returns the controls u of a step",
         "function of (q, v [, t [, u]]), u the controls, that returns dim Q numbers",
         "function(q, v) or function(q, v, t) that returns a row for every rolling one",
         "function of (q, p) at the start of a step that returns q, p at its end as one list"};
    const char *const *forms = pair ? of_pair : of_system;
    for (int i = 0; keys[i]; i++, lua_pop(L, 1)) {
        const int type = lua_getfield(L, 1, keys[i]);
        if (type == LUA_TNIL) continue;
        if (type != LUA_TFUNCTION)
            luaL_error(L, "field '%s' must be a %s (got %s)", keys[i], forms[i],
                       luaL_typename(L, -1));
        if (hyperdual)
            luaL_error(L,
                       "field '%s': a system with constraints or a force needs their derivatives "
                       "as expressions; leave out derivatives = \"hyperdual\" and use dm.where, "
                       "dm.abs, dm.max to branch",
                       keys[i]);
    }
    const int control = lua_getfield(L, 1, "control") != LUA_TNIL;
    const int force = lua_getfield(L, 1, "force") != LUA_TNIL;
    lua_pop(L, 2);
    if (control && !force)
        luaL_error(L, "field 'control' gives what force(q, v, t, u) gets as u, and there is no "
                      "'force'");
    const int reaction = lua_getfield(L, 1, "reaction") != LUA_TNIL;
    const int rolling = lua_getfield(L, 1, "rolling") != LUA_TNIL;
    lua_pop(L, 2);
    if (pair && rolling && !reaction)
        luaL_error(L,
                   "field 'reaction' is missing: the rows that span the annihilator of E_d at q0, "
                   "in whose directions 'rolling' constraints of a discrete Lagrangian react");
    if (reaction && !rolling)
        luaL_error(L, "field 'reaction' gives the directions in which 'rolling' constraints react, "
                      "and there are none");
}

/* ---- traces ---- */

/* entries of row i, on top of the stack: 1 of a number; raises where the first row has others */
static lua_Integer row_length(lua_State *L, lua_Integer i, lua_Integer first) {
    dml_scalar x;
    const int single = dml_toscalar(L, -1, &x) || dml_length(L, -1) < 0;
    const lua_Integer columns = single ? 1 : luaL_len(L, -1);
    if (i > 1 && columns != first)
        luaL_error(L, "rows of different lengths were returned: row 1 has %d entr%s, row %d has %d",
                   (int)first, first == 1 ? "y" : "ies", (int)i, (int)columns);
    return single ? 0 : columns;
}

/* f(...) with a matrix or a table of rows as one table of numbers */
static int flat_call(lua_State *L) {
    lua_Integer count = 0, first = 0;
    lua_pushvalue(L, lua_upvalueindex(1));
    lua_insert(L, 1);
    lua_call(L, lua_gettop(L) - 1, LUA_MULTRET);
    if (lua_gettop(L) != 1) return lua_gettop(L);
    if (!lua_istable(L, 1) && !dml_toarray(L, 1, 0)) return 1; /* no list: told by who asked */
    lua_newtable(L);
    const lua_Integer rows = luaL_len(L, 1);
    for (lua_Integer i = 1; i <= rows; i++, lua_pop(L, 1)) {
        lua_geti(L, 1, i);
        const lua_Integer columns = row_length(L, i, first);
        if (i == 1) first = columns ? columns : 1;
        if (!columns) {
            lua_pushvalue(L, -1);
            lua_rawseti(L, 2, ++count);
        }
        for (lua_Integer j = 1; j <= columns; j++) {
            lua_geti(L, -1, j);
            lua_rawseti(L, 2, ++count);
        }
    }
    return 1;
}

static int is_pair(lua_State *L, int arg) {
    return dml_checksystem(L, arg)->pair;
}

/* That of number `which`, with params bound, its result flattened to a list. */
static void push_function(lua_State *L, int arg, int which) {
    const int pair = is_pair(L, arg);
    if (pair && which != DML_CONSTRAINT && which != DML_MAP)
        dml_pushboundpair(L, arg, keys[which]);
    else
        dml_pushbound(L, arg, keys[which]);
    if (which == DML_REACTION || (pair && which == DML_FORCE)) lua_pushcclosure(L, flat_call, 1);
}

static void check_lengths(lua_State *L, const dml_model *m, int pair) {
    const uint32_t n = m->n, k = m->constraint[DML_CONSTRAINT].outputs,
                   l = m->constraint[DML_ROLLING].outputs;
    const uint32_t given = m->constraint[DML_REACTION].outputs;
    if (pair && m->constraint[DML_FORCE].graph && m->constraint[DML_FORCE].outputs != 2 * n)
        luaL_error(L,
                   "force of a discrete Lagrangian must return { F1, F2 }, %d numbers each, got %d "
                   "in "
                   "all",
                   (int)n, (int)m->constraint[DML_FORCE].outputs);
    if (!pair && m->constraint[DML_FORCE].graph && m->constraint[DML_FORCE].outputs != n)
        luaL_error(L, "force must return %d numbers, one per coordinate, got %d", (int)n,
                   (int)m->constraint[DML_FORCE].outputs);
    if (m->constraint[DML_REACTION].graph && given != l * n)
        luaL_error(L,
                   "reaction must return %d rows of %d numbers, one row per rolling constraint, "
                   "got %d numbers in all",
                   (int)l, (int)n, (int)given);
    if (m->constraint[DML_MAP].graph && m->constraint[DML_MAP].outputs != 2 * n + k + l)
        luaL_error(L,
                   "map must return %d numbers, q1, p1 and an impulse for each constraint, got %d",
                   (int)(2 * n + k + l), (int)m->constraint[DML_MAP].outputs);
    if (k + l > m->group.momenta)
        luaL_error(L, "%d constraints for %d coordinates: they leave no motion", (int)(k + l),
                   (int)m->group.momenta);
}

/* the traced function with its inputs q, v, t in the graph of all */
static const dm_node *transplant(dml_model *m, int which) {
    const dml_traced *one = m->constraint + which;
    const uint32_t n = m->n;
    if (!one->graph) return NULL;
    dm_node *with = dm_arena_take(m->arena, one->inputs * sizeof *with);
    dm_node *out = dm_arena_take(m->arena, one->outputs * sizeof *out);
    if (!with || !out) return NULL;
    const uint32_t beyond = m->constrained.holonomic + m->constrained.rolling; /* u comes behind */
    for (uint32_t i = 0; i < one->inputs; i++) {
        const int is_time = which == DML_CONSTRAINT && i == n;
        with[i] = dm_input(m->constrained.graph, is_time ? 2 * n : i > 2 * n ? i + beyond : i);
    }
    dm_transplant(m->constrained.graph, one->graph, one->out, one->outputs, with, out);
    return out;
}

/* All functions in one graph, so that they share what they have in common. */
static void join(lua_State *L, dml_model *m) {
    dm_constraints_traced *t = &m->constrained;
    const uint32_t k = m->constraint[DML_CONSTRAINT].outputs,
                   l = m->constraint[DML_ROLLING].outputs;
    const uint32_t c = m->constraint[DML_CONTROL].outputs;
    *t = (dm_constraints_traced){.n = m->n,
                                 .holonomic = k,
                                 .rolling = l,
                                 .controls = c,
                                 .forces = m->constraint[DML_FORCE].outputs};
    t->graph = dm_graph_new(m->arena, 2 * m->n + 1 + k + l + c);
    if (!t->graph) luaL_error(L, "not enough memory");
    t->g = transplant(m, DML_CONSTRAINT);
    t->phi = transplant(m, DML_ROLLING);
    t->u = transplant(m, DML_CONTROL);
    t->f = transplant(m, DML_FORCE);
    t->E = transplant(m, DML_REACTION);
    const int missing = (k && !t->g) || (l && !t->phi) ||
                        (m->constraint[DML_FORCE].graph && !t->f) || (c && !t->u) ||
                        (m->constraint[DML_REACTION].graph && !t->E);
    if (missing || dm_graph_status(t->graph) != DM_OK) luaL_error(L, "not enough memory");
    m->constraints_traced = dm_graph_size(t->graph);
}

/* Each is traced in a graph of its own first, to be compared alone. */
void dml_traceconstraints(lua_State *L, int arg, dml_model *m) {
    int any = 0;
    arg = lua_absindex(L, arg);
    for (int i = 0; i < DML_CONSTRAINT_FUNCTIONS; i++) {
        if (!has_field(L, arg, keys[i])) continue;
        const dml_signature s = signature(m, is_pair(L, arg), i);
        push_function(L, arg, i);
        dml_retrace(L, lua_gettop(L), &s, m->arena, NULL, m->constraint + i);
        lua_pop(L, 1);
        if (!m->constraint[i].graph)
            luaL_error(L, "%s makes more than %d operations: too many to trace", keys[i],
                       DM_GRAPH_LIMIT);
        dml_refusenans(L, m->constraint + i, keys[i]);
        any = 1;
    }
    if (!any) return;
    check_lengths(L, m, is_pair(L, arg));
    join(L, m);
}

/* *cached is not changed. */
int dml_repeatconstraints(lua_State *L, int arg, const dml_model *cached, dm_arena *arena) {
    arg = lua_absindex(L, arg);
    for (int i = 0; i < DML_CONSTRAINT_FUNCTIONS && cached->constrained.graph; i++) {
        const dml_traced *last = cached->constraint + i;
        dml_traced now;
        if (!last->graph) continue;
        const dml_signature s = signature(cached, is_pair(L, arg), i);
        push_function(L, arg, i);
        dml_retrace(L, lua_gettop(L), &s, arena, last, &now);
        lua_pop(L, 1);
        if (now.graph != last->graph) return 0;
    }
    return 1;
}

/* a discrete Lagrangian knows no time */
void dml_checkpairconstraints(lua_State *L, const dml_model *m) {
    if (m->constraints.structure & DM_CONSTRAINTS_TIMED)
        luaL_error(L, "the constraint of a discrete Lagrangian is a function of q alone: Ld(q0, "
                      "q1) knows no time");
}

/* Of an element of a group. */
static dm_status find_directions(dml_model *m) {
    dm_constraints_traced *t = &m->constrained;
    const uint32_t n = m->n, d = m->group.momenta;
    dm_node *X = dm_arena_take(m->arena, (size_t)n * d * sizeof *X);
    t->directions = X;
    t->momenta = d;
    if (!X) return DM_NO_MEMORY;
    return dm_group_directions(X, t->graph, m->group.trace + DM_TAU_EXP, n, d, m->arena);
}

/* Counts are known after this. */
void dml_buildconstraints(lua_State *L, dml_model *m) {
    const uint32_t k = m->constrained.holonomic;
    dm_status status = m->placed && k ? find_directions(m) : DM_OK;
    if (status == DM_OK) status = dm_constraints_build(&m->constraints, &m->constrained, m->arena);
    if (status != DM_OK) luaL_error(L, "constraints or force: %s", dm_status_text(status));
    const uint32_t idle = dm_constraints_idle(&m->constraints);
    if (idle < k)
        luaL_error(L,
                   "constraint %d does not depend on q: a constraint is an expression in the "
                   "coordinates that shall be zero, for instance q:dot(q) - 1",
                   (int)idle + 1);
    if (idle < k + m->constrained.rolling)
        luaL_error(L,
                   "rolling constraint %d does not depend on v (of a discrete Lagrangian: on q1): "
                   "one on "
                   "the coordinates alone goes into 'constraint'",
                   (int)(idle - k) + 1);
}

/* ---- the trace against the function ---- */

/* (q, t) or (q, v, t) out of (q, v, t) */
static void arguments_of(const dml_model *m, int which, const double *x, double *out) {
    const size_t n = m->n;
    memcpy(out, x, (2 * n + 1) * sizeof *x);
    if (which == DML_CONSTRAINT) out[n] = x[2 * n];
}

/* the constraint function as it was traced, on the tape; made once for all comparisons. NULL: no
 * memory for it */
static const dm_kernel *find_traced_kernel(dml_model *m, int which) {
    dm_kernel *kernel = m->constraint_kernel + which;
    const dml_traced *one = m->constraint + which;
    const int made = kernel->eval ||
                     dm_tape_build(kernel, one->graph, one->out, one->outputs, m->arena) == DM_OK;
    return made ? kernel : NULL;
}

static const dm_kernel *traced_kernel(lua_State *L, dml_model *m, int which) {
    const dm_kernel *kernel = find_traced_kernel(m, which);
    if (!kernel) luaL_error(L, "not enough memory");
    return kernel;
}

const char *dml_functionname(int which) {
    return keys[which];
}

/* Raises at x what differs. */
void dml_checkconstraints(lua_State *L, int arg, dml_model *m, const double *x) {
    if (!m->constrained.graph) return;
    const int top = lua_gettop(L);
    arg = lua_absindex(L, arg);
    const size_t room = 2 * (size_t)m->n + 1;
    double *at = lua_newuserdatauv(L, (room + 2 * m->constrained.controls) * sizeof *at, 0);
    double *u = at + room, *held = u + m->constrained.controls;
    memset(at, 0, (room + 2 * m->constrained.controls) * sizeof *at);
    for (int i = 0; i < DML_CONSTRAINT_FUNCTIONS; i++) {
        if (!m->constraint[i].graph) continue;
        const dm_kernel *kernel = traced_kernel(L, m, i);
        const double *here = i == DML_MAP ? NULL : x; /* x = (q0, q1) is no (q, p) */
        if (x) arguments_of(m, i, x, at);
        if (x && i == DML_CONTROL) {
            dm_kernel_prepare(kernel, held);
            dm_kernel_eval(kernel, at, held);
        }
        if (m->constrained.controls) memcpy(u, held, m->constrained.controls * sizeof *u);
        const dml_signature s = signature(m, is_pair(L, arg), i);
        push_function(L, arg, i);
        if (m->checked)
            dml_trace_check_start(L, lua_gettop(L), &s, kernel, here ? at : NULL);
        else
            dml_trace_check(L, lua_gettop(L), &s, kernel, here ? at : NULL);
        lua_pop(L, 1);
    }
    lua_settop(L, top);
}

/* inputs and outputs of all of them, one after the other; NULL: no memory */
static double *take_room(dml_model *m) {
    const size_t n = m->n, inputs = 2 * n + 1 + 2 * m->constrained.controls;
    size_t most = 0;
    for (int i = 0; i < DML_CONSTRAINT_FUNCTIONS; i++)
        most = m->constraint[i].outputs > most ? m->constraint[i].outputs : most;
    if (!m->room) m->room = dm_arena_take(m->arena, (inputs + most) * sizeof *m->room);
    if (m->room) memset(m->room, 0, (inputs + most) * sizeof *m->room);
    return m->room;
}

double dml_constraintsum(dml_model *m, int which, const double *x) {
    const uint32_t controls = m->constrained.controls;
    const dm_kernel *kernel = find_traced_kernel(m, which);
    const dm_kernel *control = controls ? find_traced_kernel(m, DML_CONTROL) : NULL;
    double *at = take_room(m), sum = 0.0;
    if (!kernel || !at || (controls && !control)) return NAN;
    double *u = at + 2 * (size_t)m->n + 1, *held = u + controls, *out = held + controls;
    arguments_of(m, which, x, at);
    if (control) {
        dm_kernel_prepare(control, held);
        dm_kernel_eval(control, x, held);
        memcpy(u, held, controls * sizeof *u);
    }
    dm_kernel_prepare(kernel, out);
    dm_kernel_eval(kernel, at, out);
    for (uint32_t i = 0; i < kernel->outputs; i++)
        sum += (1 + dm_random_uniform(4, (uint64_t)which, i)) * (isfinite(out[i]) ? out[i] : 1.0);
    return sum;
}

void dml_addforces(lua_State *L, dml_model *m, const double *x, double *p0, double *p1) {
    const size_t n = m->n;
    if (!m->constrained.graph || !m->constraints.forced) return;
    dml_want(L, m, DM_WANT_CONSTRAINT_FORCE, NULL);
    double *at = lua_newuserdatauv(L, (4 * n + 1 + 2 * n) * sizeof *at, 0), *F = at + 4 * n + 1;
    memset(at, 0, (4 * n + 1) * sizeof *at);
    memcpy(at, x, 2 * n * sizeof *at);
    dm_kernel_prepare(&m->constraints.force, F);
    dm_kernel_eval(&m->constraints.force, at, F);
    for (size_t i = 0; i < 2 * n; i++)
        if (!isfinite(F[i]))
            luaL_error(L, "force %d is not finite at (q0, q1): is it inside its domain?",
                       (int)i + 1);
    for (size_t i = 0; i < n; i++) p0[i] -= F[i];
    for (size_t i = 0; p1 && i < n; i++) p1[i] += F[n + i];
    lua_pop(L, 1);
}

/* ---- what a script sees ---- */

/* "2 constraints", with a comma where something stands before it. */
static void add_count(lua_State *L, luaL_Buffer *b, uint32_t count, const char *what) {
    if (!count) return;
    lua_pushfstring(L, ", %d %s%s", (int)count, what, count > 1 ? "s" : "");
    luaL_addvalue(b);
}

void dml_describeconstraints(lua_State *L, luaL_Buffer *b, const dml_model *m) {
    add_count(L, b, m->constraints.holonomic, "constraint");
    add_count(L, b, m->constraints.rolling, "rolling constraint");
    if (m->constraints.forced || m->model.worked) luaL_addstring(b, ", a force");
    add_count(L, b, m->constraints.controls, "control");
}

/* the first `count` outputs of a kernel of the constraints at x = (q, v, t) */
static int push_outputs(lua_State *L, const dm_kernel *kernel, const double *x, uint32_t count,
                        const char *what) {
    double *all = lua_newuserdatauv(L, kernel->outputs * sizeof *all, 0);
    double *out = dml_pushvector(L, count);
    dm_kernel_prepare(kernel, all);
    dm_kernel_eval(kernel, x, all);
    memcpy(out, all, count * sizeof *out);
    for (uint32_t i = 0; i < count; i++)
        if (!isfinite(out[i]))
            luaL_error(L, "%s %d is not finite at this point: is it inside its domain?", what,
                       (int)i + 1);
    return 1;
}

/* q, and v, at 2 and 3 of a system on a group become flat coordinates */
static void flatten(lua_State *L, int sees_v) {
    const int top = lua_gettop(L);
    lua_createtable(L, 0, 2);
    lua_pushvalue(L, 2), lua_setfield(L, -2, "q");
    if (sees_v) lua_pushvalue(L, 3), lua_setfield(L, -2, "v");
    dml_place_options(L, 1, lua_gettop(L), "state");
    lua_getfield(L, top + 1, "q"), lua_replace(L, 2);
    if (sees_v) lua_getfield(L, top + 1, "v"), lua_replace(L, 3);
    lua_settop(L, top);
}

/* x = (q, v, t) from arguments 2, 3, 4, or (q, t) from 2, 3; the model is pushed */
static dml_model *read_point(lua_State *L, int which, double **x) {
    const dml_system *s = luaL_checkudata(L, 1, DML_SYSTEM);
    const size_t n = s->n;
    const int sees_v = which != DML_CONSTRAINT;
    lua_settop(L, 4);
    if (!has_field(L, 1, keys[which]))
        luaL_error(L, "this system has no %s: it was made without '%s ='",
                   which == DML_FORCE     ? "force"
                   : which == DML_CONTROL ? "control"
                                          : "such constraint",
                   keys[which]);
    const double t = luaL_optnumber(L, sees_v ? 4 : 3, 0.0);
    dml_model *m = dml_pushmodel(L, 1);
    const size_t room =
        2 * n + 1 + m->constraints.holonomic + m->constraints.rolling + m->constraints.controls;
    *x = lua_newuserdatauv(L, room * sizeof **x, 0);
    memset(*x, 0, room * sizeof **x);
    if (s->placed) flatten(L, sees_v);
    dml_unname(L, 1, 2, "q");
    if (sees_v) dml_unname(L, 1, 3, "v");
    dml_vectorarg(L, 2, "q", *x, s->n);
    if (sees_v) dml_vectorarg(L, 3, "v", *x + n, s->n);
    (*x)[2 * n] = t;
    return m;
}

/* (q, t): g */
static int system_constraint(lua_State *L) {
    double *x;
    dml_model *m = read_point(L, DML_CONSTRAINT, &x);
    dml_want(L, m, DM_WANT_HOLONOMIC, NULL);
    return push_outputs(L, &m->constraints.holonomic_kernel, x, m->constraints.holonomic,
                        "constraint");
}

/* (q, v, t): phi */
static int system_rolling(lua_State *L) {
    double *x;
    dml_model *m = read_point(L, DML_ROLLING, &x);
    dml_want(L, m, DM_WANT_ROLLING, NULL);
    return push_outputs(L, &m->constraints.rolling_kernel, x, m->constraints.rolling,
                        "rolling constraint");
}

/* (q, v, t): f, with the control where there is one. */
static int system_force(lua_State *L) {
    double *x;
    dml_model *m = read_point(L, DML_FORCE, &x);
    const uint32_t behind =
        2 * m->constraints.n + 1 + m->constraints.holonomic + m->constraints.rolling;
    dml_want(L, m, DM_WANT_CONSTRAINT_FORCE, NULL);
    if (m->constraints.controls) {
        dm_kernel_prepare(&m->constraints.control, x + behind);
        dm_kernel_eval(&m->constraints.control, x, x + behind);
    }
    return push_outputs(L, &m->constraints.force, x, m->group.momenta, "force");
}

/* (q, v, t): u */
static int system_control(lua_State *L) {
    double *x;
    dml_model *m = read_point(L, DML_CONTROL, &x);
    dml_want(L, m, DM_WANT_CONSTRAINT_FORCE, NULL);
    return push_outputs(L, &m->constraints.control, x, m->constraints.controls, "control");
}

const dml_row dml_constraint_methods[] =
    {{"constraint", system_constraint,
      "system:constraint(q [, t]) -> dm.vector\n"
      "g(q, t) of the holonomic constraints, in their units: zero on the constraint."},
     {"rolling", system_rolling,
      "system:rolling(q, v [, t]) -> dm.vector\n"
      "phi(q, v, t) of the rolling constraints: zero where they hold."},
     {"force", system_force,
      "system:force(q, v [, t]) -> dm.vector of dim Q entries\n"
      "The force f(q, v, t) of the system, a covector: f . dq is the work; with controls, as at "
      "the start of a step."},
     {"control", system_control,
      "system:control(q, v [, t]) -> dm.vector\n"
      "The controls u of a step that starts at (q, v, t)."},
     {NULL, NULL, NULL}};
