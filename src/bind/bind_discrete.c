/* bind_discrete.c - `dm.discrete_lagrangian`: Ld(q0, q1) of a user, or of a system and a
 * rule. */
#include "bind/model_ties.h"
#include "bind/space.h"
#include "bind/system.h"

#include <math.h>
#include <string.h>

static dml_system *check(lua_State *L) {
    return luaL_checkudata(L, 1, DML_DISCRETE);
}

/* D1[n], D2[n], D1D2[n*n] at arguments 2, 3, in a userdata left on the stack */
static const double *derivatives(lua_State *L) {
    const dml_system *s = check(L);
    const uint32_t n = s->n;
    double *x = lua_newuserdatauv(L, 2 * (size_t)n * sizeof *x, 0);
    dml_vectorarg(L, 2, "q0", x, n);
    dml_vectorarg(L, 3, "q1", x + n, n);
    dml_model *m = dml_pushmodel(L, 1);
    dml_want(L, m, DM_WANT_PAIR, NULL);
    double *out = lua_newuserdatauv(L, m->model.pair.outputs * sizeof *out, 0);
    dm_kernel_prepare(&m->model.pair, out);
    dm_kernel_eval(&m->model.pair, x, out);
    dml_rethrow(L, m);
    for (uint32_t i = 0; i < m->model.pair.outputs; i++)
        if (!isfinite(out[i]))
            luaL_error(L, "a derivative of Ld is not finite at (q0, q1): is it inside "
                          "the domain of Ld?");
    return out;
}

static int discrete_minus(lua_State *L) {
    const double *d = derivatives(L);
    const uint32_t n = check(L)->n;
    double *p = dml_pushvector(L, n);
    for (uint32_t i = 0; i < n; i++) p[i] = -d[i];
    return 1;
}

static int discrete_plus(lua_State *L) {
    const double *d = derivatives(L);
    const uint32_t n = check(L)->n;
    memcpy(dml_pushvector(L, n), d + n, n * sizeof *d);
    return 1;
}

static int discrete_two_form(lua_State *L) {
    const double *d = derivatives(L);
    const uint32_t n = check(L)->n;
    double *omega = dml_pushmatrix(L, n, n);
    for (uint32_t i = 0; i < n * n; i++) omega[i] = -d[2 * n + i];
    return 1;
}

/* Ld:momentum(group, q0, q1): <J, xi> = D2 Ld . xi_Q(q1) */
static int discrete_momentum(lua_State *L) {
    const uint32_t n = check(L)->n;
    const dm_action action = dml_standard_action(L, 2, 5, n);
    double *q1 = lua_newuserdatauv(L, n * sizeof *q1, 0);
    dml_vectorarg(L, 4, "q1", q1, n);
    lua_remove(L, 2); /* derivatives wants q0, q1 at 2, 3 */
    const double *d = derivatives(L);
    const uint32_t dimension = action.group->dimension(action.k);
    dm_momentum(dml_pushvector(L, dimension), &action, n, q1, d + n);
    return 1;
}

static int discrete_call(lua_State *L) {
    const uint32_t n = check(L)->n;
    double *x = lua_newuserdatauv(L, 2 * (size_t)n * sizeof *x, 0), value;
    dml_vectorarg(L, 2, "q0", x, n);
    dml_vectorarg(L, 3, "q1", x + n, n);
    dml_model *m = dml_pushmodel(L, 1);
    dml_want(L, m, DM_WANT_PAIR, NULL);
    dm_kernel_prepare(&m->model.value, &value);
    dm_kernel_eval(&m->model.value, x, &value);
    dml_rethrow(L, m);
    if (!isfinite(value))
        luaL_error(L, "Ld is not finite at (q0, q1): is it inside its domain?");
    lua_pushnumber(L, value);
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
    return 1;
}

static int discrete_field(lua_State *L) {
    const dml_system *s = check(L);
    const char *key = luaL_checkstring(L, 2);
    static const char *const fields[] = {"Q",     "Ld",     "name", "coordinates",
                                         "units", "params", NULL};
    if (strcmp(key, "h") == 0) return lua_pushnumber(L, s->h), 1;
    for (const char *const *f = fields; *f; f++)
        if (strcmp(*f, key) == 0) return dml_systemfield(L, 1, key), 1;
    return 0;
}

/* ---- a discrete Lagrangian of a system: its L at the nodes of a rule with one velocity
 * (q1 - q0)/h ---- */

/* push L of the system at upvalue 1 at ((1 - c) q0 + c q1, (q1 - q0)/h), arguments q0,
 * q1, h at 1, 2, 3 */
static void push_node(lua_State *L, double c) {
    lua_getfield(L, lua_upvalueindex(1), "L");
    lua_pushvalue(L, 2);
    lua_pushvalue(L, 1);
    lua_arith(L, LUA_OPSUB); /* q1 - q0 */
    lua_pushvalue(L, 1);
    lua_pushvalue(L, -2);
    lua_pushnumber(L, c);
    lua_arith(L, LUA_OPMUL);
    lua_arith(L, LUA_OPADD); /* q0 + c (q1 - q0) */
    lua_insert(L, -2);
    lua_pushvalue(L, 3);
    lua_arith(L, LUA_OPDIV);
    lua_pushnumber(L, 0.0);
    lua_getfield(L, lua_upvalueindex(1), "params");
    lua_call(L, 4, 1);
}

/* h sum_i b_i L at the nodes: one of weight 1 at c = 1/2, or two of weight 1/2 at the
 * ends */
static int composed(lua_State *L) {
    const int ends = lua_toboolean(L, lua_upvalueindex(2));
    push_node(L, ends ? 0.0 : 0.5);
    if (ends) {
        push_node(L, 1.0);
        lua_arith(L, LUA_OPADD);
        lua_pushnumber(L, 0.5);
        lua_arith(L, LUA_OPMUL);
    }
    lua_pushvalue(L, 3);
    lua_arith(L, LUA_OPMUL);
    return 1;
}

/* turn (system, { rule =, h = }) on the stack into the options of a discrete Lagrangian
 * at 1 */
static void options_of_system(lua_State *L) {
    static const char *const known[] = {"rule", "h", "name", NULL};
    static const char *const copied[] = {"Q",     "name",   "coordinates",
                                         "units", "params", NULL};
    luaL_checktype(L, 2, LUA_TTABLE);
    dml_options(L, 2, known);
    if (dml_istied(L, 1))
        luaL_error(L, "a discrete Lagrangian has no place for the constraints and forces "
                      "of a system: solve it with a rule, for instance "
                      "system:solver{rule = \"rattle\", h = 0.01}");
    lua_getfield(L, 2, "rule");
    const char *rule = luaL_optstring(L, -1, "");
    const int midpoint = strcmp(rule, "midpoint") == 0;
    if (!midpoint && strcmp(rule, "trapezoidal") != 0)
        luaL_error(L,
                   "field 'rule' must be \"midpoint\" or \"trapezoidal\" (got '%s'): the "
                   "rules whose discrete "
                   "Lagrangian is a formula in q0 and q1",
                   rule);
    lua_newtable(L);
    for (const char *const *key = copied; *key; key++)
        dml_systemfield(L, 1, *key), lua_setfield(L, -2, *key);
    lua_getfield(L, 2, "h");
    lua_setfield(L, -2, "h");
    lua_pushvalue(L, 1);
    lua_pushboolean(L, !midpoint);
    lua_pushcclosure(L, composed, 2);
    lua_setfield(L, -2, "Ld");
    lua_replace(L, 1);
}

static int discrete_new(lua_State *L) {
    static const char *const known[] = {
        "Q", "h", "Ld", "name", "coordinates", "units", "params", "derivatives", NULL};
    lua_settop(L, 2);
    if (luaL_testudata(L, 1, DML_SYSTEM)) options_of_system(L);
    dml_newsystem(L, known, 1);
    return 1;
}

static const dml_row meta[] = {{"__tostring", discrete_tostring, NULL},
                               {"__call", discrete_call, NULL},
                               {NULL, NULL, NULL}};
static const dml_row methods[] = {
    {"legendre_minus", discrete_minus,
     "Ld:legendre_minus(q0, q1) -> dm.vector\nThe momentum p0 = -D1 Ld(q0, q1) at q0 "
     "(Leok 2.3)."},
    {"legendre_plus", discrete_plus,
     "Ld:legendre_plus(q0, q1) -> dm.vector\nThe momentum p1 = D2 Ld(q0, q1) at q1 (Leok "
     "2.3)."},
    {"two_form", discrete_two_form,
     "Ld:two_form(q0, q1) -> dm.matrix\n"
     "The matrix -D1D2 Ld (row q0, column q1) of the discrete symplectic form omega = "
     "-d2Ld/dq0dq1 dq0 ^ dq1."},
    {"momentum", discrete_momentum,
     "Ld:momentum(group, q0, q1 [, {block=}]) -> dm.vector of dim G entries\n"
     "The discrete momentum map <J, xi> = D2 Ld(q0, q1) . xi_Q(q1) of a standard action; "
     "kept along a "
     "path when Ld is invariant."},
    {NULL, NULL, NULL}};
static const dml_row functions[] = {
    {"discrete_lagrangian", discrete_new,
     "dm.discrete_lagrangian{Q=, h=, Ld=, name=, coordinates=, units=, params=, "
     "derivatives=} -> dm.discrete_lagrangian\n"
     "or dm.discrete_lagrangian(system, {rule=, h=}) with rule \"midpoint\" or "
     "\"trapezoidal\"\n"
     "Ld(q0, q1), Ld(q0, q1, h) or Ld(q0, q1, h, params): approximately the action from "
     "q0 to q1 in the time h. Step it with "
     "dm.solver{Ld}; Ld(q0, q1) is its value."},
    {NULL, NULL, NULL}};

void dml_open_discrete(lua_State *L) {
    dml_newclass(L, DML_DISCRETE,
                 "dm.discrete_lagrangian: Ld(q0, q1), made by dm.discrete_lagrangian{Q=, "
                 "h=, Ld=}\n"
                 "fields: Q, Ld, h, name, coordinates, units, params",
                 meta, methods, discrete_field);
    dml_setfunctions(L, functions);
}
