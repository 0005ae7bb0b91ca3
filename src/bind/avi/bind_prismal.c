/* bind_prismal.c - steps over prisms between uneven slices of time, t_0 < t_1 < ... (Leok 3.12): a
 * prism over cell s between t_k and t_(k+1) has the volume |s| h_k, the dual of a cell at t_k the
 * volume |*s| (h_(k-1) + h_k) / 2, half of either at the ends. The action of prisms gives
 *   M ((A_(k+1) - A_k) / h_k - (A_k - A_(k-1)) / h_(k-1)) = (h_(k-1) + h_k) / 2 L_q(A_k),
 * which is half a kick, a drift and half a kick with each slice's own h. */
#include "bind/avi/field_rows.h"
#include "bind/core/bind.h"
#include "bind/run/stepping.h"
#include "bind/value/array.h"

#include <math.h>
#include <string.h>

/* slices that are equal to the last bit make one burst; returns how many from k on, below end */
static long equal_slices(const double *times, long k, long end) {
    const double h = times[k + 1] - times[k];
    long count = 1;
    while (k + count < end && times[k + count + 1] - times[k + count] == h) count++;
    return count;
}

/* a path of rows; what else they need stays below it */
static dml_path *begin_path(lua_State *L, const dml_stepping *r, dml_field_rows *rows, long count,
                            double from) {
    dml_path *path = dml_field_rows_open(L, rows, r->system, r->solver->n, count, from);
    dml_stepping_describe(L, r, path);
    path->rule = "prismal";
    return path;
}

static dm_status add_row(dml_field_rows *rows, const dml_stepping *r, double t) {
    double *row;
    const dm_status status = dml_field_rows_next(rows, &row);
    row[0] = rows->path->t = t;
    memcpy(row + 1, r->state, 2 * (size_t)r->solver->n * sizeof *row);
    return status;
}

/* option `key` of the table at 2 as n numbers on the stack, NULL where it is not there */
static const double *numbers_of(lua_State *L, const char *key, uint32_t n) {
    if (lua_getfield(L, 2, key) == LUA_TNIL) return NULL;
    double *out = lua_newuserdatauv(L, ((size_t)n + 1) * sizeof *out, 0);
    dml_vectorarg(L, lua_gettop(L) - 1, key, out, n);
    return out;
}

/* The slices at 3 as times on the stack; *slices: how many steps they make. */
static const double *read_times(lua_State *L, long *slices) {
    const long count = dml_length(L, 3);
    luaL_argcheck(L, count >= 2 && count < UINT32_MAX, 3, "at least two times expected");
    double *times = lua_newuserdatauv(L, (size_t)count * sizeof *times, 0);
    dml_vectorarg(L, 3, "slices", times, (uint32_t)count);
    for (long k = 0; k + 1 < count; k++)
        luaL_argcheck(L, times[k] < times[k + 1] && isfinite(times[k + 1] - times[k]), 3,
                      "growing finite times expected");
    *slices = count - 1;
    return times;
}

/* Option `from` on the stack, an ending of so many numbers; NULL where the run begins. */
static const double *read_ending(lua_State *L, uint32_t n, uint32_t *count) {
    lua_getfield(L, 2, "from");
    const long length = lua_isnil(L, -1) ? 0 : dml_length(L, -1);
    luaL_argcheck(L, lua_isnil(L, -1) || length >= (long)dm_state_size(n), 2,
                  "its field 'from' must be an ending: a state and what its method keeps");
    *count = (uint32_t)length;
    return numbers_of(L, "from", *count);
}

/* Between two slices: the state, and what the method keeps beside it, as option `ending`. */
static void push_ending(lua_State *L, dml_stepping *r) {
    double *place;
    const size_t size = dm_state_size(r->solver->n),
                 memory = dm_stepper_memory(&r->stepper, &place);
    double *out = dml_pushvector(L, (uint32_t)(size + memory));
    memcpy(out, r->state, size * sizeof *out);
    if (memory) memcpy(out + size, place, memory * sizeof *out);
    lua_setfield(L, 2, "ending");
}

/* The stepper is open and stands at a slice: at the start of the options, or at an ending. */
static dm_status begin(lua_State *L, dml_stepping *r, const double *from, uint32_t count, double t,
                       double h) {
    const size_t size = dm_state_size(r->solver->n);
    double *place;
    if (!from) {
        dml_stepping_start(L, r);
        return dm_stepper_start(&r->stepper, r->state, t, h);
    }
    memcpy(r->state, from, size * sizeof *from);
    dml_stepping_open(L, r);
    const size_t memory = dm_stepper_memory(&r->stepper, &place);
    if (size + memory != count) {
        dml_stepping_end(r);
        luaL_error(L, "the checkpoint was made by another version of rule 'prismal'");
    }
    const dm_status status = dm_stepper_start(&r->stepper, r->state, t, h);
    memcpy(r->state, from, size * sizeof *from);
    if (memory) memcpy(place, from + size, memory * sizeof *from);
    return status;
}

/* all slices from number *done on, with rows; where the run stands when it ends */
static dm_status go(dml_stepping *r, dml_field_rows *rows, const double *times, long slices,
                    long every, long *done) {
    const long first = *done;
    dm_status status = add_row(rows, r, times[first]);
    while (*done < slices && status == DM_OK) {
        const long row = (*done / every + 1) * every, end = row < slices ? row : slices;
        const long count = equal_slices(times, *done, end);
        long made = 0;
        const double h = times[*done + 1] - times[*done];
        r->stepper.goes_on = *done > first;
        status = dm_advance(&r->stepper, r->state, times[*done], h, count, &made);
        *done += made;
        if (status == DM_OK && *done == end) status = add_row(rows, r, times[*done]);
        if (dml_stop && status == DM_OK) status = DM_STOPPED;
    }
    return status;
}

/* solver, options, times, every -> path: rows at every `every`-th slice and at the last. Options
 * `from` (an ending) and `done` (its slices) of a run that goes on; where this one ended they are
 * `ending` and `done`. */
static int prismal_run(lua_State *L) {
    dml_stepping r = {.solver = luaL_checkudata(L, 1, DML_SOLVER)};
    dml_field_rows rows;
    const lua_Integer asked = dml_checkinteger(L, 4);
    long slices;
    uint32_t count;
    luaL_checktype(L, 2, LUA_TTABLE);
    luaL_argcheck(L, asked >= 1, 4, "a number of slices >= 1 expected");
    const double *times = read_times(L, &slices);
    const double *from = read_ending(L, r.solver->n, &count);
    const long every = asked < slices ? (long)asked : slices;
    long done = dml_count(L, 2, "done", 0, 0);
    const long began = done;
    luaL_argcheck(L, done < slices, 2, "all slices are done");
    dml_stepping_prepare(L, &r, times[done]);
    dml_path *path = begin_path(L, &r, &rows, (slices + every - 1) / every - done / every + 1,
                                from ? times[done] : NAN);
    const int at = lua_gettop(L);
    dm_status status = begin(L, &r, from, count, times[done], times[done + 1] - times[done]);
    if (status != DM_OK)
        add_row(&rows, &r, times[done]);
    else
        status = go(&r, &rows, times, slices, every, &done);
    path->steps = done - began;
    push_ending(L, &r);
    lua_pushinteger(L, done), lua_setfield(L, 2, "done");
    status = dml_field_rows_close(L, &rows, status);
    if (status == DM_NOT_WRITTEN) {
        lua_pushboolean(L, 1), lua_setfield(L, 2, "unwritten");
        r.unwritten = dml_field_rows_why(L, &rows);
    }
    if (status == DM_STOPPED) dml_stop = 0;
    r.t0 = times[done] - r.solver->h * (double)done; /* so that a failure tells the time */
    dml_stepping_end(&r);
    dml_stepping_report(&r, done, 0.0);
    dml_solver_fail(L, &r, status, done, at);
    lua_settop(L, at);
    return 1;
}

static const dml_row functions[] =
    {{"prismal_run", prismal_run,
      "core.prismal_run(solver, options, times, every) -> dm.path\n"
      "Steps of the solver's rule between the times, each as long as its slice; rows at every "
      "`every`-th time and at the last. Sets `ending` and `done` (slices) of the options; a run "
      "that goes on is given them as `from` and `done`."},
     {NULL, NULL, NULL}};

const dml_class dml_class_prismal = {
    .functions = functions,
};
