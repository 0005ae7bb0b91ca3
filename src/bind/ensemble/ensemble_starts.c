/* ensemble_starts.c - where the members of an ensemble start: functions, tables or matrices of
 * numbers. */
#include "bind/ensemble/bind_ensemble.h"
#include "bind/model/model_map.h"
#include "bind/model/named.h"
#include "bind/model/space_group.h"
#include "bind/run/start_constraints.h"
#include "bind/value/array.h"
#include "numbers/small_copy.h"

#include <math.h>
#include <string.h>

/* of member i, from the source at `at`, field `key` of the options */
static void push_member(lua_State *L, int at, const char *key, long i) {
    if (lua_type(L, at) != LUA_TFUNCTION) {
        lua_geti(L, at, i + 1);
        return;
    }
    lua_pushvalue(L, at);
    lua_pushinteger(L, i + 1);
    dml_callone(L, 1, key);
}

void dml_push_source(lua_State *L, int arg, const char *key, long i) {
    lua_getfield(L, arg, key);
    push_member(L, lua_gettop(L), key, i);
    lua_remove(L, -2);
}

void dml_check_source(lua_State *L, int arg, const char *key, long members) {
    const int top = lua_gettop(L), type = lua_getfield(L, arg, key);
    if (type != LUA_TFUNCTION && type != LUA_TTABLE && type != LUA_TUSERDATA)
        luaL_error(L,
                   "field '%s' must be a function of the member's number, or a table or matrix "
                   "with a row for each of the %d members (got %s)",
                   key, (int)members, luaL_typename(L, -1));
    if (type == LUA_TUSERDATA && luaL_getmetafield(L, -1, "__len") == LUA_TNIL)
        luaL_error(L, "field '%s' must have a row for each of the %d members (got a %s)", key,
                   (int)members, dml_kindname(L, -1));
    lua_settop(L, top + 1);
    if (type == LUA_TTABLE) dml_length(L, -1); /* raises where it is more than rows */
    if (type != LUA_TFUNCTION && luaL_len(L, -1) != members)
        luaL_error(L,
                   "field '%s' has %d rows for %d members; the same for all is function() return "
                   "... end",
                   key, (int)luaL_len(L, -1), (int)members);
    lua_pop(L, 1);
}

/* The n numbers of the plain table or vector at `row` of member i, as most are; 0: it is none. What
 * the first members have beside them all have (bodies.lua, starts by functions: 1.08x). */
static int read_plain(lua_State *L, int row, long i, double *out, uint32_t n) {
    enum { LOOKED = 16 };
    const long length = i < LOOKED ? dml_length(L, row) : dml_bare_length(L, row);
    return length == (long)n && dml_readplain(L, row, out, n) == n;
}

/* the same in any other form that a system takes, with what is wrong named */
static void read_any(lua_State *L, const char *key, long i, double *out, uint32_t n) {
    const char *name = lua_pushfstring(L, "'%s' of member %d", key, (int)i + 1);
    lua_getiuservalue(L, 1, DML_SOLVER_SYSTEM);
    if (!dml_unfield(L, -1, -3, key) && dml_is_named(L, -3)) dml_unname(L, -1, -3, name);
    lua_pop(L, 1);
    dml_vectorarg(L, -2, name, out, n);
}

/* the entries of a matrix of numbers with a row of n for every member; NULL: the source at `at`
 * is none */
static const double *entries_of(lua_State *L, int at, uint32_t n) {
    const dml_array *a = dml_toarray(L, at, 2);
    return a && a->columns == n ? dml_numbersof(a) : NULL;
}

/* row i of those; 0: it has an entry that is not finite */
static int copy_row(double *out, const double *rows, long i, uint32_t n) {
    double none = 0.0;
    rows += (size_t)i * n;
    dm_small_copy(out, rows, n);
    for (uint32_t k = 0; k < n; k++) none += rows[k] - rows[k];
    return none == 0.0;
}

/* n numbers for member i from the source at s->source, field s->key of the options */
static void read_member(lua_State *L, dml_starting *s, long i, double *out, uint32_t n) {
    const int top = lua_gettop(L);
    const double *rows = s->field ? NULL : entries_of(L, s->source, n);
    if (rows && copy_row(out, rows, i, n)) return;
    s->theirs = 1;
    push_member(L, s->source, s->key, i);
    s->theirs = 0;
    if (s->field || !read_plain(L, top + 1, i, out, n)) read_any(L, s->key, i, out, n);
    lua_settop(L, top);
}

static int is_field(lua_State *L) {
    lua_getiuservalue(L, 1, DML_SOLVER_SYSTEM);
    const int is = dml_checksystem(L, -1)->field != 0;
    lua_pop(L, 1);
    return is;
}

/* where the numbers of field `key` stand in the states */
static double *place_in(const dml_part *p, const char *key, long i) {
    return p->e->state + (size_t)i * dm_state_size(p->e->n) + (*key == 'q' ? 0 : p->e->n);
}

/* those of a part; 0: one of them has an entry that is not finite. One test for all: ensembles.lua,
 * start, one step, end: 1.03x. */
static int copy_rows(const dml_part *p, const char *key, const double *rows) {
    const uint32_t n = p->e->n;
    const size_t size = dm_state_size(n), all = (size_t)p->count * n;
    double *to = place_in(p, key, p->first), none[2] = {0.0};
    rows += (size_t)p->first * n;
    for (size_t i = 0; i + 1 < all; i += 2) none[0] += 0.0 * rows[i], none[1] += 0.0 * rows[i + 1];
    if (all % 2) none[0] += 0.0 * rows[all - 1];
    for (long i = 0; i < p->count; i++, to += size, rows += n) dm_small_copy(to, rows, n);
    return none[0] + none[1] == 0.0;
}

/* field s->key of member s->next */
static void read_field(lua_State *L, dml_starting *s) {
    read_member(L, s, s->next, place_in(s->these, s->key, s->next), s->these->e->n);
}

/* q and the other one of member s->next, each by its function */
static void read_both(lua_State *L, dml_starting *s) {
    const char *keys[] = {"q", s->these->velocity ? "v" : "p"};
    for (int k = 0; k < 2; k++) {
        s->key = keys[k];
        lua_getfield(L, 2, s->key);
        s->source = lua_gettop(L);
        read_field(L, s);
        lua_pop(L, 1);
    }
}

/* field `key` for all members of a part */
static void read_column(lua_State *L, const dml_part *p, const char *key) {
    dml_starting s = {.these = p, .body = read_field, .key = key, .field = is_field(L)};
    lua_getfield(L, 2, key);
    s.source = lua_gettop(L);
    const double *rows = entries_of(L, s.source, p->e->n);
    if (!rows || !copy_rows(p, key, rows)) dml_each_start(L, &s);
    lua_pop(L, 1);
}

static int is_function(lua_State *L, const char *key) {
    const int is = lua_getfield(L, 2, key) == LUA_TFUNCTION;
    lua_pop(L, 1);
    return is;
}

/* q, and v or p; functions are called member by member, and a field reads v beside its q */
void dml_read_places(lua_State *L, const dml_part *p) {
    const char *second = p->velocity ? "v" : "p";
    const int alone = p->velocity == DML_PLACES_ALONE, field = is_field(L);
    if (alone || (!field && !is_function(L, "q") && !is_function(L, second))) {
        read_column(L, p, "q");
        if (!alone) read_column(L, p, second);
        return;
    }
    dml_each_start(L, &(dml_starting){.these = p, .body = read_both, .field = field});
}

/* the trace is checked at the first member, which may be outside of the domain where others are
 * not */
static void check_trace(lua_State *L, const dml_part *p, dml_stepping *r) {
    if (p->velocity) {
        const double *q = p->e->state + (size_t)p->first * dm_state_size(r->solver->n);
        memcpy(r->x, q, 2 * r->solver->n * sizeof *q);
        r->x[2 * r->solver->n] = r->t0;
    }
    dml_checkmember(L, r->system, r->model, p->velocity ? r->x : NULL);
    if (r->wants & DM_WANT_MAP) {
        const size_t size = dm_state_size(p->e->n);
        dml_checkmap(L, r->system, r->model, p->e->state + (size_t)p->first * size, p->count, size);
    }
}

static int has(lua_State *L, const char *key) {
    const int there = lua_getfield(L, 2, key) != LUA_TNIL;
    lua_pop(L, 1);
    return there;
}

static void refuse_starts(lua_State *L) {
    luaL_error(L, "give the starts as q and v or as q and p: one of 'v' and 'p' is needed");
}

int dml_check_starts(lua_State *L, const dml_solver *solver, long members) {
    const int velocity = has(L, "v"), momentum = has(L, "p");
    if (velocity ? momentum : !momentum && solver->alone) refuse_starts(L);
    if (velocity && solver->alone)
        luaL_error(L, "a discrete Lagrangian knows no velocity: give the momentum 'p'");
    dml_check_source(L, 2, "q", members);
    if (!velocity && !momentum) return DML_PLACES_ALONE;
    dml_check_source(L, 2, velocity ? "v" : "p", members);
    return velocity;
}

/* L is linear in v: p of member i is alpha(q), so a p that is given must be it */
static void check_alpha(lua_State *L, const dml_part *these, const dml_stepping *r, long i) {
    const uint32_t n = these->e->n;
    const double *q = these->e->state + (size_t)i * dm_state_size(n), *p = q + n;
    double *alpha = r->x, *v = r->x + n, distance = 0.0, size = 0.0;
    memset(v, 0, n * sizeof *v);
    if (dm_legendre(&r->model->model, alpha, q, v, r->t0, r->work) != DM_OK) return;
    for (uint32_t k = 0; k < n; k++) {
        distance = fmax(distance, fabs(p[k] - alpha[k]));
        size = fmax(size, fabs(alpha[k]));
    }
    if (distance > 1e-9 * size)
        luaL_error(L,
                   "member %d: no start: L is linear in v, so that p must be dL/dv = alpha(q); the "
                   "given p is off by %f: leave it out",
                   (int)i + 1, distance);
}

/* q, v, t of a member in r->x: v as it was given, or that of p. 0: it has none. */
static int place_of(dml_stepping *r, const double *state, const double *v) {
    const uint32_t n = r->solver->n;
    double *x = r->x;
    dm_small_copy(x, state, n);
    x[2 * n] = r->t0;
    if (v) {
        dm_small_copy(x + n, v, n);
        return isfinite(state[n]);
    }
    memset(x + n, 0, n * sizeof *x);
    return dm_legendre_inverse(&r->model->model, x + n, x, state + n, r->t0, r->work) == DM_OK;
}

/* member i, whose q and p are known, must lie on the constraints; v: that of p, or NULL */
static void start_on_constraints(lua_State *L, const dml_part *these, dml_stepping *r, long i,
                                 const double *v) {
    const uint32_t n = these->e->n;
    double *state = these->e->state + (size_t)i * dm_state_size(n), *x = r->x;
    const char *who = lua_pushfstring(L, "member %d: ", (int)i + 1);
    if (r->solver->pair) {
        memcpy(x, state, n * sizeof *x);
        memset(x + n, 0, n * sizeof *x);
        x[2 * n] = r->t0;
        dml_check_on_constraints(L, r, who);
    } else if (place_of(r, state, v)) {
        memcpy(r->state, state, dm_state_size(n) * sizeof *state);
        dml_start_on_constraints(L, r, who, !these->velocity);
        memcpy(state, r->state, dm_state_size(n) * sizeof *state);
    }
    lua_pop(L, 1);
}

/* L is a number where member i starts with velocity v, as a run of its own asks; x: room for its
 * arguments */
static int is_inside(const dml_part *these, const dml_stepping *r, long i, const double *v,
                     double *x) {
    const dm_model *m = these->values ? &r->inputs->model : &r->model->model;
    const uint32_t n = these->e->n, many = these->values ? r->inputs->params : 0;
    const double *q = these->e->state + (size_t)i * dm_state_size(n);
    double value = 0.0;
    if (m->structure & DM_HAMILTONIAN) return 1; /* the value is one of p */
    if (!(m->has & DM_WANT_VALUE) || m->value.inputs != 2 * n + 1 + many) return 1;
    dm_small_copy(x, q, n);
    dm_small_copy(x + n, v, n);
    x[2 * n] = r->t0;
    if (many)
        memcpy(x + 2 * n + 1, these->values + (size_t)(i - these->first) * many, many * sizeof *x);
    dm_kernel_prepare(&m->value, &value);
    dm_kernel_eval(&m->value, x, &value);
    return isfinite(value);
}

/* q, p of member i from its q, v, which are left in v; marked where it is outside of the domain or
 * the transform fails */
static int find_momentum(lua_State *L, const dml_part *these, dml_stepping *r, long i, double *v,
                         double *room) {
    const uint32_t n = these->e->n;
    double *q = these->e->state + (size_t)i * dm_state_size(n), *p = q + n;
    dm_small_copy(v, p, n);
    const int inside = is_inside(these, r, i, v, room);
    dml_rethrow(L, r->model);
    if (!inside || dm_legendre(&r->model->model, p, q, v, r->t0, r->work) != DM_OK)
        p[0] = NAN;
    else if (!(r->model->model.structure & DM_QUADRATIC_IN_V)) {
        dml_check_velocity(L, r, q, v, lua_pushfstring(L, "member %d: ", (int)i + 1));
        lua_pop(L, 1);
    }
    dml_rethrow(L, r->model);
    return inside;
}

/* the momentum of member s->next, on the constraints */
static void start_member(lua_State *L, dml_starting *s) {
    const dml_part *these = s->these;
    dml_stepping *r = s->r;
    const int linear = (r->model->model.structure & DM_LINEAR_IN_V) != 0;
    if (linear && !these->velocity) check_alpha(L, these, r, s->next);
    s->inside += !these->velocity || find_momentum(L, these, r, s->next, s->v, s->room);
    if (r->model->model.constraints || r->model->placed)
        start_on_constraints(L, these, r, s->next, these->velocity ? s->v : NULL);
}

/* starts: q, and p given or by the Legendre transform */
long dml_read_starts(lua_State *L, const dml_part *these, dml_stepping *r) {
    const uint32_t n = these->e->n, many = these->values ? r->inputs->params : 0;
    const int linear = (r->model->model.structure & DM_LINEAR_IN_V) != 0;
    if (these->velocity == DML_PLACES_ALONE && !linear) refuse_starts(L);
    dml_read_places(L, these);
    if (!these->values) check_trace(L, these, r);
    dml_starting s = {.these = these, .r = r, .body = start_member};
    s.v = lua_newuserdatauv(L, (3 * n + 1 + many) * sizeof *s.v, 0);
    s.room = s.v + n;
    dml_each_start(L, &s);
    /* where none is inside that is a mistake of the whole; room has the last one */
    if (!s.inside && !these->values && !these->varied)
        dml_checkmodel(L, r->system, r->model, s.room);
    lua_pop(L, 1);
    return s.inside;
}
