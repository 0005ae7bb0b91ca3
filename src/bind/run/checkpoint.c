/* checkpoint.c - the end of a run, from which another one goes on: taken between two steps, asked
 * for by path:checkpoint and dm.resume. */
#include "bind/run/checkpoint.h"
#include "base/random.h"
#include "bind/core/new_file.h"
#include "bind/model/model_constraints.h"
#include "bind/model/space_group.h"
#include "chain/virtual_work.h"
#include "integ/registry.h"

#include <errno.h>
#include <math.h>
#include <string.h>

/* ---- in memory ---- */

/* what a reduced system carries along since its last start (lua/dm/reduce/euler_poincare.lua): how
 * many numbers; they themselves where out is not NULL */
static uint32_t read_carried(lua_State *L, int arg, double *out) {
    const int top = lua_gettop(L);
    uint32_t count = 0;
    if (!dml_placed(L, arg)) return 0;
    dml_systemfield(L, arg, "place");
    if (lua_getfield(L, -1, "reduced") == LUA_TTABLE && lua_getfield(L, -1, "a") != LUA_TNIL) {
        count = (uint32_t)luaL_len(L, -1);
        for (uint32_t i = 0; out && i < count; i++, lua_pop(L, 1)) {
            lua_geti(L, top + 3, (lua_Integer)i + 1);
            out[i] = lua_tonumber(L, -1);
        }
    }
    lua_settop(L, top);
    return count;
}

/* How large the memory of a method is shows only where its stepper is open. */
dml_checkpoint *dml_pushcheckpoint(lua_State *L, const dml_stepping *r) {
    dm_stepper *s = (dm_stepper *)&r->stepper;
    const uint32_t n = r->solver->n;
    double *place;
    const size_t memory = s->engine ? dm_stepper_memory(s, &place) : 0;
    const uint32_t carried = read_carried(L, r->system, NULL);
    const size_t doubles = dm_state_size(n) + memory + carried;
    dml_checkpoint *c = lua_newuserdatauv(L, sizeof *c + doubles * sizeof(double), 0);
    *c = (dml_checkpoint){.n = n, .carried = carried, .memory = memory};
    memset(c->state + dm_state_size(n), 0, memory * sizeof(double));
    read_carried(L, r->system, dml_checkpoint_carried(c));
    return c;
}

/* L or Ld at x = (q, v, t) or (q0, q1) */
static double value_at(const dml_model *m, const double *x) {
    double value = NAN;
    dm_kernel_prepare(&m->model.value, &value);
    dm_kernel_eval(&m->model.value, x, &value);
    return value;
}

enum { NEAR = 3, FAR = 48 }; /* points near a state, and behind them some that are not */

/* How far point k may be, of 1 + the size of a coordinate. */
static double reach_of(int k) {
    static const double far[] = {0.5, 2, 8, 32};
    return k < NEAR ? 0.1 : far[k % 4];
}

/* Point k near the state, the same in every run: x = (q, p, t) moved, for a position behind q
 * (`pair`) q moved. */
static void near(double *x, const double *state, uint32_t n, double t, int k, int pair) {
    const double reach = reach_of(k);
    for (uint32_t i = 0; i <= 2 * n; i++) {
        const double at = i == 2 * n ? t : state[pair && i >= n ? i - n : i];
        const double u = 2 * dm_random_uniform(3, (uint64_t)k, i) - 1;
        x[i] = at + reach * u * (1 + fabs(at));
    }
}

/* Sum of finite values; one that is not counts as 1. */
static double value_near(const dml_model *m, double *x, const double *state, double t, int pair) {
    double sum = 0.0;
    for (int k = 0; k < NEAR; k++) {
        near(x, state, m->n, t, k, pair);
        const double value = value_at(m, x);
        sum += isfinite(value) ? value : 1.0;
    }
    return sum;
}

/* the same of function `which`, whose entries have weights of their own */
static double function_near(dml_model *m, double *x, const double *state, double t, int pair,
                            int which) {
    double sum = 0.0;
    if (!m->constraint[which].graph) return NAN;
    for (int k = 0; k < NEAR; k++) {
        near(x, state, m->n, t, k, pair && which != DML_MAP);
        sum += dml_constraintsum(m, which, x);
    }
    return sum;
}

/* the same of forces on a field beside L, which no function of the system gives as it stands */
static double work_near(dml_model *m, double *x, const double *state, double t) {
    enum { CELLS = 16 }; /* at once */
    const dm_work *w = m->model.work;
    const uint32_t n = m->n, unit = w->values * CELLS;
    double sum = 0.0;
    if (!m->work_room)
        m->work_room = dm_arena_take(m->arena, (unit + dm_work_room(w)) * sizeof *m->work_room);
    if (!m->work_room) return NAN;
    for (int k = 0; k < NEAR; k++) {
        near(x, state, n, t, k, 0);
        for (uint32_t i = 0; i < n; i += unit) {
            const uint32_t count = n - i < unit ? n - i : unit;
            double *f = m->work_room;
            dm_work_force(w, f, NULL, NULL, x, i, count, f + unit);
            for (uint32_t j = 0; j < count; j++)
                sum += (1 + dm_random_uniform(4, DML_FORCE, i + j)) * (isfinite(f[j]) ? f[j] : 1.0);
        }
    }
    return sum;
}

/* between -1 and 1, and 1 of what is no number: none of many hides the others */
static double bounded(double value) {
    return isfinite(value) ? value / (1 + fabs(value)) : 1.0;
}

/* of L (Ld) and of every function, at points that are far away */
static double value_far(dml_model *m, double *x, const double *state, double t, int pair) {
    double sum = 0.0;
    for (int k = NEAR; k < NEAR + FAR; k++) {
        near(x, state, m->n, t, k, pair);
        sum += (1 + dm_random_uniform(5, 0, (uint32_t)k)) * bounded(value_at(m, x));
    }
    for (int i = 0; i < DML_CONSTRAINT_FUNCTIONS; i++)
        for (int k = NEAR; m->constraint[i].graph && k < NEAR + FAR; k++) {
            near(x, state, m->n, t, k, pair && i != DML_MAP);
            sum += (1 + dm_random_uniform(5, 1 + (uint64_t)i, (uint32_t)k)) *
                   bounded(dml_constraintsum(m, i, x));
        }
    dml_forgetroots(m);
    return sum;
}

/* x: room for 2 n + 1 numbers */
static void fingerprint(double check[DML_CHECKS], dml_model *m, double *x, const double *state,
                        double t, int pair) {
    for (int k = 0; k < DML_CHECKS; k++) check[k] = NAN;
    if (m->callback) return;
    memcpy(x, state, 2 * (size_t)m->n * sizeof *x);
    x[2 * m->n] = t;
    check[DML_CHECK_STATE] = value_at(m, x);
    check[DML_CHECK_NEAR] = value_near(m, x, state, t, pair);
    for (int i = 0; i < DML_CONSTRAINT_FUNCTIONS; i++)
        check[DML_CHECK_FUNCTIONS + i] = function_near(m, x, state, t, pair, i);
    if (m->model.work) check[DML_CHECK_FUNCTIONS + DML_FORCE] = work_near(m, x, state, t);
    check[DML_CHECK_FAR] = value_far(m, x, state, t, pair);
}

/* The fingerprint is made once: L is not called again for every save. */
static void check(dml_checkpoint *c, dml_model *m, double *x, const dml_solver *s) {
    if (!c->checked)
        fingerprint(c->check, m, x, c->state, c->t0 + s->h * (double)c->steps, s->pair);
    c->check[DML_CHECK_RULE] = s->own;
    c->checked = 1;
}

/* Between two steps, where kernels of L can be evaluated at r->x. */
void dml_checkpoint_check(dml_checkpoint *c, dml_stepping *r) {
    check(c, r->model, r->x, r->solver);
}

/* push the end of the path at 1 */
static dml_checkpoint *push_end(lua_State *L, const dml_solver *s) {
    lua_getiuservalue(L, 1, DML_PATH_MODEL);
    dml_model *m = lua_touserdata(L, -1);
    lua_getiuservalue(L, 1, DML_PATH_END);
    dml_checkpoint *c = lua_touserdata(L, -1);
    if (c && !c->checked) {
        double *x = lua_newuserdatauv(L, (2 * (size_t)c->n + 1) * sizeof *x, 0);
        check(c, m, x, s);
        lua_pop(L, 1);
    }
    lua_remove(L, -2);
    return c;
}

double dml_checkpoint_time(const dml_checkpoint *c, const dml_solver *s) {
    if (s->method->traits & DM_OWN_TIME) return c->state[4 * (size_t)c->n];
    return c->t0 + (double)c->steps * s->h;
}

/* Only copies, so that it can be done between any two steps. */
void dml_checkpoint_take(dml_checkpoint *c, dml_stepping *r, long steps) {
    const size_t size = dm_state_size(c->n);
    double *place;
    c->t0 = r->t0;
    c->steps = steps;
    memcpy(c->state, r->state, size * sizeof(double));
    c->checked = 0;
    if (c->memory && dm_stepper_memory(&r->stepper, &place) == c->memory)
        memcpy(c->state + size, place, c->memory * sizeof(double));
}

static int is_same(double was, double is) {
    const double off = fabs(is - was), size = fabs(is) + fabs(was);
    return is == was || off <= 1e-9 * size || (isnan(is) && isnan(was));
}

/* Raise where L (Ld) or a function is another one far from the state. */
static void check_far(lua_State *L, double was, double is) {
    if (isnan(was) || is_same(was, is)) return;
    luaL_error(L, "the system is not the one of the checkpoint: its functions differ far from the "
                  "state where it ended; for another system start a new run from q and p");
}

/* Raise where the rule is another one of the same name: coefficients or functions differ. */
static void check_rule(lua_State *L, double was, double is) {
    if (isnan(was) || is_same(was, is)) return;
    luaL_error(L, "the rule is not the one of the checkpoint: its coefficients or functions are "
                  "others; give that one, dm.resume(file, system, { rule = the object }), or start "
                  "a new run from q and p");
}

/* Raise where the system is another one: "L", "Ld" or the function that differs. */
static void check_same(lua_State *L, const dml_stepping *r, const dml_checkpoint *c, double t) {
    double now[DML_CHECKS];
    const char *what = r->solver->pair ? "Ld" : "L";
    fingerprint(now, r->model, r->x, c->state, t, r->solver->pair);
    for (int k = 0; k < DML_CHECK_FAR; k++) {
        const char *name =
            k < DML_CHECK_FUNCTIONS ? what : dml_functionname(k - DML_CHECK_FUNCTIONS);
        if (is_same(c->check[k], now[k])) continue;
        if (isnan(c->check[k]) != isnan(now[k]) && k >= DML_CHECK_FUNCTIONS)
            luaL_error(L,
                       "the system is not the one of the checkpoint: it has %s '%s'; for another "
                       "system start a new run from q and p",
                       isnan(now[k]) ? "no" : "a", name);
        luaL_error(L,
                   "the system is not the one of the checkpoint: %s %s was %f and is %f; for "
                   "another system start a new run from q and p",
                   k == DML_CHECK_STATE ? "at its state" : "near its state the sum of", name,
                   c->check[k], now[k]);
    }
    check_far(L, c->check[DML_CHECK_FAR], now[DML_CHECK_FAR]);
    check_rule(L, c->check[DML_CHECK_RULE], r->solver->own);
}

/* The stepper is open on return, as dml_stepping_start leaves it; the memory of the method goes
 * back in when the run begins (dm_run_plan.resume). */
void dml_stepping_resume(lua_State *L, dml_stepping *r, const dml_checkpoint *c) {
    check_same(L, r, c, c->t0 + r->solver->h * (double)c->steps);
    memcpy(r->state, c->state, dm_state_size(c->n) * sizeof(double));
    dml_stepping_open(L, r);
    double *place;
    const size_t memory = dm_stepper_memory(&r->stepper, &place);
    if (memory == c->memory) return;
    dml_stepping_end(r);
    luaL_error(L, "the checkpoint was made by another version of rule '%s'",
               r->solver->nodes[0].name);
}

/* ---- what Lua sees ---- */

/* (path, file) -> file */
int dml_path_checkpoint(lua_State *L) {
    luaL_checkudata(L, 1, DML_PATH);
    const char *file = dml_filename(L, 2);
    if (lua_getiuservalue(L, 1, DML_PATH_END) == LUA_TNIL)
        luaL_error(L, "this path has no end to go on from: its run did not begin, or is one of "
                      "asynchronous steps or uneven slices (start another from its last q and p)");
    lua_getiuservalue(L, 1, DML_PATH_SOLVER);
    const dml_solver *s = luaL_checkudata(L, -1, DML_SOLVER);
    const dml_checkpoint *c = push_end(L, s);
    lua_getiuservalue(L, 1, DML_PATH_RULE);
    if (!dml_checkpoint_write(c, s, luaL_tolstring(L, -1, NULL), file))
        luaL_error(L, "path:checkpoint: cannot write %s: %s", file, strerror(errno));
    lua_settop(L, 2);
    return 1;
}

/* option `key` of the table on top */
static void set_number(lua_State *L, const char *key, double x) {
    lua_pushnumber(L, x);
    lua_setfield(L, -2, key);
}

/* options and end of the path at 1 */
static void read_path(lua_State *L) {
    luaL_checkudata(L, 1, DML_PATH);
    lua_newtable(L);
    lua_getiuservalue(L, 1, DML_PATH_SOLVER);
    const dml_solver *s = luaL_testudata(L, -1, DML_SOLVER);
    if (!s)
        luaL_error(L, "this path has no end to go on from: its run did not begin, or is one of "
                      "asynchronous steps or uneven slices (start another from its last q and p)");
    if (lua_getiuservalue(L, -1, DML_SOLVER_OBJECT) == LUA_TNIL)
        lua_pop(L, 1), lua_getiuservalue(L, -1, DML_SOLVER_RULE);
    lua_setfield(L, -3, "rule");
    lua_getiuservalue(L, -1, DML_SOLVER_BACKEND);
    lua_setfield(L, -3, "backend");
    lua_pop(L, 1);
    set_number(L, "h", s->h);
    if (s->plain) lua_pushstring(L, "plain"), lua_setfield(L, -2, "sums");
    lua_newtable(L);
    set_number(L, "tolerance", s->tolerance);
    set_number(L, "max_iterations", s->max_iterations);
    lua_setfield(L, -2, "newton");
    push_end(L, s);
}

/* the name of the rule on top of the stack, which is left there; an object is "rule NAME" */
static const char *push_rule_name(lua_State *L) {
    const char *name = luaL_tolstring(L, -1, NULL);
    return strncmp(name, "rule ", 5) == 0 ? name + 5 : name;
}

/* Formulas Ld(q0, q1) and the rules of the list that step them go with each other alone. */
static void check_kind(lua_State *L, int options, const dml_system *system) {
    dm_rule nodes[DM_RULE_NODES];
    lua_getfield(L, options, "rule");
    const char *rule = push_rule_name(L);
    const int known = !strstr(rule, "own") && !dm_rule_read(nodes, rule, NULL) && nodes[0].method;
    if (known && !(nodes[0].method->traits & DM_FOR_PAIRS) != !system->pair)
        luaL_error(L,
                   system->pair
                       ? "the checkpoint is of rule '%s', and this discrete Lagrangian is a "
                         "formula Ld(q0, q1), stepped by 'del': give the system of the "
                         "checkpoint here, or start a new run"
                       : "the checkpoint is of a formula Ld(q0, q1), stepped by rule '%s': "
                         "give that discrete Lagrangian here, or start a new run",
                   rule);
    lua_pop(L, 2);
}

/* rule and backend of the options at 3: the rule as an object, where the file has only its name */
static void override(lua_State *L, int options) {
    static const char *const known[] = {"rule", "backend", NULL};
    if (!lua_isnil(L, 3)) dml_options(L, 3, known);
    const int given = !lua_isnil(L, 3) && lua_getfield(L, 3, "rule") != LUA_TNIL;
    const int text = lua_getfield(L, options, "rule") == LUA_TSTRING;
    const char *rule = push_rule_name(L);
    if (text && strstr(rule, "own") && !given) /* an object, which its text does not give */
        luaL_error(L,
                   "the checkpoint is of '%s', a rule that a file does not hold: dm.resume(file, "
                   "system, { rule = the object })",
                   rule);
    if (given) {
        lua_getfield(L, 3, "rule");
        const char *now = push_rule_name(L);
        if (strcmp(now, rule) != 0)
            luaL_error(L,
                       "the checkpoint is of rule '%s', not '%s': with another rule start a new "
                       "run from q and p",
                       rule, now);
        lua_getfield(L, 3, "rule");
        lua_setfield(L, options, "rule");
    }
    if (!lua_isnil(L, 3) && lua_getfield(L, 3, "backend") != LUA_TNIL)
        lua_setfield(L, options, "backend");
    lua_settop(L, options + 1);
}

/* (file or path, system, options) -> a solver whose user value DML_SOLVER_START is the checkpoint
 * */
int dml_resume(lua_State *L) {
    lua_settop(L, 3);
    const int from_path = luaL_testudata(L, 1, DML_PATH) != NULL;
    if (from_path && lua_isnil(L, 2)) {
        lua_getiuservalue(L, 1, DML_PATH_SYSTEM);
        lua_replace(L, 2);
    }
    const dml_system *system = dml_checksystem(L, 2);
    if (from_path)
        read_path(L);
    else
        dml_checkpoint_read(L, dml_filename(L, 1));
    const int end = lua_gettop(L), options = end - 1;
    const dml_checkpoint *c = lua_touserdata(L, end);
    if (!c) luaL_error(L, "this path has no end to go on from");
    if (c->n != system->n)
        luaL_error(L, "the checkpoint is of a system of %d coordinates, this one has %d", (int)c->n,
                   (int)system->n);
    check_kind(L, options, system);
    override(L, options);
    lua_pushcfunction(L, dml_solver_of);
    lua_pushvalue(L, 2);
    lua_pushvalue(L, options);
    lua_call(L, 2, 1);
    lua_pushvalue(L, end);
    lua_setiuservalue(L, -2, DML_SOLVER_START);
    return 1;
}
