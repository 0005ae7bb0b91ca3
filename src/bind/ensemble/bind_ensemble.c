/* bind_ensemble.c - the `dm.ensemble` that members of solver:ensemble{} end in: what can be
 * asked of it. */
#include "bind/ensemble/bind_ensemble.h"
#include "bind/model/space_group.h"
#include "bind/trace/backend.h"
#include "code/native/jit.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

typedef dml_ensemble ensemble;

static ensemble *check(lua_State *L) {
    return luaL_checkudata(L, 1, DML_ENSEMBLE);
}

/* bytes of states, statuses and rows of a member */
static size_t bytes_of_member(uint32_t n, const dm_ensemble_rows *rows) {
    return dm_state_size(n) * sizeof(double) + sizeof(dm_member) + sizeof(long) +
           sizeof(dm_trouble) + (size_t)rows->room * rows->width * sizeof(double);
}

static double memory_of_machine(void) {
    return (double)sysconf(_SC_PHYS_PAGES) * (double)sysconf(_SC_PAGESIZE);
}

/* zeros: gigabytes of them take seconds, which Ctrl-C may end */
static void clear(lua_State *L, char *data, size_t size) {
    enum { BLOCK = 1 << 24 };
    for (size_t done = 0; done < size; done += BLOCK) {
        memset(data + done, 0, size - done < BLOCK ? size - done : BLOCK);
        dml_checkstop(L);
    }
}

dml_ensemble *dml_pushensemble(lua_State *L, long members, uint32_t n,
                               const dm_ensemble_rows *rows) {
    static const double small = 1e6; /* bytes: no need to ask the system */
    const size_t each = bytes_of_member(n, rows);
    const double bytes = (double)members * ((double)each + (double)rows->room * rows->width * 8.0);
    if (bytes > small && bytes > 0.5 * memory_of_machine()) {
        char size[24];
        snprintf(size, sizeof size, "%.3g GB", bytes * 1e-9);
        luaL_error(L,
                   "%d members need %s, more than half of this machine's memory: run them in "
                   "parts%s",
                   (int)members, size,
                   rows->room ? ", or keep fewer rows with a larger 'every'" : "");
    }
    ensemble *e = lua_newuserdatauv(L, sizeof *e + (size_t)members * each, DML_ENSEMBLE_VALUES);
    *e = (ensemble){.members = members, .n = n, .rows = *rows};
    const size_t told = sizeof *e->member + sizeof(long) + sizeof *e->trouble;
    clear(L, (char *)(e + 1), (size_t)members * (each - told));
    e->state = (double *)(e + 1);
    e->rows.data = e->state + (size_t)members * dm_state_size(n);
    e->member =
        (dm_member *)(void *)(e->rows.data + (size_t)members * (size_t)rows->room * rows->width);
    e->rows.count = (long *)(void *)(e->member + members);
    e->trouble = (dm_trouble *)(void *)(e->rows.count + members);
    for (long i = 0; i < members; i++) {
        e->member[i] = (dm_member){.status = DM_STOPPED};
        e->rows.count[i] = 0;
    }
    luaL_setmetatable(L, DML_ENSEMBLE);
    return e;
}

/* a matrix members x count of the entries from `first` of every state */
static void push_entries(lua_State *L, const ensemble *e, uint32_t first, uint32_t count) {
    double *out = dml_pushmatrix(L, (uint32_t)e->members, count);
    for (long i = 0; i < e->members; i++)
        memcpy(out + (size_t)i * count, e->state + (size_t)i * dm_state_size(e->n) + first,
               count * sizeof *out);
}

/* of a system on a group, which is at `system`: a list of elements */
static void push_elements(lua_State *L, const ensemble *e, int system) {
    lua_createtable(L, (int)e->members, 0);
    for (long i = 0; i < e->members; i++) {
        dml_pushposition(L, system, e->state + (size_t)i * dm_state_size(e->n));
        lua_rawseti(L, -2, i + 1);
    }
}

/* places (or momenta) of all members */
static int push_states(lua_State *L, const ensemble *e, int places) {
    const int top = lua_gettop(L), system = top + 1;
    lua_getiuservalue(L, 1, DML_ENSEMBLE_SOLVER);
    lua_getiuservalue(L, -1, DML_SOLVER_SYSTEM);
    lua_replace(L, system);
    if (!places)
        push_entries(L, e, e->n, dml_checksystem(L, system)->momenta);
    else if (dml_placed(L, system))
        push_elements(L, e, system);
    else
        push_entries(L, e, 0, e->n);
    lua_replace(L, system);
    return 1;
}

static int push_status(lua_State *L, const ensemble *e) {
    lua_createtable(L, (int)e->members, 0);
    for (long i = 0; i < e->members; i++) {
        lua_pushstring(L, dm_status_code(e->member[i].status));
        lua_rawseti(L, -2, i + 1);
    }
    dml_lock(L, "the status of the members");
    return 1;
}

static int push_steps(lua_State *L, const ensemble *e) {
    lua_createtable(L, (int)e->members, 0);
    for (long i = 0; i < e->members; i++) {
        lua_pushinteger(L, e->member[i].steps);
        lua_rawseti(L, -2, i + 1);
    }
    dml_lock(L, "the steps of the members");
    return 1;
}

static int has_own_time(lua_State *L) {
    lua_getiuservalue(L, 1, DML_ENSEMBLE_SOLVER);
    const dml_solver *s = lua_touserdata(L, -1); /* kept by the ensemble */
    lua_pop(L, 1);
    return (s->method->traits & DM_OWN_TIME) != 0;
}

/* steps of members that have their own */
static int push_steps_of(lua_State *L, const ensemble *e) {
    double *out = dml_pushvector(L, (uint32_t)e->members);
    for (long i = 0; i < e->members; i++) out[i] = e->pace[i].h;
    return 1;
}

/* the time that member i is to end at; of a rule with a time of its own that where it is */
static double end_of(const ensemble *e, long i, int own) {
    if (own) return e->state[(size_t)i * dm_state_size(e->n) + 4 * (size_t)e->n];
    return e->pace ? e->t0 + e->pace[i].h * (double)e->pace[i].steps : e->t;
}

static int push_ends(lua_State *L, const ensemble *e) {
    const int own = has_own_time(L);
    if (!e->pace && !own) return lua_pushnumber(L, e->t), 1;
    double *out = dml_pushvector(L, (uint32_t)e->members);
    for (long i = 0; i < e->members; i++) out[i] = end_of(e, i, own);
    return 1;
}

static int make_field(lua_State *L, const ensemble *e, const char *key) {
    if (strcmp(key, "q") == 0) return push_states(L, e, 1);
    if (strcmp(key, "p") == 0) return push_states(L, e, 0);
    if (strcmp(key, "status") == 0) return push_status(L, e);
    if (strcmp(key, "steps") == 0) return push_steps(L, e);
    if (strcmp(key, "h") == 0) return push_steps_of(L, e);
    if (strcmp(key, "t") == 0) return push_ends(L, e);
    return 0;
}

/* the large fields are made when first asked for and kept in user value 1 */
static int ensemble_field(lua_State *L) {
    const ensemble *e = check(L);
    const char *key = luaL_checkstring(L, 2);
    if (!e->pace && strcmp(key, "h") == 0) return lua_pushnumber(L, e->h), 1;
    if (strcmp(key, "lanes") == 0) return lua_pushinteger(L, e->lanes), 1;
    if (strcmp(key, "systems") == 0) return lua_pushinteger(L, e->systems), 1;
    if (strcmp(key, "solver") == 0) return lua_getiuservalue(L, 1, DML_ENSEMBLE_SOLVER), 1;
    if (strcmp(key, "rows") == 0) return lua_pushboolean(L, e->rows.room > 0), 1;
    if (lua_getiuservalue(L, 1, DML_ENSEMBLE_FIELDS) != LUA_TTABLE) {
        lua_newtable(L);
        lua_pushvalue(L, -1);
        lua_setiuservalue(L, 1, DML_ENSEMBLE_FIELDS);
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
    dml_setresult(L);
    for (long i = 0; i < e->members; i++) {
        if (e->member[i].status == DM_OK) continue;
        lua_createtable(L, 0, 3);
        lua_pushinteger(L, i + 1), lua_setfield(L, -2, "member");
        lua_pushstring(L, dm_status_code(e->member[i].status)), lua_setfield(L, -2, "code");
        lua_pushinteger(L, e->member[i].steps + 1), lua_setfield(L, -2, "step");
        if (!dml_ensemblereason(L, 1, i)) lua_pushstring(L, dm_status_text(e->member[i].status));
        lua_setfield(L, -2, "message");
        lua_rawseti(L, -2, ++count);
    }
    return 1;
}

static int ensemble_tostring(lua_State *L) {
    const ensemble *e = check(L);
    const long failed = count_failed(e);
    const int own = has_own_time(L);
    double least = INFINITY, largest = -INFINITY;
    for (long i = 0; i < e->members; i++) {
        least = fmin(least, end_of(e, i, own));
        largest = fmax(largest, end_of(e, i, own));
    }
    lua_pushfstring(L, "ensemble of %d members at t = %f", (int)e->members, least);
    if (largest > least) lua_pushfstring(L, " to %f", largest), lua_concat(L, 2);
    lua_pushliteral(L, ": ");
    if (failed)
        lua_pushfstring(L, "%d failed (see failures())", (int)failed);
    else
        lua_pushstring(L, "all ok");
    lua_concat(L, 3);
    return 1;
}

static const dml_row meta[] = {{"__len", ensemble_len, NULL},
                               {"__tostring", ensemble_tostring, NULL},
                               {NULL, NULL, NULL}};
static const dml_row methods[] =
    {{"failures", ensemble_failures,
      "ensemble:failures() -> table of {member, code, step, message}\n"
      "The members that did not reach the end, why (see dm.failure), and the step that failed. "
      "Code \"no_start\": its parameters (vary=) leave no equations of motion, a mass of zero for "
      "instance; the message says why."},
     {"path", dml_ensemble_path,
      "ensemble:path(i) -> dm.path\n"
      "The rows of member i, of an ensemble that was asked to keep some (every=, watch=): what "
      "solver:run would have given, of a failed member up to its last good state."},
     {"summary", dml_ensemble_summary,
      "ensemble:summary([name]) -> {first, last, least, largest, mean, slope, error, early, late, "
      "nearest, span, megno} or {name = {least, mean, largest}}\n"
      "What the rows of every member say of a column y, as tables with an entry for each: "
      "slope per unit of time with its standard error as path:drift finds them; early, late: "
      "largest |y - first| in the first and the last quarter of the rows; nearest, span: least |y "
      "- first| and largest - least in their second half (infinite without rows there); megno: the "
      "mean of 2 (y - its mean so far), which is MEGNO where y is the logarithm of the length of a "
      "tangent vector. NaN without rows. Without a name: of every column the extent over "
      "the rows of all members."},
     {"departure", dml_ensemble_departure,
      "ensemble:departure(i, flow, j, names [, until, bounds]) -> table of numbers, number\n"
      "How far the rows of member i are at most from those of member j of the ensemble `flow`, for "
      "each of these watched columns, up to the time `until`: that member's rows lie at even times "
      "and so dense that the polynomial through eight of them is the motion; where rows of i leave "
      "steps out parabolas tell the largest value between them. NaN where a number is none. With a "
      "table of bounds it ends at the first row beyond one, whose time is the second number, else "
      "infinite."},
     {"followed", dml_ensemble_followed,
      "ensemble:followed(i) -> {name = number}\n"
      "What solver:ensemble{beside=} has found of member i: of columns that flows have the largest "
      "distance from the flow, of others the largest size, each up to where it was looked at."},
     {"range", dml_ensemble_range,
      "ensemble:range(i, name [, until]) -> number, number\n"
      "Greatest less least value of a watched column of member i up to the time `until`, between "
      "its rows, too; and its first value (NaN without rows)."},
     {"stride", dml_ensemble_stride,
      "ensemble:stride(i, names, share) -> integer\n"
      "The largest power of two s such that every s-th row of member i tells those between, of "
      "these watched columns, to `share` of their ranges."},
     {NULL, NULL, NULL}};
static const dml_row functions[] =
    {{"summary", dml_core_summary,
      "core.summary(t, y) -> {first, last, least, largest, mean, slope, error, early, late, "
      "nearest, span, megno}\n"
      "What ensemble:summary tells of a member, of numbers y at the times t."},
     {NULL, NULL, NULL}};
static const dml_row solver_row[] =
    {{"ensemble", dml_solver_ensemble,
      "solver:ensemble{members=, q=, v=, p=, steps=, t=, t0=, h=, vary=, threads=, every=, rows=, "
      "watch=, gaps=, project=, energy=, a=, beside=} -> dm.ensemble\n"
      "Run `members` starts side by side for `steps` steps or the duration t. q, and v or p (q "
      "alone "
      "where L is linear in v): "
      "functions of the member's number (from 1) that return dim Q numbers, or a matrix or table "
      "with a row per member. vary = { name = }: numbers among the params of the system that every "
      "member has for itself, as functions or tables too; where the potential alone depends on "
      "them and the rule is explicit all share one kernel, else members that follow each other "
      "with the same ones do. h: a step of its own for every member, as a function or a table "
      "(with t each takes as many as cover it). Explicit rules step 4 or 8 members side by side in "
      "vector registers, neighbours with one step, implicit rules also those with steps of their "
      "own, where L does not depend on t (environment variable DMLUA_LANES = 0, 1, 4 or 8: at most "
      "so many). threads: default one per core (always one for hyper-dual functions, "
      "and for fields by implicit rules). Each member "
      "ends with the same bits as a run of its own, whatever the number of threads; one that fails "
      "does so alone (status[i], failures()). The ends are kept, 32 dim Q bytes a member; every = "
      "k keeps a row every k steps, rows = n about n rows of each, watch = { ... } rows of chosen "
      "numbers, as in solver:run (gaps, too): ensemble:path(i). energy: that the steps of sem(s, "
      "quadrature(r)) of all members are to have. a: the quantity that all members of a reduced "
      "system carry along (dm.euler_poincare). beside = { watch = { ... }, compared = names, flows "
      "= "
      "{ { e =, i =, horizon =, rows =, bound = }, ... } }: columns beside those of a resolved "
      "flow "
      "for every member (false: none), member i of the ensemble e, as in ensemble:departure, up "
      "to the time `horizon`, at about so many rows, until one is beyond its bound (a list as "
      "`compared`; left out: none), then at the rows that are kept; no row of this stays: "
      "ensemble:followed(i). Raises dm.failure with the ensemble as its path on "
      "Ctrl-C."},
     {NULL, NULL, NULL}};

/* DMLUA_LANES: as on a processor with so many lanes; 0: one without native code */
static void limit_lanes(lua_State *L) {
    const char *text = getenv("DMLUA_LANES");
    if (!text || !*text) return;
    if (strlen(text) != 1 || !strchr("0148", *text))
        luaL_error(L, "environment variable DMLUA_LANES must be 0, 1, 4 or 8 (got '%s')", text);
    dm_jit_limit((uint32_t)(*text - '0'));
}

static void open_ensemble(lua_State *L) {
    limit_lanes(L);
    dml_limitprocessor(L);
}

static const dml_extension more[] = {
    {DML_SOLVER, solver_row},
    {NULL, NULL},
};

const dml_class dml_class_ensemble = {
    .name = DML_ENSEMBLE,
    .doc = "dm.ensemble: the ends of many runs, made by solver:ensemble{members=}\n"
           "fields: q, p (matrices, a row per member; of a failed one its last good state), "
           "status[i] (\"ok\" or a code of dm.failure), steps[i] (finished), t, h (vectors where "
           "members have steps of their own, t also where the rule has a time of its own), solver, "
           "rows (were some kept?), lanes (members that "
           "went side by side, 1: one by one), systems (made for the parameters of members, 1: one "
           "kernel served all); #ensemble members",
    .meta = meta,
    .methods = methods,
    .functions = functions,
    .field = ensemble_field,
    .more = more,
    .open = open_ensemble,
};
