/* model_cache.c - the model of a system's last run, found again by the next one.
 * Speed: setup, again: 25x, against making its kernels. */
#include "bind/model/model_cache.h"

#include "algebra/body_sum.h"
#include "bind/core/state.h"
#include "bind/model/model_constraints.h"

#include <string.h>

/* its address is the registry key of a table from systems to models, which holds neither alive
 * for the other */
static const char key;

/* Made when first asked for. */
static void push_table(lua_State *L) {
    if (lua_rawgetp(L, LUA_REGISTRYINDEX, &key) == LUA_TTABLE) return;
    lua_pop(L, 1);
    lua_newtable(L);
    lua_createtable(L, 0, 1);
    lua_pushstring(L, "k");
    lua_setfield(L, -2, "__mode");
    lua_setmetatable(L, -2);
    lua_pushvalue(L, -1);
    lua_rawsetp(L, LUA_REGISTRYINDEX, &key);
}

/* Nodes by number: the graphs were found to be the same. */
static int same_roots(const dm_node *a, const dm_node *b, size_t count) {
    if (!a != !b) return 0;
    return !a || memcmp(a, b, count * sizeof *a) == 0;
}

/* the map is in a graph of its own */
static int same_map(const dml_traced *a, const dml_traced *b) {
    if (!a->graph || !b->graph) return a->graph == b->graph;
    return a->outputs == b->outputs && same_roots(a->out, b->out, a->outputs) &&
           dml_samenodes(a->graph, b->graph, dm_graph_size(a->graph));
}

/* the functions that constrain it, node for node */
static int same_constraints(const dml_model *cached, const dml_model *fresh) {
    const dm_constraints_traced *a = &cached->constrained, *b = &fresh->constrained;
    if (!a->graph != !b->graph || a->holonomic != b->holonomic || a->rolling != b->rolling ||
        a->controls != b->controls || a->forces != b->forces || a->crossings != b->crossings ||
        a->prolonged != b->prolonged || cached->constraints_traced != fresh->constraints_traced ||
        !same_map(cached->constraint + DML_MAP, fresh->constraint + DML_MAP))
        return 0;
    return !a->graph ||
           (same_roots(a->g, b->g, a->holonomic) && same_roots(a->phi, b->phi, a->rolling) &&
            same_roots(a->f, b->f, a->forces) && same_roots(a->u, b->u, a->controls) &&
            same_roots(a->E, b->E, (size_t)a->rolling * a->n) &&
            dml_samenodes(a->graph, b->graph, cached->constraints_traced));
}

/* the trace of *fresh is the beginning of the graph of *cached, to which derivatives were added */
int dml_sametrace(const dml_model *cached, const dml_model *fresh) {
    const uint32_t size = dm_graph_size(fresh->graph);
    if (cached->traced != size || cached->lagrangian != fresh->lagrangian || cached->n != fresh->n)
        return 0;
    return dml_samenodes(cached->graph, fresh->graph, size) &&
           dm_sums_same(cached->graph, fresh->graph) && same_constraints(cached, fresh);
}

/* A model whose native code the collector has given back already is none. */
dml_model *dml_pushcached(lua_State *L, int arg, dm_compile *compile) {
    arg = lua_absindex(L, arg);
    push_table(L);
    lua_pushvalue(L, arg);
    lua_rawget(L, -2);
    lua_remove(L, -2);
    dml_model *cached = lua_touserdata(L, -1);
    if (cached && cached->compile == compile && !dml_arenalost(cached->arena)) return cached;
    lua_pop(L, 1);
    return NULL;
}

/* The model stays on the stack. */
void dml_cachemodel(lua_State *L, int arg, dml_model *m, dm_compile *compile) {
    arg = lua_absindex(L, arg);
    m->compile = compile;
    push_table(L);
    lua_pushvalue(L, arg);
    lua_pushvalue(L, -3);
    lua_rawset(L, -3);
    lua_pop(L, 1);
}
