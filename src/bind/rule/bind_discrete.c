/* bind_discrete.c - `dm.discrete_lagrangian`: Ld(q0, q1) of a user, or of a system and a
 * rule. */
#include "bind/model/bind_space.h"
#include "bind/model/bind_system.h"
#include "bind/model/model_constraints.h"
#include "bind/model/model_map.h"
#include "bind/rule/discrete_rule.h"
#include "bind/trace/bind_root.h"
#include "integ/registry.h"

#include <math.h>
#include <string.h>

static dml_system *check(lua_State *L) {
    return luaL_checkudata(L, 1, DML_DISCRETE);
}

static int has_field(lua_State *L, int arg, const char *key) {
    const int there = dml_systemfield(L, arg, key) != LUA_TNIL;
    lua_pop(L, 1);
    return there;
}

/* p0 = -D1 Ld - F1, p1 = D2 Ld + F2, -D1D2 Ld at the points q0, q1 */
typedef struct {
    const double *p0, *p1, *two_form;
} momenta;

/* of a user's formula, at arguments 2, 3, in a userdata left on the stack */
static momenta of_formula(lua_State *L) {
    const dml_system *s = check(L);
    const uint32_t n = s->n;
    double *x = lua_newuserdatauv(L, 2 * (size_t)n * sizeof *x, 0);
    dml_vectorarg(L, 2, "q0", x, n);
    dml_vectorarg(L, 3, "q1", x + n, n);
    dml_model *m = dml_pushlast(L, 1, NULL);
    dml_want(L, m, DM_WANT_PAIR, NULL);
    double *out = lua_newuserdatauv(L, m->model.pair.outputs * sizeof *out, 0);
    dml_forgetroots(m);
    dm_kernel_prepare(&m->model.pair, out);
    dm_kernel_eval(&m->model.pair, x, out);
    dml_rethrow(L, m);
    for (uint32_t i = 0; i < m->model.pair.outputs; i++) {
        if (!isfinite(out[i]))
            luaL_error(L,
                       "a derivative of Ld is not finite at (q0, q1): is it inside the domain of "
                       "Ld?%s",
                       dml_modeltrouble(L, m));
        if (i < n || i >= 2 * n) out[i] = -out[i];
    }
    dml_addforces(L, m, x, out, out + n);
    return (momenta){out, out + n, out + 2 * (size_t)n};
}

/* a formula of the script has no time, and a third argument may have been meant for its h */
static void check_time(lua_State *L) {
    const dml_system *s = check(L);
    if (s->ruled || lua_isnoneornil(L, 4)) return;
    dml_checknumber(L, 4);
    if (dml_discrete_source(L), lua_isnil(L, -1))
        luaL_error(L, "a formula Ld(q0, q1) has no time; its h is %f", s->h);
    lua_pop(L, 1);
}

/* Of a formula by its derivatives, of a rule by solving for its stages: the methods below do not
 * care. */
static momenta find_ends(lua_State *L) {
    dm_discrete d;
    check_time(L);
    if (!check(L)->ruled) return of_formula(L);
    dml_solveruled(L, &d);
    return (momenta){d.p0, d.p1, d.two_form};
}

static void push_vector(lua_State *L, const double *x, uint32_t n) {
    memcpy(dml_pushvector(L, n), x, n * sizeof *x);
}

/* Stack of the methods: Ld, q0, q1, and a time for a rule. */
static int discrete_minus(lua_State *L) {
    lua_settop(L, 4);
    const momenta e = find_ends(L);
    push_vector(L, e.p0, check(L)->n);
    return 1;
}

static int discrete_plus(lua_State *L) {
    lua_settop(L, 4);
    const momenta e = find_ends(L);
    push_vector(L, e.p1, check(L)->n);
    return 1;
}

static int discrete_two_form(lua_State *L) {
    lua_settop(L, 4);
    if (check(L)->ruled && dml_systemfield(L, 1, "system") && has_field(L, -1, "force"))
        luaL_error(L,
                   "Ld:two_form: this system has a force, with which steps keep no two-form, and "
                   "the action along its curves tells nothing of p0 and p1");
    lua_settop(L, 4);
    const momenta e = find_ends(L);
    const uint32_t n = check(L)->n;
    memcpy(dml_pushmatrix(L, n, n), e.two_form, (size_t)n * n * sizeof(double));
    return 1;
}

/* push option t of the options at `at`, nil without it; the options there lose it */
static void push_time(lua_State *L, int at) {
    if (!lua_istable(L, at) || lua_getfield(L, at, "t") == LUA_TNIL) {
        lua_settop(L, at);
        lua_pushnil(L);
        return;
    }
    luaL_argcheck(L, lua_type(L, -1) == LUA_TNUMBER, at, "option 't' must be a number");
    lua_newtable(L);
    for (lua_pushnil(L); lua_next(L, at);) {
        lua_pushvalue(L, -2);
        lua_insert(L, -2);
        lua_rawset(L, -4);
    }
    lua_pushnil(L);
    lua_setfield(L, -2, "t");
    lua_replace(L, at);
}

/* Ld:momentum(group, q0, q1): <J, xi> = D2 Ld . xi_Q(q1) */
static int discrete_momentum(lua_State *L) {
    const uint32_t n = check(L)->n;
    lua_settop(L, 5);
    push_time(L, 5);
    const dm_action action = dml_standard_action(L, 2, 5, 1, n);
    double *q1 = lua_newuserdatauv(L, n * sizeof *q1, 0);
    dml_vectorarg(L, 4, "q1", q1, n);
    lua_pushvalue(L, 6);
    lua_replace(L, 5);
    lua_remove(L, 2); /* q0, q1 are wanted at 2, 3, a time or nil at 4 */
    const momenta e = find_ends(L);
    const uint32_t dimension = action.group->dimension(action.k);
    dm_momentum(dml_pushvector(L, dimension), &action, n, q1, e.p1);
    return 1;
}

/* The value has a kernel of its own, on the tape: it is asked for seldom. */
static double value_of_formula(lua_State *L) {
    const uint32_t n = check(L)->n;
    double *x = lua_newuserdatauv(L, 2 * (size_t)n * sizeof *x, 0), value;
    dml_vectorarg(L, 2, "q0", x, n);
    dml_vectorarg(L, 3, "q1", x + n, n);
    dml_model *m = dml_pushlast(L, 1, NULL);
    dml_want(L, m, DM_WANT_PAIR, NULL);
    dml_forgetroots(m);
    dm_kernel_prepare(&m->model.value, &value);
    dm_kernel_eval(&m->model.value, x, &value);
    dml_rethrow(L, m);
    if (!isfinite(value))
        luaL_error(L, "Ld is not finite at (q0, q1): is it inside its domain?%s",
                   dml_modeltrouble(L, m));
    return value;
}

/* Ld(q0, q1). */
static int discrete_call(lua_State *L) {
    dm_discrete d;
    lua_settop(L, 4);
    check_time(L);
    if (check(L)->ruled)
        dml_solveruled(L, &d);
    else
        d.value = value_of_formula(L);
    lua_pushnumber(L, d.value);
    return 1;
}

/* a function of its own, so that help finds its own text */
static int discrete_value(lua_State *L) {
    return discrete_call(L);
}

static void set_matrix(lua_State *L, const char *key, const double *x, uint32_t rows, uint32_t n) {
    memcpy(dml_pushmatrix(L, rows, n), x, (size_t)rows * n * sizeof *x);
    lua_setfield(L, -2, key);
}

/* All that the stationary curve has: a table of vectors and matrices, a row a point. */
static int hamilton_pontryagin(lua_State *L) {
    const dml_system *s = check(L);
    dm_discrete d;
    lua_settop(L, 4);
    dml_needstages(L, s);
    dml_solveruled(L, &d);
    lua_createtable(L, 0, 7);
    dml_setresult(L);
    lua_pushnumber(L, d.value), lua_setfield(L, -2, "value");
    lua_pushnumber(L, d.residual), lua_setfield(L, -2, "residual");
    push_vector(L, d.p0, s->n), lua_setfield(L, -2, "p0");
    push_vector(L, d.p1, s->n), lua_setfield(L, -2, "p1");
    set_matrix(L, "q", d.q, d.points, s->n);
    set_matrix(L, "v", d.v, d.points, s->n);
    set_matrix(L, "p", d.p, d.points, s->n);
    return 1;
}

static int discrete_tostring(lua_State *L) {
    const dml_system *s = check(L);
    dml_systemfield(L, 1, "name");
    const char *name = lua_tostring(L, -1);
    dml_systemfield(L, 1, "Q");
    const char *Q = luaL_tolstring(L, -1, NULL);
    if (name)
        lua_pushfstring(L, "discrete Lagrangian '%s' on %s, h = %f", name, Q, s->h);
    else
        lua_pushfstring(L, "discrete Lagrangian on %s, h = %f", Q, s->h);
    if (!s->ruled) return 1;
    dml_systemfield(L, 1, "rule");
    const char *rule = luaL_tolstring(L, -1, NULL);
    lua_pushfstring(L, "%s, by %s", lua_tostring(L, -3), rule);
    return 1;
}

/* Fields are those that were given, h is a number of its own. */
static int discrete_field(lua_State *L) {
    const dml_system *s = check(L);
    const char *key = luaL_checkstring(L, 2);
    static const char *const fields[] = {"Q",       "Ld",       "name", "coordinates", "units",
                                         "params",  "system",   "rule", "constraint",  "force",
                                         "rolling", "reaction", "map",  NULL};
    if (strcmp(key, "h") == 0) return lua_pushnumber(L, s->h), 1;
    if (strcmp(key, "source") == 0) return dml_discrete_source(L);
    for (const char *const *f = fields; *f; f++)
        if (strcmp(*f, key) == 0) return dml_shownfield(L, key);
    return 0;
}

/* holonomic constraints go with a formula, whose nodes are the ends; forces with any rule */
static void check_of_system(lua_State *L) {
    luaL_checktype(L, 2, LUA_TTABLE);
    const int holonomic = has_field(L, 1, "constraint") && !has_field(L, 1, "rolling");
    if (has_field(L, 1, "control"))
        luaL_error(L, "a discrete Lagrangian has no place for a control, which is held from the "
                      "start of a step on: solve the system with a rule, for instance "
                      "system:solver{rule = \"gauss(2)\", h = 0.01}");
    if ((has_field(L, 1, "rolling") || has_field(L, 1, "constraint")) &&
        !(holonomic && dml_formula_points(L)))
        luaL_error(L,
                   "a discrete Lagrangian has no place for %s: solve the system with a rule, for "
                   "instance system:solver{rule = \"%s\", h = 0.01}",
                   holonomic ? "the constraints of a system but at its nodes (rules \"midpoint\" "
                               "and \"trapezoidal\")"
                             : "rolling constraints of a system",
                   holonomic ? "rattle" : "midpoint");
}

/* a formula Ld(q0, q1) has no time: stages have; of hyper-dual numbers it is not known */
static int is_timed(lua_State *L) {
    const dm_model *m = &dml_pushmodel(L, 1)->model;
    const int known = m->source.graph != NULL;
    const int timed = !(m->structure & DM_AUTONOMOUS);
    const int nodal = has_field(L, 1, "constraint");
    lua_settop(L, 2);
    if (!known) return !dml_isconstrained(L, 1);
    if (timed && nodal)
        luaL_error(L, "a discrete Lagrangian with constraints knows no time, on which this system "
                      "depends: solve the system with a rule, for instance system:solver{rule = "
                      "\"rattle\", h = 0.01}");
    return timed;
}

static const char *const known[] = {"Q",           "h",         "Ld",      "name",
                                    "coordinates", "units",     "params",  "derivatives",
                                    "constraint",  "force",     "rolling", "reaction",
                                    "map",         "crossings", NULL};

/* core.with_step: the map is that of the unreduced equations, and Ld another road */
int dml_core_with_step(lua_State *L) {
    dml_newsystem(L, known, 1);
    dml_checksystem(L, -1)->solved = 1;
    return 1;
}

/* { system, rule = }, as dm.solver takes a discrete Lagrangian */
static void refuse_one_table(lua_State *L) {
    if (!lua_istable(L, 1)) return;
    lua_rawgeti(L, 1, 1);
    const int entry = luaL_testudata(L, -1, DML_SYSTEM) != NULL;
    if (entry || dml_field(L, 1, "system") || dml_field(L, 1, "rule"))
        luaL_error(L,
                   "of a system and a rule it is dm.discrete_lagrangian(system, { rule =, h = })");
    lua_settop(L, 2);
}

/* A table is a formula. A system and a rule become a formula where the rule has one velocity,
 * else they stay a rule whose stages are solved for. */
static int discrete_new(lua_State *L) {
    lua_settop(L, 2);
    if (luaL_testudata(L, 1, DML_SYSTEM)) {
        check_of_system(L);
        if (!dml_formula_points(L) || is_timed(L)) return dml_pushruled(L), 1;
        dml_formula_of_system(L);
    } else {
        refuse_one_table(L);
    }
    dml_newsystem(L, known, 1);
    if (has_field(L, -1, "map")) {
        dml_checkmap(L, -2, dml_pushlast(L, -1, NULL), NULL, 0, 0);
        lua_pop(L, 1);
    }
    return 1;
}

static const dml_row meta[] = {{"__tostring", discrete_tostring, NULL},
                               {"__call", discrete_call, NULL},
                               {NULL, NULL, NULL}};
static const dml_row methods[] = {
    {"value", discrete_value,
     "Ld:value(q0, q1 [, t]) -> number\n"
     "The discrete Lagrangian, the same as Ld(q0, q1 [, t]): of a rule, the action of the curve of "
     "that rule from q0 at the time t (0) to q1, found by Newton to round-off."},
    {"hamilton_pontryagin", hamilton_pontryagin,
     "Ld:hamilton_pontryagin(q0, q1 [, t]) -> {value, p0, p1, q, v, p, residual}\n"
     "The stationary point of h sum_i b_i [L(q_i, v_i) + p_i . (dq_i/dt - v_i)] over the curves "
     "of the rule from q0 to q1: positions, velocities and momenta p_i = dL/dv at its points "
     "(matrices, a row each), the multipliers p0 and p1 of the ends, which are the discrete "
     "Legendre transforms, and what is left of its equations (Leok 5.2)."},
    {"coefficients", dml_discrete_coefficients,
     "Ld:coefficients() -> {a, d, b, c, beta}\n"
     "Of a system and a rule, what its curves are made of (Leok 2.4): with velocities V_j, Q_i = "
     "q0 + h sum_j a_ij V_j and Qdot_i = sum_j d_ij V_j at the times c_i h, where L is taken with "
     "the weights h b_i; q1 = q0 + h sum_j beta_j V_j."},
    {"legendre_minus", discrete_minus,
     "Ld:legendre_minus(q0, q1 [, t]) -> dm.vector\n"
     "The momentum p0 = -D1 Ld(q0, q1) - F1 at q0, F1 the discrete force (Leok 2.3, 2.8.2). t: of "
     "a system and a rule, the time at q0 (0)."},
    {"legendre_plus", discrete_plus,
     "Ld:legendre_plus(q0, q1 [, t]) -> dm.vector\n"
     "The momentum p1 = D2 Ld(q0, q1) + F2 at q1, F2 the discrete force (Leok 2.3, 2.8.2). t: of a "
     "system and a rule, the time at q0 (0)."},
    {"two_form", discrete_two_form,
     "Ld:two_form(q0, q1 [, t]) -> dm.matrix\n"
     "The matrix -D1D2 Ld (row q0, column q1) of the discrete symplectic form omega = "
     "-d2Ld/dq0dq1 dq0 ^ dq1. t: of a system and a rule, the time at q0 (0)."},
    {"momentum", discrete_momentum,
     "Ld:momentum(group, q0, q1 [, {block=, t=}]) -> dm.vector of dim G entries\n"
     "The discrete momentum map <J, xi> = D2 Ld(q0, q1) . xi_Q(q1) of a standard action; kept "
     "along a path when Ld is invariant. t: of a system and a rule, the time at q0 (0)."},
    {NULL, NULL, NULL}};
static const dml_row functions[] =
    {{"discrete_lagrangian", discrete_new,
      "dm.discrete_lagrangian{Q=, h=, Ld=, name=, coordinates=, units=, params=, derivatives=, "
      "constraint=, rolling=, reaction=, force=, map=, crossings=} -> dm.discrete_lagrangian   or "
      "  "
      "dm.discrete_lagrangian(system, {rule=, "
      "h=})\n"
      "The latter with any stage rule (\"galerkin(3, lobatto(4))\", \"gauss(2)\", \"midpoint\" "
      "...), or with \"exact\": the action of the motion from q0 to q1 itself, by gauss(8) on as "
      "many pieces as round-off needs (Leok 5.1.1); it raises where q0 and q1 are conjugate or no "
      "motion is found. A force of the system is in p0 and p1 by the quadrature of the rule (Leok "
      "2.8.2).\n"
      "Ld(q0, q1), Ld(q0, q1, h) or Ld(q0, q1, h, params): approximately the action from q0 to q1 "
      "in the time h. Step it with dm.solver{Ld}; Ld(q0, q1) is its value. constraint(q): what is "
      "to be zero at every node, D2 Ld(q0, q1) + D1 Ld(q1, q2) + G^T lambda = 0 (a run gives "
      "lambda with record = { \"impulses\" }); momenta are D2 Ld, as they are. crossings: as of "
      "dm.system. map(q, p): the step "
      "of Ld, q1 and p1 as one list (with constraints, holonomic and rolling, an impulse for each "
      "behind them), where it is known: runs then take it (rule \"map\") in place of solving for "
      "q1. It is compared with Ld and its forces at made-up points here, and at the start of every "
      "run: raises with the point where it is not their step. rolling(q0, q1 [, h [, params]]): "
      "what is to be zero between two nodes; reaction(q0, q1 [, h [, params]]): a row of "
      "dim Q numbers for each, in whose directions it reacts (the rows span the annihilator of the "
      "virtual displacements at q0; Cuell-Patrick 3). force(q0, q1 [, h [, params]]): { F1, F2 }, "
      "dim Q numbers each, the discrete forces at q0 and at q1: p0 = -D1 Ld - F1, p1 = D2 Ld + F2 "
      "(Leok 2.8.2)."},
     {NULL, NULL, NULL}};

const dml_class dml_class_discrete = {
    .name = DML_DISCRETE,
    .doc = "dm.discrete_lagrangian: Ld(q0, q1), made by dm.discrete_lagrangian{Q=, h=, Ld=}\n"
           "or, of a system and a rule, by dm.discrete_lagrangian(system, {rule=, h=})\n"
           "fields: Q, Ld, h, name, coordinates, units, params, system, rule, constraint, map",
    .meta = meta,
    .methods = methods,
    .field = discrete_field,
    .functions = functions,
};
