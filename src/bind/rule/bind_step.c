/* bind_step.c - `dm.step`: the functions of a step, traced for the system that it steps. */
#include "bind/rule/bind_step.h"

#include "algebra/derive.h"
#include "base/random.h"
#include "bind/core/state.h"
#include "bind/rule/bind_rule.h"
#include "bind/trace/backend.h"

#include <math.h>
#include <string.h>

enum { MOST = 1000, CONDITIONS = 64 };

/* what is made for one system */
typedef struct {
    dm_step_kernels k;
    dm_arena *arena;
    dm_compile *compile;
} maker;

/* With the name of the function. */
static void check_status(lua_State *L, dm_status status, const char *what) {
    if (status != DM_OK) luaL_error(L, "dm.step, '%s': %s", what, dm_status_text(status));
}

/* What functions get: (q, p, t, parts, x, h), without x, or (q, p, h) alone. */
typedef enum { OF_ROOT, OF_STATE, OF_START } arguments_of;

/* parts are left out where there are none, since no argument is empty */
static dml_signature signature(const maker *made, const char *name, arguments_of of,
                               uint32_t outputs) {
    dml_signature s = {.what = name, .length = {(int)made->k.n, (int)made->k.d}, .arguments = 2};
    if (of != OF_START) s.length[s.arguments++] = DML_SCALAR_ARGUMENT;
    if (of != OF_START && made->k.w) s.length[s.arguments++] = (int)made->k.w;
    if (of == OF_ROOT) s.length[s.arguments++] = (int)made->k.m;
    s.length[s.arguments++] = DML_SCALAR_ARGUMENT;
    s.outputs = (int)outputs;
    return s;
}

/* function `name` of the table on top, traced with the inputs of step_method.h; 0: there is none */
static int trace(lua_State *L, const maker *made, const char *name, arguments_of of,
                 uint32_t outputs, dml_traced *out) {
    const dml_signature s = signature(made, name, of, outputs);
    const int there = lua_getfield(L, -1, name) != LUA_TNIL;
    if (there) dml_trace(L, lua_gettop(L), &s, made->arena, out);
    lua_pop(L, 1);
    return there;
}

/* a kernel of it */
static void build(lua_State *L, maker *made, const char *name, arguments_of of, uint32_t outputs,
                  dm_kernel *out) {
    dml_traced t;
    if (!trace(L, made, name, of, outputs, &t)) return;
    check_status(L, made->compile(out, t.graph, t.out, t.outputs, made->arena), name);
}

/* F, and F with dF/dx */
static void build_equation(lua_State *L, maker *made) {
    const uint32_t m = made->k.m, first = made->k.n + made->k.d + 1 + made->k.w;
    dml_traced t;
    trace(L, made, "equation", OF_ROOT, m, &t);
    check_status(L, made->compile(&made->k.equation, t.graph, t.out, m, made->arena), "equation");
    dm_node *nodes = dm_arena_take(made->arena, (m + (size_t)m * m) * sizeof *nodes);
    if (!nodes) luaL_error(L, "not enough memory");
    memcpy(nodes, t.out, m * sizeof *nodes);
    dm_jacobian(t.graph, t.out, m, first, m, nodes + m);
    check_status(L, dm_graph_status(t.graph), "equation");
    check_status(L, made->compile(&made->k.tangent, t.graph, nodes, m + m * m, made->arena),
                 "equation");
}

/* push function `name` of lua/dm/group/step.lua */
static void push_module(lua_State *L, const char *name) {
    lua_getglobal(L, "require");
    lua_pushliteral(L, "dm.group.step");
    lua_call(L, 1, 1);
    lua_getfield(L, -1, name);
    lua_remove(L, -2);
}

/* push the options of the dm.rule at `object` */
static void push_options(lua_State *L, int object) {
    lua_getiuservalue(L, object, 1);
    lua_getiuservalue(L, -1, 1);
    lua_remove(L, -2);
}

/* push the functions of flat coordinates */
static void push_functions(lua_State *L, int object, int arg) {
    push_module(L, "functions");
    push_options(L, object);
    lua_pushvalue(L, arg);
    lua_call(L, 2, 1);
}

/* The row of steps whose time is their own takes the place of the other. */
const dm_method *dml_step_method(lua_State *L, int object, int arg) {
    object = lua_absindex(L, object);
    arg = lua_absindex(L, arg);
    if (dml_checksystem(L, arg)->pair) luaL_error(L, "dm.step steps a dm.system");
    const dm_step_row *row = dml_torule(L, object)->rule.data;
    if (row->fixed) return &dm_method_step_tied;
    push_module(L, "is_timed");
    push_options(L, object);
    lua_pushvalue(L, arg);
    lua_call(L, 2, 1);
    const int timed = lua_toboolean(L, -1);
    lua_pop(L, 1);
    return timed ? &dm_method_step_timed : &dm_method_step;
}

/* push function `name` of lua/dm/measure/declared_order.lua */
static void push_measure(lua_State *L, const char *name) {
    lua_getglobal(L, "require");
    lua_pushliteral(L, "dm.measure.declared_order");
    lua_call(L, 1, 1);
    lua_getfield(L, -1, name);
    lua_remove(L, -2);
}

void dml_step_order(lua_State *L, const dm_method *method, int members) {
    if (method != &dm_method_step) return;
    push_measure(L, "check");
    lua_pushvalue(L, 1);
    lua_pushvalue(L, 2);
    lua_pushboolean(L, members);
    lua_call(L, 3, 0);
}

void dml_step_said(lua_State *L, const dm_method *method) {
    if (method == &dm_method_step) {
        push_measure(L, "said");
        lua_insert(L, -3);
        lua_call(L, 2, 1);
        lua_pushfstring(L, " (%s)", lua_tostring(L, -1));
        lua_remove(L, -2);
    } else {
        lua_pop(L, 2);
        lua_pushstring(L,
                       method == &dm_method_step_timed ? " (declared; its time is its own)" : "");
    }
}

/* The list is made once, with the step. */
void dml_step_parts(lua_State *L, int object) {
    push_options(L, lua_absindex(L, object));
    lua_getfield(L, -1, "parts");
    lua_remove(L, -2);
}

/* dml_rule.bring: the functions for the system at `arg`. All that is pushed but the maker goes
 * again. Raises what dml_trace raises, and wrong lengths. */
static const void *bring(lua_State *L, int object, int arg, const char *backend, double h) {
    (void)h;
    object = lua_absindex(L, object);
    arg = lua_absindex(L, arg);
    const dml_system *s = dml_checksystem(L, arg);
    const dml_rule *rule = dml_torule(L, object);
    if (!rule) luaL_error(L, "a step is made by dm.step");
    if (s->pair) luaL_error(L, "dm.step steps a dm.system");
    maker *made = lua_newuserdatauv(L, sizeof *made, 2);
    *made =
        (maker){.k = {.n = s->n, .d = s->momenta}, .compile = dml_findbackend(L, backend)->compile};
    made->k.m = ((const dm_step_row *)rule->rule.data)->unknowns;
    made->k.w = ((const dm_step_row *)rule->rule.data)->parts;
    made->arena = dml_pusharena(L);
    lua_setiuservalue(L, -2, 1);
    push_functions(L, object, arg);
    build_equation(L, made);
    build(L, made, "next", OF_ROOT, s->n + s->momenta + 2 + made->k.w, &made->k.next);
    build(L, made, "start", OF_STATE, made->k.m, &made->k.start);
    if (made->k.w) build(L, made, "begin", OF_START, made->k.w, &made->k.begin);
    build(L, made, "inside", OF_ROOT, 0, &made->k.inside);
    build(L, made, "scale", OF_STATE, made->k.m, &made->k.scale);
    if (made->k.inside.outputs > CONDITIONS)
        luaL_error(L, "dm.step, 'inside': at most %d numbers", CONDITIONS);
    lua_setiuservalue(L, -2, 2);
    return &made->k;
}

/* function `name` of the table on top against its kernel at `in`; is_guess: what is there is not
 * the root, which alone has to be in the domain */
static void compare(lua_State *L, const maker *made, const char *name, arguments_of of,
                    const dm_kernel *kernel, const double *in, int is_guess) {
    const int any = kernel == &made->k.inside;
    if (!kernel->outputs) return;
    dml_signature s = signature(made, name, of, any ? 0 : kernel->outputs);
    s.may_be_outside = is_guess;
    lua_getfield(L, -1, name);
    dml_trace_check_start(L, -1, &s, kernel, in);
    lua_pop(L, 1);
}

/* out, behind the inputs of a kernel that it follows from */
static void eval(const dm_kernel *kernel, const double *in, double *out) {
    if (!kernel->outputs) return;
    dm_kernel_prepare(kernel, out);
    dm_kernel_eval(kernel, in, out);
}

/* Of x the place where Newton's method begins is looked at, and one beside it: there nothing is 0
 * since something happens to be 0 at the start. */
void dml_step_compare(lua_State *L, int at, const dm_method *method, const double *state, double t,
                      double h) {
    const double aside = 0.01;
    if (!dm_is_step(method)) return;
    const maker *made = lua_touserdata(L, at);
    const dm_step_kernels *k = &made->k;
    const size_t n = k->n, d = k->d, m = k->m, y = n + d + 1 + k->w;
    double *in = lua_newuserdatauv(L, (y + m + 1 + m) * sizeof *in, 0), *x = in + y + m + 1;
    lua_getiuservalue(L, at, 2);
    memset(in, 0, (y + m + 1) * sizeof *in);
    memcpy(in, state, (n + d) * sizeof *in);
    in[n + d] = h;
    compare(L, made, "begin", OF_START, &k->begin, in, 0);
    eval(&k->begin, in, in + n + d + 1);
    in[n + d] = t;
    in[y] = h;
    compare(L, made, "start", OF_STATE, &k->start, in, 0);
    compare(L, made, "scale", OF_STATE, &k->scale, in, 0);
    eval(&k->start, in, x);
    memcpy(in + y, x, m * sizeof *x);
    in[y + m] = h;
    compare(L, made, "equation", OF_ROOT, &k->equation, in, 0);
    for (size_t i = 0; i < m; i++) in[y + i] += aside * (1 + fabs(x[i]));
    compare(L, made, "equation", OF_ROOT, &k->equation, in, 1);
    compare(L, made, "next", OF_ROOT, &k->next, in, 1);
    compare(L, made, "inside", OF_ROOT, &k->inside, in, 1);
    lua_pop(L, 2);
}

/* of the outputs of kernel `which` at `in`, each with a weight; 1 of what is no number */
static double sum_of(const dm_kernel *kernel, uint64_t which, const double *in, double *out) {
    double sum = 0.0;
    eval(kernel, in, out);
    for (uint32_t i = 0; i < kernel->outputs; i++) {
        const double weight = 1 + dm_random_uniform(6, which, i);
        sum += weight * (isfinite(out[i]) ? out[i] / (1 + fabs(out[i])) : 1.0);
    }
    return sum;
}

double dml_step_sum(lua_State *L, int at, const dm_method *method) {
    enum { POINTS = 24 };
    if (!dm_is_step(method)) return NAN;
    const dm_step_kernels *k = &((const maker *)lua_touserdata(L, at))->k;
    const size_t y = (size_t)k->n + k->d + 1 + k->w, inputs = y + k->m + 1;
    const size_t outputs = (size_t)k->n + k->d + 2 + k->w + k->m + CONDITIONS;
    double *in = lua_newuserdatauv(L, (inputs + outputs) * sizeof *in, 0), sum = 0.0;
    for (uint64_t p = 0; p < POINTS; p++) {
        const double reach = (double)(1 << p % 4); /* 1 to 8, about 0 */
        for (uint32_t i = 0; i < inputs; i++) in[i] = reach * (2 * dm_random_uniform(7, p, i) - 1);
        in[y + k->m] = in[y] = fabs(in[y]) / 8; /* h: behind the state, or behind x */
        sum += sum_of(&k->start, 4 * p, in, in + inputs);
        sum += sum_of(&k->inside, 4 * p + 1, in, in + inputs);
        sum += sum_of(&k->equation, 4 * p + 2, in, in + inputs);
        sum += sum_of(&k->next, 4 * p + 3, in, in + inputs);
    }
    lua_pop(L, 1);
    return sum;
}

/* field `key` of the options at 1 as a function; it may be left out where `optional` */
static void check_function(lua_State *L, const char *key, int optional) {
    const int type = lua_getfield(L, 1, key);
    if (type != LUA_TFUNCTION && !(optional && type == LUA_TNIL))
        luaL_error(L, "field '%s' must be a function (got %s)", key, luaL_typename(L, -1));
    lua_pop(L, 1);
}

/* The options are kept: the functions are traced for every system anew. */
static int make_step(lua_State *L, const char *const *known, int fixed) {
    lua_settop(L, 1);
    luaL_checktype(L, 1, LUA_TTABLE);
    dml_options(L, 1, known);
    const long count = dml_count(L, 1, "unknowns", 1, 0), order = dml_count(L, 1, "order", 1, 0);
    if (count > MOST) luaL_error(L, "field 'unknowns' must be at most %d", MOST);
    check_function(L, "equation", 0);
    check_function(L, "next", 0);
    check_function(L, "start", 0);
    check_function(L, "begin", 1);
    check_function(L, "inside", 1);
    check_function(L, "scale", 1);
    lua_getfield(L, 1, "name");
    const char *name = luaL_optstring(L, -1, "a step of one's own");
    const char *text = lua_pushfstring(L, "%s (own)", name);
    dm_step_row *row = lua_newuserdatauv(L, sizeof *row, 1);
    *row = (dm_step_row){.unknowns = (uint32_t)count, .fixed = fixed, .order = (int)order};
    lua_getfield(L, 1, "sums");
    row->sums = lua_toboolean(L, -1);
    lua_getfield(L, 1, "holonomic");
    lua_getfield(L, 1, "rolling");
    row->holonomic = (uint32_t)lua_tointeger(L, -2), row->rolling = (uint32_t)lua_tointeger(L, -1);
    lua_pop(L, 3);
    push_module(L, "options");
    lua_pushvalue(L, 1);
    lua_call(L, 1, 2);
    row->parts = (uint32_t)lua_tointeger(L, -1);
    lua_pop(L, 1);
    lua_setiuservalue(L, -2, 1);
    dml_pushrule(L, "step", row, text)->bring = bring;
    return 1;
}

#define OPTIONS                                                                                    \
    "name", "unknowns", "order", "start", "equation", "next", "parts", "begin", "inside", "scale", \
        "sums"

static int step_new(lua_State *L) {
    static const char *const known[] = {OPTIONS, NULL};
    return make_step(L, known, 0);
}

static int tied_step_new(lua_State *L) {
    static const char *const known[] = {OPTIONS, "holonomic", "rolling", NULL};
    return make_step(L, known, 1);
}

static const dml_row functions[] = {
    {"tied_step", tied_step_new,
     "core.tied_step{..., holonomic=, rolling=} -> dm.rule\n"
     "dm.step{...} of a discrete Lagrangian on a group: the first unknowns are x of q exp(x), the "
     "last ones impulses of so many constraints, holonomic and rolling (0), which the system has "
     "too, and the last equations are these constraints at the end of the step."},
    {"step", step_new,
     "dm.step{equation=, next=, start=, unknowns=, order=, name=, parts=, begin=, inside=, "
     "scale=, sums=} -> dm.rule\n"
     "A rule from three functions, traced once for the system that it steps and solved in C: x, "
     "of `unknowns` numbers, is the root of equation(y, x, h, m) = 0 that Newton's method finds "
     "from start(y, h, m), to round-off and with the exact Jacobian; next(y, x, h, m) is the "
     "state behind the step, { q =, p = }. y has q (an element on a group), p, t, and parts of "
     "its own: parts = { { \"E\", 1 }, { \"F\", 3 } } are a number y.E and a vector y.F, which "
     "begin(q, p, h, m) sets at the start, { E =, F = } (left out: 0), and next gives anew; what "
     "it does not give stays. They are columns of paths and go into checkpoints. t grows by h "
     "unless next gives it: the steps have a time of their own then. m has functions of the "
     "system and their exact derivatives: L(q, v, t), L_q, L_v and H(q, p, t), H_q, H_p (of an L, "
     "where it is quadratic in v); on groups v is xi and L_q the derivative along the body "
     "velocity. inside(y, x, h, m) gives numbers that must be > 0 at the root, scale(y, h, m) the "
     "sizes of what the unknowns are added to, where x is a small difference. With sums = true "
     "next gives what the step adds to q (on a group: to `flat`, the coordinates of y.q that y "
     "has too) and to p, and runs sum it to twice the digits. The declared order "
     "is measured in the first run on a system, which raises where it is less; print(solver) says "
     "what was found, or why nothing can be told (ends that differ by round-off, steps that do "
     "not resolve the motion). It is that of steps of h, h/2 ... beside each other: that they "
     "tend to the motion of the system, and no other, is what a chart shows. At the start of a run "
     "traces are compared with plain calls; a q that is off its group by more than 1e-8 ends the "
     "run. Such a rule looks for events, fills ensembles, goes on from checkpoints and "
     "has a tangent map as any other."},
    {NULL, NULL, NULL}};

const dml_class dml_class_step = {
    .functions = functions,
};
