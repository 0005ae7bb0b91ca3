/* root_shape.c - a dm.root for one shape of its arguments: traced, compared, differentiated. */
#include "algebra/derive.h"
#include "bind/core/state.h"
#include "bind/trace/bind_root.h"
#include "bind/trace/traced_call.h"
#include "bind/value/array.h"
#include "code/tape/tape.h"
#include "graph/analyse.h"

#include <string.h>

typedef dml_root_shape shape;

enum { FIELDS = 1, SHAPES = 2 }; /* user values of a dm.root */

/* Of the arena of the shape; raises without memory. */
static void *take(lua_State *L, dm_arena *arena, size_t size) {
    void *block = dm_arena_take(arena, size);
    if (!block) luaL_error(L, "not enough memory");
    return block;
}

/* Raises with the name of the root. */
static void check_status(lua_State *L, const char *name, dm_status status) {
    if (status == DM_NO_MEMORY) luaL_error(L, "not enough memory");
    if (status != DM_OK) luaL_error(L, "%s: %s", name, dm_status_text(status));
}

/* field `key` of the options of the root at 1 on top; its type */
static int push_field(lua_State *L, const char *key) {
    lua_getiuservalue(L, 1, FIELDS);
    const int type = lua_getfield(L, -1, key);
    lua_remove(L, -2);
    return type;
}

/* The string is left on the stack. */
const char *dml_rootname(lua_State *L, int arg) {
    lua_getiuservalue(L, arg, FIELDS);
    lua_getfield(L, -1, "name");
    lua_remove(L, -2);
    return lua_tostring(L, -1);
}

/* ---- the shape of a call ---- */

/* arguments from stack index 2 to `top`; the first argument of the signature, y, comes later */
static void read_lengths(lua_State *L, shape *s, int top) {
    dml_scalar x;
    if (top > DML_MAX_ARGUMENTS)
        luaL_error(L, "%s takes at most %d arguments (got %d): join some to one vector",
                   dml_rootname(L, 1), DML_MAX_ARGUMENTS - 1, top - 1);
    s->s.arguments = top;
    for (int arg = 2; arg <= top; arg++) {
        const long n = dml_length(L, arg);
        if (n < 0)
            luaL_error(L,
                       "%s: argument %d must be a number, or a vector or table of numbers (got %s)",
                       dml_rootname(L, 1), arg - 1, luaL_typename(L, arg));
        s->s.length[arg - 1] = dml_toscalar(L, arg, &x) ? DML_SCALAR_ARGUMENT : (int)n;
        s->inputs += (uint32_t)n;
    }
}

/* The lengths of the arguments as a string: the name of the shape in the table of shapes. */
static void push_key(lua_State *L, const shape *s) {
    luaL_Buffer b;
    luaL_buffinit(L, &b);
    for (int k = 1; k < s->s.arguments; k++) {
        lua_pushfstring(L, "%d ", s->s.length[k]);
        luaL_addvalue(&b);
    }
    luaL_pushresult(&b);
}

/* ---- traces ---- */

/* "'key' of name", kept by the shape */
static const char *title(lua_State *L, const shape *s, const char *key) {
    const char *text = lua_pushfstring(L, "'%s' of %s", key, dml_rootname(L, 1));
    const size_t size = strlen(text) + 1;
    char *kept = take(L, s->arena, size);
    memcpy(kept, text, size);
    lua_pop(L, 2);
    return kept;
}

/* Field `key` of the options traced into the arena of the shape; graph NULL without it. */
static void trace_field(lua_State *L, shape *s, const char *key, dml_signature *sig,
                        dml_traced *out) {
    push_field(L, key);
    sig->what = title(L, s, key);
    dml_trace(L, -1, sig, s->arena, out);
    lua_pop(L, 1);
}

/* Is field `key` of the root at 1 given? */
static int has(lua_State *L, const char *key) {
    const int there = push_field(L, key) != LUA_TNIL;
    lua_pop(L, 1);
    return there;
}

/* lists of numbers become nodes of a graph without inputs; `starts` lists, or one */
static void read_start(lua_State *L, shape *s, int at, uint32_t starts, int nested) {
    const uint32_t r = s->unknowns;
    dm_graph *g = dm_graph_new(s->arena, 0);
    if (!g) luaL_error(L, "not enough memory");
    double *x = take(L, s->arena, r * sizeof *x);
    dm_node *nodes = take(L, s->arena, starts * r * sizeof *nodes);
    for (uint32_t k = 0; k < starts; k++) {
        if (nested)
            lua_geti(L, at, (lua_Integer)k + 1);
        else
            lua_pushvalue(L, at);
        dml_vectorarg(L, -1, "field 'start'", x, r);
        lua_pop(L, 1);
        for (uint32_t i = 0; i < r; i++) nodes[k * r + i] = dm_constant(g, x[i]);
    }
    s->start = (dml_traced){.graph = g, .out = nodes, .outputs = starts * r};
}

/* a function of the arguments */
static void trace_start(lua_State *L, shape *s, long unknowns) {
    dml_signature sig = s->s;
    sig.arguments--;
    memmove(sig.length, sig.length + 1, (size_t)sig.arguments * sizeof *sig.length);
    trace_field(L, s, "start", &sig, &s->start);
    s->unknowns = s->start.outputs;
    if (s->start.bare) s->s.length[0] = DML_SCALAR_ARGUMENT;
    if (unknowns && unknowns != (long)s->unknowns)
        luaL_error(L, "%s: 'start' gives %d numbers for %d unknowns", dml_rootname(L, 1),
                   (int)s->unknowns, (int)unknowns);
}

/* a list of numbers, or of such lists, or a number */
static void list_start(lua_State *L, shape *s, long unknowns) {
    const int at = lua_gettop(L);
    dml_scalar x;
    int nested = 0;
    if (lua_istable(L, at)) {
        lua_geti(L, at, 1);
        nested = !lua_isnil(L, -1) && !dml_toscalar(L, -1, &x);
    }
    const long own = dml_length(L, nested ? -1 : at);
    s->unknowns = unknowns ? (uint32_t)unknowns : own > 0 ? (uint32_t)own : 0;
    if (lua_type(L, at) == LUA_TNUMBER) s->s.length[0] = DML_SCALAR_ARGUMENT;
    read_start(L, s, at, nested ? (uint32_t)dml_length(L, at) : 1, nested);
}

/* how many unknowns, and where Newton's method may begin */
static void find_start(lua_State *L, shape *s) {
    const int top = lua_gettop(L);
    push_field(L, "unknowns");
    const long unknowns = (long)lua_tointeger(L, -1);
    const int type = push_field(L, "start");
    s->s.length[0] = 0;
    if (type == LUA_TNIL) dml_pushvector(L, (uint32_t)unknowns);
    if (type == LUA_TFUNCTION)
        trace_start(L, s, unknowns);
    else
        list_start(L, s, unknowns);
    if (s->unknowns < 1 || s->unknowns > DM_ROOT_MOST)
        luaL_error(L, "%s: there must be from 1 to %d unknowns (got %d)", dml_rootname(L, 1),
                   DM_ROOT_MOST, (int)s->unknowns);
    if (!s->s.length[0]) s->s.length[0] = (int)s->unknowns;
    lua_settop(L, top);
}

/* all functions, as they are now */
static void trace_all(lua_State *L, shape *s) {
    find_start(L, s);
    dml_signature sig = s->s;
    sig.outputs = DML_SCALAR_ARGUMENT;
    if (has(L, "branch")) trace_field(L, s, "branch", &sig, &s->branch);
    const int stationary = has(L, "stationary");
    sig.outputs = stationary ? DML_SCALAR_ARGUMENT : 0;
    trace_field(L, s, stationary ? "stationary" : "equations", &sig, &s->equation);
    if (!stationary && s->equation.outputs != s->unknowns)
        luaL_error(L,
                   "%s gives %d numbers for %d unknowns: as many equations as unknowns are needed",
                   sig.what, (int)s->equation.outputs, (int)s->unknowns);
    s->s = sig;
    s->s.outputs = s->equation.bare ? DML_SCALAR_ARGUMENT : (int)s->equation.outputs;
}

/* Node for node, so that the kernels of one are those of the other. */
static int same_traced(const dml_traced *a, const dml_traced *b) {
    if (!a->graph || !b->graph) return !a->graph && !b->graph;
    const uint32_t size = dm_graph_size(b->graph);
    return a->outputs == b->outputs && dm_graph_size(a->graph) == size &&
           dml_samenodes(a->graph, b->graph, size) &&
           memcmp(a->out, b->out, a->outputs * sizeof *a->out) == 0;
}

/* All that was traced of both. */
static int is_same(const shape *a, const shape *b) {
    return a->unknowns == b->unknowns && same_traced(&a->equation, &b->equation) &&
           same_traced(&a->branch, &b->branch) && same_traced(&a->start, &b->start);
}

/* ---- the function ---- */

/* Does an output depend on it? */
static int is_used(const dml_traced *t, uint32_t input) {
    return t->graph && dm_depends(t->graph, t->out, t->outputs, input, 1);
}

/* Arguments that nothing depends on are left out of f: their derivatives are zero. */
static void find_used(lua_State *L, shape *s) {
    const uint32_t r = s->unknowns;
    s->used = take(L, s->arena, (s->inputs + (size_t)1) * sizeof *s->used);
    for (uint32_t i = 0; i < s->inputs; i++)
        if (is_used(&s->equation, r + i) || is_used(&s->branch, r + i) || is_used(&s->start, i))
            s->used[s->uses++] = i;
}

/* nodes of another trace in the graph of the function, whose inputs are y and what is used;
 * `unknowns` of its own inputs are y */
static const dm_node *bring(lua_State *L, const shape *s, const dml_traced *t, dm_graph *g,
                            uint32_t unknowns) {
    const size_t inputs = unknowns + (size_t)s->inputs;
    dm_node *with = take(L, s->arena, (inputs + 1) * sizeof *with);
    dm_node *out = take(L, s->arena, t->outputs * sizeof *out);
    memset(with, 0, (inputs + 1) * sizeof *with);
    for (uint32_t i = 0; i < unknowns; i++) with[i] = dm_input(g, i);
    for (uint32_t i = 0; i < s->uses; i++)
        with[unknowns + s->used[i]] = dm_input(g, s->unknowns + i);
    dm_transplant(g, t->graph, t->out, t->outputs, with, out);
    return out;
}

/* which unknowns are angles, a bit for each */
static uint64_t read_angles(lua_State *L, const shape *s) {
    const int top = lua_gettop(L);
    uint64_t angles = 0;
    if (push_field(L, "angles") == LUA_TNIL) {
        lua_settop(L, top);
        return 0;
    }
    for (lua_Integer k = 1; k <= luaL_len(L, top + 1); k++) {
        int whole;
        lua_geti(L, top + 1, k);
        const lua_Integer i = dml_tointegerx(L, -1, &whole);
        if (!whole || i < 1 || i > (lua_Integer)s->unknowns)
            luaL_error(L,
                       "%s: field 'angles' must be a list of places of unknowns that are angles, "
                       "whole numbers from 1 to %d",
                       dml_rootname(L, 1), (int)s->unknowns);
        angles |= (uint64_t)1 << (i - 1);
        lua_settop(L, top + 1);
    }
    lua_settop(L, top);
    return angles;
}

/* F_x, which here tells how well roots are known and nothing else, as it stands: fewer operations
 * are not worth what it takes to find them (first frames of docs/benchmarks/frames.md). */
static dm_status slopes(dm_kernel *out, dm_graph *g, const dm_node *roots, uint32_t m,
                        dm_arena *arena) {
    return dm_has_roots(g, roots, m) ? dm_tape_build(out, g, roots, m, arena)
                                     : dm_tape_build_exact(out, g, roots, m, arena);
}

/* f, from equations, start and branch in one graph. */
static void make_function(lua_State *L, shape *s) {
    const uint32_t r = s->unknowns;
    const char *name = dml_rootname(L, 1);
    push_field(L, "failure");
    find_used(L, s);
    dm_graph *g = dm_graph_new(s->arena, r + s->uses);
    if (!g) luaL_error(L, "not enough memory");
    const dm_node *equation = bring(L, s, &s->equation, g, r);
    push_field(L, "stationary");
    const int stationary = !lua_isnil(L, -1);
    const dm_implicit_draft draft = {.serial = ++dml_getstate(L)->roots,
                                     .name = name,
                                     .advice = lua_tostring(L, -2),
                                     .unknowns = r,
                                     .inputs = s->uses,
                                     .starts = s->start.outputs / r,
                                     .angles = read_angles(L, s),
                                     .graph = g,
                                     .equation = stationary ? NULL : equation,
                                     .value = stationary ? equation : NULL,
                                     .branch =
                                         s->branch.graph ? bring(L, s, &s->branch, g, r) : NULL,
                                     .start = bring(L, s, &s->start, g, 0)};
    dm_status status = dm_graph_status(g);
    if (status == DM_OK) s->f = dm_implicit_make(&draft, s->arena, &status);
    check_status(L, name, status);
    check_status(L, name,
                 dm_root_solver_build(&s->solver, s->f, dm_tape_build, slopes, s->arena, 1));
    if (stationary)
        check_status(L, name, dm_tape_build(&s->value, s->f->graph, s->f->value, 1, s->arena));
    lua_pop(L, 3);
}

/* the equations (or S) as they were traced, against plain calls */
static void check_trace(lua_State *L, shape *s) {
    dm_kernel kernel;
    check_status(L, s->s.what,
                 dm_tape_build(&kernel, s->equation.graph, s->equation.out, s->equation.outputs,
                               s->arena));
    push_field(L, has(L, "stationary") ? "stationary" : "equations");
    dml_trace_check(L, -1, &s->s, &kernel, NULL);
    lua_pop(L, 1);
}

/* a new shape on top, traced only */
static shape *push_traced(lua_State *L, int top) {
    shape *s = lua_newuserdatauv(L, sizeof *s, 1);
    *s = (shape){.inputs = 0};
    s->arena = dml_pusharena(L);
    lua_setiuservalue(L, -2, 1);
    read_lengths(L, s, top);
    trace_all(L, s);
    return s;
}

/* A shape that is traced but not known yet becomes one that can be solved. */
static void make(lua_State *L, shape *s) {
    const size_t n = s->inputs + (size_t)1, r = s->unknowns;
    make_function(L, s);
    s->x = take(L, s->arena, (2 * n + r + r * r) * sizeof(double));
    s->chosen = s->x + n;
    s->y = s->chosen + n;
    s->inverse = s->y + r;
}

/* Pushes the userdata of the shape, which is kept by the root. */
dml_root_shape *dml_rootshape(lua_State *L, int anew) {
    shape like = {.inputs = 0};
    const int top = lua_gettop(L), shapes = top + 1, key = top + 2;
    luaL_checkstack(L, 40, NULL);
    read_lengths(L, &like, top);
    lua_getiuservalue(L, 1, SHAPES);
    push_key(L, &like);
    lua_pushvalue(L, key);
    lua_rawget(L, shapes);
    shape *last = lua_touserdata(L, -1);
    if (!last || anew) {
        shape *fresh = push_traced(L, top);
        if (!last || !is_same(last, fresh)) {
            make(L, fresh);
            lua_replace(L, key + 1);
            lua_pushvalue(L, key);
            lua_pushvalue(L, key + 1);
            lua_rawset(L, shapes);
            last = fresh;
        }
    }
    lua_pushvalue(L, key + 1);
    lua_replace(L, top + 1);
    lua_settop(L, top + 1);
    return last;
}

/* What was traced for calls that compare nothing may be another function by now. */
dml_root_shape *dml_rootchecked(lua_State *L, int anew) {
    const int top = lua_gettop(L);
    const double before = dml_getstate(L)->roots;
    shape *s = dml_rootshape(L, anew);
    if (s->checked) return s;
    if (!anew && s->f->serial <= before) {
        lua_settop(L, top);
        s = dml_rootshape(L, 1);
    }
    check_trace(L, s);
    s->checked = 1;
    return s;
}
