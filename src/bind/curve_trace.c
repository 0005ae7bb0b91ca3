/*
** curve_trace.c - the coefficients of a one-step method written in Lua. It is traced with symbols for x and h and with a
** field f whose i-th call answers with symbols k_i of its own. Where it put x + h sum_j a_ij k_j into that call and gives
** x + h sum_i b_i k_i, it is a Runge-Kutta method, whatever f is.
*/
#include "bind/array.h"
#include "bind/curve.h"
#include "bind/trace.h"
#include "expr/tape.h"

#include <math.h>
#include <string.h>

/* x of the trace: positions and velocities of two coordinates; a call of f is its point and its time */
enum { SIZE = 4, CALL = SIZE + 1, INPUTS = SIZE + 1 + DM_CURVE_STAGES * SIZE + 1 };
static const double NOISE = 1e-12; /* of what is linear to round-off */

/* ---- the call ---- */

/* append the `count` entries of the vector or table at `arg` to the table at `list` */
static void append(lua_State *L, int list, int arg, const char *what) {
    const long n = dml_length(L, arg);
    if (n != SIZE || (!lua_istable(L, arg) && !dml_toarray(L, arg, 1)))
        luaL_error(
            L,
            "%s must be a vector of as many entries as x, positions and velocities "
            "(got %s of %d for %d)",
            what, luaL_typename(L, arg), n < 0 ? 0 : (int)n, SIZE);
    for (uint32_t i = 0; i < SIZE; i++) {
        const dml_scalar x = dml_entry(L, arg, i);
        dml_pushscalar(L, &x);
        lua_rawseti(L, list, (lua_Integer)lua_rawlen(L, list) + 1);
    }
}

/* f(x) or f(x, t); upvalues: the list of calls, the k of all calls, t */
static int field(lua_State *L) {
    dml_scalar k[SIZE];
    const int list = lua_upvalueindex(1), slopes = lua_upvalueindex(2);
    const uint32_t call = (uint32_t)(lua_rawlen(L, list) / CALL);
    if (call == DM_CURVE_STAGES)
        luaL_error(L, "the method calls f more than %d times a step", DM_CURVE_STAGES);
    lua_settop(L, 2);
    lua_pushvalue(L, list);
    append(L, 3, 1, "the argument of f");
    if (lua_isnil(L, 2))
        lua_pushboolean(L, 0);
    else
        lua_pushvalue(L, 2);
    lua_rawseti(L, list, (lua_Integer)lua_rawlen(L, list) + 1);
    for (uint32_t i = 0; i < SIZE; i++) k[i] = dml_entry(L, slopes, call * SIZE + i);
    dml_pushscalars(L, k, SIZE);
    return 1;
}

/* times that were not given are those of the coefficients: marked by t itself, told apart by `timed` */
static void settle_times(lua_State *L, int list, int t) {
    const lua_Integer length = (lua_Integer)lua_rawlen(L, list);
    for (lua_Integer i = CALL; i <= length; i += CALL) {
        if (lua_rawgeti(L, list, i) == LUA_TBOOLEAN) {
            lua_pushvalue(L, t);
            lua_rawseti(L, list, i);
        }
        lua_pop(L, 1);
    }
}

/* (x, h, k, t) -> all points with their times, then the end; upvalue 1: the method */
static int call_method(lua_State *L) {
    lua_settop(L, 4);
    lua_newtable(L);
    lua_pushvalue(L, lua_upvalueindex(1));
    lua_pushvalue(L, 1);
    lua_pushvalue(L, 5);
    lua_pushvalue(L, 3);
    lua_pushvalue(L, 4);
    lua_pushcclosure(L, field, 3);
    lua_pushvalue(L, 2);
    lua_pushvalue(L, 4);
    lua_call(L, 4, 1);
    append(L, 5, 6, "what the method returns");
    lua_settop(L, 5);
    const lua_Integer length = (lua_Integer)lua_rawlen(L, 5);
    for (lua_Integer i = length; i > length - SIZE; i--) lua_rawgeti(L, 5, i);
    lua_settop(L, 5);
    settle_times(L, 5, 4);
    return 1;
}

/* ---- its coefficients ---- */

typedef struct {
    dm_kernel kernel;
    int s;
    double *in, *out; /* [INPUTS], [s * CALL + SIZE] */
    dm_curve *c;
    int timed[DM_CURVE_STAGES];
} probe;

static double *slope_of(probe *p, int i) {
    return p->in + SIZE + 1 + i * SIZE;
}

/* point i, or the end for i = s */
static const double *point(const probe *p, int i) {
    return p->out + i * CALL;
}

/* h = 1, x = 0, k_j = 1: column j of the coefficients */
static void read_column(probe *p, int j) {
    memset(p->in, 0, INPUTS * sizeof *p->in);
    p->in[SIZE] = 1.0;
    for (int k = 0; k < SIZE; k++) slope_of(p, j)[k] = 1.0;
    dm_kernel_eval(&p->kernel, p->in, p->out);
    for (int i = j + 1; i < p->s; i++) p->c->a[i][j] = point(p, i)[0];
    p->c->plus[j] = point(p, p->s)[0];
}

/* a number in [-1, 1] that has nothing to do with the method */
static double scattered(int i) {
    const double x = 0.7548776662466927 * (i + 1) + 0.3;
    return 2.0 * (x - floor(x)) - 1.0;
}

/* |x + h sum_j a_j k_j - got| and the size of the terms */
static int is_sum(probe *p, const double *a, int count, const double *got) {
    for (int k = 0; k < SIZE; k++) {
        double sum = p->in[k], size = fabs(sum);
        for (int j = 0; j < count; j++) {
            const double term = p->in[SIZE] * a[j] * slope_of(p, j)[k];
            sum += term;
            size += fabs(term);
        }
        if (!(fabs(sum - got[k]) <= NOISE * size)) return 0;
    }
    return 1;
}

/* is it linear with these coefficients at scattered x, h, k? */
static int is_linear(probe *p) {
    for (int round = 0; round < 3; round++) {
        for (int i = 0; i < INPUTS; i++) p->in[i] = scattered(i + round * INPUTS);
        p->in[SIZE] = 0.3 + 0.4 * round;
        dm_kernel_eval(&p->kernel, p->in, p->out);
        for (int i = 0; i < p->s; i++)
            if (!is_sum(p, p->c->a[i], i, point(p, i))) return 0;
        if (!is_sum(p, p->c->plus, p->s, point(p, p->s))) return 0;
    }
    return 1;
}

/* times that are given must be t + c_i h with the sum c_i of row i */
static int has_right_times(probe *p) {
    const double h = p->in[SIZE], t = p->in[INPUTS - 1];
    for (int i = 0; i < p->s; i++) {
        double c = 0.0;
        for (int j = 0; j < i; j++) c += p->c->a[i][j];
        const double given = point(p, i)[SIZE];
        if (given != t && fabs(given - t - c * h) > NOISE * (fabs(t) + fabs(h))) return 0;
    }
    return 1;
}

static void read_coefficients(lua_State *L, probe *p) {
    for (int j = 0; j < p->s; j++) read_column(p, j);
    if (!is_linear(p))
        luaL_error(
            L,
            "the method is no Runge-Kutta method: every argument of f, and the result, "
            "must be x + h times a sum of numbers times earlier values of f");
    if (!has_right_times(p))
        luaL_error(L,
                   "the method gives f a time that is not t + c h with the sum c of the "
                   "coefficients of that call");
}

static void build(lua_State *L, dm_kernel *out, const dml_traced *traced,
                  dm_arena *arena) {
    const dm_status status =
        dm_tape_build(out, traced->graph, traced->out, traced->outputs, arena);
    if (status != DM_OK) luaL_error(L, "the method: %s", dm_status_text(status));
}

static void check_consistent(lua_State *L, const dm_curve *c, int s) {
    double sum = 0.0;
    for (int i = 0; i < s; i++) sum += c->plus[i];
    if (s == 0 || !(fabs(sum - 1.0) <= 1e-10))
        luaL_error(
            L,
            "the method is not consistent: for small h it must give x + h f(x), this one "
            "gives x + %f h f(x)",
            sum);
}

void dml_curve_trace(lua_State *L, int fn, dm_curve *out) {
    static const dml_signature signature = {.what = "the method",
                                            .arguments = 4,
                                            .length = {SIZE, DML_SCALAR_ARGUMENT,
                                                       DM_CURVE_STAGES * SIZE,
                                                       DML_SCALAR_ARGUMENT}};
    double in[INPUTS], values[DM_CURVE_STAGES * CALL + SIZE];
    dml_traced traced;
    probe p = {.in = in, .out = values, .c = out};
    lua_pushvalue(L, fn);
    lua_pushcclosure(L, call_method, 1);
    const int call = lua_gettop(L);
    dm_arena *arena = dml_pusharena(L);
    dml_trace(L, call, &signature, arena, &traced);
    build(L, &p.kernel, &traced, arena);
    dml_trace_check(L, call, &signature, &p.kernel, NULL);
    dm_kernel_prepare(&p.kernel, p.out);
    p.s = ((int)traced.outputs - SIZE) / CALL;
    memset(out, 0, sizeof *out);
    read_coefficients(L, &p);
    check_consistent(L, out, p.s);
    lua_settop(L, call - 1);
    double a[DM_CURVE_STAGES * DM_CURVE_STAGES], b[DM_CURVE_STAGES];
    for (int i = 0; i < p.s; i++) {
        b[i] = out->plus[i];
        for (int j = 0; j < p.s; j++) a[i * p.s + j] = out->a[i][j];
    }
    dm_curve_fill(out, p.s, a, b);
}
