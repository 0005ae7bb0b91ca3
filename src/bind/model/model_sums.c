#include "bind/model/model_sums.h"

#include "algebra/body_sum.h"
#include "bind/core/scope.h"
#include "chain/loops.h"

/* sums are loops again, or what they were before; the scope is its first member */
static void end_given(dml_state *state, dml_scope *scope) {
    state->given = ((dml_given *)scope)->before;
}

/* Closing it takes it out of the list, also when an error passes. */
void dml_pushgiven(lua_State *L, const dm_graph *g, int checked) {
    dml_state *state = dml_getstate(L);
    dml_given *given = dml_pushscope(L, sizeof *given, 0, end_given);
    given->graph = g;
    given->looked = checked ? UINT32_MAX : 0;
    given->within = state->frames;
    given->before = state->given;
    state->given = given;
}

/* What is pushed must stay until the comparison is over. */
const double *dml_givesums(lua_State *L, const dml_model *m, const dm_kernel **kernel,
                           const double *x) {
    double value;
    const double *with;
    if (!(m->model.structure & DM_LOOPS) || !dm_sums(m->graph)) return x;
    if (x) dm_kernel_eval(*kernel, x, &value);
    *kernel = dm_loops_outer(*kernel, &with);
    dml_pushgiven(L, m->graph, m->checked);
    return x ? with : NULL;
}

/* push a model of the same trace as the one at `at`, which keeps it */
static void push_twin(lua_State *L, int at, const dml_model *m) {
    dml_model *twin = lua_newuserdatauv(L, sizeof *twin, 5);
    *twin = *m;
    twin->cache = NULL;
    twin->model.has = 0;
    twin->checked = 0;
    for (int k = 1; k <= 3; k++) {
        lua_getiuservalue(L, at, k);
        lua_setiuservalue(L, -2, k);
    }
    lua_pushvalue(L, -1);
    lua_setiuservalue(L, at, 5);
}

/* Dense kernels see all bodies at once, which loops do not give. */
static int needs_tables(const dml_model *m, unsigned want) {
    return want & DM_WANT_DENSE && m->model.structure & DM_LOOPS && dm_sums(m->graph) &&
           m->n <= DM_MODEL_DENSE && !dm_sum_over_near(m->graph);
}

/* Slope and mass are taken out of the stage kernel where there is one, and round in another way
 * than alone: a rule that does without it shall have the same bits whatever ran before it. */
static int needs_own(const dml_model *m, unsigned want) {
    const unsigned simple = DM_SEPARABLE | DM_CONSTANT_MASS;
    const unsigned shared =
        (m->model.structure & simple) == simple ? DM_WANT_SLOPE : DM_WANT_SLOPE | DM_WANT_MASS;
    return m->model.has & DM_WANT_STAGE && !(want & (DM_WANT_STAGE | DM_WANT_STAGE_LATER)) &&
           want & shared;
}

/* The stack index stays, the model there may be another one. */
dml_model *dml_standin(lua_State *L, int at, unsigned want) {
    dml_model *m = lua_touserdata(L, at);
    at = lua_absindex(L, at);
    if (m->callback || !m->graph || (!needs_tables(m, want) && !needs_own(m, want))) return m;
    if (lua_getiuservalue(L, at, 5) != LUA_TUSERDATA) {
        lua_pop(L, 1);
        push_twin(L, at, m);
    }
    dml_model *twin = lua_touserdata(L, -1);
    twin->trace_ms = m->trace_ms;
    twin->compile_ms = 0.0;
    lua_replace(L, at);
    return twin;
}

/* Kernels made before go. */
void dml_writeout(lua_State *L, dml_model *m) {
    if (!m->graph || !dm_sums(m->graph)) return;
    dml_refusecells(L, m, "this");
    if (m->n > DM_MODEL_DENSE)
        luaL_error(L,
                   "the sums of dm.sum_over are written out up to %d coordinates (this system has "
                   "%d)",
                   DM_MODEL_DENSE, (int)m->n);
    dm_graph *plain = dm_graph_new(m->arena, dm_sum_first(m->graph));
    if (!plain) luaL_error(L, "not enough memory");
    m->lagrangian = m->stepped = dm_sum_write_out(plain, m->graph, m->lagrangian);
    m->graph = plain;
    const dm_status status = dm_graph_status(plain);
    if (status != DM_OK) luaL_error(L, "%s", dm_status_text(status));
}

/* Of any other model nothing is raised. Sums over near pairs are refused in their own words. */
void dml_refusecells(lua_State *L, const dml_model *m, const char *why) {
    if (dm_sum_over_near(m->graph))
        luaL_error(L,
                   "%s needs second derivatives of L, which sums over pairs within a distance do "
                   "not have: they are for explicit rules (\"verlet\", \"blanes-moan(6)\"), "
                   "without constraints, forces or groups",
                   why);
    if (!dm_sum_over_cells(m->graph)) return;
    if (m->model.inverse_mass)
        luaL_error(L,
                   "%s cannot be had of a field: it asks for second derivatives of L as a full "
                   "matrix, which the sums over cells of a field do not have (verlet, midpoint, "
                   "trapezoidal, gauss(s), lobatto(s), compositions and explicit Runge-Kutta rules "
                   "do without)",
                   why);
    luaL_error(L,
               "%s cannot be had of a field: its kinetic energy must be a sum of m v^2 / 2 over "
               "cells with masses that are numbers, as v:dot(v) / 2 is",
               why);
}

/* Conjugate gradients are for the one symmetric matrix of one stage and one value. */
void dml_refusestages(lua_State *L, const char *rule) {
    luaL_error(L,
               "rule '%s' solves for several stages or values of a field at once, which needs "
               "dm/sparse.so (libsuitesparse-dev); take midpoint or a composition of it, of a "
               "field "
               "of one value",
               rule);
}
