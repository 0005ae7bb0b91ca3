/* bind_step.c - `dm.step`: the functions of a step, traced for the system that it steps. */
#include "bind/rule/bind_step.h"

#include "algebra/derive.h"
#include "bind/core/state.h"
#include "bind/rule/bind_rule.h"
#include "bind/trace/backend.h"

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

/* function `name` of the table on top, traced with the inputs of step_method.h; 0: there is none */
static int trace(lua_State *L, const maker *made, const char *name, int with_root, uint32_t outputs,
                 dml_traced *out) {
    const int n = (int)made->k.n, d = (int)made->k.d, m = (int)made->k.m;
    dml_signature s = {.what = name,
                       .arguments = with_root ? 5 : 4,
                       .length = {n, d, DML_SCALAR_ARGUMENT, DML_SCALAR_ARGUMENT},
                       .outputs = (int)outputs};
    if (with_root) s.length[3] = m, s.length[4] = DML_SCALAR_ARGUMENT;
    const int there = lua_getfield(L, -1, name) != LUA_TNIL;
    if (there) dml_trace(L, lua_gettop(L), &s, made->arena, out);
    lua_pop(L, 1);
    return there;
}

/* a kernel of it */
static void build(lua_State *L, maker *made, const char *name, int with_root, uint32_t outputs,
                  dm_kernel *out) {
    dml_traced t;
    if (!trace(L, made, name, with_root, outputs, &t)) return;
    check_status(L, made->compile(out, t.graph, t.out, t.outputs, made->arena), name);
}

/* F, and F with dF/dx */
static void build_equation(lua_State *L, maker *made) {
    const uint32_t m = made->k.m, first = made->k.n + made->k.d + 1;
    dml_traced t;
    trace(L, made, "equation", 1, m, &t);
    check_status(L, made->compile(&made->k.equation, t.graph, t.out, m, made->arena), "equation");
    dm_node *nodes = dm_arena_take(made->arena, (m + (size_t)m * m) * sizeof *nodes);
    if (!nodes) luaL_error(L, "not enough memory");
    memcpy(nodes, t.out, m * sizeof *nodes);
    dm_jacobian(t.graph, t.out, m, first, m, nodes + m);
    check_status(L, dm_graph_status(t.graph), "equation");
    check_status(L, made->compile(&made->k.tangent, t.graph, nodes, m + m * m, made->arena),
                 "equation");
}

/* push the functions of flat coordinates (lua/dm/group/step.lua) */
static void push_functions(lua_State *L, int object, int arg) {
    lua_getglobal(L, "require");
    lua_pushliteral(L, "dm.group.step");
    lua_call(L, 1, 1);
    lua_getfield(L, -1, "functions");
    lua_remove(L, -2);
    lua_getiuservalue(L, object, 1);
    lua_getiuservalue(L, -1, 1);
    lua_remove(L, -2);
    lua_pushvalue(L, arg);
    lua_call(L, 2, 1);
}

/* All that is pushed but the maker goes again. */
const dm_step_kernels *dml_step_trace(lua_State *L, int object, int arg, const char *backend) {
    object = lua_absindex(L, object);
    arg = lua_absindex(L, arg);
    const dml_system *s = dml_checksystem(L, arg);
    const dml_rule *rule = dml_torule(L, object);
    if (!rule) luaL_error(L, "a step is made by dm.step");
    if (s->pair) luaL_error(L, "dm.step steps a dm.system");
    maker *made = lua_newuserdatauv(L, sizeof *made, 1);
    *made =
        (maker){.k = {.n = s->n, .d = s->momenta}, .compile = dml_findbackend(L, backend)->compile};
    made->k.m = ((const dm_step_row *)rule->rule.data)->unknowns;
    made->arena = dml_pusharena(L);
    lua_setiuservalue(L, -2, 1);
    push_functions(L, object, arg);
    build_equation(L, made);
    build(L, made, "next", 1, s->n + s->momenta, &made->k.next);
    build(L, made, "start", 0, made->k.m, &made->k.start);
    build(L, made, "inside", 1, 0, &made->k.inside);
    build(L, made, "scale", 0, made->k.m, &made->k.scale);
    if (made->k.inside.outputs > CONDITIONS)
        luaL_error(L, "dm.step, 'inside': at most %d numbers", CONDITIONS);
    lua_pop(L, 1);
    return &made->k;
}

/* field `key` of the options at 1 as a function; it may be left out where `optional` */
static void check_function(lua_State *L, const char *key, int optional) {
    const int type = lua_getfield(L, 1, key);
    if (type != LUA_TFUNCTION && !(optional && type == LUA_TNIL))
        luaL_error(L, "field '%s' must be a function (got %s)", key, luaL_typename(L, -1));
    lua_pop(L, 1);
}

/* The options are kept: the functions are traced for every system anew. */
static int step_new(lua_State *L) {
    static const char *const known[] = {"name", "unknowns", "order", "start", "equation",
                                        "next", "inside",   "scale", NULL};
    lua_settop(L, 1);
    luaL_checktype(L, 1, LUA_TTABLE);
    dml_options(L, 1, known);
    const long count = dml_count(L, 1, "unknowns", 1, 0), order = dml_count(L, 1, "order", 1, 0);
    if (count > MOST) luaL_error(L, "field 'unknowns' must be at most %d", MOST);
    check_function(L, "equation", 0);
    check_function(L, "next", 0);
    check_function(L, "start", 0);
    check_function(L, "inside", 1);
    check_function(L, "scale", 1);
    lua_getfield(L, 1, "name");
    const char *name = luaL_optstring(L, -1, "a step of one's own");
    const char *text = lua_pushfstring(L, "%s (own)", name);
    dm_step_row *row = lua_newuserdatauv(L, sizeof *row, 1);
    *row = (dm_step_row){.unknowns = (uint32_t)count, .order = (int)order};
    dml_pushcopy(L, 1);
    lua_setiuservalue(L, -2, 1);
    dml_pushrule(L, "step", row, text);
    return 1;
}

static const dml_row functions[] =
    {{"step", step_new,
      "dm.step{equation=, next=, start=, unknowns=, order=, name=, inside=, scale=} -> dm.rule\n"
      "A rule from three functions, traced once for the system that it steps and solved in C: x, "
      "of `unknowns` numbers, is the root of equation(y, x, h, m) = 0 that Newton's method finds "
      "from start(y, h, m), to round-off and with the exact Jacobian; next(y, x, h, m) is the "
      "state behind the step, { q =, p = }. y has q (an element on a group), p and t. m has "
      "functions of the system and their exact derivatives: L(q, v, t), L_q, L_v and, where L is "
      "quadratic in v, H(q, p, t), H_q, H_p; on groups v is xi and L_q the derivative along the "
      "body velocity. inside(y, x, h, m) gives numbers that must be > 0 at the root, scale(y, h, "
      "m) the sizes of what the unknowns are added to, where x is a small difference. order: as "
      "declared; solver:measured_order measures it. Such a rule runs, looks for events, fills "
      "ensembles and "
      "goes on from checkpoints as any other."},
     {NULL, NULL, NULL}};

const dml_class dml_class_step = {
    .functions = functions,
};
