/* bind_mesh.c - `dm.mesh`: what a script asks a complex. */
#include "bind/dec/bind_mesh.h"
#include "bind/value/array.h"
#include "dec/orientation.h"
#include "dec/parts.h"
#include "dec/wedge.h"

#include <math.h>
#include <string.h>

dml_mesh *dml_checkmesh(lua_State *L, int arg) {
    return luaL_checkudata(L, arg, DML_MESH);
}

uint32_t dml_checkdegree(lua_State *L, int arg, const dml_mesh *m) {
    const lua_Integer k = dml_checkinteger(L, arg);
    if (k < 0 || k > m->K.n)
        luaL_argerror(L, arg,
                      lua_pushfstring(L, "a degree from 0 to %d is needed, got %I", (int)m->K.n,
                                      k));
    return (uint32_t)k;
}

void dml_needorientation(lua_State *L, const dml_mesh *m) {
    static const char GOES_ON[] = "d, Betti numbers and Laplacians go on";
    const uint32_t n = m->K.n, facet = dm_complex_crowded(&m->K);
    if (m->K.orientation) return;
    if (facet == UINT32_MAX)
        luaL_error(L,
                   "the mesh is not orientable: top forms are no functions, dual cells have no "
                   "directions; %s",
                   GOES_ON);
    luaL_error(L,
               "the mesh is not orientable: it is no manifold at %s, a face of %d cells of degree "
               "%d; %s",
               dml_pushface(L, &m->K, n - 1, facet),
               (int)(m->K.coface_at[n - 1][facet + 1] - m->K.coface_at[n - 1][facet]), (int)n,
               GOES_ON);
}

void dml_needmetric(lua_State *L, const dml_mesh *m) {
    if (!m->measured)
        luaL_error(L, "this mesh has no metric: make it with points = or lengths =; d, boundaries "
                      "and homology work without");
}

/* Arguments of all methods: the mesh at 1, the degree at 2, what is asked of it behind. */
static int mesh_count(lua_State *L) {
    const dml_mesh *m = dml_checkmesh(L, 1);
    lua_pushinteger(L, m->K.count[dml_checkdegree(L, 2, m)]);
    return 1;
}

/* A table of tables: ids of a script begin at 1, those of the complex at 0. */
static int mesh_simplices(lua_State *L) {
    const dml_mesh *m = dml_checkmesh(L, 1);
    const uint32_t k = dml_checkdegree(L, 2, m);
    uint32_t room[DM_DIMENSION + 1];
    lua_createtable(L, (int)m->K.count[k], 0);
    dml_setresult(L);
    for (uint32_t i = 0; i < m->K.count[k]; i++) {
        const uint32_t *v = dm_complex_vertices(&m->K, k, i, room);
        lua_createtable(L, (int)k + 1, 0);
        for (uint32_t j = 0; j <= k; j++) {
            lua_pushinteger(L, (lua_Integer)v[j] + 1);
            lua_rawseti(L, -2, (lua_Integer)j + 1);
        }
        lua_rawseti(L, -2, (lua_Integer)i + 1);
    }
    return 1;
}

/* A copy: the mesh itself never changes. */
static int mesh_points(lua_State *L) {
    const dml_mesh *m = dml_checkmesh(L, 1);
    if (!m->points) luaL_error(L, "this mesh has no points: it is made of lengths, or of neither");
    memcpy(dml_pushmatrix(L, m->K.count[0], m->ambient), m->points,
           (size_t)m->K.count[0] * m->ambient * sizeof *m->points);
    return 1;
}

/* a copy of `count` numbers */
static int push_numbers(lua_State *L, const double *x, uint32_t count) {
    memcpy(dml_pushvector(L, count), x, count * sizeof *x);
    return 1;
}

/* stack: mesh, k */
static int mesh_volume(lua_State *L) {
    const dml_mesh *m = dml_checkmesh(L, 1);
    const uint32_t k = dml_checkdegree(L, 2, m);
    dml_needmetric(L, m);
    return push_numbers(L, m->metric.volume[k], m->K.count[k]);
}

static int mesh_dual_volume(lua_State *L) {
    const dml_mesh *m = dml_checkmesh(L, 1);
    const uint32_t k = dml_checkdegree(L, 2, m);
    dml_needmetric(L, m);
    return push_numbers(L, m->metric.dual[k], m->K.count[k]);
}

/* the cell of degree k at arg, from 0 */
static uint32_t check_cell(lua_State *L, int arg, const dml_mesh *m, uint32_t k) {
    const lua_Integer i = dml_checkinteger(L, arg);
    if (i < 1 || i > m->K.count[k])
        luaL_argerror(L, arg,
                      lua_pushfstring(L, "a cell from 1 to %d is needed, got %I",
                                      (int)m->K.count[k], i));
    return (uint32_t)i - 1;
}

/* numbers of cells, from 1 */
static int push_ids(lua_State *L, const uint32_t *id, uint32_t count) {
    lua_createtable(L, (int)count, 0);
    dml_setresult(L);
    for (uint32_t j = 0; j < count; j++) {
        lua_pushinteger(L, (lua_Integer)id[j] + 1);
        lua_rawseti(L, -2, (lua_Integer)j + 1);
    }
    return 1;
}

/* stack: mesh, k, cell */
static int mesh_faces(lua_State *L) {
    const dml_mesh *m = dml_checkmesh(L, 1);
    const uint32_t k = dml_checkdegree(L, 2, m), i = check_cell(L, 3, m, k);
    return push_ids(L, k ? m->K.face[k] + (size_t)i * (k + 1) : NULL, k ? k + 1 : 0);
}

static int mesh_cofaces(lua_State *L) {
    const dml_mesh *m = dml_checkmesh(L, 1);
    const uint32_t k = dml_checkdegree(L, 2, m), i = check_cell(L, 3, m, k);
    if (k == m->K.n) return push_ids(L, NULL, 0);
    const uint32_t from = m->K.coface_at[k][i];
    return push_ids(L, m->K.coface[k] + from, m->K.coface_at[k][i + 1] - from);
}

/* the number of the cell with these vertices and the sign of their order */
static int mesh_find(lua_State *L) {
    const dml_mesh *m = dml_checkmesh(L, 1);
    uint32_t tuple[DM_DIMENSION + 1];
    int sign = 1;
    const long length = dml_length(L, 2);
    if (!lua_istable(L, 2) && !dml_toarray(L, 2, 1)) luaL_typeerror(L, 2, "list of vertices");
    if (length < 1 || length > (long)m->K.n + 1) return 0;
    for (uint32_t i = 0; i < (uint32_t)length; i++) {
        lua_geti(L, 2, (lua_Integer)i + 1);
        int is_whole;
        const lua_Integer id = dml_tointegerx(L, -1, &is_whole);
        if (!is_whole)
            luaL_error(L, "a vertex is a whole number (got %s)", luaL_tolstring(L, -1, NULL));
        if (id < 1 || id > m->K.count[0]) return 0;
        uint32_t j = i;
        for (; j > 0 && tuple[j - 1] > (uint32_t)id - 1; j--) tuple[j] = tuple[j - 1], sign = -sign;
        tuple[j] = (uint32_t)id - 1;
        lua_pop(L, 1);
    }
    const uint32_t cell = dm_complex_find(&m->K, (uint32_t)length - 1, tuple);
    if (cell == UINT32_MAX) return 0;
    lua_pushinteger(L, (lua_Integer)cell + 1);
    lua_pushinteger(L, sign);
    return 2;
}

/* coherent signs of the top cells */
static int mesh_orientation(lua_State *L) {
    const dml_mesh *m = dml_checkmesh(L, 1);
    const uint32_t count = m->K.count[m->K.n];
    if (!m->K.orientation) return 0;
    double *out = dml_pushvector(L, count);
    for (uint32_t i = 0; i < count; i++) out[i] = m->K.orientation[i];
    return 1;
}

/* x with the signs of the top cells: between values about ascending vertices and functions */
static int mesh_oriented(lua_State *L) {
    const dml_mesh *m = dml_checkmesh(L, 1);
    const uint32_t count = m->K.count[m->K.n];
    dml_needorientation(L, m);
    double *x = lua_newuserdatauv(L, ((size_t)count + 1) * sizeof *x, 0);
    dml_vectorarg(L, 2, "the values on top cells", x, count);
    double *out = dml_pushvector(L, count);
    for (uint32_t i = 0; i < count; i++) out[i] = m->K.orientation[i] * x[i];
    return 1;
}

/* d x, and d^T x */
static int mesh_coboundary(lua_State *L) {
    const dml_mesh *m = dml_checkmesh(L, 1);
    const uint32_t k = dml_checkdegree(L, 2, m), above = k < m->K.n ? m->K.count[k + 1] : 0;
    double *x = lua_newuserdatauv(L, ((size_t)m->K.count[k] + 1) * sizeof *x, 0);
    dml_vectorarg(L, 3, "the values of a cochain", x, m->K.count[k]);
    double *out = dml_pushvector(L, above);
    for (uint32_t i = 0; i < above; i++) {
        const uint32_t *face = m->K.face[k + 1] + (size_t)i * (k + 2);
        for (uint32_t j = 0; j < k + 2; j++) out[i] += j % 2 ? -x[face[j]] : x[face[j]];
    }
    return 1;
}

/* stack: mesh, k, values on k-cells; result: on (k - 1)-cells */
static int mesh_boundary_sum(lua_State *L) {
    const dml_mesh *m = dml_checkmesh(L, 1);
    const uint32_t k = dml_checkdegree(L, 2, m);
    double *x = lua_newuserdatauv(L, ((size_t)m->K.count[k] + 1) * sizeof *x, 0);
    dml_vectorarg(L, 3, "the values of a cochain", x, m->K.count[k]);
    double *out = dml_pushvector(L, k ? m->K.count[k - 1] : 0);
    for (uint32_t i = 0; k && i < m->K.count[k]; i++) {
        const uint32_t *face = m->K.face[k] + (size_t)i * (k + 1);
        for (uint32_t j = 0; j <= k; j++) out[face[j]] += j % 2 ? -x[i] : x[i];
    }
    return 1;
}

/* which ratio a call of K:star_values asks for */
static int is_to_dual(lua_State *L, int arg) {
    static const char *const names[] = {"dual", "primal", NULL};
    return luaL_checkoption(L, arg, "dual", names) == 0;
}

/* stack: mesh, k, values, "dual" or "primal", pinv; no sign of the orientation is in it */
static int mesh_star_values(lua_State *L) {
    const dml_mesh *m = dml_checkmesh(L, 1);
    const uint32_t k = dml_checkdegree(L, 2, m), count = m->K.count[k];
    const int to_dual = is_to_dual(L, 4), pinv = lua_toboolean(L, 5);
    dml_needmetric(L, m);
    double *x = lua_newuserdatauv(L, ((size_t)count + 1) * sizeof *x, 0);
    dml_vectorarg(L, 3, "the values of a form", x, count);
    double *out = dml_pushvector(L, count);
    const double *volume = m->metric.volume[k], *dual = m->metric.dual[k];
    const double sign = k * (m->K.n - k) % 2 ? -1.0 : 1.0;
    double largest = 0.0;
    for (uint32_t i = 0; i < count; i++) largest = fmax(largest, fabs(dual[i]));
    for (uint32_t i = 0; i < count; i++) {
        const int none = fabs(dual[i]) < 1e-12 * largest;
        if (to_dual)
            out[i] = dual[i] / volume[i] * x[i];
        else if (!none)
            out[i] = sign * volume[i] / dual[i] * x[i];
        else if (!pinv)
            luaL_error(L,
                       "zero dual volume at simplex %s: its star has no inverse; give pinv = true "
                       "for 0 there, or dual = \"barycentric\" to the mesh",
                       dml_pushface(L, &m->K, k, i));
    }
    return 1;
}

/* a ^ b of plain values */
static int mesh_wedge_values(lua_State *L) {
    static const char *const names[] = {"natural", "metric", "cup", NULL};
    const dml_mesh *m = dml_checkmesh(L, 1);
    const uint32_t k = dml_checkdegree(L, 2, m), l = dml_checkdegree(L, 4, m);
    const dm_wedge_rule rule = (dm_wedge_rule)luaL_checkoption(L, 6, "natural", names);
    if (k + l > m->K.n)
        luaL_error(L, "a product of degree %d is 0 on a mesh of dimension %d", (int)(k + l),
                   (int)m->K.n);
    if (rule == DM_WEDGE_METRIC) dml_needmetric(L, m);
    double *a = lua_newuserdatauv(L, ((size_t)m->K.count[k] + 1) * sizeof *a, 0);
    double *b = lua_newuserdatauv(L, ((size_t)m->K.count[l] + 1) * sizeof *b, 0);
    dml_vectorarg(L, 3, "the values of a form", a, m->K.count[k]);
    dml_vectorarg(L, 5, "the values of a form", b, m->K.count[l]);
    double *out = dml_pushvector(L, m->K.count[k + l]);
    dm_wedge(out, &m->K, &m->metric, rule, k, a, l, b);
    return 1;
}

/* "mesh of dimension 2: 162, 480, 320 cells; orientable, chi 2" */
static int mesh_text(lua_State *L) {
    const dml_mesh *m = dml_checkmesh(L, 1);
    luaL_Buffer b;
    luaL_buffinit(L, &b);
    lua_pushfstring(L, "mesh of dimension %d: ", (int)m->K.n);
    luaL_addvalue(&b);
    for (uint32_t k = 0; k <= m->K.n; k++) {
        lua_pushfstring(L, k ? ", %d" : "%d", (int)m->K.count[k]);
        luaL_addvalue(&b);
    }
    lua_pushfstring(L, " cells; %sorientable, chi %d%s", m->K.orientation ? "" : "not ",
                    (int)dm_complex_euler(&m->K), m->measured ? "" : ", without a metric");
    luaL_addvalue(&b);
    if (m->folds) luaL_addstring(&b, ", folded");
    luaL_pushresult(&b);
    return 1;
}

/* found when first asked for */
static int push_manifold(lua_State *L, dml_mesh *m) {
    if (m->manifold < 0) m->manifold = dm_parts_manifold(&m->K, dml_pusharena(L));
    if (m->manifold < 0) luaL_error(L, "not enough memory");
    lua_pushboolean(L, m->manifold);
    return 1;
}

/* K.dimension and its like; what is asked of a mesh without points or metric is nil. */
static int mesh_field(lua_State *L) {
    dml_mesh *m = dml_checkmesh(L, 1);
    const char *key = luaL_checkstring(L, 2);
    if (strcmp(key, "dimension") == 0)
        lua_pushinteger(L, m->K.n);
    else if (strcmp(key, "ambient") == 0 && m->points)
        lua_pushinteger(L, m->ambient);
    else if (strcmp(key, "euler") == 0)
        return dml_mesh_pusheuler(L, m);
    else if (strcmp(key, "orientable") == 0)
        lua_pushboolean(L, m->K.orientation != NULL);
    else if (strcmp(key, "manifold") == 0)
        return push_manifold(L, m);
    else if (strcmp(key, "dual") == 0 && m->measured)
        lua_pushstring(L, m->metric.centres == DM_BARYCENTRES ? "barycentric" : "circumcentric");
    else if (strcmp(key, "pure") == 0)
        lua_pushboolean(L, m->K.pure);
    else if (strcmp(key, "measured") == 0)
        lua_pushboolean(L, m->measured);
    else if (strcmp(key, "bytes") == 0)
        lua_pushinteger(L, (lua_Integer)m->bytes);
    else
        return 0;
    return 1;
}

static const dml_row methods[] = {
    {"count", mesh_count, "K:count(k) -> number\nHow many cells of degree k there are."},
    {"simplices", mesh_simplices,
     "K:simplices(k) -> table of lists of vertices\n"
     "The cells of degree k as ascending lists of vertex numbers, from 1, in lexicographic order: "
     "the order of all that lives on them."},
    {"points", mesh_points,
     "K:points() -> dm.matrix\nThe points of the vertices, a row each. Raises where there are "
     "none."},
    {"volume", mesh_volume,
     "K:volume(k) -> dm.vector\n"
     "The volumes of the cells of degree k, in units of length to the power k; of vertices 1."},
    {"dual_volume", mesh_dual_volume,
     "K:dual_volume(k) -> dm.vector\n"
     "The signed volumes of the dual cells (of degree n - k) of the cells of degree k: zero or "
     "negative where a centre lies outside of its simplex (Leok 3.3)."},
    {"faces", mesh_faces,
     "K:faces(k, i) -> list of cell numbers\n"
     "The k + 1 faces of cell i of degree k: face j is opposite to its vertex j and stands in its "
     "boundary with the sign (-1)^(j - 1)."},
    {"cofaces", mesh_cofaces,
     "K:cofaces(k, i) -> list of cell numbers\n"
     "The cells of degree k + 1 that have cell i of degree k as a face, ascending."},
    {"find", mesh_find,
     "K:find{i, j, ...} -> number, sign   or nothing\n"
     "The number of the cell with these vertices, and 1 or -1: the parity of their order."},
    {"orientation", mesh_orientation,
     "K:orientation() -> dm.vector   or nothing\n"
     "1 or -1 for every top cell: the coherent orientation against the ascending order."},
    {"oriented", mesh_oriented,
     "K:oriented(x) -> dm.vector\n"
     "Values on the top cells times the signs of K:orientation(): what is about ascending vertices "
     "becomes a function, and back. Raises where the mesh is not orientable."},
    {"coboundary", mesh_coboundary,
     "K:coboundary(k, x) -> dm.vector\n"
     "d x of plain values x on the cells of degree k, on those of degree k + 1."},
    {"boundary_sum", mesh_boundary_sum,
     "K:boundary_sum(k, x) -> dm.vector\n"
     "The transpose of d: values on the cells of degree k, with signs, to their faces."},
    {"star_values", mesh_star_values,
     "K:star_values(k, x, \"dual\" | \"primal\" [, pinv]) -> dm.vector\n"
     "Plain values x on the cells of degree k to their duals, by |*s| / |s|, or back, by (-1)^(k "
     "(n - k)) |s| / |*s| (Leok, Def 3.18), without signs of orientation. Raises where a dual "
     "volume is below 1e-12 of the largest, unless pinv: 0 there."},
    {"wedge_values", mesh_wedge_values,
     "K:wedge_values(k, a, l, b [, rule]) -> dm.vector\n"
     "The product of plain values a on k-cells and b on l-cells, on (k + l)-cells; rule "
     "\"natural\" "
     "(the default), \"metric\" or \"cup\": see form:wedge."},
    {NULL, NULL, NULL}};

static const dml_row meta[] = {{"__tostring", mesh_text, NULL}, {NULL, NULL, NULL}};

static const dml_row functions[] = {
    {"complex", dml_mesh_new,
     "dm.complex{simplices=, points= | lengths=, dual=, vertices=, degree=} -> dm.mesh\n"
     "The mesh with these simplices and all their faces: simplices is a list of lists of vertex "
     "numbers from 1, or a dm.vector of them with degree =. lengths: a number, a list in the order "
     "of the edges, or a function(i, j), i < j. dual = \"circumcentric\" (the default) or "
     "\"barycentric\". dm.mesh knows meshes by name besides. Raises on repeated vertices, "
     "duplicate and degenerate simplices and impossible lengths, naming the simplex (Leok 3.3, "
     "3.4)."},
    {NULL, NULL, NULL}};

const dml_class dml_class_mesh = {
    .name = DML_MESH,
    .doc = "dm.mesh: a simplicial complex of dimension 1 to 8, with volumes and signed duals, made "
           "by dm.mesh{...}\n"
           "fields: dimension, ambient (of its points), euler, orientable, manifold, pure, "
           "measured, dual (\"circumcentric\", \"barycentric\"), bytes",
    .meta = meta,
    .methods = methods,
    .field = mesh_field,
    .functions = functions,
};
