/* curve_trace.c - the coefficients of a one-step method written in Lua. It is traced with
 * symbols for x = (q, v) and h and with a field f whose i-th call answers with symbols k_i =
 * (V_i, A_i) of its own. What it put into that call, and gives in the end, must be (q + h g v +
 * h sum_j a_j V_j + h^2 sum_j lift_j A_j, v + h sum_j push_j A_j): a Runge-Kutta method where
 * push is a and the others are zero, else one that treats q and v each in its way (Nystroem;
 * leapfrog). */
#include "bind/rule/bind_curve.h"
#include "bind/trace/trace.h"
#include "bind/value/array.h"
#include "code/tape/tape.h"

#include <math.h>
#include <string.h>

/* x of the trace: positions and velocities of two coordinates; a call of f is its point and its
 * time */
enum { HALF = 2, SIZE = 2 * HALF, CALL = SIZE + 1, INPUTS = SIZE + 1 + DM_CURVE_STAGES * SIZE + 1 };
static const double NOISE = 1e-12; /* of what is linear to round-off */

/* ---- the call ---- */

/* append the `count` entries of the vector or table at `arg` to the table at `list` */
static void append(lua_State *L, int list, int arg, const char *what) {
    const long n = dml_length(L, arg);
    if (n != SIZE || (!lua_istable(L, arg) && !dml_toarray(L, arg, 1)))
        luaL_error(L,
                   "%s must be a vector of as many entries as x, positions and velocities (got %s)",
                   what,
                   n > 1 ? lua_pushfstring(L, "%d for %d", (int)n, SIZE) : luaL_typename(L, arg));
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

/* times that were not given are those of the coefficients: marked by t itself, told apart by
 * `timed` */
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
    dml_callone(L, 4, "the method");
    append(L, 5, 6, "what the method returns");
    lua_settop(L, 5);
    const lua_Integer length = (lua_Integer)lua_rawlen(L, 5);
    for (lua_Integer i = length; i > length - SIZE; i--) lua_rawgeti(L, 5, i);
    lua_settop(L, 5);
    settle_times(L, 5, 4);
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
static int has_right_times(probe *p) {
    const double h = p->in[SIZE], t = p->in[INPUTS - 1];
    for (int i = 0; i < p->s; i++) {
        const double c = p->rows[i].g + sum_of(p->rows[i].a, i);
        const double given = point(p, i)[SIZE];
        if (given != t && fabs(given - t - c * h) > NOISE * (fabs(t) + fabs(h))) return 0;
    }
    return 1;
}

/* From the traced sums to the rows of the tableau; anything but numbers there is no linear
 * method. */
static void read_coefficients(lua_State *L, probe *p) {
    read_sums(p);
    if (!is_linear(p))
        luaL_error(L, "the method is not linear in the values of f: every argument of f, and the "
                      "result, must be x + h times a sum of numbers times values of f (positions "
                      "may also take h v, and h^2 times accelerations)");
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

static void build(lua_State *L, dm_kernel *out, const dml_traced *traced, dm_arena *arena) {
    const dm_status status = dm_tape_build(out, traced->graph, traced->out, traced->outputs, arena);
    if (status != DM_OK) luaL_error(L, "the method: %s", dm_status_text(status));
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

/* The function at `fn` is called with symbols; what it did with the answers of f is read off the
 * graph. */
void dml_curve_trace(lua_State *L, int fn, dm_curve *out) {
    static const dml_signature signature = {.what = "the method",
                                            .arguments = 4,
                                            .length = {SIZE, DML_SCALAR_ARGUMENT,
                                                       DM_CURVE_STAGES * SIZE,
                                                       DML_SCALAR_ARGUMENT}};
    double in[INPUTS], values[DM_CURVE_STAGES * CALL + SIZE];
    dml_traced traced;
    lua_pushvalue(L, fn);
    lua_pushcclosure(L, call_method, 1);
    const int call = lua_gettop(L);
    dm_arena *arena = dml_pusharena(L);
    dml_trace(L, call, &signature, arena, &traced);
    probe p = {.in = in, .out = values, .s = ((int)traced.outputs - SIZE) / CALL};
    p.rows = lua_newuserdatauv(L, (size_t)(p.s + 1) * sizeof *p.rows, 0);
    build(L, &p.kernel, &traced, arena);
    dml_trace_check(L, call, &signature, &p.kernel, NULL);
    dm_kernel_prepare(&p.kernel, p.out);
    read_coefficients(L, &p);
    if (is_runge_kutta(&p))
        fill_runge_kutta(out, &p);
    else
        fill_lifted(L, out, &p);
    check_consistent(L, out);
    lua_settop(L, call - 1);
}
