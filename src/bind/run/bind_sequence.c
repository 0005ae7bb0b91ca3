/* bind_sequence.c - `dm.sequence`: a sequence known by an equation, run in C. */
#include "algebra/derive.h"
#include "bind/core/bind_failure.h"
#include "bind/trace/backend.h"
#include "bind/trace/trace.h"
#include "bind/value/array.h"
#include "run/sequence.h"

#include <string.h>

/* the functions of the options, by their place on the stack */
enum { OPTIONS = 1, ARENA, EQUATION, NEXT, START, INSIDE, SCALE, COUNT = 5 };
static const char *const keys[COUNT] = {"equation", "next", "start", "inside", "scale"};

typedef struct {
    dm_arena *arena;
    dm_compile *compile;
    dm_sequence r;
    int check; /* compare the traces with plain calls */
} maker;

static void check_status(lua_State *L, dm_status status, const char *what) {
    if (status != DM_OK) luaL_error(L, "'%s': %s", what, dm_status_text(status));
}

static dml_signature signature(const maker *k, int which, int outputs) {
    dml_signature s = {.what = keys[which], .arguments = which == 2 || which == 4 ? 1 : 2};
    s.length[0] = (int)k->r.n;
    s.length[1] = (int)k->r.m;
    s.outputs = outputs;
    return s;
}

/* trace the function of `which`; with `tangent` also its derivatives in x */
static void build(lua_State *L, maker *k, int which, int outputs, dm_kernel *out,
                  dm_kernel *tangent) {
    const dml_signature s = signature(k, which, outputs);
    dml_traced t;
    dml_trace(L, EQUATION + which, &s, k->arena, &t);
    check_status(L, k->compile(out, t.graph, t.out, t.outputs, k->arena), s.what);
    if (k->check) dml_trace_check(L, EQUATION + which, &s, out, NULL);
    if (!tangent) return;
    const uint32_t m = k->r.m;
    dm_node *nodes = dm_arena_take(k->arena, (m + (size_t)m * m) * sizeof *nodes);
    if (!nodes) luaL_error(L, "not enough memory");
    memcpy(nodes, t.out, m * sizeof *nodes);
    dm_jacobian(t.graph, t.out, m, k->r.n, m, nodes + m);
    check_status(L, dm_graph_status(t.graph), s.what);
    check_status(L, k->compile(tangent, t.graph, nodes, m + m * m, k->arena), s.what);
}

/* the functions at their places, the kernels made of them */
static void read_functions(lua_State *L, maker *k) {
    for (int i = 0; i < COUNT; i++) {
        lua_getfield(L, OPTIONS, keys[i]);
        if (lua_isnil(L, -1) && EQUATION + i >= INSIDE) continue;
        if (!lua_isfunction(L, -1))
            luaL_error(L, "field '%s' must be a function (got %s)", keys[i], luaL_typename(L, -1));
    }
    build(L, k, 0, (int)k->r.m, &k->r.equation, &k->r.tangent);
    build(L, k, 1, (int)k->r.n, &k->r.next, NULL);
    build(L, k, 2, (int)k->r.m, &k->r.start, NULL);
    if (!lua_isnil(L, INSIDE)) build(L, k, 3, 0, &k->r.inside, NULL);
    if (!lua_isnil(L, SCALE)) build(L, k, 4, (int)k->r.m, &k->r.scale, NULL);
}

static void push_report(lua_State *L, const dm_sequence_report *report, dm_status status) {
    lua_createtable(L, 0, 6);
    lua_pushstring(L, dm_status_code(status)), lua_setfield(L, -2, "code");
    lua_pushstring(L, dm_status_text(status)), lua_setfield(L, -2, "text");
    lua_pushinteger(L, report->done), lua_setfield(L, -2, "done");
    lua_pushinteger(L, report->outside), lua_setfield(L, -2, "outside");
    lua_pushinteger(L, report->newton.iterations), lua_setfield(L, -2, "iterations");
    lua_pushnumber(L, report->newton.residual), lua_setfield(L, -2, "residual");
}

/* the rows that were filled, as a matrix */
static void push_rows(lua_State *L, const double *rows, uint32_t count, uint32_t n) {
    double *to = dml_pushmatrix(L, count, n);
    memcpy(to, rows, (size_t)count * n * sizeof *to);
}

static uint32_t count_of(lua_State *L, const char *key) {
    const long n = dml_count(L, OPTIONS, key, 1, 0);
    if (n > 1000) luaL_error(L, "field '%s' must be at most 1000", key);
    return (uint32_t)n;
}

static dm_sequence_plan read_plan(lua_State *L) {
    return (dm_sequence_plan){.steps = dml_count(L, OPTIONS, "steps", 0, -1),
                              .every = dml_count(L, OPTIONS, "every", 1, 1),
                              .tolerance = 4e-15,
                              .max_iterations = 50,
                              .stop = &dml_stop};
}

static double *room(lua_State *L, size_t count) {
    return lua_newuserdatauv(L, count * sizeof(double), 0);
}

static int sequence(lua_State *L) {
    static const char *const known[] = {"equation", "next",  "start", "inside", "y", "unknowns",
                                        "steps",    "every", "check", "scale",  NULL};
    luaL_checktype(L, OPTIONS, LUA_TTABLE);
    lua_settop(L, OPTIONS);
    dml_options(L, OPTIONS, known);
    lua_getfield(L, OPTIONS, "y");
    const long n = lua_isnil(L, -1) ? 0 : dml_length(L, -1);
    if (n < 1 || n > 1000) luaL_error(L, "field 'y' must be a list of 1 to 1000 numbers");
    lua_settop(L, OPTIONS);
    maker k = {.compile = dml_findbackend(L, NULL)->compile,
               .r = {.n = (uint32_t)n, .m = count_of(L, "unknowns")}};
    const dm_sequence_plan plan = read_plan(L);
    k.check = dml_flag(L, OPTIONS, "check", 1);
    k.arena = dml_pusharena(L);
    read_functions(L, &k);
    const long most = dm_sequence_rows(&plan);
    if ((double)most * (double)n > 1e9)
        luaL_error(L, "%I rows of %d numbers are too many: raise 'every'", (LUAI_UACINT)most,
                   (int)n);
    double *rows = room(L, (size_t)most * (size_t)n);
    double *work = room(L, dm_sequence_work(&k.r));
    dml_numbers(L, OPTIONS, "y", rows, k.r.n);
    dm_sequence_report report;
    const dm_status status = dm_sequence_run(rows, &k.r, &plan, work, &report);
    push_rows(L, rows, (uint32_t)report.rows, k.r.n);
    if (status == DM_STOPPED) dml_stopped(L, "dm.sequence", report.done);
    push_report(L, &report, status);
    return 2;
}

static const dml_row functions[] =
    {{"sequence", sequence,
      "dm.sequence{equation=, next=, start=, y=, unknowns=, steps=, inside=, every=, check=} -> "
      "dm.matrix, report\n"
      "The sequence y, y', y'' ... with y' = next(y, x) where x, of `unknowns` numbers, is the "
      "root of equation(y, x) = 0 that Newton's method finds from start(y). The functions are "
      "traced once, with vectors y and x, and run in C. inside(y, x) gives numbers that must be > "
      "0 at the root. scale(y) gives the sizes of what the unknowns are added to, where x is a "
      "small difference. check = false trusts the traces without comparing them with plain calls. "
      "Rows: y at the start, every `every` steps, and at the end. report: code (\"ok\", "
      "\"no_convergence\", \"singular\", \"not_finite\"), text, done (steps), outside (which "
      "condition the root broke, from 1), iterations, residual. A step that fails ends the "
      "sequence without an error: look at report.code. Ctrl-C raises a dm.failure, whose path has "
      "the rows so far."},
     {NULL, NULL, NULL}};

const dml_class dml_class_sequence = {
    .functions = functions,
};
