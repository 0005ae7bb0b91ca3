/* ensemble_vary.c - `vary = { name = ... }`: members of one ensemble with parameters of their
 * own. */
#include "bind/core/missing_key.h"
#include "bind/ensemble/bind_ensemble.h"
#include "bind/model/bind_system.h"
#include "bind/model/model_params.h"
#include "bind/run/stepping.h"

#include <math.h>
#include <string.h>

/* the system of the solver at 1 must have a number of that name among its params */
static void check_parameter(lua_State *L, const char *name) {
    lua_getiuservalue(L, 1, DML_SOLVER_SYSTEM);
    if (dml_systemfield(L, lua_gettop(L), "params") != LUA_TTABLE)
        luaL_error(L, "field 'vary': the system has no parameters; give them as dm.system{params = "
                      "{...}} and take them as the fourth argument of L");
    if (lua_getfield(L, -1, name) == LUA_TNIL &&
        lua_getfield(L, LUA_REGISTRYINDEX, "dm_param_names") == LUA_TFUNCTION) {
        lua_pushvalue(L, -3);
        lua_call(L, 1, 1);
        luaL_error(L,
                   "field 'vary': '%s' is not a number among the params of the system (it is not "
                   "there; its parameters are %s)",
                   name, lua_tostring(L, -1));
    }
    if (lua_type(L, -1) != LUA_TNUMBER)
        luaL_error(L,
                   "field 'vary': '%s' is not a number among the params of the system (it is %s)",
                   name, luaL_typename(L, -1));
    lua_pop(L, 3);
}

/* the names in alphabetical order, whatever the order of the table */
static void push_names(lua_State *L, int vary) {
    lua_newtable(L);
    for (lua_pushnil(L); lua_next(L, vary); lua_pop(L, 1)) {
        if (lua_type(L, -2) != LUA_TSTRING)
            luaL_error(L, "field 'vary' must be a table { name = function or table }, for instance "
                          "vary = { k = function(i) return i / 10 end }");
        check_parameter(L, lua_tostring(L, -2));
        lua_pushvalue(L, -2);
        lua_rawseti(L, -4, luaL_len(L, -4) + 1);
    }
    lua_getglobal(L, "table");
    lua_getfield(L, -1, "sort");
    lua_pushvalue(L, -3);
    lua_call(L, 1, 0);
    lua_pop(L, 1);
}

static double read_value(lua_State *L, int vary, const char *name, long i) {
    dml_push_source(L, vary, name, i);
    if (lua_type(L, -1) != LUA_TNUMBER || !isfinite(lua_tonumber(L, -1)))
        luaL_error(L, "field 'vary': '%s' of member %d must be a finite number (got %s)", name,
                   (int)i + 1, luaL_tolstring(L, -1, NULL));
    const double x = lua_tonumber(L, -1);
    lua_pop(L, 1);
    return x;
}

/* push the params of the system of the solver at 1 with the values of member i */
static void push_params(lua_State *L, const double *values, int names, long i) {
    const lua_Integer count = luaL_len(L, names);
    lua_getiuservalue(L, 1, DML_SOLVER_SYSTEM);
    dml_systemfield(L, -1, "params");
    dml_copyparams(L, -1);
    for (lua_Integer k = 1; k <= count; k++) {
        lua_rawgeti(L, names, k);
        lua_pushnumber(L, values[i * count + k - 1]);
        lua_rawset(L, -3);
    }
    lua_remove(L, -2);
    lua_remove(L, -2);
}

/* replace the list of names on top by those of them that nothing reads where the params are those
 * of member i */
static void keep_unread(lua_State *L, const double *values, int names, long i) {
    const int unread = lua_gettop(L);
    lua_getfield(L, LUA_REGISTRYINDEX, "dm_unread");
    lua_getiuservalue(L, 1, DML_SOLVER_SYSTEM);
    push_params(L, values, names, i);
    lua_pushvalue(L, unread);
    lua_call(L, 3, 1);
    lua_replace(L, unread);
}

/* Raises where one of the names does not reach the functions of the system that read it; those that
 * none has read are on top. */
static void check_reach(lua_State *L, int names) {
    const int unread = lua_gettop(L);
    lua_getfield(L, LUA_REGISTRYINDEX, "dm_out_of_reach");
    lua_getiuservalue(L, 1, DML_SOLVER_SYSTEM);
    lua_pushvalue(L, names);
    lua_pushvalue(L, unread);
    lua_call(L, 3, 2);
    const char *name = lua_tostring(L, -2);
    if (name)
        luaL_error(L, "field 'vary': members would not differ by parameter '%s': %s", name,
                   lua_tostring(L, -1));
    lua_settop(L, unread);
}

/* A parameter that nothing reads makes members that are alike without a word. One value of another
 * may decide what is read, so several members are looked at. */
static void check_read(lua_State *L, const double *values, int names, long members) {
    enum { LOOKS = 8 };
    if (lua_getfield(L, LUA_REGISTRYINDEX, "dm_unread") != LUA_TFUNCTION) /* the core alone */
        return lua_pop(L, 1);
    lua_pop(L, 1);
    lua_pushvalue(L, names);
    for (long k = 0; k < LOOKS && k < members && luaL_len(L, -1); k++)
        keep_unread(L, values, names, members <= LOOKS ? k : k * (members - 1) / (LOOKS - 1));
    check_reach(L, names);
    lua_pop(L, 1);
}

/* Raises where a function of the options' field `watch` reads a parameter that varies. */
static void check_watch(lua_State *L, int names) {
    const int top = lua_gettop(L);
    if (lua_getfield(L, LUA_REGISTRYINDEX, "dm_outside") != LUA_TFUNCTION) /* the core alone */
        return lua_settop(L, top);
    lua_getiuservalue(L, 1, DML_SOLVER_SYSTEM);
    lua_getfield(L, 2, "watch");
    lua_pushvalue(L, names);
    lua_call(L, 3, 2);
    const char *name = lua_tostring(L, -1), *key = lua_tostring(L, -2);
    if (name)
        luaL_error(L,
                   "field 'watch': %s reads params.%s, which is that of the system, not that of a "
                   "member: watch what it is made of, and compute it from the rows of "
                   "ensemble:path(i)",
                   key, name);
    lua_settop(L, top);
}

const double *dml_read_vary(lua_State *L, long members, uint32_t *count) {
    const int type = lua_getfield(L, 2, "vary"), vary = lua_gettop(L);
    if (type == LUA_TNIL) return lua_pop(L, 1), NULL;
    if (type != LUA_TTABLE)
        luaL_error(L, "field 'vary' must be a table { name = function or table } (got %s)",
                   luaL_typename(L, -1));
    push_names(L, vary);
    *count = (uint32_t)luaL_len(L, -1);
    if (*count == 0) return lua_settop(L, vary - 1), NULL;
    double *values = lua_newuserdatauv(L, ((size_t)members * *count + 1) * sizeof *values, 0);
    for (uint32_t k = 0; k < *count; k++) {
        lua_rawgeti(L, vary + 1, k + 1);
        const char *name = lua_tostring(L, -1);
        dml_check_source(L, vary, name, members);
        for (long i = 0; i < members; i++)
            values[(size_t)i * *count + k] = read_value(L, vary, name, i);
        lua_pop(L, 1);
    }
    check_read(L, values, vary + 1, members);
    check_watch(L, vary + 1);
    lua_insert(L, -2);
    lua_remove(L, vary);
    return values;
}

long dml_vary_alike(const double *values, uint32_t count, long first, long members) {
    const size_t bytes = count * sizeof *values;
    const double *row = values + (size_t)first * count;
    long last = first + 1;
    while (last < members && memcmp(row, values + (size_t)last * count, bytes) == 0) last++;
    return last - first;
}

/* fields of the system, with these numbers among its params */
static void push_fields(lua_State *L, int system, const double *values, int names, int base) {
    lua_getiuservalue(L, system, 1);
    dml_pushcopy(L, -1);
    if (base)
        lua_pushvalue(L, base);
    else
        lua_getfield(L, -1, "params");
    dml_copyparams(L, -1);
    for (lua_Integer k = 1; k <= luaL_len(L, names); k++) {
        lua_rawgeti(L, names, k);
        lua_pushnumber(L, values[k - 1]);
        lua_rawset(L, -3);
    }
    lua_setfield(L, -3, "params");
    lua_pop(L, 1);
    lua_remove(L, -2);
}

dml_solver *dml_vary_solver(lua_State *L, const double *values, int names, int base) {
    dml_solver *solver = dml_pushtwin(L, 1, DML_SOLVER_VALUES);
    const int twin = lua_gettop(L);
    for (int k = 1; k <= DML_SOLVER_VALUES; k++) {
        lua_getiuservalue(L, 1, k);
        lua_setiuservalue(L, twin, k);
    }
    lua_getiuservalue(L, 1, DML_SOLVER_SYSTEM);
    dml_pushtwin(L, twin + 1, 1);
    push_fields(L, twin + 1, values, names, base);
    lua_setiuservalue(L, -2, 1);
    lua_setiuservalue(L, twin, DML_SOLVER_SYSTEM);
    lua_settop(L, twin);
    lua_replace(L, 1);
    return solver;
}

/* ---- parameters as inputs of one kernel ---- */

/* (solver, options) -> names of all parameters that its kernels have as inputs, or nothing */
static int find_names(lua_State *L) {
    dml_stepping r = {.solver = lua_touserdata(L, 1), .varied = 1};
    dml_stepping_prepare(L, &r, 0.0);
    if (!r.inputs) return 0;
    dml_pushnames(L, &r);
    return 1;
}

/* the place of a name in the list at `names`, from 0; -1: none */
static lua_Integer place_of(lua_State *L, int names, const char *name) {
    const lua_Integer count = luaL_len(L, names);
    lua_Integer found = -1;
    for (lua_Integer k = 1; k <= count && found < 0; k++) {
        lua_rawgeti(L, names, k);
        if (strcmp(lua_tostring(L, -1), name) == 0) found = k - 1;
        lua_pop(L, 1);
    }
    return found;
}

/* the varied ones are all among the inputs */
static int are_inputs(lua_State *L, int inputs, int varied, uint32_t count) {
    int all = 1;
    for (uint32_t k = 0; k < count; k++) {
        lua_rawgeti(L, varied, k + 1);
        all = all && place_of(L, inputs, lua_tostring(L, -1)) >= 0;
        lua_pop(L, 1);
    }
    return all;
}

/* one column of the inputs: varied, or as the system has it */
static void fill_column(lua_State *L, double *out, uint32_t many, long members,
                        const dml_varied *v) {
    const char *name = lua_tostring(L, -1);
    const lua_Integer k = v->values ? place_of(L, v->names, name) : -1;
    lua_getiuservalue(L, 1, DML_SOLVER_SYSTEM);
    dml_systemfield(L, -1, "params");
    lua_getfield(L, -1, name);
    const double own = lua_tonumber(L, -1);
    lua_pop(L, 3);
    for (long i = 0; i < members; i++)
        out[(size_t)i * many] = k < 0 ? own : v->values[(size_t)i * v->count + (size_t)k];
}

const double *dml_vary_inputs(lua_State *L, long members, const dml_varied *v) {
    const int inputs = lua_gettop(L) + 1;
    lua_pushcfunction(L, find_names);
    lua_pushvalue(L, 1);
    lua_pushvalue(L, 2);
    if (!dml_try(L, 2, 1) || !lua_istable(L, inputs) ||
        (v->values && !are_inputs(L, inputs, v->names, v->count)))
        return lua_settop(L, inputs), NULL;
    const uint32_t many = (uint32_t)luaL_len(L, inputs);
    double *out = lua_newuserdatauv(L, (size_t)members * many * sizeof *out, 0);
    for (uint32_t j = 0; j < many; j++) {
        lua_rawgeti(L, inputs, j + 1);
        fill_column(L, out + j, many, members, v);
        lua_pop(L, 1);
    }
    lua_replace(L, inputs);
    return out;
}

/* (what is compared, function, inputs): raises where trace and function differ; a member outside
 * of the domain fails alone */
static int compare(lua_State *L) {
    const dml_stepping *r = lua_touserdata(L, 1);
    const dml_model *m = r->inputs;
    dml_signature sig = dml_withsignature(m->n, m->params);
    sig.may_be_outside = 1;
    dml_trace_check_beside(L, 2, &sig, &m->model.value, lua_touserdata(L, 3), 2 * (size_t)m->n + 1);
    return 0;
}

/* ---- members that start alike ---- */

/* numbers of members (from 1) by hash, 0: free; as many places as a power of two above their
 * number */
typedef struct {
    uint32_t *member;
    size_t places;
    const dml_part *part;
    uint32_t many;
} seen;

static void open_seen(lua_State *L, seen *s) {
    s->places = 4;
    while (s->places < 2 * (size_t)s->part->count) s->places *= 2;
    s->member = lua_newuserdatauv(L, s->places * sizeof *s->member, 0);
    memset(s->member, 0, s->places * sizeof *s->member);
}

static const double *state_of(const dml_part *p, long i) {
    return p->e->state + (size_t)(p->first + i) * dm_state_size(p->e->n);
}

/* FNV-1a of words */
static uint64_t add_words(uint64_t hash, const double *x, size_t count) {
    for (size_t k = 0; k < count; k++) {
        uint64_t word;
        memcpy(&word, x + k, sizeof word);
        hash = (hash ^ word) * 1099511628211u;
        hash ^= hash >> 32;
    }
    return hash;
}

/* has a member before i the same start and values, bit for bit? */
static int is_seen(seen *s, long i) {
    const dml_part *p = s->part;
    const size_t n = p->e->n, own = 2 * n * sizeof(double);
    const size_t bytes = s->many * sizeof(double);
    const double *values = p->values + (size_t)i * s->many;
    uint64_t at = add_words(14695981039346656037u, state_of(p, i), 2 * n);
    for (at = add_words(at, values, s->many);; at++) {
        uint32_t *place = s->member + (at & (s->places - 1));
        if (!*place) return *place = (uint32_t)i + 1, 0;
        const long other = (long)*place - 1;
        if (memcmp(state_of(p, other), state_of(p, i), own) == 0 &&
            memcmp(p->values + (size_t)other * s->many, values, bytes) == 0)
            return 1;
    }
}

int dml_vary_is_traced(lua_State *L, const dml_part *p, dml_stepping *r) {
    const uint32_t n = p->e->n, many = r->inputs->params;
    const size_t bytes = many * sizeof(double);
    const int top = lua_gettop(L);
    double *x = lua_newuserdatauv(L, (2 * n + 1) * sizeof *x + bytes, 0);
    seen before = {.part = p, .many = many};
    int same = 1;
    open_seen(L, &before);
    dml_pushnames(L, r);
    dml_pushwith(L, r->system, -1);
    const int fn = lua_gettop(L);
    for (long i = 0; same && i < p->count; i++) {
        const double *state = state_of(p, i);
        const double *values = p->values + (size_t)i * many;
        if (i && memcmp(values, values - many, bytes) == 0) continue;
        if (is_seen(&before, i)) continue;
        memcpy(x, state, 2 * n * sizeof *x);
        x[2 * n] = r->t0;
        memcpy(x + 2 * n + 1, values, bytes);
        if (dm_legendre_inverse(&r->model->model, x + n, state, state + n, r->t0, r->work) != DM_OK)
            continue;
        lua_pushcfunction(L, compare);
        lua_pushlightuserdata(L, r);
        lua_pushvalue(L, fn);
        lua_pushlightuserdata(L, x);
        same = dml_try(L, 3, 0);
        lua_settop(L, fn);
    }
    lua_settop(L, top);
    return same;
}
