/* bind_emit.c - `system:emit_c()` and `f:emit_c()`: what dmlua computes, as C. */
#include "algebra/derive.h"
#include "bind/core/c_names.h"
#include "bind/model/bind_system.h"
#include "bind/trace/function.h"
#include "code/tape/emit_c.h"

#include <string.h>

static void put(void *ud, const char *text, size_t length) {
    luaL_addlstring(ud, text, length);
}

/* push what was written as a file, with what stands before it */
static int push_file(luaL_Buffer *b) {
    lua_State *L = b->L;
    luaL_Buffer file;
    luaL_pushresult(b);
    const char *body = lua_tostring(L, -1);
    luaL_buffinit(L, &file);
    dm_emit_c_head(put, &file, body);
    luaL_addstring(&file, body);
    luaL_pushresult(&file);
    return 1;
}

typedef struct {
    lua_State *L;
    luaL_Buffer *b;
    dm_graph *graph;
    const char *const *names;
} emitter;

static void emit(const emitter *e, const char *name, const dm_node *roots, uint32_t m) {
    if (!dm_emit_c(e->graph, roots, m, name, e->names, put, e->b))
        luaL_error(e->L, dm_graph_status(e->graph) == DM_OK
                             ? "an operation of this function has no C text (dm.sum_over, dm.root)"
                             : "not enough memory");
    luaL_addchar(e->b, '\n');
}

/* names of the inputs (q, v, t) or (q0, q1), kept alive by a userdata on the stack */
static const char *const *input_names(lua_State *L, const dml_system *s) {
    const uint32_t inputs = s->pair ? 2 * s->n : 2 * s->n + 1;
    const char **names = lua_newuserdatauv(L, inputs * sizeof *names, 1);
    lua_newtable(L);
    for (uint32_t i = 0; i < inputs; i++) {
        const char *kind = s->pair ? (i < s->n ? "q0_" : "q1_") : i < s->n ? "q" : "v";
        if (i == 2 * s->n)
            names[i] = lua_pushliteral(L, "t");
        else
            names[i] = lua_pushfstring(L, "%s%d", kind, (int)(i % s->n) + 1);
        lua_rawseti(L, -2, (lua_Integer)i + 1);
    }
    lua_setiuservalue(L, -2, 1);
    return names;
}

/* constraint, rolling, reaction, force: in = q, v, t, then room for multipliers, then controls */
static void emit_constraints(emitter e, const dm_constraints_traced *t) {
    e.graph = t->graph;
    if (!t->graph) return;
    if (t->g) emit(&e, "constraint", t->g, t->holonomic);
    if (t->phi) emit(&e, "rolling", t->phi, t->rolling);
    if (t->E) emit(&e, "reaction", t->E, t->rolling * t->n);
    if (t->controls) e.names = NULL; /* the names end with t */
    if (t->f) emit(&e, "force", t->f, t->n);
}

/* L, its slopes and the energy, the constraints; or Ld and its slopes */
static int system_emit(lua_State *L) {
    const dml_system *s = dml_checksystem(L, 1);
    const uint32_t n = s->n;
    const char *const *names = input_names(L, s);
    dml_model *m = dml_pushmodel(L, 1);
    if (!m->graph)
        return luaL_error(L, "this system runs on hyper-dual numbers: it has no graph to write");
    if (dm_graph_inputs(m->graph) > (s->pair ? 2 * n : 2 * n + 1))
        return luaL_error(L, "this system keeps a loop over its bodies (dm.sum_over), which has no "
                             "C text; one with few bodies has");
    dm_node *slope = lua_newuserdatauv(L, 2 * (size_t)n * sizeof *slope, 0);
    luaL_Buffer b;
    luaL_buffinit(L, &b);
    const emitter e = {.L = L, .b = &b, .graph = m->graph, .names = names};
    dm_gradient(m->graph, m->lagrangian, 0, 2 * n, slope);
    emit(&e, s->pair ? "Ld" : "lagrangian", &m->lagrangian, 1);
    emit(&e, "slope", slope, 2 * n);
    if (!s->pair) {
        dm_node E = dm_neg(m->graph, m->lagrangian);
        for (uint32_t i = 0; i < n; i++) {
            const dm_node v = dm_input(m->graph, n + i), term = dm_mul(m->graph, v, slope[n + i]);
            E = dm_add(m->graph, E, term);
        }
        emit(&e, "energy", &E, 1);
    }
    emit_constraints(e, &m->constrained);
    return push_file(&b);
}

static int function_emit(lua_State *L) {
    const dml_function *f = luaL_checkudata(L, 1, DML_FUNCTION);
    size_t length = 1;
    const char *name = luaL_optlstring(L, 2, "f", &length);
    const char *taken = strlen(name) == length ? dml_c_taken(name) : "is none: it has a zero byte";
    if (taken)
        return luaL_error(L, "emit_c: as the name of a C function \"%s\" %s; take another one",
                          name, taken);
    luaL_Buffer b;
    luaL_buffinit(L, &b);
    const emitter e = {.L = L, .b = &b, .graph = f->graph};
    emit(&e, name, f->parts[DML_VALUE].nodes, dml_outputs(f));
    return push_file(&b);
}

static const dml_row of_systems[] =
    {{"emit_c", system_emit,
      "system:emit_c() -> string\n"
      "C17 text of what the runtime computes, with no need of dmlua: lagrangian (1 output), slope "
      "(dL/dq, dL/dv: 2 dim Q) and energy, and constraint, rolling, reaction, force where there "
      "are such, each void f(const double *in, double *out) with in = q, v, t; of a discrete "
      "Lagrangian Ld and slope with in = q0, q1. Compile with -ffp-contract=off and, for gcc "
      "with -mfma, -fno-tree-slp-vectorize: then nothing is fused that the text does not fuse."},
     {NULL, NULL, NULL}};
static const dml_row of_functions[] =
    {{"emit_c", function_emit,
      "f:emit_c([name]) -> string\n"
      "C17 text of f: void name(const double *in, double *out); name defaults to f. Words of C, "
      "names in <math.h> and functions of the C library are refused."},
     {NULL, NULL, NULL}};

static const dml_extension more[] = {
    {DML_SYSTEM, of_systems},
    {DML_DISCRETE, of_systems},
    {DML_FUNCTION, of_functions},
    {NULL, NULL},
};

const dml_class dml_class_emit = {
    .more = more,
};
