/* function_replay.c - a traced function called inside another one, or on hyper-dual
 * numbers: its operations are done again on what it is given. */
#include "bind/trace/bind_root.h"
#include "bind/trace/function.h"
#include "bind/value/array.h"

#include <string.h>

/* Arguments from stack index 2 on. */
int dml_function_isspecial(lua_State *L, const dml_function *f) {
    dml_scalar x;
    for (int arg = 2; arg <= lua_gettop(L) && arg < 2 + f->s.arguments; arg++) {
        const dml_array *a = dml_toarray(L, arg, 1);
        if (a && !dml_numbersof(a)) return 1;
        if (!a && dml_toscalar(L, arg, &x) && x.kind != DML_NUMBER) return 1;
        for (long i = 0, n = lua_istable(L, arg) ? dml_length(L, arg) : 0; i < n; i++)
            if (dml_entry(L, arg, (uint32_t)i).kind != DML_NUMBER) return 1;
    }
    return 0;
}

/* arguments of any kind */
static void read_scalars(lua_State *L, const dml_function *f, dml_scalar *x) {
    for (int k = 0; k < f->s.arguments; k++) {
        const int n = f->s.length[k] == DML_SCALAR_ARGUMENT ? 1 : f->s.length[k];
        if (dml_length(L, k + 2) != n)
            luaL_error(L, "argument %d must have %d entries (got %d)", k + 1, n,
                       (int)dml_length(L, k + 2));
        for (int i = 0; i < n; i++) *x++ = dml_entry(L, k + 2, (uint32_t)i);
    }
}

/* 1 for every node that the outputs need */
static const uint8_t *needed_nodes(lua_State *L, const dm_graph *g, const dm_node *out,
                                   uint32_t m) {
    const uint32_t size = dm_graph_size(g);
    uint8_t *needed = lua_newuserdatauv(L, size, 0);
    memset(needed, 0, size);
    for (uint32_t i = 0; i < m; i++) needed[out[i]] = 1;
    for (dm_node n = size; n-- > 0;) {
        const dm_expr *e = dm_graph_at(g, n);
        for (int k = 0; needed[n] && k < dm_op_operands(e->op); k++) needed[e->as.arg[k]] = 1;
    }
    return needed;
}

/* an implicit function of the values y of its arguments */
static dml_scalar replay_root(lua_State *L, const dm_graph *g, const dm_expr *e,
                              const dml_scalar *y) {
    const uint32_t m = dm_implicit_length(g, e->as.arg[0]);
    const int top = lua_gettop(L);
    dm_node *nodes = lua_newuserdatauv(L, (m + 1) * sizeof *nodes, 0);
    dml_scalar *a = lua_newuserdatauv(L, (m + 1) * sizeof *a, 0);
    const dm_implicit *f = dm_implicit_read(g, e->as.arg[0], nodes);
    for (uint32_t i = 0; i < m; i++) a[i] = y[nodes[i]];
    const uint32_t entry = (uint32_t)dm_graph_at(g, e->as.arg[1])->as.value;
    const dml_scalar out = dml_rootentry(L, f, a, m, entry);
    lua_settop(L, top);
    return out;
}

/* node n done again on the values y of its operands */
static dml_scalar replay(lua_State *L, const dm_graph *g, dm_node n, const dml_scalar *x,
                         const dml_scalar *y) {
    const dm_expr e = *dm_graph_at(g, n);
    switch (e.op) {
    case DM_OP_INPUT:
        return x[e.as.input];
    case DM_OP_CONSTANT:
        return (dml_scalar){.kind = DML_NUMBER, .as.number = e.as.value};
    case DM_OP_IMPLICIT:
    case DM_OP_WITH: /* links to arguments: the root reads them */
        return (dml_scalar){.kind = DML_NUMBER};
    case DM_OP_ROOT:
        return replay_root(L, g, &e, y);
    default:
        return dml_apply(L, e.op, y + e.as.arg[0], y + e.as.arg[1], y + e.as.arg[2]);
    }
}

/* Only nodes that the outputs need are computed. */
void dml_replay(lua_State *L, const dm_graph *g, const dm_node *nodes, uint32_t m,
                const dml_scalar *x, dml_scalar *out) {
    const uint32_t size = dm_graph_size(g);
    const int top = lua_gettop(L);
    luaL_checkstack(L, 10, NULL);
    dml_scalar *y = lua_newuserdatauv(L, size * sizeof *y, 0);
    const uint8_t *needed = needed_nodes(L, g, nodes, m);
    for (dm_node n = 0; n < size; n++)
        if (needed[n]) y[n] = replay(L, g, n, x, y);
    for (uint32_t i = 0; i < m; i++) out[i] = y[nodes[i]];
    lua_settop(L, top);
}

/* Pushes a number, vector or matrix, as a call on numbers does. */
int dml_function_replay(lua_State *L, dml_function *f) {
    const uint32_t m = dml_outputs(f);
    dml_function_checkcount(L, f);
    luaL_checkstack(L, 10, NULL);
    dml_scalar *x = lua_newuserdatauv(L, (f->inputs + (size_t)m) * sizeof *x, 0);
    dml_scalar *y = x + f->inputs, kind = {.kind = DML_NUMBER};
    read_scalars(L, f, x);
    dml_replay(L, f->graph, f->parts[DML_VALUE].nodes, m, x, y);
    if (f->rank == 0) {
        dml_pushscalar(L, y);
        return 1;
    }
    for (uint32_t i = 0; i < m; i++) kind = dml_common(L, &kind, y + i);
    dml_array *result = dml_newarray(L, f->rank, f->rows, f->columns, &kind);
    for (uint32_t i = 0; i < m; i++) dml_put(L, result, i, y + i);
    return 1;
}
