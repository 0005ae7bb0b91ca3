/* bind_system.c - `dm.system`: a configuration space and a Lagrangian L(q, v, t). */
#include "bind/model/bind_system.h"
#include "bind/model/model_constraints.h"
#include "bind/model/model_sums.h"
#include "bind/model/named.h"
#include "bind/model/space_group.h"
#include "bind/model/system_dual.h"

#include <math.h>
#include <stddef.h>
#include <string.h>

/* Both classes have one layout. */
dml_system *dml_checksystem(lua_State *L, int arg) {
    dml_system *s = luaL_testudata(L, arg, DML_SYSTEM);
    if (!s) s = luaL_testudata(L, arg, DML_DISCRETE);
    if (!s) luaL_typeerror(L, arg, "dm.system or dm.discrete_lagrangian");
    return s;
}

/* Fields are as the user gave them; nil for what was left out. */
int dml_systemfield(lua_State *L, int arg, const char *key) {
    lua_getiuservalue(L, arg, 1);
    const int type = lua_getfield(L, -1, key);
    lua_remove(L, -2);
    return type;
}

/* The string is left on the stack. */
const char *dml_coordinate(lua_State *L, int arg, uint32_t i) {
    if (dml_systemfield(L, arg, "coordinates") == LUA_TTABLE) {
        lua_geti(L, -1, (lua_Integer)i + 1);
        lua_remove(L, -2);
    } else {
        lua_pop(L, 1);
        lua_pushfstring(L, "q%d", (int)i + 1);
    }
    return lua_tostring(L, -1);
}

/* q and v or p at 2 and 3 of a system on a group, by way of the options of a start */
static void flatten(lua_State *L, const char *second) {
    lua_createtable(L, 0, 2);
    lua_pushvalue(L, 2), lua_setfield(L, -2, "q");
    lua_pushvalue(L, 3), lua_setfield(L, -2, second);
    dml_place_options(L, 1, lua_gettop(L), "state");
    lua_getfield(L, -1, "q");
    lua_replace(L, 2);
    lua_getfield(L, -1, second);
    lua_replace(L, 3);
    lua_pop(L, 1);
}

/* x = (q, v, t) from arguments 2, 3 and the optional 4; t = 0 when it is left out */
static double *arguments(lua_State *L, const dml_system *s, const char *second) {
    lua_settop(L, 4);
    const double t = dml_optnumber(L, 4, 0.0);
    if (s->placed) flatten(L, second);
    double *x = lua_newuserdatauv(L, (2 * (size_t)s->n + 1) * sizeof *x, 0);
    dml_unname(L, 1, 2, "q");
    dml_unname(L, 1, 3, second);
    dml_vectorarg(L, 2, "q", x, s->n);
    dml_vectorarg(L, 3, second, x + s->n, s->n);
    x[2 * s->n] = t;
    return x;
}

/* A result that is no number raises with the entry that is not. */
static void check_finite(lua_State *L, const double *y, uint32_t n, const char *what) {
    for (uint32_t i = 0; i < n; i++)
        if (!isfinite(y[i]))
            luaL_error(L, "%s is not finite (%s) at this point: is it inside the domain of L?",
                       what, isnan(y[i]) ? "NaN" : "infinite");
}

/* the kernel of a model, evaluated at the arguments; out is a userdata on the stack
 */
static double *evaluate(lua_State *L, unsigned want, size_t which, const char *what) {
    const dml_system *s = luaL_checkudata(L, 1, DML_SYSTEM);
    const double *x = arguments(L, s, s->hamiltonian ? "p" : "v");
    dml_model *m = dml_pushlast(L, 1, NULL);
    if (m->model.structure & DM_SADDLE)
        dml_asgiven(L, m = dml_pushmodel(L, 1));
    else
        m = dml_standin(L, -1, want);
    dml_want(L, m, want | DM_WANT_VALUE, NULL);
    dml_checkmember(L, 1, m, x); /* what the trace did not see is told, not computed */
    const dm_kernel *kernel = (const dm_kernel *)((const char *)&m->model + which);
    double *out = lua_newuserdatauv(L, kernel->outputs * sizeof *out, 0);
    dm_kernel_prepare(kernel, out);
    dm_kernel_eval(kernel, x, out);
    dml_rethrow(L, m);
    check_finite(L, out, kernel->outputs, what);
    return out;
}

/* (q, v, t): v . dL/dv - L; of an H (q, p, t) */
static int system_energy(lua_State *L) {
    const double *E = evaluate(L, DM_WANT_ENERGY, offsetof(dm_model, energy), "the energy");
    return lua_pushnumber(L, *E), 1;
}

/* (q, v, t): L itself, by its kernel. */
static int system_lagrangian(lua_State *L) {
    dml_need_lagrangian(L, "system:lagrangian");
    const double *value = evaluate(L, DM_WANT_VALUE, offsetof(dm_model, value), "L");
    lua_pushnumber(L, *value);
    return 1;
}

/* p with dH/dp = v, of a system that has only H */
static int momentum_of_velocity(lua_State *L, const dml_system *s) {
    const double *x = arguments(L, s, "v");
    dml_model *m = dml_pushlast(L, 1, NULL);
    dml_want(L, m, dml_legendre_wants(m, 0), NULL);
    double *work = lua_newuserdatauv(L, dm_legendre_work(&m->model) * sizeof *work, 0);
    double *p = lua_newuserdatauv(L, s->n * sizeof *p, 0);
    const dm_status status = dm_legendre(&m->model, p, x, x + s->n, x[2 * s->n], work);
    if (status != DM_OK)
        luaL_error(L, "no momentum has this velocity: %s; is d2H/dp2 regular at q?",
                   dm_status_text(status));
    memcpy(dml_pushvector(L, s->momenta), p, s->momenta * sizeof *p);
    return 1;
}

/* (q, v, t): p = dL/dv */
static int system_legendre(lua_State *L) {
    const dml_system *s = luaL_checkudata(L, 1, DML_SYSTEM);
    if (s->hamiltonian) return momentum_of_velocity(L, s);
    const double *p = evaluate(L, DM_WANT_SLOPE, offsetof(dm_model, slope), "the momentum");
    memcpy(dml_pushvector(L, s->momenta), p + s->n, s->momenta * sizeof *p);
    return 1;
}

/* a function of its own, so that help finds its own text */
static int system_momentum(lua_State *L) {
    return system_legendre(L);
}

/* (q, v, t): d2L/dv2, n x n */
static int system_mass(lua_State *L) {
    const dml_system *s = luaL_checkudata(L, 1, DML_SYSTEM);
    dml_need_lagrangian(L, "system:mass");
    const double *p = evaluate(L, DM_WANT_MASS, offsetof(dm_model, mass), "the mass matrix");
    double *mass = dml_pushmatrix(L, s->momenta, s->momenta);
    for (size_t i = 0; i < s->momenta; i++)
        memcpy(mass + i * s->momenta, p + s->n + i * s->n, s->momenta * sizeof *p);
    return 1;
}

/* (q, p, t): v with dL/dv = p, from v = 0 on. */
static int system_velocity(lua_State *L) {
    const dml_system *s = luaL_checkudata(L, 1, DML_SYSTEM);
    const double *x = arguments(L, s, "p");
    dml_model *m = dml_pushlast(L, 1, NULL);
    if (m->model.structure & DM_NO_VELOCITY)
        luaL_error(L, "no velocity has this momentum: L has no velocity in it, so that p = dL/dv "
                      "is 0");
    if (m->model.structure & DM_LINEAR_IN_V)
        luaL_error(L, "no velocity has this momentum: L is linear in v, so that p = dL/dv does not "
                      "depend on v");
    dml_want(L, m, DM_WANT_VALUE | dml_legendre_wants(m, 0), NULL);
    double *work = lua_newuserdatauv(L, dm_legendre_work(&m->model) * sizeof *work, 0);
    double *at = lua_newuserdatauv(L, (2 * (size_t)s->n + 1) * sizeof *at, 0);
    double *v = lua_newuserdatauv(L, s->n * sizeof *v, 0);
    memset(v, 0, s->n * sizeof *v);
    const dm_status status = dm_legendre_inverse(&m->model, v, x, x + s->n, x[2 * s->n], work);
    dml_rethrow(L, m);
    memcpy(at, x, (2 * (size_t)s->n + 1) * sizeof *x);
    if (!s->hamiltonian) memcpy(at + s->n, v, s->n * sizeof *v);
    if (status == DM_OK) dml_checkmember(L, 1, m, at);
    if (status != DM_OK)
        luaL_error(L, "no velocity has this momentum: %s; %s", dm_status_text(status),
                   status == DM_NOT_FINITE ? "no velocity inside the domain of L was found"
                                           : "is L regular (d2L/dv2 invertible) at q?");
    memcpy(dml_pushvector(L, s->momenta), v, s->momenta * sizeof *v);
    return 1;
}

/* Entry of the table on top. */
static void set_flag(lua_State *L, const char *name, int value) {
    lua_pushboolean(L, value);
    lua_setfield(L, -2, name);
}

/* What was found in the graph, and what rules use of it. */
static int system_structure(lua_State *L) {
    const dml_system *s = luaL_checkudata(L, 1, DML_SYSTEM);
    dml_model *m = dml_pushmodel(L, 1);
    const int saddle = (m->model.structure & DM_SADDLE) != 0;
    dml_asgiven(L, m);
    const unsigned bits = m->model.structure;
    lua_newtable(L);
    dml_setresult(L);
    set_flag(L, "separable", (bits & DM_SEPARABLE) != 0);
    set_flag(L, "constant_mass", (bits & DM_CONSTANT_MASS) != 0);
    set_flag(L, "diagonal_mass", (bits & DM_DIAGONAL_MASS) != 0);
    set_flag(L, "autonomous", (bits & DM_AUTONOMOUS) != 0);
    set_flag(L, "linear_in_v", (bits & DM_LINEAR_IN_V) != 0);
    set_flag(L, "quadratic_in_v", (bits & DM_QUADRATIC_IN_V) != 0);
    set_flag(L, "saddle", saddle);
    set_flag(L, "forced", m->constraints.forced || m->model.worked);
    set_flag(L, "hamiltonian", m->hamiltonian);
    lua_pushinteger(L, m->constraints.holonomic);
    lua_setfield(L, -2, "constraints");
    lua_pushinteger(L, m->constraints.rolling);
    lua_setfield(L, -2, "rolling");
    lua_pushinteger(L, m->model.operations);
    lua_setfield(L, -2, "operations");
    lua_newtable(L);
    for (uint32_t i = 0, k = 0; !s->placed && m->model.cyclic && i < s->n; i++) {
        if (!m->model.cyclic[i]) continue;
        dml_coordinate(L, 1, i);
        lua_rawseti(L, -2, (lua_Integer)++k);
    }
    lua_setfield(L, -2, "cyclic");
    return 1;
}

/* names and units at the top of the stack: others in them would reach half of what was made */
static void lock_names(lua_State *L, const char *key) {
    const int is_units = strcmp(key, "units") == 0;
    if (!lua_istable(L, -1) || (!is_units && strcmp(key, "coordinates") != 0)) return;
    dml_lock(L, is_units ? "the table of units of a system" : "the list of names of coordinates");
}

int dml_shownfield(lua_State *L, const char *key) {
    dml_systemfield(L, 1, key);
    lock_names(L, key);
    return 1;
}

/* a copy of the options that the system was made with, but its own params, as members have them */
static int push_given(lua_State *L) {
    lua_newtable(L);
    lua_getiuservalue(L, 1, 1);
    if (dml_placed(L, 1)) {
        lua_getfield(L, -1, "place");
        lua_getfield(L, -1, "given");
        lua_copy(L, -1, -3);
        lua_pop(L, 2);
    }
    for (lua_pushnil(L); lua_next(L, -2);) {
        lua_pushvalue(L, -2);
        lua_insert(L, -2);
        lua_rawset(L, -5);
    }
    lua_pop(L, 1);
    dml_systemfield(L, 1, "params"), lua_setfield(L, -2, "params");
    for (const char *const *key = dml_names; *key; key++)
        lua_getfield(L, -1, *key), lock_names(L, *key), lua_setfield(L, -2, *key);
    return 1;
}

static int system_field(lua_State *L) {
    luaL_checkudata(L, 1, DML_SYSTEM);
    const char *key = luaL_checkstring(L, 2);
    if (strcmp(key, "given") == 0)
        return push_given(L), dml_lock(L, "a field of the options of a system"), 1;
    if (strcmp(key, "L") == 0 && dml_placed(L, 1))
        return push_given(L), lua_getfield(L, -1, key), 1;
    if (strcmp(key, "params") == 0) return dml_shownparams(L);
    static const char *const fields[] = {"Q",     "L",     "H",     "name", "coordinates",
                                         "units", "place", "field", NULL};
    for (const char *const *f = fields; *f; f++)
        if (strcmp(*f, key) == 0) return dml_shownfield(L, key);
    return 0;
}

static const dml_row meta[] = {{"__tostring", dml_system_tostring, NULL}, {NULL, NULL, NULL}};
static const dml_row methods[] =
    {{"energy", system_energy,
      "system:energy(q, v [, t]) -> number\n"
      "v . dL/dv - L, in the units of L; q, v: vectors or tables of dim Q numbers, t: 0 unless "
      "given. Of an H that has no Lagrangian: system:energy(q, p [, t]), H itself. Raises where it "
      "is not finite, as do the other methods of a state."},
     {"lagrangian", system_lagrangian,
      "system:lagrangian(q, v [, t]) -> number\n"
      "L(q, v, t) through the kernel that was traced from it, in the units of L."},
     {"legendre", system_legendre,
      "system:legendre(q, v [, t]) -> dm.vector\n"
      "The momentum p = dL/dv of dim Q entries (the Legendre transform), entry i in units of L "
      "over those of v_i; inverse: system:velocity."},
     {"momentum", system_momentum,
      "system:momentum(q, v [, t]) -> dm.vector\n"
      "The same as system:legendre, p = dL/dv; the momentum map of a group along a path is "
      "path:momentum(group)."},
     {"velocity", system_velocity,
      "system:velocity(q, p [, t]) -> dm.vector\n"
      "The velocity v with dL/dv(q, v, t) = p, by Newton to round-off; of an H, dH/dp. Raises when "
      "d2L/dv2 is singular, or L linear in v."},
     {"mass", system_mass,
      "system:mass(q, v [, t]) -> dm.matrix\n"
      "The mass matrix d2L/dv2, dim Q x dim Q; singular where L is degenerate."},
     {"structure", system_structure,
      "system:structure() -> table\n"
      "What was read off the graph of L: separable, constant_mass, diagonal_mass, autonomous, "
      "linear_in_v, quadratic_in_v (d2L/dv2 does not depend on v), saddle (d2L/dv2 is singular by "
      "itself and regular with the constraints; rules "
      "step L plus squares of the constraints' velocities, which vanish) (booleans), cyclic (names "
      "of coordinates that L does not depend on), operations; and how the system is constrained: "
      "constraints, rolling (how many), forced (boolean). hamiltonian: H(q, p) is stepped as it "
      "stands, no formula gives an L of it; separable is then H = T(p) + V(q, t)."},
     {"graph", dml_system_graph,
      "system:graph() -> string\n"
      "The expression graph of L, one assignment a line; coordinates and their rates by name."},
     {NULL, NULL, NULL}};
static const dml_row functions[] =
    {{"stand_in", dml_stand_in_new,
      "core.stand_in{Q=, L=, name=, constraint=, rolling=, reaction=, crossings=} -> dm.system\n"
      "A system on a group that steps of a discrete Lagrangian are run with: L only says how they "
      "begin, and paths have no energy and no velocity; starts are on its constraints."},
     {"prolonged", dml_prolonged_new,
      "core.prolonged{Q=, L= | H=, constraint=, rolling=, force=, control=, reaction=, params=, "
      "crossings=} -> dm.system\n"
      "A dm.system of (q, u) whose runs are tangent maps: the first half of its constraints are "
      "those of q alone, the second half their change along u."},
     {"system", dml_system_new,
      "dm.system{Q=, L= | H=, constraint=, rolling=, force=, control=, reaction=, name=, "
      "coordinates=, units=, params=, derivatives=, crossings=} -> dm.system\n"
      "A mechanical system on the space Q with the Lagrangian L(q, v), L(q, v, t) or, with params, "
      "L(q, v, t, params); q, v are vectors of dim Q entries. L is called with symbols at every "
      "run, so a changed upvalue is picked up. coordinates: dim Q names, used for columns; units: "
      "table name -> unit, used for labels; derivatives: \"exact\" (traced, the default) or "
      "\"hyperdual\" for functions that branch on the state. Raises when L cannot be traced, with "
      "what to use instead.\n"
      "H(q, p), H(q, p, t) or H(q, p, t, params) in place of L: a Hamiltonian. Quadratic in p with "
      "a regular mass it is taken as its Lagrangian, in the field L, and every rule steps it; "
      "functions of a state get v = dH/dp. Any other (point vortices, H = q p, a relativistic "
      "particle) is stepped as it stands, by rules of stages and explicit rules, and starts from q "
      "and p, or from v where dH/dp = v has a solution.\n"
      "constraint(q [, t]) returns what shall be zero along every path (holonomic: reactions along "
      "its gradient), rolling(q, v [, t]) what shall be zero of the velocities (reactions along "
      "its derivative in v, Chetaev's rule, or along the rows that reaction(q, v [, t]) returns), "
      "force(q, v [, t]) dim Q numbers (friction, driving) that are added to dL/dq (discrete "
      "Lagrange-d'Alembert); with control(q, v [, t]) it is force(q, v, t, u), where u is what "
      "control returned at the start of the step and is held over it; each a number, a vector or a "
      "table, traced like L. Rules without them refuse the system and name others. A step over a "
      "place where constraints cross, as the flat position of a parallelogram, ends the run; with "
      "crossings = true steps go over it, mostly straight on."},
     {NULL, NULL, NULL}};

static const dml_extension more[] = {
    {DML_SYSTEM, dml_constraint_methods},
    {NULL, NULL},
};

const dml_class dml_class_system = {
    .name = DML_SYSTEM,
    .doc = "dm.system: a configuration space and a Lagrangian, made by dm.system{Q=, L=}\n"
           "fields: Q, L, name, coordinates, units, params, given (all options as they were given, "
           "to be read); "
           "system.params.k = 3 reaches the next run, a new name that nothing reads is refused",
    .meta = meta,
    .methods = methods,
    .field = system_field,
    .functions = functions,
    .more = more,
};
