/* bind_wave_stepper.c - `dm.wave_stepper`: steps of a wave and their rows, for lua/dm/wave. */
#include "bind/core/bind_failure.h"
#include "bind/core/bind_terminal.h"
#include "bind/value/array.h"
#include "bind/wave/bind_wave.h"
#include "wave/wave_run.h"

#include <limits.h>
#include <math.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

/* User values: the equation, and the arena of the tables. */
typedef struct {
    dm_wave_stepper stepper;
    double *a, *psi; /* [2 n] scratch */
} stepper;

/* The stepper at stack index 1, as of every method here. */
static stepper *check(lua_State *L) {
    return luaL_checkudata(L, 1, DML_WAVE_STEPPER);
}

/* ---- making one ---- */

/* engines of wave_stepper.h */
static const char *const kinds[] = {"split", "stages", "two-step", NULL};

/* kicks at 4, drifts at 5 */
static dm_status open_split(lua_State *L, dm_wave_stepper *s, const dm_wave *w, double h,
                            dm_arena *arena) {
    const long stages = dml_length(L, 5);
    luaL_argcheck(L, stages >= 1 && stages <= 40 && dml_length(L, 4) == stages + 1, 5,
                  "drifts, one less than kicks, are needed");
    double b[41], a[40];
    dml_vectorarg(L, 4, "kicks", b, (uint32_t)stages + 1);
    dml_vectorarg(L, 5, "drifts", a, (uint32_t)stages);
    return dm_wave_split(s, w, h, (int)stages, b, a, arena, &dml_stop);
}

/* core.wave_stepper(w, kind, h, ...) */
static int stepper_new(lua_State *L) {
    const dm_wave *w = dml_checkwave(L, 1);
    const int kind = luaL_checkoption(L, 2, NULL, kinds);
    const double h = dml_checknumber(L, 3);
    dm_status status;
    lua_settop(L, 5);
    stepper *s = lua_newuserdatauv(L, sizeof *s, 2);
    dm_arena *arena = dml_pusharena(L);
    lua_setiuservalue(L, -2, 2);
    lua_pushvalue(L, 1);
    lua_setiuservalue(L, -2, 1);
    s->a = dm_arena_take(arena, 2 * (size_t)w->n * sizeof *s->a);
    s->psi = dm_arena_take(arena, 2 * (size_t)w->n * sizeof *s->psi);
    if (!s->a || !s->psi) return luaL_error(L, "not enough memory");
    if (kind == 0)
        status = open_split(L, &s->stepper, w, h, arena);
    else if (kind == 1)
        status = dm_wave_gauss(&s->stepper, w, h, (int)dml_checkinteger(L, 4), arena, &dml_stop);
    else
        status = dm_wave_two_step(&s->stepper, w, h, lua_toboolean(L, 4), arena, &dml_stop);
    dml_wavefail(L, status);
    /* a run without a start would show it */
    memset(s->stepper.state, 0, s->stepper.size * sizeof(double));
    luaL_setmetatable(L, DML_WAVE_STEPPER);
    return 1;
}

/* ---- its state ---- */

/* s:start(re, im) */
static int start(lua_State *L) {
    stepper *s = check(L);
    const dm_wave *w = s->stepper.wave;
    lua_settop(L, 3);
    dml_wavevalues(L, 2, s->psi, w->n);
    dm_wave_amplitudes(s->a, w, s->psi);
    dml_wavefail(L, s->stepper.engine->start(&s->stepper, s->a));
    return 0;
}

/* s:state([numbers]) */
static int state(lua_State *L) {
    stepper *s = check(L);
    const uint32_t size = (uint32_t)s->stepper.size;
    lua_settop(L, 2);
    if (!lua_isnil(L, 2)) {
        luaL_argcheck(L, dml_length(L, 2) == (long)size, 2, "the state of another wave");
        /* read whole before it is taken: one that is wrong changes nothing */
        double *given = lua_newuserdatauv(L, size * sizeof *given, 0);
        dml_vectorarg(L, 2, "the state", given, size);
        memcpy(s->stepper.state, given, size * sizeof *given);
    }
    memcpy(dml_pushvector(L, size), s->stepper.state, size * sizeof(double));
    return 1;
}

/* ---- runs ---- */

/* what the line of progress needs */
typedef struct {
    lua_State *L;
    double began;
} progress;

/* s of a clock that never goes back */
static double now(void) {
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

/* About ten times a second; the time that is left is that of the rate so far. */
static void show_progress(void *ud, long done, long steps) {
    const progress *p = ud;
    const double rate = (double)done / (now() - p->began);
    dml_progress(p->L, "run", (double)done / (double)steps, rate, (double)(steps - done) / rate);
}

/* Room for the rows, at most half of the machine's memory. */
static double *push_room(lua_State *L, long rows, size_t width) {
    const double bytes = (double)rows * (double)width * sizeof(double);
    const double memory = (double)sysconf(_SC_PHYS_PAGES) * (double)sysconf(_SC_PAGESIZE);
    if (bytes > 0.5 * memory || rows > INT_MAX)
        luaL_error(L,
                   "recording %f rows needs %f GB, more than half of this machine's memory: keep "
                   "fewer with a larger 'every'",
                   (double)rows, bytes * 1e-9);
    return dml_pushmatrix(L, (uint32_t)rows, (uint32_t)width);
}

/* s:run(t0, first, steps, every, seconds) -> rows, done, code */
static int run(lua_State *L) {
    stepper *s = check(L);
    progress p = {.L = L, .began = now()};
    lua_settop(L, 6);
    const dm_wave_plan plan = {.t0 = dml_checknumber(L, 2),
                               .first = (long)dml_checkinteger(L, 3),
                               .steps = (long)dml_checkinteger(L, 4),
                               .every = (long)dml_checkinteger(L, 5),
                               .seconds = dml_optnumber(L, 6, 0.0),
                               .stop = &dml_stop,
                               .progress = show_progress,
                               .ud = &p};
    luaL_argcheck(L, plan.steps >= 0 && plan.every >= 1, 4, "steps and rows are counted");
    const size_t width = DM_WAVE_COLUMNS + 2 * (size_t)s->stepper.wave->n;
    const long most = dm_wave_rows(&plan);
    double *rows = push_room(L, most, width);
    long done, kept;
    const dm_status status = dm_wave_run(&plan, &s->stepper, rows, s->a, s->psi, &done, &kept);
    const double took = now() - p.began;
    dml_progress_end(L);
    if (status == DM_STOPPED) dml_stop = 0;
    /* a run that ended early gives as many rows as it has */
    if (kept < most) {
        double *fewer = dml_pushmatrix(L, (uint32_t)kept, (uint32_t)width);
        memcpy(fewer, rows, (size_t)kept * width * sizeof *rows);
        lua_remove(L, -2);
    }
    lua_pushinteger(L, done);
    lua_pushstring(L, dm_status_code(status));
    lua_pushnumber(L, took);
    return 4;
}

/* core.wave_fail(code, rule, step, t, h, iterations, residual, why, path) */
static int fail(lua_State *L) {
    static const char *const codes[] = {
#define CODE(name, code, text) code,
        DM_STATUS_LIST(CODE)
#undef CODE
            NULL};
    lua_settop(L, 9);
    const dml_failure f = {.status = (dm_status)luaL_checkoption(L, 1, NULL, codes),
                           .rule = luaL_checkstring(L, 2),
                           .step = (long)dml_checkinteger(L, 3),
                           .time = dml_checknumber(L, 4),
                           .h = dml_checknumber(L, 5),
                           .iterations = (int)dml_checkinteger(L, 6),
                           .residual = dml_checknumber(L, 7),
                           .root = luaL_optstring(L, 8, NULL)};
    dml_fail(L, &f, 9);
    return 0;
}

/* s.iterations ... */
static int field(lua_State *L) {
    const stepper *s = check(L);
    const char *key = luaL_checkstring(L, 2);
    if (strcmp(key, "iterations") == 0)
        lua_pushinteger(L, s->stepper.iterations);
    else if (strcmp(key, "residual") == 0)
        lua_pushnumber(L, s->stepper.residual);
    else if (strcmp(key, "parasitic") == 0)
        lua_pushnumber(L, s->stepper.parasitic);
    else
        return 0;
    return 1;
}

/* core.wave_values(rows, i) -> re, im of row i */
static int values(lua_State *L) {
    const dml_array *rows = dml_checkarray(L, 1, 2);
    const lua_Integer i = dml_checkinteger(L, 2);
    const double *numbers = dml_numbersof(rows);
    luaL_argcheck(L, numbers && rows->columns > DM_WAVE_COLUMNS, 1, "rows of a wave are needed");
    luaL_argcheck(L, i >= 1 && i <= rows->rows, 2, "no such row");
    dml_pushwave(L, numbers + (size_t)(i - 1) * rows->columns + DM_WAVE_COLUMNS,
                 (rows->columns - DM_WAVE_COLUMNS) / 2);
    return 2;
}

static const dml_row methods[] = {
    {"start", start, "s:start(re, im)\nSet the state to the values of psi at the points."},
    {"state", state,
     "s:state([numbers]) -> dm.vector\nAll that a run needs to go on bit for bit; given, it is set "
     "first."},
    {"run", run,
     "s:run(t0, first, steps, every [, seconds]) -> rows, done, code, seconds\n"
     "Steps from the state, which is step `first` of a run from t0, and a row for `every` of them: "
     "t, norm, energy, x, momentum, noether, tail, edge, then re and im of psi in turn. code as of "
     "a dm.failure, \"ok\" where nothing failed."},
    {NULL, NULL, NULL}};

static const dml_row functions[] =
    {{"wave_stepper", stepper_new,
      "core.wave_stepper(w, \"split\", h, kicks, drifts) -> dm.wave_stepper   or   w, \"stages\", "
      "h, "
      "degree   or   w, \"two-step\", h, keeps_norm\n"
      "What steps the wave equation w."},
     {"wave_values", values,
      "core.wave_values(rows, i) -> re, im\nThe values of psi in row i of what s:run gave."},
     {"wave_fail", fail,
      "core.wave_fail(code, rule, step, t, h, iterations, residual, why, path)\n"
      "Raise the dm.failure of a wave."},
     {NULL, NULL, NULL}};

const dml_class dml_class_wave_stepper = {
    .name = DML_WAVE_STEPPER,
    .doc = "dm.wave_stepper: steps of a wave\n"
           "fields: iterations, residual (of the last step that was solved for), parasitic",
    .methods = methods,
    .field = field,
    .functions = functions,
};
