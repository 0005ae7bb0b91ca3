#include "bind/model_kept.h"

#include "bind/model_ties.h"
#include "bind/state.h"
#include "expr/sum.h"

#include <string.h>

/* its address is the registry key of a table from systems to models, which holds neither alive
 * for the other */
static const char key;

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

static int same_node(const dm_expr *a, const dm_expr *b) {
    if (a->op != b->op) return 0;
    if (a->op == DM_OP_CONSTANT || a->op == DM_OP_IMPLICIT)
        return memcmp(&a->as.value, &b->as.value, sizeof a->as.value) == 0;
    if (a->op == DM_OP_INPUT) return a->as.input == b->as.input;
    return memcmp(a->as.arg, b->as.arg, sizeof a->as.arg) == 0; /* 0 where unused */
}

int dml_samenodes(const dm_graph *a, const dm_graph *b, uint32_t size) {
    const dm_expr *x = dm_graph_at(a, 0), *y = dm_graph_at(b, 0);
    for (dm_node i = 0; i < size; i++)
        if (!same_node(x + i, y + i)) return 0;
    return 1;
}

/* the trace of *fresh is the beginning of the graph of *kept, to which derivatives were added */
int dml_sametrace(const dml_model *kept, const dml_model *fresh) {
    const uint32_t size = dm_graph_size(fresh->graph);
    if (kept->traced != size || kept->lagrangian != fresh->lagrangian || kept->n != fresh->n)
        return 0;
    return dml_samenodes(kept->graph, fresh->graph, size) &&
           dm_sums_same(kept->graph, fresh->graph) && dml_sameties(kept, fresh);
}

dml_model *dml_pushkept(lua_State *L, int arg, dm_compile *compile) {
    arg = lua_absindex(L, arg);
    push_table(L);
    lua_pushvalue(L, arg);
    lua_rawget(L, -2);
    lua_remove(L, -2);
    dml_model *kept = lua_touserdata(L, -1);
    if (kept && kept->compile == compile && !dml_arenalost(kept->arena)) return kept;
    lua_pop(L, 1);
    return NULL;
}

void dml_keep(lua_State *L, int arg, dml_model *m, dm_compile *compile) {
    arg = lua_absindex(L, arg);
    m->compile = compile;
    push_table(L);
    lua_pushvalue(L, arg);
    lua_pushvalue(L, -3);
    lua_rawset(L, -3);
    lua_pop(L, 1);
}
