/* ensemble_run.c - `solver:ensemble{}`: threads, parts with the same parameters, the run itself. */
#include "bind/core/bind_failure.h"
#include "bind/core/bind_terminal.h"
#include "bind/core/missing_key.h"
#include "bind/ensemble/bind_ensemble.h"
#include "bind/model/model_sums.h"
#include "bind/model/space_group.h"
#include "bind/rule/bind_step.h"
#include "bind/run/observables.h"
#include "integ/method/lanes.h"
#include "run/run.h"

#include <math.h>
#include <stddef.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

typedef dml_ensemble ensemble;
enum { MOST_MEMBERS = 100000000 };

static int has(lua_State *L, const char *key) {
    const int there = lua_getfield(L, 2, key) != LUA_TNIL;
    lua_pop(L, 1);
    return there;
}

/* ---- running it ---- */

static int default_threads(void) {
    const long cores = sysconf(_SC_NPROCESSORS_ONLN);
    return cores < 1 ? 1 : cores > DM_ENSEMBLE_THREADS ? DM_ENSEMBLE_THREADS : (int)cores;
}

static int read_threads(lua_State *L) {
    if (!has(L, "threads")) return default_threads();
    const long threads = dml_count(L, 2, "threads", 1, 1);
    if (threads > DM_ENSEMBLE_THREADS)
        luaL_error(L, "field 'threads' must be at most %d", DM_ENSEMBLE_THREADS);
    return (int)threads;
}

static long read_members(lua_State *L) {
    const long members = dml_count(L, 2, "members", 1, 0);
    if (members > MOST_MEMBERS)
        luaL_error(L, "field 'members' must be at most %d: run more in parts", MOST_MEMBERS);
    return members;
}

typedef struct {
    lua_State *L;
    double start, told; /* s */
    double before, all; /* steps of the members of earlier parts, of all members */
} clock_of_run;

static double now(void) {
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static void show_progress(void *ud, long done) {
    clock_of_run *c = ud;
    const double t = now(), finished = c->before + (double)done;
    const double rate = finished / (t - c->start);
    if (t - c->told < 0.1) return;
    c->told = t;
    dml_progress(c->L, "ensemble", finished / c->all, rate, (c->all - finished) / rate);
}

/* steps of the members before the one at `end` */
static double steps_before(const dml_part *p, long end) {
    const dm_pace *pace = p->e->pace;
    double steps = pace ? 0.0 : (double)p->steps * (double)end;
    for (long i = 0; pace && i < end; i++) steps += (double)pace[i].steps;
    return steps;
}

/* steps, or t = duration, as solver:run reads them */
static long read_steps(lua_State *L, const dml_solver *s) {
    if (!has(L, "t") && !has(L, "steps"))
        luaL_error(L, "how long? 'steps' (how many) or 't' (a duration) is missing");
    if (!has(L, "t")) return dml_count(L, 2, "steps", 0, -1);
    if (has(L, "steps")) luaL_error(L, "give either 'steps' or 't' (a duration), not both");
    return dml_stepping_cover(L, s, dml_positive(L, 2, "t", 0), s->h);
}

/* a model and stepper for every thread but the first, which has those of *r; leaves them on the
 * stack */
static void open_steppers(lua_State *L, dml_stepping *r, int threads, dm_stepper **steppers) {
    for (int i = 1; i < threads; i++) {
        luaL_checkstack(L, 8, "too many threads");
        dml_stepping *other = lua_newuserdatauv(L, sizeof *other, 0);
        *other =
            (dml_stepping){.solver = r->solver, .apart = 1, .complete = 1, .numbers = r->numbers};
        dml_stepping_prepare(L, other, r->t0);
        steppers[i] = &other->stepper;
    }
    steppers[0] = &r->stepper;
}

/* open all or none */
static dm_status open_all(dm_stepper **steppers, int threads) {
    for (int i = 0; i < threads; i++) {
        const dm_status status = dm_stepper_open(steppers[i]);
        if (status == DM_OK) continue;
        for (int k = 0; k <= i; k++) dm_stepper_close(steppers[k]);
        return status;
    }
    return DM_OK;
}

static void close_all(dm_stepper **steppers, int first, int threads) {
    for (int i = first; i < threads; i++) dm_stepper_close(steppers[i]);
}

/* raises, with all closed, where sums are to be plain and the rule has none */
static void check_plain(lua_State *L, dml_stepping *r, dm_stepper **steppers, int threads) {
    if (r->solver->plain && !r->stepper.report.plain) close_all(steppers, 1, threads);
    dml_stepping_checkplain(L, r);
}

/* what is watched, or the parts of the rule; their names are left at the old top of the stack + 1,
 * under what keeps the kernels */
static void read_columns(lua_State *L, dml_observables *o, const dml_stepping *r) {
    dm_impulses none = {0};
    if (has(L, "watch"))
        dml_watch_read(L, o, r);
    else
        dml_record_read(L, o, r, &none);
}

/* what every thread records, by kernels of its own; leaves them on the stack */
static dm_observer *read_observers(lua_State *L, dm_stepper **steppers, int threads) {
    dm_observer *out = lua_newuserdatauv(L, (size_t)threads * sizeof *out, 0);
    for (int i = 0; i < threads; i++) {
        luaL_checkstack(L, 8, "too many threads");
        dml_observables *o = lua_newuserdatauv(L, sizeof *o, 0);
        memset(o, 0, sizeof *o);
        read_columns(L, o,
                     (dml_stepping *)(void *)((char *)steppers[i] -
                                              offsetof(dml_stepping, stepper)));
        out[i] = o->observer;
    }
    return out;
}

/* what every thread looks at beside flows; the same */
static dm_observer *read_aside(lua_State *L, dm_stepper **steppers, int threads) {
    const int options = lua_gettop(L) + 1;
    if (!dml_follow_options(L)) return NULL;
    dm_observer *out = read_observers(L, steppers, threads);
    lua_pushvalue(L, options);
    lua_replace(L, 2);
    return out;
}

/* what every thread looks at where the mass may change its inertia; it stays on the stack */
static dm_inertia *open_inertia(lua_State *L, dm_stepper **steppers, int threads) {
    if (!dm_inertia_may_change(steppers[0]->model)) return NULL;
    dm_inertia *out = lua_newuserdatauv(L, (size_t)threads * sizeof *out, 0);
    for (int i = 0; i < threads; i++) {
        double *place;
        const dm_model *m = steppers[i]->model;
        const size_t memory = steppers[i]->engine ? dm_stepper_memory(steppers[i], &place) : 0;
        const size_t room = dm_inertia_work(m, memory, DM_LANES_GROUPS * 8);
        luaL_checkstack(L, 8, "too many threads");
        dm_inertia_open(out + i, m, memory, lua_newuserdatauv(L, room * sizeof(double), 0));
    }
    return out;
}

/* the rows of the members of a part */
static dm_ensemble_rows rows_of(const dml_part *p) {
    dm_ensemble_rows rows = p->e->rows;
    rows.data = dm_ensemble_rows_of(&rows, p->first);
    rows.count += p->first;
    return rows;
}

/* all threads with one part; what it leaves on the stack is dropped by the caller */
static dm_status run_part(lua_State *L, const dml_part *p, dml_solver *solver, int threads,
                          clock_of_run *clock) {
    /* the first thread takes the kernels of the last run, where the system is the same one */
    dml_stepping r = {.solver = solver, .apart = p->varied, .complete = 1, .numbers = !p->values};
    dm_stepper *steppers[DM_ENSEMBLE_THREADS];
    ensemble *e = p->e;
    dml_stepping_prepare(L, &r, e->t);
    if (!p->varied) {
        lua_pushvalue(L, r.model_at);
        lua_setiuservalue(L, p->at, DML_ENSEMBLE_MODEL);
    }
    /* neither Lua nor factorizations, whose memory is that of Lua, run in several threads */
    if (r.model->callback || r.stepper.solvers) threads = 1;
    if (threads > p->count) threads = (int)p->count;
    const long inside = dml_read_starts(L, p, &r);
    if (p->values && !inside) return DM_NO_NATIVE;
    if (p->values && !dml_vary_is_traced(L, p, &r)) return DM_NO_NATIVE;
    open_steppers(L, &r, threads, steppers);
    for (int i = 0; i < threads; i++) steppers[i]->energy = p->energy;
    const dm_ensemble_rows rows = rows_of(p);
    const int watched = rows.beside || has(L, "watch");
    dm_ensemble plan = {.members = p->count,
                        .steps = p->steps,
                        .t0 = e->t,
                        .h = solver->h,
                        .pace = e->pace ? e->pace + p->first : NULL,
                        .params = p->values,
                        .state = e->state + (size_t)p->first * dm_state_size(e->n),
                        .member = e->member + p->first,
                        .trouble = e->trouble + p->first,
                        .rows = rows.room ? &rows : NULL,
                        .watch = watched ? read_observers(L, steppers, threads) : NULL,
                        .follow = p->follow ? p->follow + p->first : NULL,
                        .aside = read_aside(L, steppers, threads),
                        .lanes = &e->lanes,
                        .stop = &dml_stop,
                        .progress = show_progress,
                        .ud = clock};
    /* what engines without a memory hold outside of Lua is not given back where memory ends */
    const int early = dm_rule_engine(r.stepper.rule, r.stepper.model)->memory == NULL;
    if (early) plan.inertia = open_inertia(L, steppers, threads);
    dm_status status = open_all(steppers, threads);
    if (status == DM_NO_START) dml_refusestages(L, solver->nodes[0].name);
    if (status != DM_OK) luaL_error(L, "rule cannot start: %s", dm_status_text(status));
    if (!early) plan.inertia = open_inertia(L, steppers, threads);
    check_plain(L, &r, steppers, threads);
    status = dm_ensemble_run(&plan, steppers, threads);
    if (status == DM_OK) dml_note_reasons(L, p, &r, plan.inertia);
    close_all(steppers, 0, threads);
    dml_rethrow(L, r.model);
    return status;
}

/* a part, its parameters as inputs where that can be: then one kernel serves for all */
static dm_status run_alike(lua_State *L, const dml_part *p, const dml_varied *v,
                           clock_of_run *clock) {
    const int threads = read_threads(L), top = lua_gettop(L);
    dml_part with = *p;
    dm_status status = DM_NO_NATIVE;
    with.values = dml_vary_inputs(L, p->count, v);
    if (with.values) status = run_part(L, &with, lua_touserdata(L, 1), threads, clock);
    lua_settop(L, top);
    if (status != DM_NO_NATIVE || v->values) return status;
    return run_part(L, p, lua_touserdata(L, 1), threads, clock);
}

/* a part that is a system of its own; ud: the clock */
static dm_status run_own(lua_State *L, const dml_part *p, void *ud) {
    clock_of_run *clock = ud;
    clock->before = steps_before(p, p->first);
    return run_alike(L, p, &(dml_varied){0}, clock);
}

static dm_status run_all(lua_State *L, dml_part *p, const dml_varied *v) {
    clock_of_run clock = {.L = L, .start = now(), .all = steps_before(p, p->e->members)};
    p->count = p->e->members;
    p->e->systems = 1;
    dm_status status = run_alike(L, p, v, &clock);
    if (status == DM_NO_NATIVE) status = dml_run_parts(L, p, v, run_own, &clock);
    dml_progress_end(L);
    return status;
}

/* one state in `every` with the parts of the rule, or what is watched; room 0: only the ends.
 * Pushes the names of columns, or nil where they are those of the state. */
static dm_ensemble_rows read_rows(lua_State *L, long steps, double t0) {
    dm_ensemble_rows rows = {.every = dml_read_every(L, steps)};
    dml_stepping r = {.solver = lua_touserdata(L, 1)};
    const int top = lua_gettop(L), watched = has(L, "watch");
    lua_getiuservalue(L, 1, DML_SOLVER_SYSTEM);
    const uint32_t states = r.solver->n + dml_checksystem(L, -1)->momenta;
    lua_settop(L, top);
    lua_pushnil(L);
    if (has(L, "every") || watched)
        rows.room = dm_run_rows(&(dm_run_plan){.steps = steps, .every = rows.every});
    if (has(L, "rows")) rows.room = dml_count(L, 2, "rows", 1, 1) + 2;
    rows.width = 1 + states;
    if (!watched && !rows.room) dml_refuse_gaps(L);
    if (!rows.room || !(watched || dml_records(L, &r))) return rows;
    dml_observables *o = lua_newuserdatauv(L, sizeof *o, 0);
    dml_stepping_prepare(L, &r, t0);
    const int names = lua_gettop(L) + 1;
    read_columns(L, o, &r);
    rows.beside = !watched;
    rows.width = 1 + dm_observer_width(&o->observer) + (watched ? 0 : states);
    lua_pushvalue(L, names);
    lua_replace(L, top + 1);
    lua_settop(L, top + 1);
    return rows;
}

/* paths of members that vary some are those of the others as they are now */
static void keep_params(lua_State *L, int at) {
    const int top = lua_gettop(L);
    lua_getiuservalue(L, 1, DML_SOLVER_SYSTEM);
    dml_systemfield(L, -1, "params");
    dml_copyparams(L, -1);
    lua_setiuservalue(L, at, DML_ENSEMBLE_PARAMS);
    lua_settop(L, top);
}

static void raise_stopped(lua_State *L, const ensemble *e, double t0, int at) {
    const dml_failure f = {.status = DM_STOPPED, .time = t0, .h = e->h, .rule = "ensemble"};
    dml_stop = 0;
    dml_fail(L, &f, at);
}

int dml_solver_ensemble(lua_State *L) {
    static const char *const known[] = {"members", "q",      "v",       "p",    "steps",
                                        "t",       "t0",     "threads", "vary", "project",
                                        "every",   "watch",  "rows",    "h",    "energy",
                                        "a",       "beside", "gaps",    NULL};
    const dml_solver *solver = luaL_checkudata(L, 1, DML_SOLVER);
    lua_settop(L, 2);
    luaL_checktype(L, 2, LUA_TTABLE);
    dml_options(L, 2, known);
    dml_step_order(L, solver->method, 1);
    dml_flag(L, 2, "project", 0);
    lua_getiuservalue(L, 1, DML_SOLVER_SYSTEM);
    dml_carried(L, 3);
    dml_place_options(L, 3, 2, "starts");
    if (lua_getiuservalue(L, 1, DML_SOLVER_START) != LUA_TNIL)
        luaL_error(L, "this solver goes on from a checkpoint, which is one run: make a solver of "
                      "the system for an ensemble");
    lua_settop(L, 2);
    const long members = read_members(L);
    dml_part p = {0};
    double energy;
    if (dml_stepping_energy(L, solver, &energy)) p.energy = &energy;
    const dm_pace *pace = dml_read_steps(L, solver, members, &p.steps);
    if (!pace) p.steps = read_steps(L, solver);
    const double t0 = dml_number(L, 2, "t0", 0.0);
    read_threads(L);
    p.velocity = dml_check_starts(L, solver, members);
    const dm_ensemble_rows rows = read_rows(L, p.steps, t0);
    p.e = dml_pushensemble(L, members, solver->n, &rows);
    const int at = p.at = lua_gettop(L);
    lua_pushvalue(L, at - 1);
    lua_setiuservalue(L, at, DML_ENSEMBLE_COLUMNS);
    lua_pushvalue(L, 1);
    lua_setiuservalue(L, at, DML_ENSEMBLE_SOLVER);
    p.e->t0 = t0;
    p.e->h = solver->h;
    p.e->pace = pace;
    lua_pushvalue(L, 3);
    lua_setiuservalue(L, at, DML_ENSEMBLE_STEPS);
    p.e->t = t0;
    p.follow = dml_read_follow(L, &p, t0);
    lua_setiuservalue(L, at, DML_ENSEMBLE_ASIDE);
    lua_setiuservalue(L, at, DML_ENSEMBLE_FOLLOWED);
    dml_varied v = {0};
    v.values = dml_read_vary(L, members, &v.count);
    if (v.values) {
        lua_pushvalue(L, at + 1);
        lua_setiuservalue(L, at, DML_ENSEMBLE_VARIED);
        lua_pushvalue(L, lua_gettop(L));
        lua_setiuservalue(L, at, DML_ENSEMBLE_NAMES);
        keep_params(L, at);
    }
    v.names = lua_gettop(L);
    const dm_status status = run_all(L, &p, &v);
    p.e->t = t0 + p.e->h * (double)p.steps;
    if (status == DM_STOPPED) raise_stopped(L, p.e, t0, at);
    lua_settop(L, at);
    return 1;
}
