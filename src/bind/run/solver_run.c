/* solver_run.c - solver:run: from its options to a path, or to a dm.failure with the path so
 * far. */
#include "bind/core/bind_failure.h"
#include "bind/core/bind_terminal.h"
#include "bind/rule/bind_step.h"
#include "bind/run/bind_path.h"
#include "bind/run/checkpoint.h"
#include "bind/run/run_events.h"
#include "bind/run/run_file.h"
#include "bind/trace/bind_root.h"
#include "run/run.h"

#include <errno.h>
#include <math.h>
#include <string.h>
#include <time.h>

typedef dml_solver solver;

/* steps of a rule whose number of steps is not known beforehand */
enum { LONGEST_OWN_TIME = 2000000000 };

/* The solver at stack index 1. */
static solver *check(lua_State *L) {
    return luaL_checkudata(L, 1, DML_SOLVER);
}

/* s of a clock that never goes back. */
static double now(void) {
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

/* at = { t1, t2, ... }: growing times from t0 on; the block stays on the stack */
static void read_times(lua_State *L, const solver *s, dm_run_plan *plan, double from) {
    if (s->alone)
        luaL_error(L, "a discrete Lagrangian has a fixed step: take 'every' instead of 'at'");
    lua_getfield(L, 2, "at");
    const long count = dml_length(L, -1);
    if (count == 0) luaL_error(L, "field 'at' is empty: give it times, growing ones");
    if (count < 0)
        luaL_error(L, "field 'at' must be a vector or table of times (got %s)",
                   luaL_typename(L, -1));
    lua_pop(L, 1);
    double *at = lua_newuserdatauv(L, ((size_t)count + 2 * dm_state_size(s->n)) * sizeof *at, 0);
    dml_numbers(L, 2, "at", at, (uint32_t)count);
    for (long i = 0; i < count; i++)
        if (!(at[i] > (i ? at[i - 1] : nextafter(from, -INFINITY))))
            luaL_error(L,
                       "field 'at' must hold growing times from the start, t = %f, on (entry %d is "
                       "%f)",
                       from, (int)i + 1, at[i]);
    plan->at = at;
    plan->at_count = count;
    plan->between = at + count;
    plan->until = at[count - 1];
}

/* Is option `key` of the table at 2 given? */
static int has(lua_State *L, const char *key) {
    const int there = lua_getfield(L, 2, key) != LUA_TNIL;
    lua_pop(L, 1);
    return there;
}

/* ---- a run ---- */

/* everything that a run has beside its steps; what is not asked for is NULL in the plan */
typedef struct {
    dml_stepping r;
    dm_run_plan plan;
    lua_State *L;
    double began; /* s */
    dm_impulses impulses;
    dml_run_file file;
    dm_resumption resume;
    dm_inertia inertia;
    dml_run_control control;
    dml_checkpoint *end;        /* where it ends, or is */
    const dml_checkpoint *from; /* where it goes on; NULL: a start */
    const char *rule, *saving;  /* file of checkpoints; NULL: none */
    int names, path, unwritten; /* stack indices; errno of a checkpoint not written, or 0 */
    double energy;              /* that steps are to have, of rules that choose them by it */
    dml_observables watch;      /* from its lists on nothing is zero unless it is asked for */
    dml_run_events events;
} run;

/* About ten times a second; the time that is left is that of the rate so far. */
static void show_progress(void *ud, long done, long steps) {
    const run *u = ud;
    const double seconds = now() - u->began, rate = (double)done / seconds;
    dml_progress(u->L, "run", (double)done / (double)steps, rate, (double)(steps - done) / rate);
}

/* time of the first state, from the options or the checkpoint that the solver starts from */
static double find_start(lua_State *L, run *u) {
    static const char *const starts[] = {"q", "v", "p", "q0", "q1", "t0", NULL};
    lua_getiuservalue(L, 1, DML_SOLVER_START);
    u->from = lua_touserdata(L, -1); /* kept by the solver */
    lua_pop(L, 1);
    if (!u->from) return u->r.t0 = dml_number(L, 2, "t0", 0.0);
    for (const char *const *key = starts; *key; key++)
        if (has(L, *key))
            luaL_error(L,
                       "field '%s': this solver goes on from a checkpoint, which has its own state "
                       "and time",
                       *key);
    u->r.t0 = u->from->t0;
    u->resume = (dm_resumption){.steps = u->from->steps,
                                .memory = u->from->state + dm_state_size(u->from->n)};
    u->plan.resume = &u->resume;
    return dml_checkpoint_time(u->from, u->r.solver);
}

/* how long: steps = n, or t = duration, or up to the last of the times `at`, from the time
 * `from`; by a rule with a time of its own in at most so many steps (most = n), else it has
 * taken too long */
static void read_length(lua_State *L, const solver *s, dm_run_plan *plan, double from) {
    const int own = (s->method->traits & DM_OWN_TIME) != 0;
    plan->until = INFINITY;
    plan->h = s->h;
    if (has(L, "t") + has(L, "at") + has(L, "steps") > 1)
        luaL_error(L, "give one of 'steps', 't' (a duration) and 'at' (times)");
    const long most = dml_count(L, 2, "most", 1, LONGEST_OWN_TIME);
    if (has(L, "most") && !(own && has(L, "at")))
        luaL_error(L, "'most' (steps) goes with 'at' and a rule that has a time of its own");
    if (has(L, "at") && has(L, "every"))
        luaL_error(L, "give either 'every' (rows of steps) or 'at' (rows at times), not both");
    plan->every = dml_count(L, 2, "every", 1, 1);
    if (has(L, "at"))
        read_times(L, s, plan, from);
    else if (has(L, "t"))
        plan->until = from + dml_positive(L, 2, "t", 0);
    else if (!has(L, "steps"))
        luaL_error(L, "how long? 'steps' (how many), 't' (a duration) or 'at' (times) is missing");
    else
        plan->steps = dml_count(L, 2, "steps", 0, -1);
    if (!isfinite(plan->until)) return;
    const int control = has(L, "control");
    plan->steps = (own || control) && plan->at ? most
                  : control                    ? dml_control_most(s, has(L, "seconds"))
                                               : dml_stepping_cover(L, s, plan->until - from, s->h);
}

/* checkpoint = file, or { file =, every = seconds } */
static void read_saving(lua_State *L, run *u) {
    static const char *const known[] = {"file", "every", NULL};
    enum { EVERY = 60 };
    lua_getfield(L, 2, "checkpoint");
    u->plan.save_every = EVERY;
    if (lua_istable(L, -1)) {
        const int at = lua_gettop(L);
        dml_options(L, at, known);
        u->plan.save_every = dml_positive(L, at, "every", EVERY);
        lua_getfield(L, at, "file");
    }
    if (lua_type(L, -1) != LUA_TSTRING || strlen(lua_tostring(L, -1)) != lua_rawlen(L, -1))
        luaL_error(L, "field 'checkpoint' must be the name of a file, or { file =, every = seconds "
                      "}");
    u->saving = lua_tostring(L, -1);
    if (!dml_checkpoint_try(u->saving))
        luaL_error(L, "field 'checkpoint': cannot write %s: %s", u->saving, strerror(errno));
}

/* Where the run is. A time that events or a control found is none of so many steps. */
static void take_end(run *u, long done) {
    const int ended = u->plan.events && u->events.events.ended;
    const double t0 = u->r.t0;
    if (ended)
        u->r.t0 = u->events.events.end;
    else if (u->plan.control)
        u->r.t0 = u->plan.control->t;
    dml_checkpoint_take(u->end, &u->r, ended || u->plan.control ? 0 : done + u->resume.steps);
    if (u->saving) dml_checkpoint_check(u->end, &u->r);
    u->r.t0 = t0;
}

/* between two steps: a checkpoint of where the run is; one that cannot be written ends the run */
static dm_status save(void *ud, long done) {
    run *u = ud;
    take_end(u, done);
    if (dml_checkpoint_write(u->end, u->r.solver, u->rule, u->saving)) return DM_OK;
    u->unwritten = errno;
    return DM_NOT_WRITTEN;
}

int dml_stepping_energy(lua_State *L, const dml_solver *s, double *out) {
    if (!has(L, "energy")) return 0;
    if (!(s->method->traits & DM_BY_ENERGY))
        luaL_error(L,
                   "field 'energy' goes with rules that choose their steps by it, sem(s, "
                   "quadrature(r)); rule '%s' does not",
                   s->nodes[0].name);
    const double E = dml_number(L, 2, "energy", 0.0);
    if (out) *out = E;
    return 1;
}

/* energy = E of the steps */
static void check_energy(lua_State *L, const run *u) {
    if (dml_stepping_energy(L, u->r.solver, NULL) && u->from)
        luaL_error(L, "field 'energy': this solver goes on from a checkpoint, whose steps have "
                      "their energy");
}

/* What is asked of the run, before anything is traced. */
static void read_plan(lua_State *L, run *u) {
    const double from = find_start(L, u);
    u->plan.t0 = u->r.t0;
    u->plan.stop = &dml_stop;
    u->plan.progress = show_progress;
    u->plan.ud = u;
    read_length(L, u->r.solver, &u->plan, from);
    check_energy(L, u);
    u->plan.seconds = has(L, "seconds") ? dml_positive(L, 2, "seconds", 0) : 0.0;
    if (!has(L, "checkpoint")) return;
    read_saving(L, u);
    u->plan.save = save;
}

/* columns beside q and p; how many */
static uint32_t read_record(lua_State *L, run *u) {
    u->names = lua_gettop(L) + 1;
    dml_record_read(L, &u->watch, &u->r, &u->impulses);
    u->plan.beside = 1;
    if (u->watch.observer.count) u->plan.watch = &u->watch.observer;
    const uint32_t width = dm_observer_width(&u->watch.observer);
    if (!u->impulses.constraints) return width;
    if (u->plan.at || has(L, "events"))
        luaL_error(L, "field 'record': impulses are those of steps, and rows at times or events "
                      "lie inside of them; record \"lambda\", the multipliers at the state");
    u->plan.impulses = &u->impulses;
    return width + dm_impulses_width(&u->impulses);
}

/* what it records and looks for; the empty path is left on the stack */
static dml_path *make_path(lua_State *L, run *u) {
    const uint32_t n = u->r.solver->n;
    uint32_t width = 1 + n + dml_checksystem(L, u->r.system)->momenta;
    if (has(L, "watch") && has(L, "record"))
        luaL_error(L, "give 'watch' (rows hold this instead of q and p) or 'record' (rows hold it "
                      "too), not both");
    if (has(L, "watch")) {
        u->names = lua_gettop(L) + 1;
        dml_watch_read(L, &u->watch, &u->r);
        u->plan.watch = &u->watch.observer;
        width = 1 + dm_observer_width(&u->watch.observer);
    } else if (dml_records(L, &u->r))
        width += read_record(L, u);
    if (has(L, "events")) {
        dml_events_read(L, &u->events, &u->r);
        u->plan.events = &u->events.events;
    }
    long rows = dm_run_rows(&u->plan);
    if (has(L, "file") && rows > DML_ROWS_IN_MEMORY) rows = DML_ROWS_IN_MEMORY + 1;
    dml_path *path = dml_pushpath(L, u->r.system, n, rows, width);
    u->path = lua_gettop(L);
    path->watched = has(L, "watch");
    if (u->names) lua_pushvalue(L, u->names), lua_setiuservalue(L, u->path, DML_PATH_NAMES);
    dml_stepping_describe(L, &u->r, path);
    return path;
}

/* the file of rows, whose columns the path knows */
static void open_file(lua_State *L, run *u) {
    lua_getfield(L, u->path, "columns");
    const uint32_t n = !u->plan.watch || u->plan.beside ? u->r.solver->n : 0;
    dml_file_start from = {.t = NAN};
    if (u->from)
        from = (dml_file_start){dml_checkpoint_time(u->from, u->r.solver), u->from->unfiled,
                                u->from->state, n};
    const int names = lua_gettop(L);
    lua_getfield(L, u->path, "system");
    const int is_field = lua_getfield(L, -1, "field") != LUA_TNIL;
    lua_settop(L, names);
    dml_file_open(L, &u->file, names, is_field, &from);
    u->plan.outlet = &u->file.outlet;
    lua_pushstring(L, u->file.name);
    lua_setiuservalue(L, u->path, DML_PATH_FILE);
}

/* room for the end of the run, and, on the stack, for what looks where the mass may change its
 * inertia */
static void keep_room(lua_State *L, run *u) {
    const dm_model *m = u->r.stepper.model;
    u->end = dml_pushcheckpoint(L, &u->r);
    lua_setiuservalue(L, u->path, DML_PATH_END);
    if (!dm_inertia_may_change(m)) return;
    const size_t size = dm_inertia_work(m, u->end->memory, 1) * sizeof(double);
    dm_inertia_open(&u->inertia, m, u->end->memory, lua_newuserdatauv(L, size, 0));
    u->plan.inertia = &u->inertia;
}

/* The stepper is opened last, since what it holds outside of Lua is not given back by an error.
 * Rules with a memory hold nothing there, and how large that is is known only then. */
static void start(lua_State *L, run *u) {
    const int early = dm_rule_engine(u->r.solver->nodes, &u->r.model->model)->memory == NULL;
    lua_getiuservalue(L, 1, DML_SOLVER_RULE);
    u->rule = luaL_tolstring(L, -1, NULL);
    lua_pushvalue(L, 1);
    lua_setiuservalue(L, u->path, DML_PATH_SOLVER);
    if (early) keep_room(L, u);
    if (u->from)
        dml_stepping_resume(L, &u->r, u->from);
    else
        dml_stepping_start(L, &u->r);
    if (early) return;
    keep_room(L, u);
    if (u->end->memory) /* for steps on the side */
        u->r.stepper.aside = lua_newuserdatauv(L, u->end->memory * sizeof(double), 0);
}

/* the path says what was done; of rows that went to a file it keeps the last */
static void fill_path(run *u, dml_path *path, long done, long rows, double seconds) {
    const size_t width = path->width;
    path->rows = rows, path->steps = done;
    if (u->plan.outlet) dml_file_keep(&u->file, path, rows), rows = path->rows;
    u->end->unfiled = path->unfiled;
    path->every = u->plan.every;
    if (!u->plan.at) path->until = u->plan.until;
    path->t = rows ? path->data[(size_t)(rows - 1) * width] : u->plan.t0;
    path->ns_per_step = done ? seconds * 1e9 / (double)done : 0.0;
    path->constraint = u->r.stepper.report.constraint;
    path->rolling = u->r.stepper.report.rolling;
    path->sem = u->r.stepper.report.sem;
    path->condition = u->r.stepper.report.condition;
    path->defect = u->r.stepper.report.defect;
    path->drift = u->r.stepper.report.drift;
}

/* note which file ended the run, for its failure; the text stays on the stack */
static void note_unwritten(lua_State *L, run *u, const char *file, int why) {
    if (u->r.unwritten) return;
    u->r.unwritten = lua_pushfstring(L, "cannot write %s: %s; the path so far is in failure.path",
                                     file, strerror(why));
}

/* Files and events of a run whose path is whole. A checkpoint behind rows that are not in the file
 * is not written: a run that goes on from the one that is there leaves no gap. */
static dm_status finish(lua_State *L, run *u, dm_status status) {
    if (u->unwritten) note_unwritten(L, u, u->saving, u->unwritten);
    if (u->plan.outlet && !dml_file_close(L, &u->file))
        note_unwritten(L, u, u->file.name, u->file.why);
    if (u->saving && !u->end->unfiled &&
        !dml_checkpoint_write(u->end, u->r.solver, u->rule, u->saving))
        note_unwritten(L, u, u->saving, errno);
    if (u->plan.events) {
        dml_pushevents(L, &u->events, u->r.system);
        lua_setiuservalue(L, u->path, DML_PATH_EVENTS);
    }
    return status == DM_OK && u->r.unwritten ? DM_NOT_WRITTEN : status;
}

/* (solver, options) -> path. Whatever fails after the first step has its path so far. */
int dml_solver_run(lua_State *L) {
    static const char *const known[] = {"q",          "v",       "p",      "q0",      "q1",
                                        "p0",         "steps",   "t0",     "every",   "t",
                                        "at",         "watch",   "record", "events",  "file",
                                        "checkpoint", "project", "a",      "control", "seconds",
                                        "energy",     "gaps",    "most",   NULL};
    run u;
    memset(&u, 0, offsetof(run, watch.list));
    u.r.solver = check(L), u.L = L;
    long done = 0, rows = 0;
    lua_settop(L, 2);
    if (!lua_istable(L, 2))
        luaL_error(L, "a run takes a table of options: solver:run { q =, v =, t = } (got %s)",
                   luaL_typename(L, 2));
    dml_options(L, 2, known);
    dml_step_order(L, u.r.solver->method, 0);
    dml_stepping_names(L);
    read_plan(L, &u);
    dml_stepping_prepare(L, &u.r, u.r.t0);
    if (dml_stepping_energy(L, u.r.solver, &u.energy)) u.r.stepper.energy = &u.energy;
    dml_path *path = make_path(L, &u);
    if (has(L, "file")) open_file(L, &u);
    if (has(L, "control")) u.plan.control = dml_control_read(L, &u.control, &u.r, u.plan.until);
    start(L, &u);
    u.began = now();
    dm_status status = dm_run(&u.plan, &u.r.stepper, u.r.state, path->data, &done, &rows);
    const double seconds = now() - u.began;
    u.r.control = u.plan.control;
    u.r.fading = u.plan.inertia && dm_inertia_is_fading(u.plan.inertia);
    if (status == DM_SINGULAR && u.plan.inertia && u.plan.inertia->seen.degenerate)
        dml_note_degenerate(L, &u.r, u.plan.inertia);
    take_end(&u, done); /* before its stepper is closed */
    dml_stepping_end(&u.r);
    if (status == DM_STOPPED) dml_stop = 0;
    dml_progress_end(L);
    fill_path(&u, path, done, rows, seconds);
    status = finish(L, &u, status);
    dml_watch_missed(L, &u.watch, u.path, &u.r);
    if (u.plan.events) dml_events_missed(L, &u.events, &u.r);
    dml_stepping_report(&u.r, done, seconds);
    u.r.t0 = u.plan.t0 + u.r.solver->h * (double)u.resume.steps;
    dml_solver_fail(L, &u.r, status, done, u.path);
    dml_stepping_leave(L, &u.r);
    return lua_pushvalue(L, u.path), 1;
}
