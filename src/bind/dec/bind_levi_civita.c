/* bind_levi_civita.c - what K:levi_civita is made of: deficits, dual loops, rotations between the
 * frames of neighbours. */
#include "bind/dec/bind_mesh.h"
#include "bind/dec/bind_sparse.h"
#include "bind/value/value.h"
#include "dec/incidence.h"
#include "dec/levi_civita/deficit.h"
#include "dec/levi_civita/ring.h"
#include "dec/levi_civita/rotation.h"

/* the mesh at 1, with a metric and cells of codimension 2 */
static dml_mesh *check(lua_State *L) {
    dml_mesh *m = dml_checkmesh(L, 1);
    if (m->K.n < 2)
        luaL_error(L,
                   "the curvature of a mesh is at cells of codimension 2: its dimension must be "
                   "2 or more (got %d)",
                   (int)m->K.n);
    return m;
}

/* raises where a cell of codimension 2 has other than one loop or fan of top cells round it; looked
 * for once */
static void check_rings(lua_State *L, dml_mesh *m) {
    if (m->ringed || m->manifold == 1) return;
    const uint32_t k = m->K.n - 2;
    uint32_t *ring = lua_newuserdatauv(L, (m->K.count[m->K.n] + 1) * sizeof *ring, 0);
    const uint32_t torn = dm_ring_torn(ring, &m->K);
    lua_pop(L, 1);
    if (torn != UINT32_MAX)
        luaL_error(L,
                   "the mesh is no manifold: round %s, cell %d of degree %d, the top cells make no "
                   "single loop or fan",
                   dml_pushface(L, &m->K, k, torn), (int)torn + 1, (int)k);
    m->ringed = 1;
}

/* K:deficits(): a list, false where there is no ring of top cells */
static int mesh_deficits(lua_State *L) {
    dml_mesh *m = check(L);
    const uint32_t k = m->K.n - 2, count = m->K.count[k];
    dml_needmetric(L, m);
    check_rings(L, m);
    double *deficit = lua_newuserdatauv(L, (count + 1) * sizeof *deficit, 0);
    dm_turn *work = lua_newuserdatauv(L, (count + 1) * sizeof *work, 0);
    unsigned char *mark = lua_newuserdatauv(L, (size_t)count + 1, 0);
    dm_boundary_marks(mark, &m->K, k);
    dm_deficits(deficit, work, &m->K, &m->metric);
    dml_checkstop(L);
    lua_createtable(L, (int)count, 0);
    dml_setresult(L);
    for (uint32_t i = 0; i < count; i++) {
        if (mark[i] || work[i].cells == 0)
            lua_pushboolean(L, 0);
        else
            lua_pushnumber(L, deficit[i]);
        lua_rawseti(L, -2, (lua_Integer)i + 1);
    }
    return 1;
}

/* the number at arg of a cell of degree k, from 0 */
static uint32_t check_cell(lua_State *L, int arg, const dml_mesh *m, uint32_t k) {
    const lua_Integer cell = dml_checkinteger(L, arg);
    if (cell < 1 || cell > (lua_Integer)m->K.count[k])
        luaL_argerror(L, arg,
                      lua_pushfstring(L, "there is no such cell: those of degree %d are 1 to %d",
                                      (int)k, (int)m->K.count[k]));
    return (uint32_t)cell - 1;
}

/* K:dual_ring(cell) */
static int mesh_dual_ring(lua_State *L) {
    const dml_mesh *m = check(L);
    const uint32_t k = m->K.n - 2, cell = check_cell(L, 2, m, k);
    const size_t facets = m->K.coface_at[k][cell + 1] - m->K.coface_at[k][cell];
    uint32_t *ring = lua_newuserdatauv(L, (facets + 1) * sizeof *ring, 0), length;
    const dm_ring_kind kind = dm_ring(ring, &length, &m->K, cell);
    if (kind != DM_RING_CLOSED)
        luaL_error(L,
                   kind == DM_RING_BOUNDARY
                       ? "cell %d of degree %d, %s, lies on the boundary: there is no loop of "
                         "top cells round it, and no curvature"
                       : "round cell %d of degree %d, %s, the top cells make no single loop: "
                         "the mesh is no manifold there",
                   (int)cell + 1, (int)k, dml_pushface(L, &m->K, k, cell));
    lua_createtable(L, (int)length, 0);
    dml_setresult(L);
    for (uint32_t i = 0; i < length; i++) {
        lua_pushinteger(L, (lua_Integer)ring[i] + 1);
        lua_rawseti(L, -2, (lua_Integer)i + 1);
    }
    return 1;
}

/* frames at arg, n n numbers a top cell, or nothing; the rule behind it */
static dm_levi_civita read_connection(lua_State *L, int arg, const dml_mesh *m) {
    const uint32_t n = m->K.n;
    const int32_t numbers = (int32_t)(m->K.count[n] * n * n);
    dml_needmetric(L, m);
    return (dm_levi_civita){
        .K = &m->K,
        .metric = &m->metric,
        .turn =
            lua_isnoneornil(L, arg) ? NULL : dml_numbersat(L, arg, "n n numbers a cell", numbers),
        .rule = lua_toboolean(L, arg + 1) ? DM_BY_NORMAL : DM_BY_FACE,
    };
}

/* K:frame_rotation(i, j [, frames [, printed]]) */
static int mesh_frame_rotation(lua_State *L) {
    const dml_mesh *m = check(L);
    const uint32_t n = m->K.n, i = check_cell(L, 2, m, n), j = check_cell(L, 3, m, n);
    const dm_levi_civita c = read_connection(L, 4, m);
    double *R = dml_pushmatrix(L, n, n);
    if (dm_levi_civita_rotation(R, &c, i, j) != DM_OK)
        luaL_error(L, "the cells %d and %d are no neighbours: they share no face of degree %d",
                   (int)i + 1, (int)j + 1, (int)n - 1);
    return 1;
}

/* K:frame_places(cell [, frames]) */
static int mesh_frame_places(lua_State *L) {
    const dml_mesh *m = check(L);
    const uint32_t n = m->K.n, cell = check_cell(L, 2, m, n);
    const dm_levi_civita c = read_connection(L, 3, m);
    dm_levi_civita_frame(dml_pushmatrix(L, n + 1, n), &c, cell);
    return 1;
}

static const dml_row mesh_methods[] =
    {{"deficits", mesh_deficits,
      "K:deficits() -> list of numbers or false\n"
      "2 pi - the sum of the angles of the top cells at every cell of codimension 2; false at the "
      "boundary. On a surface they are the curvatures of the vertices. Raises where K is no "
      "manifold."},
     {"dual_ring", mesh_dual_ring,
      "K:dual_ring(cell) -> list of top cells\n"
      "The dual loop round a cell of codimension 2, from the top cell with the least number on, in "
      "the sense of the orientation of K. Raises at the boundary."},
     {"frame_rotation", mesh_frame_rotation,
      "K:frame_rotation(i, j [, frames [, printed]]) -> dm.matrix, n x n\n"
      "The rotation from the frame of top cell i to that of its neighbour j; frames: n n numbers a "
      "cell, the axes of its frame as columns in the cell's own one; printed = true: the least "
      "rotation of the normals."},
     {"frame_places", mesh_frame_places,
      "K:frame_places(cell [, frames]) -> dm.matrix, n + 1 x n\n"
      "The vertices of a top cell in its frame, a row each, the first at 0."},
     {NULL, NULL, NULL}};

static const dml_extension more[] = {{DML_MESH, mesh_methods}, {NULL, NULL}};

const dml_class dml_class_levi_civita = {
    .more = more,
};
