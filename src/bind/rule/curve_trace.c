/* curve_trace.c - a one-step method written in Lua. It is traced with symbols for x = (q, v) and h
 * and with a field f whose i-th call answers with symbols k_i = (V_i, A_i) of its own. Where what
 * it put into that call, and gives in the end, is (q + h g v + h sum_j a_j V_j + h^2 sum_j lift_j
 * A_j, v + h sum_j push_j A_j), its coefficients say all: a Runge-Kutta method where push is a and
 * the others are zero, else one that treats q and v each in its way (Nystroem; leapfrog). Any
 * other method is kept as its graph, a recipe, and traced again for every dim Q. */
#include "bind/rule/curve_recipes.h"
#include "bind/trace/trace.h"
#include "bind/value/array.h"
#include "code/tape/tape.h"

#include <math.h>
#include <string.h>

/* x of the trace that looks for coefficients: positions and velocities of two coordinates; a call
 * of f is its point and its time */
enum { HALF = 2, SIZE = 2 * HALF, CALL = SIZE + 1, INPUTS = SIZE + 1 + DM_CURVE_STAGES * SIZE + 1 };
static const double NOISE = 1e-12; /* of what is linear to round-off */

/* ---- the call ---- */

/* upvalues of f and of f.along: what was asked so far, entry by entry; the k of all calls; t; of
 * every call twice its directions, and 1 where it says the time; entries of x */
enum { ASKED = 1, SLOPES, TIME, KINDS, ENTRIES };

/* append the entries of the vector or table at `arg` to the table at `list` */
static void append(lua_State *L, int list, int arg, long size, const char *what) {
    const long n = dml_length(L, arg);
    if (n != size || (!lua_istable(L, arg) && !dml_toarray(L, arg, 1)))
        luaL_error(L,
                   "%s must be a vector of as many entries as x, positions and velocities (got %s)",
                   what,
                   n > 1 ? lua_pushfstring(L, "%d for %d", (int)n, (int)size)
                         : luaL_typename(L, arg));
    for (uint32_t i = 0; i < (uint32_t)size; i++) {
        const dml_scalar x = dml_entry(L, arg, i);
        dml_pushscalar(L, &x);
        lua_rawseti(L, list, (lua_Integer)lua_rawlen(L, list) + 1);
    }
}

/* the vector of a direction { u, rate } at `arg` and its rate are pushed; 0: it is a plain u */
static int push_parts(lua_State *L, int arg) {
    if (!lua_istable(L, arg) || lua_rawlen(L, arg) != 2) return 0;
    lua_geti(L, arg, 2);
    lua_geti(L, arg, 1);
    if (lua_istable(L, -1) || dml_toarray(L, lua_gettop(L), 1)) return 1;
    lua_pop(L, 2);
    return 0;
}

/* append a direction: u, along which the time goes on at this rate, or { u, rate } */
static void append_direction(lua_State *L, int list, int arg, long size, int rate) {
    const int top = lua_gettop(L), parts = push_parts(L, arg);
    if (parts && !rate)
        luaL_error(L, "a direction { u, rate } needs a time: f:along(x, t, { u, rate })");
    if (!parts) lua_pushinteger(L, rate);
    append(L, list, parts ? top + 2 : arg, size, "a direction of f:along");
    lua_pushvalue(L, top + 1);
    lua_rawseti(L, list, (lua_Integer)lua_rawlen(L, list) + 1);
    lua_settop(L, top);
}

/* A call at the point at `point`, at the time at `time` (nil: that of the step), along `count`
 * directions from `first` on; pushes its answer. */
static int note_call(lua_State *L, int point, int time, int first, int count) {
    const int kinds = lua_upvalueindex(KINDS), slopes = lua_upvalueindex(SLOPES);
    const long size = (long)lua_tointeger(L, lua_upvalueindex(ENTRIES));
    const uint32_t call = (uint32_t)lua_rawlen(L, kinds);
    if (call == DM_CURVE_STAGES)
        luaL_error(L, "the method calls f more than %d times a step", DM_CURVE_STAGES);
    lua_pushvalue(L, lua_upvalueindex(ASKED));
    const int list = lua_gettop(L), timed = !lua_isnil(L, time);
    append(L, list, point, size, "the argument of f");
    lua_pushvalue(L, timed ? time : lua_upvalueindex(TIME));
    lua_rawseti(L, list, (lua_Integer)lua_rawlen(L, list) + 1);
    for (int i = 0; i < count; i++) append_direction(L, list, first + i, size, timed);
    lua_pushinteger(L, 2 * count + timed);
    lua_rawseti(L, kinds, (lua_Integer)call + 1);
    dml_scalar *k = lua_newuserdatauv(L, (size_t)size * sizeof *k, 0);
    for (uint32_t i = 0; i < (uint32_t)size; i++)
        k[i] = dml_entry(L, slopes, call * (uint32_t)size + i);
    dml_pushscalars(L, k, (uint32_t)size);
    return 1;
}

/* f(x) or f(x, t) */
static int field(lua_State *L) {
    lua_settop(L, 3);
    return note_call(L, 2, 3, 0, 0);
}

/* f:along(x, u, ...): the derivative of f at x along u, the second one along two directions, ...;
 * f:along(x, t, u, ...) at that time */
static int field_along(lua_State *L) {
    const int timed = lua_gettop(L) > 2 && !lua_istable(L, 3) && !dml_toarray(L, 3, 1);
    const int first = 3 + timed, count = lua_gettop(L) - first + 1;
    if (timed && count < 1)
        luaL_error(L, "a direction of f:along must be a vector: f:along(x, u) or, with the time, "
                      "f:along(x, t, u)");
    if (count < 1) luaL_error(L, "f:along takes a point and a direction, f:along(x, u)");
    if (count > DM_RECIPE_DIRECTIONS)
        luaL_error(L, "f:along takes at most %d directions", DM_RECIPE_DIRECTIONS);
    lua_pushnil(L);
    return note_call(L, 2, timed ? 3 : first + count, first, count);
}

/* push f for (asked, k, t, kinds, size) at 5, 3, 4, 6, 7 */
static void push_field(lua_State *L) {
    static const int upvalues[] = {5, 3, 4, 6, 7};
    lua_createtable(L, 0, 1);
    for (int i = 0; i < 5; i++) lua_pushvalue(L, upvalues[i]);
    lua_pushcclosure(L, field_along, 5);
    lua_setfield(L, -2, "along");
    lua_createtable(L, 0, 1);
    for (int i = 0; i < 5; i++) lua_pushvalue(L, upvalues[i]);
    lua_pushcclosure(L, field, 5);
    lua_setfield(L, -2, "__call");
    lua_setmetatable(L, -2);
}

/* (x, h, k, t) -> all that was asked, then the end; upvalues: the method, and the kinds of calls,
 * which begin anew */
static int call_method(lua_State *L) {
    lua_settop(L, 4);
    lua_newtable(L);
    lua_pushvalue(L, lua_upvalueindex(2));
    for (lua_Integer i = (lua_Integer)lua_rawlen(L, 6); i > 0; i--) {
        lua_pushnil(L);
        lua_rawseti(L, 6, i);
    }
    lua_pushinteger(L, dml_length(L, 1));
    lua_pushvalue(L, lua_upvalueindex(1));
    lua_pushvalue(L, 1);
    push_field(L);
    lua_pushvalue(L, 2);
    lua_pushvalue(L, 4);
    dml_callone(L, 4, "the method");
    append(L, 5, 8, dml_length(L, 1), "what the method returns");
    lua_settop(L, 5);
    return 1;
}

/* ---- its coefficients ---- */

/* of one call, or of the end */
typedef struct {
    double g, a[DM_CURVE_STAGES], push[DM_CURVE_STAGES], lift[DM_CURVE_STAGES];
} sums;

typedef struct {
    dm_kernel kernel;
    int s;
    double *in, *out; /* [INPUTS], [s * CALL + SIZE] */
    sums *rows;       /* [s + 1], the last one the end */
} probe;

static double *slope_of(probe *p, int i) {
    return p->in + SIZE + 1 + i * SIZE;
}

/* point i, or the end for i = s */
static const double *point(const probe *p, int i) {
    return p->out + i * CALL;
}

/* h = 1, all else 0 but the pair of inputs at `one`, which are 1 */
static void ask(probe *p, double *one) {
    memset(p->in, 0, INPUTS * sizeof *p->in);
    p->in[SIZE] = one[0] = one[1] = 1.0;
    dm_kernel_eval(&p->kernel, p->in, p->out);
}

/* What is added to x: coefficients of h k_i in positions and in velocities. */
static void read_sums(probe *p) {
    memset(p->rows, 0, (size_t)(p->s + 1) * sizeof *p->rows);
    ask(p, p->in + HALF);
    for (int i = 0; i <= p->s; i++) p->rows[i].g = point(p, i)[0];
    for (int j = 0; j < p->s; j++) {
        ask(p, slope_of(p, j));
        for (int i = j + 1; i <= p->s; i++) p->rows[i].a[j] = point(p, i)[0];
        ask(p, slope_of(p, j) + HALF);
        for (int i = j + 1; i <= p->s; i++) {
            p->rows[i].lift[j] = point(p, i)[0];
            p->rows[i].push[j] = point(p, i)[HALF];
        }
    }
}

/* a number in [-1, 1] that has nothing to do with the method */
static double scattered(int i) {
    const double x = 0.7548776662466927 * (i + 1) + 0.3;
    return 2.0 * (x - floor(x)) - 1.0;
}

static void add_term(double *sum, double *size, double term) {
    *sum += term;
    *size += fabs(term);
}

/* is point i what its sums say? */
static int is_sum(probe *p, int i) {
    const double h = p->in[SIZE], *got = point(p, i);
    const sums *row = p->rows + i;
    for (int k = 0; k < HALF; k++) {
        double q = p->in[k], v = p->in[HALF + k], q_size = fabs(q), v_size = fabs(v);
        add_term(&q, &q_size, h * row->g * v);
        for (int j = 0; j < i; j++) {
            const double *slope = slope_of(p, j) + k;
            add_term(&q, &q_size, h * row->a[j] * slope[0]);
            add_term(&q, &q_size, h * h * row->lift[j] * slope[HALF]);
            add_term(&v, &v_size, h * row->push[j] * slope[HALF]);
        }
        if (!(fabs(q - got[k]) <= NOISE * q_size)) return 0;
        if (!(fabs(v - got[HALF + k]) <= NOISE * v_size)) return 0;
    }
    return 1;
}

/* with these sums at scattered x, h, k? */
static int is_linear(probe *p) {
    for (int round = 0; round < 3; round++) {
        for (int i = 0; i < INPUTS; i++) p->in[i] = scattered(i + round * INPUTS);
        p->in[SIZE] = 0.3 + 0.4 * round;
        dm_kernel_eval(&p->kernel, p->in, p->out);
        for (int i = 0; i <= p->s; i++)
            if (!is_sum(p, i)) return 0;
    }
    return 1;
}

static double sum_of(const double *x, int n) {
    double sum = 0.0;
    for (int i = 0; i < n; i++) sum += x[i];
    return sum;
}

/* times that are given must be t + c h, where q is moved by c h v in all */
static int has_right_times(const probe *p) {
    const double h = p->in[SIZE], t = p->in[INPUTS - 1];
    for (int i = 0; i < p->s; i++) {
        const double c = p->rows[i].g + sum_of(p->rows[i].a, i);
        const double given = point(p, i)[SIZE];
        if (given != t && fabs(given - t - c * h) > NOISE * (fabs(t) + fabs(h))) return 0;
    }
    return 1;
}

/* The rows of the tableau are known. */
static void check_times(lua_State *L, const probe *p) {
    if (!has_right_times(p))
        luaL_error(L, "the method gives f a time that is not t + c h, where c is the sum of the "
                      "coefficients of that call");
}

/* Positions and velocities are treated alike: then Ld has a sum of its own, and its order. */
static int is_runge_kutta(const probe *p) {
    for (int i = 0; i <= p->s; i++) {
        const sums *row = p->rows + i;
        if (row->g != 0.0) return 0;
        for (int j = 0; j < i; j++)
            if (row->lift[j] != 0.0 || row->push[j] != row->a[j]) return 0;
    }
    return 1;
}

/* point 0 is x itself: the first call, or a point more before it */
static void fill_runge_kutta(dm_curve *out, const probe *p) {
    double a[DM_CURVE_STAGES * DM_CURVE_STAGES] = {0};
    for (int i = 0; i < p->s; i++) memcpy(a + i * p->s, p->rows[i].a, (size_t)p->s * sizeof *a);
    dm_curve_fill(out, p->s, a, p->rows[p->s].a);
}

static int is_at_start(const sums *row) {
    return row->g == 0.0;
}

/* A method that treats them differently: accelerations enter positions by h^2, and the
 * quadrature runs along nodes. */
static void fill_lifted(lua_State *L, dm_curve *out, const probe *p) {
    const int before = !is_at_start(p->rows), s = p->s + before;
    if (s > DM_CURVE_STAGES)
        luaL_error(L, "the method calls f more than %d times a step", DM_CURVE_STAGES - 1);
    memset(out, 0, sizeof *out);
    out->s = s;
    out->bias = 1.0;
    out->lifted = 1;
    for (int i = 0; i <= p->s; i++) {
        const sums *row = p->rows + i;
        const int k = i + before, end = i == p->s;
        double *a = end ? out->plus : out->a[k];
        double *push = end ? out->arrival : out->push[k];
        double *lift = end ? out->plus_lift : out->lift[k];
        memcpy(a + before, row->a, (size_t)i * sizeof *a);
        memcpy(push + before, row->push, (size_t)i * sizeof *a);
        memcpy(lift + before, row->lift, (size_t)i * sizeof *a);
        a[0] += row->g;
        if (!end) out->c[k] = sum_of(a, k);
    }
}

/* A method must move by h f for constant f, or it is none. */
static void check_consistent(lua_State *L, const dm_curve *c) {
    const double moved = sum_of(c->plus, c->s), pushed = sum_of(c->arrival, c->s);
    if (!(fabs(moved - 1.0) <= 1e-10 && fabs(pushed - 1.0) <= 1e-10))
        luaL_error(L,
                   "the method is not consistent: for small h it must give x + h f(x), this one "
                   "gives q + %f h v and v + %f h a",
                   moved, pushed);
}

/* ---- the trace ---- */

void dml_curve_ask(lua_State *L, int fn, uint32_t n, dml_curve_asked *out) {
    const int size = 2 * (int)n;
    *out =
        (dml_curve_asked){.signature = {.what = "the method",
                                        .arguments = 4,
                                        .length = {size, DML_SCALAR_ARGUMENT,
                                                   DM_CURVE_STAGES * size, DML_SCALAR_ARGUMENT}}};
    lua_newtable(L);
    out->kinds = lua_gettop(L);
    lua_pushvalue(L, fn);
    lua_pushvalue(L, out->kinds);
    lua_pushcclosure(L, call_method, 2);
    const int call = lua_gettop(L);
    out->arena = dml_pusharena(L);
    out->arena_at = lua_gettop(L);
    dml_trace(L, call, &out->signature, out->arena, &out->traced);
    out->calls = (int)lua_rawlen(L, out->kinds);
    dm_kernel *k = &out->kernel;
    const dml_traced *t = &out->traced;
    const dm_status status = dm_tape_build(k, t->graph, t->out, t->outputs, out->arena);
    if (status != DM_OK) luaL_error(L, "the method: %s", dm_status_text(status));
    dml_trace_check(L, call, &out->signature, k, NULL);
}

/* how many directions a call has, of the table of kinds */
static int asks_derivatives(lua_State *L, const dml_curve_asked *a) {
    int any = 0;
    for (int i = 1; i <= a->calls; i++) {
        lua_rawgeti(L, a->kinds, i);
        any |= lua_tointeger(L, -1) > 1;
        lua_pop(L, 1);
    }
    return any;
}

/* Coefficients where numbers say all; 0: they do not. */
int dml_curve_tableau(lua_State *L, int fn, dm_curve *out) {
    double in[INPUTS], values[DM_CURVE_STAGES * CALL + SIZE];
    const int top = lua_gettop(L);
    dml_curve_asked asked;
    dml_curve_ask(L, fn, HALF, &asked);
    probe p = {.in = in, .out = values, .s = asked.calls, .kernel = asked.kernel};
    p.rows = lua_newuserdatauv(L, (size_t)(p.s + 1) * sizeof *p.rows, 0);
    int linear = !asks_derivatives(L, &asked);
    if (linear) {
        dm_kernel_prepare(&p.kernel, p.out);
        read_sums(&p);
        linear = is_linear(&p);
    }
    if (linear) {
        check_times(L, &p);
        if (is_runge_kutta(&p))
            fill_runge_kutta(out, &p);
        else
            fill_lifted(L, out, &p);
        check_consistent(L, out);
    }
    lua_settop(L, top);
    return linear;
}
