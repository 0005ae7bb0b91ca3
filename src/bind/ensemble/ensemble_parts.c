/* ensemble_parts.c - members whose parameters are no inputs of one kernel: parts with the same
 * ones, each a system of its own. A part that has no equations of motion (a mass that is zero)
 * fails without the others. */
#include "bind/ensemble/bind_ensemble.h"

#include <math.h>
#include <string.h>

enum { SWEEP = 32 }; /* parts after which their memory is asked back */

typedef struct {
    const dml_part *part;
    dml_part_run *run;
    void *ud;
    dm_status status;
} attempt;

/* (solver, options, attempt) */
static int try_part(lua_State *L) {
    attempt *a = lua_touserdata(L, 3);
    lua_settop(L, 2);
    a->status = a->run(L, a->part, a->ud);
    return 0;
}

/* keep what was raised, on top of the stack, as the message of every member of a part that has
 * no start */
static void fail_part(lua_State *L, const dml_part *p) {
    const size_t n = p->e->n, size = dm_state_size(p->e->n);
    luaL_tolstring(L, -1, NULL);
    dml_read_places(L, p); /* raises where these were the reason */
    dml_ensemblemessages(L, p->at);
    for (long i = p->first; i < p->first + p->count; i++) {
        double *momenta = p->e->state + (size_t)i * size + n;
        for (size_t k = 0; p->velocity && k < n; k++) momenta[k] = NAN;
        p->e->member[i] = (dm_member){.status = DM_NO_START};
        lua_pushvalue(L, -2);
        lua_rawseti(L, -2, i + 1);
    }
    lua_pop(L, 3);
}

/* 1: the part was run, as *status says */
static int is_run(lua_State *L, attempt *a) {
    lua_pushcfunction(L, try_part);
    lua_pushvalue(L, 1);
    lua_pushvalue(L, 2);
    lua_pushlightuserdata(L, a);
    if (dml_try(L, 3, 0)) return 1;
    fail_part(L, a->part);
    return 0;
}

/* the solver at 1 for the values of a part that begins at p->first */
static void take_part(lua_State *L, dml_part *p, const dml_varied *v) {
    p->count = dml_vary_alike(v->values, v->count, p->first, p->e->members);
    dml_vary_solver(L, v->values + (size_t)p->first * v->count, v->names, 0);
}

static void give_back(lua_State *L, int own) {
    lua_pushvalue(L, own);
    lua_replace(L, 1);
    lua_settop(L, own);
}

dm_status dml_run_parts(lua_State *L, dml_part *p, const dml_varied *v, dml_part_run *run,
                        void *ud) {
    const int own = lua_gettop(L) + 1;
    attempt a = {.part = p, .run = run, .ud = ud};
    long good = 0;
    p->varied = 1;
    lua_pushvalue(L, 1);
    for (long k = 1; p->first < p->e->members && a.status == DM_OK; k++) {
        take_part(L, p, v);
        good += is_run(L, &a);
        p->e->systems = k;
        p->first += p->count;
        give_back(L, own);
        if (k % SWEEP == 0) lua_gc(L, LUA_GCCOLLECT, 0);
    }
    if (good) return a.status;
    p->first = 0; /* what the first one raises is what there is to say */
    take_part(L, p, v);
    return run(L, p, ud);
}
