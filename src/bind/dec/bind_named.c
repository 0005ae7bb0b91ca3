/* bind_named.c - arrays of meshes by name that are made in C: large ones cost little beside their
 * mesh. lua/dm/dec/named.lua knows the names. */
#include "bind/core/bind.h"
#include "bind/value/array.h"
#include "dec/named/icosphere.h"
#include "dec/named/tiling.h"

#include <string.h>

/* numbers of vertices, from 1 */
static void push_ids(lua_State *L, const uint32_t *vertex, size_t count) {
    double *out = dml_pushvector(L, (uint32_t)count);
    for (size_t i = 0; i < count; i++) out[i] = vertex[i] + 1.0;
}

static int named_icosphere(lua_State *L) {
    dm_icosphere sphere;
    const lua_Integer splits = dml_checkinteger(L, 1);
    if (splits < 0 || splits > DM_ICOSPHERE_MOST)
        luaL_error(L, "dm.mesh: icosphere must be from 0 to %d (got %I)", DM_ICOSPHERE_MOST,
                   splits);
    const dm_status status =
        dm_icosphere_make(&sphere, dml_pusharena(L), (uint32_t)splits, &dml_stop);
    if (status == DM_STOPPED) dml_checkstop(L);
    if (status != DM_OK) luaL_error(L, "dm.mesh: %s", dm_status_text(status));
    push_ids(L, sphere.face, (size_t)sphere.faces * 3);
    memcpy(dml_pushmatrix(L, sphere.vertices, 3), sphere.point,
           (size_t)sphere.vertices * 3 * sizeof *sphere.point);
    return 2;
}

/* ---- tilings ---- */

/* a list of whole numbers from `least` at arg; how many, at most `most` */
static uint32_t read_list(lua_State *L, int arg, uint32_t *out, uint32_t most, lua_Integer least) {
    luaL_checktype(L, arg, LUA_TTABLE);
    const lua_Integer count = luaL_len(L, arg);
    luaL_argcheck(L, count >= 1 && count <= most, arg, "a list of whole numbers is needed");
    for (lua_Integer i = 1; i <= count; i++) {
        lua_geti(L, arg, i);
        int whole;
        const lua_Integer x = dml_tointegerx(L, -1, &whole);
        luaL_argcheck(L, whole, arg, "a list of whole numbers is needed");
        luaL_argcheck(L, x >= least && x < INT32_MAX, arg, "a number is out of range");
        out[i - 1] = (uint32_t)x;
        lua_pop(L, 1);
    }
    return (uint32_t)count;
}

/* product of a list, or 0 where it is too large for an array */
static uint32_t product_of(const uint32_t *x, uint32_t count, uint32_t factor) {
    uint64_t product = factor;
    for (uint32_t i = 0; i < count; i++) {
        product *= x[i];
        if (product >= INT32_MAX) return 0;
    }
    return (uint32_t)product;
}

/* cells and vertices of every axis, at 1 and 2 */
static void read_box(lua_State *L, dm_tiling *t) {
    t->axes = read_list(L, 1, t->cells, DM_TILING_AXES, 1);
    luaL_argcheck(L, read_list(L, 2, t->along, DM_TILING_AXES, 1) == t->axes, 2,
                  "as many numbers as axes are needed");
    if (!product_of(t->along, t->axes, t->axes))
        luaL_error(L, "dm.mesh: too many vertices for a mesh");
}

/* cells, vertices, pattern [, turn] -> vector of ids */
static int named_tiling(lua_State *L) {
    enum { MOST = 1 << 12 };
    dm_tiling t = {.turn = (uint32_t)dml_optinteger(L, 4, 0)};
    read_box(L, &t);
    uint32_t *corner = lua_newuserdatauv(L, MOST * sizeof *corner, 0);
    const uint32_t count = read_list(L, 3, corner, MOST, 0);
    luaL_argcheck(L, count % t.axes == 0, 3, "a list of offsets along every axis is needed");
    t.corner = corner;
    t.corners = count / t.axes;
    const uint32_t total = product_of(t.cells, t.axes, t.corners);
    if (!total) luaL_error(L, "dm.mesh: too many simplices for a mesh");
    uint32_t *vertex = lua_newuserdatauv(L, total * sizeof *vertex, 0);
    if (!dm_tiling_fill(vertex, &t, &dml_stop)) dml_checkstop(L);
    push_ids(L, vertex, total);
    return 1;
}

/* cells, vertices -> matrix of points */
static int named_lattice(lua_State *L) {
    dm_tiling t = {.turn = 0};
    read_box(L, &t);
    dm_tiling_points(dml_pushmatrix(L, product_of(t.along, t.axes, 1), t.axes), &t);
    return 1;
}

static const dml_row functions[] =
    {{"icosphere", named_icosphere,
      "core.icosphere(s) -> dm.vector, dm.matrix\n"
      "Vertex numbers of the triangles and points of dm.mesh{icosphere = s}."},
     {"tiling", named_tiling,
      "core.tiling(cells, vertices, offsets [, turn]) -> dm.vector\n"
      "Vertex numbers of simplices that are the same in every cell of a box: cells[a] cells and "
      "vertices[a] vertices along axis a, numbered along axis 1 first; offsets of the corners of "
      "all simplices of one cell from its first vertex, a number for every axis, taken modulo "
      "vertices[a]; a way round axis 2 adds turn along axis 1."},
     {"lattice", named_lattice,
      "core.lattice(cells, vertices) -> dm.matrix\n"
      "The points of the vertices of such a box, of side 1."},
     {NULL, NULL, NULL}};

const dml_class dml_class_named = {.functions = functions};
