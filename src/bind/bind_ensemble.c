/* bind_ensemble.c - `solver:ensemble{}`: many members at once, and the `dm.ensemble` that they end in. */
#include "bind/failure.h"
#include "bind/stepping.h"
#include "bind/terminal.h"
#include "run/ensemble.h"

#include <math.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

static const char *const TNAME = "dm.ensemble";
enum { MOST_MEMBERS = 100000000 };

typedef struct {
    long members;
    uint32_t n;
    double t, h;
    double *state;     /* members x dm_state_size(n) */
    dm_member *member; /* members */
} ensemble;

static ensemble *check(lua_State *L) {
    return luaL_checkudata(L, 1, TNAME);
}

/* ---- making one ---- */

static ensemble *push_ensemble(lua_State *L, long members, uint32_t n) {
    const double memory = (double)sysconf(_SC_PHYS_PAGES) * (double)sysconf(_SC_PAGESIZE);
    const size_t each = dm_state_size(n) * sizeof(double) + sizeof(dm_member);
    if ((double)members * (double)each > 0.5 * memory)
        luaL_error(L,
                   "%d members need %f GB, more than half of this machine's memory: run "
                   "them in parts",
                   (int)members, (double)members * (double)each * 1e-9);
    ensemble *e = lua_newuserdatauv(L, sizeof *e + (size_t)members * each, 1);
    *e = (ensemble){.members = members, .n = n};
    e->state = (double *)(e + 1);
    e->member = (dm_member *)(void *)(e->state + (size_t)members * dm_state_size(n));
    memset(e->state, 0, (size_t)members * each);
    luaL_setmetatable(L, TNAME);
    return e;
}

/* n numbers for member i from field `key`: a function of i, or a matrix or table with a row for each */
static void read_member(lua_State *L, const char *key, long i, double *out, uint32_t n) {
    if (lua_getfield(L, 2, key) == LUA_TFUNCTION) {
        lua_pushinteger(L, i + 1);
        lua_call(L, 1, 1);
    } else {
        lua_geti(L, -1, i + 1);
        lua_remove(L, -2);
    }
    const char *name = lua_pushfstring(L, "'%s' of member %d", key, (int)i + 1);
    dml_vectorarg(L, -2, name, out, n);
    lua_pop(L, 2);
}

static void check_source(lua_State *L, const char *key, long members) {
    const int type = lua_getfield(L, 2, key);
    if (type != LUA_TFUNCTION && type != LUA_TTABLE && type != LUA_TUSERDATA)
        luaL_error(L,
                   "field '%s' must be a function of the member's number, or a table or "
                   "matrix with a row for "
                   "each of the %d members (got %s)",
                   key, (int)members, luaL_typename(L, -1));
    if (type != LUA_TFUNCTION && luaL_len(L, -1) != members)
        luaL_error(L, "field '%s' has %d rows for %d members", key, (int)luaL_len(L, -1),
                   (int)members);
    lua_pop(L, 1);
}

static int has(lua_State *L, const char *key) {
    const int there = lua_getfield(L, 2, key) != LUA_TNIL;
    lua_pop(L, 1);
    return there;
}

/* the trace is checked at the first member */
static void check_trace(lua_State *L, dml_stepping *r, int velocity) {
    if (velocity) {
        read_member(L, "q", 0, r->x, r->solver->n);
        read_member(L, "v", 0, r->x + r->solver->n, r->solver->n);
        r->x[2 * r->solver->n] = r->t0;
    }
    dml_checkmodel(L, r->system, r->model, velocity ? r->x : NULL);
}

/* all starts: q, and p given or by the Legendre transform; a member whose transform fails is marked */
static void read_starts(lua_State *L, ensemble *e, dml_stepping *r) {
    const int velocity = has(L, "v");
    const char *second = velocity ? "v" : "p";
    double *x = r->x;
    if (velocity == has(L, "p"))
        luaL_error(
            L, "give the starts as q and v or as q and p: one of 'v' and 'p' is needed");
    if (velocity && r->solver->pair)
        luaL_error(L, "a discrete Lagrangian knows no velocity: give the momentum 'p'");
    check_source(L, "q", e->members);
    check_source(L, second, e->members);
    check_trace(L, r, velocity);
    for (long i = 0; i < e->members; i++) {
        double *q = e->state + (size_t)i * dm_state_size(e->n), *p = q + e->n;
        read_member(L, "q", i, q, e->n);
        read_member(L, second, i, p, e->n);
        if (!velocity) continue;
        memcpy(x, p, e->n * sizeof *x);
        if (dm_legendre(&r->model->model, p, q, x, r->t0, r->work) != DM_OK) p[0] = NAN;
        dml_rethrow(L, r->model);
    }
}

/* ---- running it ---- */

static int default_threads(const dml_stepping *r) {
    const long cores = sysconf(_SC_NPROCESSORS_ONLN);
    if (r->model->callback) return 1; /* Lua runs in one thread */
    return cores < 1 ? 1 : cores > DM_ENSEMBLE_THREADS ? DM_ENSEMBLE_THREADS : (int)cores;
}

static int read_threads(lua_State *L, const dml_stepping *r) {
    const long threads = dml_count(L, 2, "threads", 1, default_threads(r));
    if (threads > DM_ENSEMBLE_THREADS)
        luaL_error(L, "field 'threads' must be at most %d", DM_ENSEMBLE_THREADS);
    return r->model->callback ? 1 : (int)threads;
}

static long read_members(lua_State *L) {
    const long members = dml_count(L, 2, "members", 1, 0);
    if (members > MOST_MEMBERS)
        luaL_error(L, "field 'members' must be at most %d: run more in parts",
                   MOST_MEMBERS);
    return members;
}

typedef struct {
    lua_State *L;
    double start, told; /* s */
} clock_of_run;

static double now(void) {
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static void show_progress(void *ud, long done, long members) {
    clock_of_run *c = ud;
    const double t = now(), rate = (double)done / (t - c->start);
    if (t - c->told < 0.1) return;
    c->told = t;
    dml_progress(c->L, "ensemble", (double)done / (double)members, rate,
                 (double)(members - done) / rate);
}

/* steps, or t = duration, as solver:run reads them */
static long read_steps(lua_State *L, double h) {
    if (!has(L, "t")) return dml_count(L, 2, "steps", 0, -1);
    if (has(L, "steps"))
        luaL_error(L, "give either 'steps' or 't' (a duration), not both");
    return (long)ceil(dml_positive(L, 2, "t", 0) / h - 1e-9);
}

/* a model and stepper for every thread but the first, which has those of *r; leaves them on the stack */
static void open_steppers(lua_State *L, dml_stepping *r, int threads,
                          dm_stepper **steppers) {
    for (int i = 1; i < threads; i++) {
        luaL_checkstack(L, 8, "too many threads");
        dml_stepping *other = lua_newuserdatauv(L, sizeof *other, 0);
        *other = (dml_stepping){.solver = r->solver};
        dml_stepping_prepare(L, other, r->t0);
        steppers[i] = &other->stepper;
    }
    steppers[0] = &r->stepper;
}

/* open all or none */
static dm_status open_all(dm_stepper **steppers, int threads) {
    for (int i = 0; i < threads; i++) {
        const dm_method *m = steppers[i]->method;
        const dm_status status = m->open ? m->open(steppers[i]) : DM_OK;
        if (status == DM_OK) continue;
        for (int k = 0; k <= i; k++)
            if (m->close) m->close(steppers[k]);
        return status;
    }
    return DM_OK;
}

static int solver_ensemble(lua_State *L) {
    static const char *const known[] = {"members", "q",  "v",       "p", "steps",
                                        "t",       "t0", "threads", NULL};
    dml_stepping r = {.solver = luaL_checkudata(L, 1, DML_SOLVER)};
    dm_stepper *steppers[DM_ENSEMBLE_THREADS];
    lua_settop(L, 2);
    luaL_checktype(L, 2, LUA_TTABLE);
    dml_options(L, 2, known);
    const long members = read_members(L), steps = read_steps(L, r.solver->h);
    dml_stepping_prepare(L, &r, dml_number(L, 2, "t0", 0.0));
    const int threads = read_threads(L, &r);
    ensemble *e = push_ensemble(L, members, r.solver->n);
    const int at = lua_gettop(L);
    read_starts(L, e, &r);
    open_steppers(L, &r, threads, steppers);
    clock_of_run clock = {.L = L, .start = now()};
    const dm_ensemble plan = {.members = members,
                              .steps = steps,
                              .t0 = r.t0,
                              .state = e->state,
                              .member = e->member,
                              .stop = &dml_stop,
                              .progress = show_progress,
                              .ud = &clock};
    dm_status status = open_all(steppers, threads);
    if (status != DM_OK) luaL_error(L, "rule cannot start: %s", dm_status_text(status));
    status = dm_ensemble_run(&plan, steppers, threads);
    for (int i = 0; i < threads; i++)
        if (r.solver->method->close) r.solver->method->close(steppers[i]);
    dml_progress_end(L);
    dml_rethrow(L, r.model);
    e->h = r.solver->h;
    e->t = r.t0 + e->h * (double)steps;
    if (status == DM_STOPPED) {
        dml_stop = 0;
        const dml_failure f = {
            .status = status, .time = r.t0, .h = e->h, .rule = "ensemble"};
        dml_fail(L, &f, at);
    }
    lua_settop(L, at);
    return 1;
}

/* ---- what can be asked of it ---- */

/* a matrix members x n of the entries from `first` of every state */
static int push_states(lua_State *L, const ensemble *e, uint32_t first) {
    double *out = dml_pushmatrix(L, (uint32_t)e->members, e->n);
    for (long i = 0; i < e->members; i++)
        memcpy(out + (size_t)i * e->n, e->state + (size_t)i * dm_state_size(e->n) + first,
               e->n * sizeof *out);
    return 1;
}

static int push_status(lua_State *L, const ensemble *e) {
    lua_createtable(L, (int)e->members, 0);
    for (long i = 0; i < e->members; i++) {
        lua_pushstring(L, dm_status_code(e->member[i].status));
        lua_rawseti(L, -2, i + 1);
    }
    return 1;
}

static int push_steps(lua_State *L, const ensemble *e) {
    lua_createtable(L, (int)e->members, 0);
    for (long i = 0; i < e->members; i++) {
        lua_pushinteger(L, e->member[i].steps);
        lua_rawseti(L, -2, i + 1);
    }
    return 1;
}

static int make_field(lua_State *L, const ensemble *e, const char *key) {
    if (strcmp(key, "q") == 0) return push_states(L, e, 0);
    if (strcmp(key, "p") == 0) return push_states(L, e, e->n);
    if (strcmp(key, "status") == 0) return push_status(L, e);
    if (strcmp(key, "steps") == 0) return push_steps(L, e);
    return 0;
}

/* the large fields are made when first asked for and kept in user value 1 */
static int ensemble_field(lua_State *L) {
    const ensemble *e = check(L);
    const char *key = luaL_checkstring(L, 2);
    if (strcmp(key, "t") == 0) return lua_pushnumber(L, e->t), 1;
    if (strcmp(key, "h") == 0) return lua_pushnumber(L, e->h), 1;
    if (lua_getiuservalue(L, 1, 1) != LUA_TTABLE) {
        lua_newtable(L);
        lua_pushvalue(L, -1);
        lua_setiuservalue(L, 1, 1);
    }
    if (lua_getfield(L, -1, key) != LUA_TNIL) return 1;
    if (!make_field(L, e, key)) return 0;
    lua_pushvalue(L, -1);
    lua_setfield(L, -4, key);
    return 1;
}

static int ensemble_len(lua_State *L) {
    lua_pushinteger(L, check(L)->members);
    return 1;
}

static long count_failed(const ensemble *e) {
    long failed = 0;
    for (long i = 0; i < e->members; i++) failed += e->member[i].status != DM_OK;
    return failed;
}

/* e:failures() -> { {member =, code =, step =}, ... } */
static int ensemble_failures(lua_State *L) {
    const ensemble *e = check(L);
    lua_Integer count = 0;
    lua_newtable(L);
    for (long i = 0; i < e->members; i++) {
        if (e->member[i].status == DM_OK) continue;
        lua_createtable(L, 0, 3);
        lua_pushinteger(L, i + 1), lua_setfield(L, -2, "member");
        lua_pushstring(L, dm_status_code(e->member[i].status)),
            lua_setfield(L, -2, "code");
        lua_pushinteger(L, e->member[i].steps + 1), lua_setfield(L, -2, "step");
        lua_rawseti(L, -2, ++count);
    }
    return 1;
}

static int ensemble_tostring(lua_State *L) {
    const ensemble *e = check(L);
    const long failed = count_failed(e);
    lua_pushfstring(L, "ensemble of %d members at t = %f: ", (int)e->members, e->t);
    if (failed)
        lua_pushfstring(L, "%d failed (see failures())", (int)failed);
    else
        lua_pushstring(L, "all ok");
    lua_concat(L, 2);
    return 1;
}

static const dml_row meta[] = {{"__len", ensemble_len, NULL},
                               {"__tostring", ensemble_tostring, NULL},
                               {NULL, NULL, NULL}};
static const dml_row methods[] = {
    {"failures", ensemble_failures,
     "ensemble:failures() -> table of {member, code, step}\n"
     "The members that did not reach the end, why (see dm.failure), and the step that "
     "failed."},
    {NULL, NULL, NULL}};
static const dml_row solver_row[] = {
    {"ensemble", solver_ensemble,
     "solver:ensemble{members=, q=, v=, p=, steps=, t=, t0=, threads=} -> dm.ensemble\n"
     "Run `members` starts side by side for `steps` steps or the duration t. q, and v or "
     "p: functions of the member's "
     "number (from 1) that return dim Q numbers, or a matrix or table with a row per "
     "member. threads: default "
     "one per core (always one for hyper-dual functions). Each member ends with the same "
     "bits as a run of its own, "
     "whatever the number of threads; one that fails does so alone (status[i], "
     "failures()). Only the ends are kept: "
     "32 dim Q bytes a member. Raises dm.failure with the ensemble as its path on "
     "Ctrl-C."},
    {NULL, NULL, NULL}};

void dml_open_ensemble(lua_State *L) {
    dml_newclass(L, TNAME,
                 "dm.ensemble: the ends of many runs, made by solver:ensemble{members=}\n"
                 "fields: q, p (matrices, a row per member; of a failed one its last "
                 "good state), status[i] (\"ok\" or a "
                 "code of dm.failure), steps[i] (finished), t, h; #ensemble members",
                 meta, methods, ensemble_field);
    dml_addmethods(L, DML_SOLVER, solver_row);
}
