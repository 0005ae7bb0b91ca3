/* bind_parts.c - parts of a mesh and what it is worth: centres, boundary, stars, components,
 * quality, flips. Lua modules make meshes of parts. Arguments: the mesh at 1, a degree at 2. */
#include "bind/dec/bind_mesh.h"
#include "bind/value/value.h"
#include "dec/cell.h"
#include "dec/parts.h"
#include "dec/quality.h"

#include <string.h>

static void *work(lua_State *L, size_t count, size_t size) {
    return lua_newuserdatauv(L, (count + 1) * size, 0);
}

/* so many marks are enough for any degree */
static uint32_t most_cells(const dml_mesh *m) {
    uint32_t most = 0;
    for (uint32_t k = 0; k <= m->K.n; k++) most = m->K.count[k] > most ? m->K.count[k] : most;
    return most;
}

/* the numbers of marked cells, from 1 */
static int push_marked(lua_State *L, const uint8_t *mark, uint32_t count, uint32_t marked) {
    lua_createtable(L, (int)marked, 0);
    dml_setresult(L);
    for (uint32_t i = 0, at = 0; i < count; i++) {
        if (!mark[i]) continue;
        lua_pushinteger(L, (lua_Integer)i + 1);
        lua_rawseti(L, -2, (lua_Integer)++at);
    }
    return 1;
}

/* stack: mesh, k */
static int mesh_boundary_cells(lua_State *L) {
    const dml_mesh *m = dml_checkmesh(L, 1);
    const uint32_t k = dml_checkdegree(L, 2, m), most = most_cells(m);
    uint8_t *mark = work(L, most, 1), *other = work(L, most, 1);
    const uint32_t marked = dm_parts_boundary(mark, other, &m->K, k);
    return push_marked(L, mark, marked ? m->K.count[k] : 0, marked);
}

/* stack: mesh, k, cell, degree d >= k of the cells that are asked for */
static int mesh_star_cells(lua_State *L) {
    const dml_mesh *m = dml_checkmesh(L, 1);
    const uint32_t k = dml_checkdegree(L, 2, m), d = dml_checkdegree(L, 4, m);
    const lua_Integer cell = dml_checkinteger(L, 3);
    luaL_argcheck(L, cell >= 1 && cell <= m->K.count[k], 3, "there is no such cell");
    luaL_argcheck(L, d >= k, 4, "a degree not below that of the cell is needed");
    uint8_t *mark = work(L, most_cells(m), 1), *other = work(L, most_cells(m), 1);
    const uint32_t marked = dm_parts_star(mark, other, &m->K, k, (uint32_t)cell - 1, d);
    return push_marked(L, mark, m->K.count[d], marked);
}

/* c = sum of lambda_j p_j, lambda from lengths alone */
static int mesh_circumcentres(lua_State *L) {
    const dml_mesh *m = dml_checkmesh(L, 1);
    const uint32_t k = dml_checkdegree(L, 2, m), N = m->ambient;
    dm_cell_metric c;
    dml_needmetric(L, m);
    if (!m->points) luaL_error(L, "this mesh has no points: its centres have no places");
    double *out = dml_pushmatrix(L, m->K.count[k], N);
    uint32_t room[DM_DIMENSION + 1];
    for (uint32_t i = 0; i < m->K.count[k]; i++) {
        const uint32_t *v = dm_complex_vertices(&m->K, k, i, room);
        dm_metric_simplex(&c, &m->K, &m->metric, k, i);
        for (uint32_t j = 0; j <= k; j++)
            for (uint32_t x = 0; x < N; x++)
                out[(size_t)i * N + x] += c.centre[j] * m->points[(size_t)v[j] * N + x];
    }
    return 1;
}

/* two passes: how many components, then the vertices of each in a list of its own */
static int mesh_components(lua_State *L) {
    const dml_mesh *m = dml_checkmesh(L, 1);
    const uint32_t vertices = m->K.count[0];
    uint32_t *component = work(L, vertices, sizeof *component);
    uint32_t *parent = work(L, vertices, sizeof *parent);
    const uint32_t count = dm_complex_components(&m->K, component, parent);
    memset(parent, 0, vertices * sizeof *parent); /* now: vertices found of each */
    lua_createtable(L, (int)count, 0);
    dml_setresult(L);
    for (uint32_t c = 0; c < count; c++) {
        lua_newtable(L);
        lua_rawseti(L, -2, (lua_Integer)c + 1);
    }
    for (uint32_t v = 0; v < vertices; v++) {
        lua_rawgeti(L, -1, (lua_Integer)component[v] + 1);
        lua_pushinteger(L, (lua_Integer)v + 1);
        lua_rawseti(L, -2, (lua_Integer)++parent[component[v]]);
        lua_pop(L, 1);
    }
    return 1;
}

/* counts by degree, from 0 */
static void set_counts(lua_State *L, const char *key, const uint32_t *count, uint32_t n) {
    lua_createtable(L, (int)n, 1);
    for (uint32_t k = 0; k <= n; k++) {
        lua_pushinteger(L, count[k]);
        lua_rawseti(L, -2, (lua_Integer)k);
    }
    dml_setresult(L);
    lua_setfield(L, -2, key);
}

/* counts, and what follows from them */
static int mesh_quality(lua_State *L) {
    const dml_mesh *m = dml_checkmesh(L, 1);
    dm_quality q;
    dml_needmetric(L, m);
    if (dm_quality_measure(&q, &m->K, &m->metric, &dml_stop) == DM_STOPPED) dml_checkstop(L);
    lua_createtable(L, 0, 5);
    dml_setresult(L);
    set_counts(L, "negative", q.negative, m->K.n);
    set_counts(L, "zero", q.zero, m->K.n);
    lua_pushnumber(L, q.least);
    lua_setfield(L, -2, "least");
    lua_pushboolean(L, q.least > 1e-12);
    lua_setfield(L, -2, "well_centred");
    lua_pushboolean(L, q.crossed == 0);
    lua_setfield(L, -2, "delaunay");
    return 1;
}

/* counted when the mesh was made */
static int mesh_folds(lua_State *L) {
    const dml_mesh *m = dml_checkmesh(L, 1);
    lua_pushinteger(L, m->folds);
    if (!m->folds) return 1;
    dml_pushface(L, &m->K, m->K.n - 1, m->fold);
    return 2;
}

/* the triangles and squared lengths after the flips, for mesh:make_delaunay */
static int mesh_flip(lua_State *L) {
    const dml_mesh *m = dml_checkmesh(L, 1);
    uint32_t ends[2];
    dml_needmetric(L, m);
    if (m->K.n != 2) luaL_error(L, "only surfaces are flipped: the mesh has dimension %d", m->K.n);
    if (!m->K.orientation)
        luaL_error(L, "flips need an orientable surface; dual = \"barycentric\" makes its stars "
                      "positive");
    const size_t count = m->K.count[2];
    dm_triangles t = {.vertex = work(L, count, sizeof *t.vertex)};
    t.length2 = work(L, count, sizeof *t.length2);
    t.beside = work(L, count, sizeof *t.beside);
    uint32_t *stack = work(L, 3 * count, sizeof *stack);
    dm_triangles_read(&t, &m->K, m->metric.length2);
    const dm_status status = dm_triangles_flip(&t, stack, &dml_stop, ends);
    dml_checkstop(L);
    if (status != DM_OK)
        luaL_error(L,
                   "the Delaunay triangulation of this surface is no simplicial complex: a second "
                   "edge %s would be in it; split triangles there, or take dual = \"barycentric\"",
                   dml_pushcell(L, ends, 2));
    double *vertex = dml_pushvector(L, 3 * t.triangles);
    double *length2 = dml_pushvector(L, 3 * t.triangles);
    for (size_t i = 0; i < 3 * count; i++) {
        vertex[i] = t.vertex[i / 3][i % 3] + 1.0;
        length2[i] = t.length2[i / 3][i % 3];
    }
    lua_pushinteger(L, t.flips);
    return 3;
}

static const dml_row methods[] = {
    {"boundary_cells", mesh_boundary_cells,
     "K:boundary_cells(k) -> list of cell numbers\n"
     "The cells of degree k in the boundary, ascending: the facets of one top cell only, and their "
     "faces."},
    {"star_cells", mesh_star_cells,
     "K:star_cells(k, i, d) -> list of cell numbers\n"
     "The cells of degree d >= k that have cell i of degree k as a face, or are it."},
    {"circumcentres", mesh_circumcentres,
     "K:circumcentres(k) -> dm.matrix\n"
     "The circumcentres of the cells of degree k, a row each (Leok, Def 3.5); the barycentres "
     "where "
     "the mesh takes its duals from these."},
    {"components", mesh_components,
     "K:components() -> list of lists of vertices\n"
     "The connected components, each by its vertices, ascending."},
    {"folds", mesh_folds,
     "K:folds() -> count, text of the first\n"
     "How many facets of a mesh in a space of its own dimension have both of their top cells on "
     "the "
     "same side: there a cell is turned inside out, and the mesh lies over itself. Volumes, stars "
     "and solutions are those of the folded surface then, not of what it covers."},
    {"quality", mesh_quality,
     "K:quality() -> table\n"
     "negative[k], zero[k], k from 0: how many dual volumes of cells of degree k are below 0, or 0 "
     "(below 1e-12 of the largest of that degree); well_centred: every circumcentre lies inside "
     "its "
     "simplex; least: the least barycentric coordinate of a circumcentre; delaunay: no facet "
     "between two top cells has a negative dual volume."},
    {"flip_values", mesh_flip,
     "K:flip_values() -> dm.vector, dm.vector, number\n"
     "The triangles of mesh:make_delaunay, three vertices each; the squares of the lengths of the "
     "edges opposite to these; how many flips it took."},
    {NULL, NULL, NULL}};

static const dml_extension more[] = {{DML_MESH, methods}, {NULL, NULL}};

const dml_class dml_class_parts = {.more = more};
