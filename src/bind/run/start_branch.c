/* start_branch.c - the start of a run as it is given: names, elements of groups, which of the
 * velocities of a momentum is meant, how many steps. */
#include "bind/run/start_constraints.h"

#include "bind/model/space_group.h"
#include "bind/run/checkpoint.h"
#include "bind/value/value.h"

#include <math.h>
#include <string.h>

/* of the larger: what a search for v from p leaves, where p hardly tells it, is less */
static const double APART = 1e-5;

void dml_check_velocity(lua_State *L, dml_stepping *r, const double *state, const double *v,
                        const char *who) {
    const dm_model *m = &r->model->model;
    double *found = r->work + dm_legendre_work(m), apart = 0.0, size = 0.0;
    if (m->structure & (DM_QUADRATIC_IN_V | DM_HAMILTONIAN) || r->model->callback) return;
    memset(found, 0, m->n * sizeof *found);
    if (dm_legendre_inverse(m, found, state, state + m->n, r->t0, r->work) != DM_OK)
        return; /* the first step says so */
    for (uint32_t i = 0; i < m->n; i++) {
        apart = fmax(apart, fabs(found[i] - v[i]));
        size = fmax(size, fmax(fabs(v[i]), fabs(found[i])));
    }
    if (apart <= APART * size) return;
    luaL_error(L,
               "%sno start: L is not convex in v, so that the momentum of this v belongs to other "
               "velocities too, and a run, which goes on from q and p, would take one of these",
               who);
}

/* Is option `key` of the table at 2 given? */
static int has(lua_State *L, const char *key) {
    const int there = lua_getfield(L, 2, key) != LUA_TNIL;
    lua_pop(L, 1);
    return there;
}

/* The table at 2 is replaced by a copy; that of the user stays as it is. */
static void rename_start(lua_State *L) {
    static const char *const from[] = {"q0", "p0"}, *const to[] = {"q", "p"};
    if (!has(L, "p0")) return;
    if (has(L, "q") || has(L, "p") || has(L, "v") || has(L, "q1") || !has(L, "q0"))
        luaL_error(L, "give the momentum p0 with the position q0 alone");
    lua_newtable(L);
    for (lua_pushnil(L); lua_next(L, 2);) {
        lua_pushvalue(L, -2);
        lua_insert(L, -2);
        lua_rawset(L, -4);
    }
    for (int i = 0; i < 2; i++) {
        lua_getfield(L, 2, from[i]);
        lua_setfield(L, -2, to[i]);
        lua_pushnil(L);
        lua_setfield(L, -2, from[i]);
    }
    lua_replace(L, 2);
}

void dml_carried(lua_State *L, int system) {
    if (has(L, "a") && !dml_placed(L, system))
        luaL_error(L, "field 'a' is for reduced systems that carry a quantity along "
                      "(dm.euler_poincare, advected =)");
}

void dml_pushcarried(lua_State *L, dml_checkpoint *c) {
    if (!c || !c->carried)
        lua_pushnil(L);
    else
        memcpy(dml_pushvector(L, c->carried), dml_checkpoint_carried(c),
               c->carried * sizeof(double));
}

/* what was carried along to the checkpoint that the solver at 1 goes on from, unless it is given */
static void carry_on(lua_State *L) {
    const int top = lua_gettop(L);
    lua_getiuservalue(L, 1, DML_SOLVER_START);
    dml_checkpoint *c = lua_touserdata(L, -1);
    if (c && c->carried && !has(L, "a")) {
        dml_pushcopy(L, 2);
        dml_pushcarried(L, c);
        lua_setfield(L, -2, "a");
        lua_replace(L, 2);
    }
    lua_settop(L, top);
}

/* q0 and p0 are q and p; of a system on a group elements are flat coordinates. */
void dml_stepping_names(lua_State *L) {
    rename_start(L);
    carry_on(L);
    const int goes_on = lua_getiuservalue(L, 1, DML_SOLVER_START) != LUA_TNIL;
    lua_getiuservalue(L, 1, DML_SOLVER_SYSTEM);
    dml_carried(L, lua_gettop(L));
    dml_place_options(L, -1, 2, goes_on ? "more" : "start");
    lua_settop(L, 2);
}

/* A duration that h divides to round-off takes no step more. */
long dml_stepping_cover(lua_State *L, const dml_solver *s, double duration, double h) {
    if (s->method->traits & DM_OWN_TIME)
        luaL_error(L,
                   "rule '%s' has a time of its own: give 'steps', or, to solver:run, 'at' for "
                   "the states at given times",
                   s->nodes[0].name);
    const double n = ceil(duration / h - 1e-9);
    if (!(n < 9e15)) luaL_error(L, "%f steps of h = %f are too many", n, h);
    return n < 0.0 ? 0 : (long)n;
}
