/* trace_hyperdual.c - callback kernels: a Lua function called with hyper-dual numbers.
 * One call gives the derivatives along two directions, so a gradient takes n / 2 calls
 * and a Hessian n (n + 1) / 2. The calls run in a thread of their own, so that a kernel
 * needs no lua_State of its caller. */
#include "bind/core/state.h"
#include "bind/trace/apart.h"
#include "bind/trace/traced_call.h"

#include <math.h>

enum {
    ORDERS = 3,
    DEEPEST = 8 /* callbacks inside callbacks: each starts a new count of C calls */
};

typedef struct {
    dml_callback *callback;
    int order;
} context;

struct dml_callback {
    lua_State *thread; /* kept by user value 1; holds the function, then an error */
    dml_state *state;
    dml_signature s;
    uint32_t inputs;
    int busy, failed, recursed;
    context orders[ORDERS];
    dml_scalar x[]; /* inputs */
};

/* one evaluation, as the protected call sees it */
typedef struct {
    dml_callback *callback;
    int order;
    const double *in;
    double *out;
} job;

/* f with direction a along input i and direction b along input j (or none where out of
 * range) */
static dml_hyperdual call(lua_State *L, const job *j, uint32_t a, uint32_t b) {
    dml_callback *c = j->callback;
    const dml_signature *s = &c->s;
    dml_scalar *x = c->x;
    for (uint32_t i = 0; i < c->inputs; i++)
        x[i] = (dml_scalar){.kind = DML_HYPERDUAL,
                            .as.hyper = {.f = j->in[i], .a = i == a, .b = i == b}};
    lua_pushvalue(L, 2);
    for (int k = 0; k < s->arguments; k++) {
        dml_pushargument(L, s, k, x);
        x += s->length[k] == DML_SCALAR_ARGUMENT ? 1 : s->length[k];
    }
    dml_callone(L, s->arguments, s->what);
    const int result = lua_gettop(L);
    dml_result_length(L, s, result);
    dml_scalar y = dml_result_entry(L, s, result, 0);
    if (y.kind == DML_SYMBOL)
        luaL_error(L, "%s returned a symbol: it was kept in a global or an upvalue", s->what);
    lua_settop(L, result - 1);
    return y.kind == DML_HYPERDUAL ? y.as.hyper : (dml_hyperdual){.f = y.as.number};
}

/* Two inputs with each call, one along either direction. */
static void gradient(lua_State *L, const job *j) {
    const uint32_t n = j->callback->inputs;
    for (uint32_t i = 0; i < n; i += 2) {
        const dml_hyperdual y = call(L, j, i, i + 1);
        j->out[i] = y.a;
        if (i + 1 < n) j->out[i + 1] = y.b;
    }
}

/* The lower triangle by calls, the upper one by symmetry; the gradient comes with the diagonal. */
static void hessian(lua_State *L, const job *j) {
    const uint32_t n = j->callback->inputs;
    double *slope = j->out, *curve = j->out + n;
    for (uint32_t a = 0; a < n; a++)
        for (uint32_t b = 0; b <= a; b++) {
            const dml_hyperdual y = call(L, j, a, b);
            if (a == b) slope[a] = y.a;
            curve[a * n + b] = curve[b * n + a] = y.ab;
        }
}

/* protected: 1 the job, 2 the function */
static int work(lua_State *L) {
    const job *j = lua_touserdata(L, 1);
    luaL_checkstack(L, DML_MAX_ARGUMENTS + 10, NULL);
    if (j->callback->state->depth > DEEPEST)
        return luaL_error(L, "%s calls itself through too many solvers", j->callback->s.what);
    if (j->order == 0)
        dml_call_numbers(L, 2, &j->callback->s, j->in, j->out, 1);
    else if (j->order == 1)
        gradient(L, j);
    else
        hessian(L, j);
    return 0;
}

/* What a kernel gives whose function failed; the error itself waits in the thread. */
static void fill_nan(double *out, uint32_t n) {
    for (uint32_t i = 0; i < n; i++) out[i] = NAN;
}

/* By the order of the kernel: see trace.h. */
static uint32_t outputs(const dml_callback *c, int order) {
    return order == 0 ? 1 : order == 1 ? c->inputs : c->inputs + c->inputs * c->inputs;
}

/* Called from inside of loops in C: no error of Lua may pass through these. */
static void eval(const void *pool, const double *in, double *out) {
    const context *at = pool;
    dml_callback *c = at->callback;
    job j = {c, at->order, in, out};
    if (c->busy) c->recursed = 1;
    if (c->busy || c->failed) {
        fill_nan(out, outputs(c, at->order));
        return;
    }
    dml_apart apart;
    dml_setapart(c->state, &apart);
    c->busy = 1;
    c->state->depth++;
    lua_pushcfunction(c->thread, work);
    lua_pushlightuserdata(c->thread, &j);
    lua_pushvalue(c->thread, 1);
    c->failed = lua_pcall(c->thread, 2, 0, 0) != LUA_OK;
    c->state->depth--;
    c->busy = 0;
    dml_endapart(c->state, &apart);
    if (c->failed) fill_nan(out, outputs(c, at->order));
}

/* Leaves the callback on the stack, which keeps the thread and so the function. */
dml_callback *dml_hyperdual_new(lua_State *L, int fn, const dml_signature *s) {
    const uint32_t inputs = dml_signature_inputs(s);
    fn = lua_absindex(L, fn);
    luaL_checkstack(L, 6, NULL);
    dml_callback *c = lua_newuserdatauv(L, sizeof *c + inputs * sizeof *c->x, 1);
    *c = (dml_callback){.state = dml_getstate(L), .s = *s, .inputs = inputs};
    for (int order = 0; order < ORDERS; order++) c->orders[order] = (context){c, order};
    c->thread = lua_newthread(L);
    lua_pushvalue(L, fn);
    lua_xmove(L, c->thread, 1);
    lua_setiuservalue(L, -2, 1);
    return c;
}

/* The kernel is only as good as the callback lives. */
void dml_hyperdual_kernel(dml_callback *c, int order, dm_kernel *out) {
    *out = (dm_kernel){.eval = eval,
                       .pool = c->orders + order,
                       .inputs = c->inputs,
                       .outputs = outputs(c, order),
                       .backend = "hyperdual"};
}

/* After every loop that may have called the kernel. */
void dml_hyperdual_rethrow(lua_State *L, dml_callback *c) {
    const int recursed = c->recursed;
    c->recursed = 0;
    if (c->failed) {
        c->failed = 0;
        luaL_checkstack(L, 2, NULL);
        lua_xmove(c->thread, L, 1);
        lua_error(L);
    }
    if (recursed) luaL_error(L, "%s calls itself through its own solver", c->s.what);
}
