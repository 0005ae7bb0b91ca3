/* solver_run.c - solver:run: from its options to a path, or to a dm.failure with the path so far. */
#include "bind/failure.h"
#include "bind/path.h"
#include "bind/stepping.h"
#include "bind/terminal.h"
#include "run/run.h"

#include <math.h>
#include <string.h>
#include <time.h>

typedef dml_solver solver;

enum {
    LONGEST_OWN_TIME = 2000000000
}; /* steps of a rule whose number of steps is not known beforehand */

static solver *check(lua_State *L) {
    return luaL_checkudata(L, 1, DML_SOLVER);
}

typedef struct {
    lua_State *L;
    double start; /* s */
} clock_of_run;

static double now(void) {
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static void show_progress(void *ud, long done, long steps) {
    const clock_of_run *c = ud;
    const double seconds = now() - c->start, rate = (double)done / seconds;
    dml_progress(c->L, "run", (double)done / (double)steps, rate,
                 (double)(steps - done) / rate);
}

/* at = { t1, t2, ... }: growing times from t0 on; the block stays on the stack */
static void read_times(lua_State *L, const solver *s, dm_run_plan *plan) {
    if (s->pair)
        luaL_error(L, "a discrete Lagrangian has a fixed step: record with 'every' "
                      "instead of 'at'");
    lua_getfield(L, 2, "at");
    const long count = dml_length(L, -1);
    if (count < 1)
        luaL_error(L, "field 'at' must be a vector or table of times (got %s)",
                   luaL_typename(L, -1));
    lua_pop(L, 1);
    double *at =
        lua_newuserdatauv(L, ((size_t)count + 2 * dm_state_size(s->n)) * sizeof *at, 0);
    dml_numbers(L, 2, "at", at, (uint32_t)count);
    for (long i = 0; i < count; i++)
        if (!(at[i] > (i ? at[i - 1] : nextafter(plan->t0, -INFINITY))))
            luaL_error(
                L, "field 'at' must hold growing times from t0 = %f on (entry %d is %f)",
                plan->t0, (int)i + 1, at[i]);
    plan->at = at;
    plan->at_count = count;
    plan->landing = at + count;
    plan->until = at[count - 1];
}

static int has(lua_State *L, const char *key) {
    const int there = lua_getfield(L, 2, key) != LUA_TNIL;
    lua_pop(L, 1);
    return there;
}

/* how long: steps = n, or t = duration, or up to the last of the times `at` */
static dm_run_plan read_plan(lua_State *L, const solver *s) {
    dm_run_plan plan = {
        .t0 = dml_number(L, 2, "t0", 0.0), .until = INFINITY, .stop = &dml_stop};
    const int own = (s->method->traits & DM_OWN_TIME) != 0;
    if (has(L, "t") + has(L, "at") + has(L, "steps") > 1)
        luaL_error(L, "give one of 'steps', 't' (a duration) and 'at' (times)");
    if (has(L, "at") && has(L, "every"))
        luaL_error(
            L, "give either 'every' (rows of steps) or 'at' (rows at times), not both");
    plan.every = dml_count(L, 2, "every", 1, 1);
    if (has(L, "at"))
        read_times(L, s, &plan);
    else if (has(L, "t"))
        plan.until = plan.t0 + dml_positive(L, 2, "t", 0);
    else
        plan.steps = dml_count(L, 2, "steps", 0, -1);
    if (!isfinite(plan.until)) return plan;
    plan.steps =
        own ? LONGEST_OWN_TIME : dml_stepping_cover(L, plan.until - plan.t0, s->h);
    if (own && !plan.at)
        luaL_error(L,
                   "rule '%s' has a time of its own: give 'steps', or 'at' for the "
                   "states at given times",
                   s->nodes[0].name);
    return plan;
}

static uint32_t tie_operations(const dm_ties *t, unsigned wants) {
    return (wants & DM_WANT_HOLONOMIC ? t->holonomic_kernel.operations : 0) +
           (wants & DM_WANT_ROLLING ? t->rolling_kernel.operations : 0) +
           (wants & DM_WANT_TIE_FORCE ? t->force.operations : 0) +
           (wants & DM_WANT_FORCE_CURVE ? t->force_curve.operations : 0) +
           (wants & DM_WANT_REACTION ? t->reaction.operations : 0);
}

static uint32_t operations(const dm_model *m, unsigned wants) {
    return (wants & DM_WANT_STAGE ? m->stage.operations : 0) +
           (wants & DM_WANT_FORCE ? m->force.operations : 0) +
           (wants & DM_WANT_SLOPE ? m->slope.operations : 0) +
           (wants & DM_WANT_PAIR ? m->pair.operations : 0) +
           (m->ties ? tie_operations(m->ties, wants) : 0);
}

static void set_number(lua_State *L, const char *key, double x) {
    lua_pushnumber(L, x);
    lua_setfield(L, -2, key);
}

static void set_count(lua_State *L, const char *key, long n) {
    lua_pushinteger(L, n);
    lua_setfield(L, -2, key);
}

/* what the last run cost: user value 3 of the solver */
static void keep_report(lua_State *L, const dml_stepping *r, long steps, double seconds) {
    const solver *s = r->solver;
    const dm_report *report = &r->stepper.report;
    lua_createtable(L, 0, 12);
    lua_getiuservalue(L, 1, DML_SOLVER_RULE);
    lua_setfield(L, -2, "rule");
    lua_pushstring(L, r->model->backend);
    lua_setfield(L, -2, "backend");
    set_number(L, "h", s->h);
    set_count(L, "order", s->method->order(s->nodes));
    set_count(L, "operations", (long)operations(&r->model->model, r->wants));
    set_number(L, "trace_ms", r->model->trace_ms);
    set_number(L, "compile_ms", r->model->trace_ms + r->model->compile_ms);
    set_count(L, "steps", steps);
    set_number(L, "ns_per_step", steps ? seconds * 1e9 / (double)steps : 0.0);
    set_count(L, "newton", report->newton);
    set_count(L, "evaluations", report->evaluations);
    set_number(L, "newton_per_step",
               steps ? (double)report->newton / (double)steps : 0.0);
    if (r->model->model.ties) {
        set_number(L, "constraint", report->constraint);
        set_number(L, "rolling", report->rolling);
    }
    lua_setiuservalue(L, 1, DML_SOLVER_REPORT);
}

void dml_solver_fail(lua_State *L, const dml_stepping *r, dm_status status, long done,
                     int path) {
    const solver *s = r->solver;
    dml_rethrow(L, r->model);
    if (status == DM_OK) return;
    lua_getiuservalue(L, 1, DML_SOLVER_RULE);
    const dml_failure f = {.status = status,
                           .step = done + (status != DM_STOPPED),
                           .time = r->t0 + s->h * (double)done,
                           .h = s->h,
                           .residual = r->stepper.report.residual,
                           .iterations = r->stepper.report.iterations,
                           .rule = lua_tostring(L, -1)};
    dml_fail(L, &f, path);
}

int dml_solver_run(lua_State *L) {
    static const char *const known[] = {"q",  "v",     "p", "q0", "q1",      "steps",
                                        "t0", "every", "t", "at", "project", NULL};
    dml_stepping r = {.solver = check(L)};
    lua_settop(L, 2);
    luaL_checktype(L, 2, LUA_TTABLE);
    dml_options(L, 2, known);
    dm_run_plan plan = read_plan(L, r.solver);
    clock_of_run clock = {.L = L, .start = 0.0};
    plan.progress = show_progress;
    plan.ud = &clock;
    dml_stepping_prepare(L, &r, plan.t0);
    dml_path *path = dml_pushpath(L, r.system, r.solver->n, dm_run_rows(&plan));
    const int at = lua_gettop(L);
    dml_stepping_describe(L, &r, path);
    dml_stepping_start(L, &r); /* last thing before the loop that may raise */
    long done = 0, rows = 0;
    clock.start = now();
    const dm_status status = dm_run(&plan, &r.stepper, r.state, path->data, &done, &rows);
    const double seconds = now() - clock.start;
    dml_stepping_end(&r);
    if (status == DM_STOPPED) dml_stop = 0;
    dml_progress_end(L);
    path->rows = rows, path->steps = done;
    path->t = rows ? path->data[(size_t)(rows - 1) * dml_path_width(path)] : plan.t0;
    path->ns_per_step = done ? seconds * 1e9 / (double)done : 0.0;
    path->constraint = r.stepper.report.constraint;
    path->rolling = r.stepper.report.rolling;
    memcpy(path->state, r.state, dm_state_size(path->n) * sizeof(double));
    keep_report(L, &r, done, seconds);
    dml_solver_fail(L, &r, status, done, at);
    lua_settop(L, at);
    return 1;
}
