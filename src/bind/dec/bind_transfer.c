/* bind_transfer.c - forms from mesh to mesh, as sparse matrices: dm.remesh asks for them. */
#include "bind/core/state.h"
#include "bind/dec/bind_mesh.h"
#include "bind/dec/bind_sparse.h"
#include "dec/transfer/transfer.h"

static dm_realization realization_at(lua_State *L, int arg) {
    const dml_mesh *m = dml_checkmesh(L, arg);
    dml_needmetric(L, m);
    if (!m->points) luaL_argerror(L, arg, "a mesh with points is needed");
    return (dm_realization){&m->K, &m->metric, m->points, m->ambient};
}

/* (mesh, mesh, k, rule) -> matrix, or nil, the cell that is not covered, how much of it is */
static int mesh_transfer(lua_State *L) {
    static const char *const rules[] = {"whitney", "sum", "thesis", NULL};
    const dm_realization from = realization_at(L, 1), to = realization_at(L, 2);
    const uint32_t k = dml_checkdegree(L, 3, dml_checkmesh(L, 1));
    const dm_transfer_rule rule = (dm_transfer_rule)luaL_checkoption(L, 4, "whitney", rules);
    luaL_argcheck(L, from.K->n == to.K->n && from.N == to.N, 2, "not of the same dimension");
    luaL_argcheck(L, rule != DM_TRANSFER_THESIS || from.N == from.K->n, 4, "the mesh is bent");
    dm_transfer_report report = {0, 0.0};
    dm_arena *arena, *work = dml_pusharena(L);
    const int at = lua_gettop(L);
    dm_sparse *T = dml_newsparse(L, &arena);
    const dm_status status = dm_transfer(T, arena, work, &from, &to, k, rule, &dml_stop, &report);
    if (status == DM_SINGULAR) {
        lua_pushnil(L);
        lua_pushinteger(L, (lua_Integer)report.cell + 1);
        lua_pushnumber(L, report.covered);
        return 3;
    }
    dml_sparsedone(L, status);
    dml_sparearena(L, at);
    return 1;
}

static const dml_row methods[] =
    {{"transfer", mesh_transfer,
      "K:transfer(M, k [, rule]) -> dm.sparse   or nil, number, number\n"
      "The matrix that takes the values of k-forms on K to those on M: see dm.remesh; or nil, the "
      "first cell of M of which not all is covered by K, and how much of it is."},
     {NULL, NULL, NULL}};

static const dml_extension more[] = {{DML_MESH, methods}, {NULL, NULL}};

const dml_class dml_class_transfer = {.more = more};
