/* system_constraints.c - constraints and forces of a system as a script sees them. */
#include "bind/model/model_constraints.h"
#include "bind/model/named.h"
#include "bind/model/space_group.h"
#include "bind/value/array.h"

#include "bind/model/model_cache.h"

#include <math.h>
#include <string.h>

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
    dml_place_options(L, 1, lua_gettop(L), sees_v ? "state" : "position");
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
    if (!dml_has_function(L, 1, which))
        luaL_error(L, "this system has no %s: it was made without '%s ='",
                   which == DML_FORCE     ? "force"
                   : which == DML_CONTROL ? "control"
                                          : "such constraint",
                   dml_functionname(which));
    const double t = dml_optnumber(L, sees_v ? 4 : 3, 0.0);
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
