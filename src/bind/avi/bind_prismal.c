/* bind_prismal.c - steps over prisms between uneven slices of time, t_0 < t_1 < ... (Leok 3.12): a
 * prism over cell s between t_k and t_(k+1) has the volume |s| h_k, the dual of a cell at t_k the
 * volume |*s| (h_(k-1) + h_k) / 2, half of either at the ends. The action of prisms gives
 *   M ((A_(k+1) - A_k) / h_k - (A_k - A_(k-1)) / h_(k-1)) = (h_(k-1) + h_k) / 2 L_q(A_k),
 * which is half a kick, a drift and half a kick with each slice's own h. */
#include "bind/core/bind.h"
#include "bind/run/stepping.h"
#include "bind/value/array.h"

#include <string.h>

/* slices that are equal to the last bit make one burst; returns how many from k on, below end */
static long equal_slices(const double *times, long k, long end) {
    const double h = times[k + 1] - times[k];
    long count = 1;
    while (k + count < end && times[k + count + 1] - times[k + count] == h) count++;
    return count;
}

/* a path of rows, with row 0 filled; the system is at r->system */
static dml_path *begin_path(lua_State *L, const dml_stepping *r, uint32_t rows) {
    const uint32_t n = r->solver->n;
    dml_path *path = dml_pushpath(L, r->system, n, rows, 2 * n + 1);
    dml_stepping_describe(L, r, path);
    path->rule = "prismal";
    return path;
}

static void add_row(dml_path *path, const dml_stepping *r, double t) {
    double *row = path->data + (size_t)path->rows * path->width;
    row[0] = path->t = t;
    memcpy(row + 1, r->state, 2 * (size_t)r->solver->n * sizeof *row);
    path->rows++;
}

/* solver, options, times, every -> path: rows at every `every`-th slice and at the last */
static int prismal_run(lua_State *L) {
    dml_stepping r = {.solver = luaL_checkudata(L, 1, DML_SOLVER)};
    const long slices = dml_length(L, 3) - 1, every = luaL_checkinteger(L, 4);
    double *times = lua_newuserdatauv(L, ((size_t)slices + 2) * sizeof *times, 0);
    dml_vectorarg(L, 3, "slices", times, (uint32_t)slices + 1);
    dml_stepping_prepare(L, &r, times[0]);
    dml_path *path = begin_path(L, &r, (uint32_t)((slices + every - 1) / every + 1));
    const int at = lua_gettop(L);
    dml_stepping_start(L, &r);
    dm_status status = dm_stepper_start(&r.stepper, r.state, times[0], times[1] - times[0]);
    add_row(path, &r, times[0]);
    long done = 0;
    while (done < slices && status == DM_OK) {
        const long row = (done / every + 1) * every, end = row < slices ? row : slices;
        const long count = equal_slices(times, done, end);
        long made = 0;
        const double h = times[done + 1] - times[done];
        r.stepper.goes_on = done > 0;
        status = dm_advance(&r.stepper, r.state, times[done], h, count, &made);
        done += made;
        if (status == DM_OK && done == end) add_row(path, &r, times[done]);
        if (dml_stop) status = DM_STOPPED;
    }
    path->steps = done;
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
      "`every`-th time and at the last."},
     {NULL, NULL, NULL}};

const dml_class dml_class_prismal = {
    .functions = functions,
};
