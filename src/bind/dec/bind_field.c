/* bind_field.c - what a script asks of fields of vectors and 1-forms, on plain values: Lua modules
 * make forms and fields of it. Fields are matrices, a row for every vertex or top cell. */
#include "bind/dec/bind_mesh.h"
#include "bind/value/array.h"
#include "dec/dual_wedge.h"
#include "dec/extrusion.h"

#include <math.h>
#include <string.h>

/* work of `size` bytes, the collector's */
static void *work(lua_State *L, size_t count, size_t size) {
    return lua_newuserdatauv(L, (count + 1) * size, 0);
}

/* the mesh at 1, which must have points */
static const dml_mesh *check_embedded(lua_State *L) {
    const dml_mesh *m = dml_checkmesh(L, 1);
    dml_needmetric(L, m);
    if (m->K.n == 0) luaL_error(L, "a mesh of single points has no fields of vectors along it");
    if (!m->points)
        luaL_error(L, "fields of vectors need points, and this mesh is made of lengths; forms go "
                      "on without");
    return m;
}

/* where a field has its vectors */
static const char *const PLACES[] = {"vertices", "cells", NULL};

/* the field whose matrix is at arg and whose place, "vertices" or "cells", behind it */
static dm_vector_field check_field(lua_State *L, int arg, const dml_mesh *m) {
    const int on_cells = luaL_checkoption(L, arg + 1, NULL, PLACES);
    const dml_array *a = dml_checkarray(L, arg, 2);
    const uint32_t rows = m->K.count[on_cells ? m->K.n : 0];
    const double *values = dml_numbersof(a);
    if (!values || a->rows != rows || a->columns != m->ambient)
        luaL_argerror(L, arg,
                      lua_pushfstring(L, "a matrix of %d x %d numbers is needed, got %s", (int)rows,
                                      (int)m->ambient, dml_shape(L, a)));
    return (dm_vector_field){on_cells, m->ambient, m->points, values};
}

/* `count` numbers of the vector or table at arg, in memory of the collector */
static double *check_values(lua_State *L, int arg, uint32_t count) {
    double *x = work(L, count, sizeof *x);
    dml_vectorarg(L, arg, "the values of a form", x, count);
    return x;
}

/* Raise for a dual volume that is divided by. */
static void refuse(lua_State *L, const dml_mesh *m, const dm_sharp_fault *fault) {
    const char *cell = dml_pushface(L, &m->K, fault->degree, fault->cell);
    luaL_error(L,
               "zero dual volume at simplex %s; dual = \"barycentric\" makes a mesh without, "
               "K:quality() counts them",
               cell);
}

/* stack: mesh, matrix, place, side; results: values, how many edges took plain means */
static int mesh_flat(lua_State *L) {
    static const char *const sides[] = {"primal", "dual", NULL};
    const dml_mesh *m = check_embedded(L);
    const dm_vector_field X = check_field(L, 2, m);
    const int to_dual = luaL_checkoption(L, 4, "primal", sides);
    uint32_t degenerate = 0;
    if (to_dual) {
        dml_needorientation(L, m);
        dm_flat_dual(dml_pushvector(L, m->K.count[m->K.n - 1]), &m->K, &m->metric, &X);
    } else {
        uint32_t *tops = work(L, m->K.count[1], sizeof *tops);
        dm_flat_primal(dml_pushvector(L, m->K.count[1]), &m->K, &m->metric, &X, tops, &degenerate);
    }
    lua_pushinteger(L, degenerate);
    return 2;
}

/* to cells by Whitney forms, to vertices by gradients or as printed */
static int sharp_primal(lua_State *L, const dml_mesh *m, int to_cells, int thesis, int pinv) {
    const uint32_t N = m->ambient, rows = m->K.count[to_cells ? m->K.n : 0];
    const double *a = check_values(L, 2, m->K.count[1]);
    double *out = dml_pushmatrix(L, rows, N);
    dm_sharp_fault fault;
    if (to_cells)
        dm_sharp_cells(out, &m->K, &m->metric, m->points, N, a);
    else if (thesis)
        dm_sharp_thesis(out, &m->K, &m->metric, m->points, N, a);
    else if (dm_sharp_vertices(out, &m->K, &m->metric, m->points, N, a, pinv, &fault) != DM_OK)
        refuse(L, m, &fault);
    return 1;
}

/* stack: mesh, values, side, place, thesis, pinv; result: a matrix, a row for each vector */
static int mesh_sharp(lua_State *L) {
    static const char *const froms[] = {"primal", "dual", NULL};
    const dml_mesh *m = check_embedded(L);
    const int from_dual = luaL_checkoption(L, 3, NULL, froms);
    const int to_cells = luaL_checkoption(L, 4, NULL, PLACES);
    const int thesis = lua_toboolean(L, 5), pinv = lua_toboolean(L, 6);
    dm_sharp_fault fault;
    if (!from_dual) return sharp_primal(L, m, to_cells, thesis, pinv);
    dml_needorientation(L, m);
    const double *b = check_values(L, 2, m->K.count[m->K.n - 1]);
    double *out = dml_pushmatrix(L, m->K.count[m->K.n], m->ambient);
    if (dm_sharp_dual(out, &m->K, &m->metric, m->points, m->ambient, b, pinv, &fault) != DM_OK)
        refuse(L, m, &fault);
    return 1;
}

/* stack: mesh, matrix, place; results: the matrix of tangent parts, the largest normal part */
static int mesh_tangent(lua_State *L) {
    const dml_mesh *m = check_embedded(L);
    const dm_vector_field X = check_field(L, 2, m);
    const uint32_t count = m->K.count[m->K.n];
    luaL_argcheck(L, X.on_cells, 3, "a field on cells is needed");
    double *out = dml_pushmatrix(L, count, X.N);
    memcpy(out, X.values, (size_t)count * X.N * sizeof *out);
    lua_pushnumber(L, dm_field_tangent(out, &m->K, &m->metric, m->points, X.N));
    return 2;
}

/* stack: mesh, matrix, place, with the flux through the boundary */
static int mesh_divergence(lua_State *L) {
    const dml_mesh *m = check_embedded(L);
    const dm_vector_field X = check_field(L, 2, m);
    const int flux = lua_toboolean(L, 4);
    dm_sharp_fault fault;
    double *out = dml_pushvector(L, m->K.count[0]);
    if (dm_divergence(out, &m->K, &m->metric, &X, flux, &fault) != DM_OK) refuse(L, m, &fault);
    return 1;
}

/* stack: mesh, k, values, matrix, place, side; results: values on (k - 1)-cells, how many of them
 * took plain means */
static int mesh_contract(lua_State *L) {
    static const char *const sides[] = {"central", "forward", "backward", NULL};
    const dml_mesh *m = check_embedded(L);
    const uint32_t k = dml_checkdegree(L, 2, m);
    const dm_vector_field X = check_field(L, 4, m);
    const dm_side side = (dm_side)luaL_checkoption(L, 6, "central", sides);
    uint32_t degenerate = 0;
    luaL_argcheck(L, k > 0, 2, "a form of degree 0 has no contraction");
    const double *a = check_values(L, 3, m->K.count[k]);
    uint32_t *counts = work(L, m->K.count[k - 1], sizeof *counts);
    double *scores = work(L, m->K.count[k - 1], sizeof *scores);
    double *out = dml_pushvector(L, m->K.count[k - 1]);
    dm_contract(out, &m->K, &m->metric, &X, k, a, side, counts, scores, &degenerate);
    lua_pushinteger(L, degenerate);
    return 2;
}

/* stack: mesh, k, values on duals of (n - k)-cells, l, values, rule */
static int mesh_dual_wedge(lua_State *L) {
    static const char *const rules[] = {"consistent", "thesis", NULL};
    const dml_mesh *m = dml_checkmesh(L, 1);
    const uint32_t n = m->K.n, k = dml_checkdegree(L, 2, m), l = dml_checkdegree(L, 4, m);
    const dm_dual_rule rule = (dm_dual_rule)luaL_checkoption(L, 6, "consistent", rules);
    dm_sharp_fault fault;
    dml_needmetric(L, m);
    dml_needorientation(L, m);
    if (k + l > n)
        luaL_error(L, "a product of degree %d is 0 on a mesh of dimension %d", (int)(k + l),
                   (int)n);
    const double *a = check_values(L, 3, m->K.count[n - k]);
    const double *b = check_values(L, 5, m->K.count[n - l]);
    double *out = dml_pushvector(L, m->K.count[n - k - l]);
    if (dm_dual_wedge(out, &m->K, &m->metric, rule, k, a, l, b, &fault) != DM_OK)
        refuse(L, m, &fault);
    return 1;
}

static const dml_row methods[] =
    {{"integrals", dml_mesh_integrals,
      "K:integrals(k, f [, dual [, order [, chart]]]) -> dm.vector\n"
      "The de Rham map on plain values: see mesh:form. f(x, y, ...) gives the components of a "
      "k-form, in increasing order of their coordinates; order: the degree of polynomials that the "
      "quadrature (Grundmann & Moeller) integrates exactly, from 1 to 21, 5 by default."},
     {"flat_values", mesh_flat,
      "K:flat_values(X, \"vertices\" | \"cells\", \"primal\" | \"dual\") -> dm.vector, number\n"
      "The 1-form of a field of vectors, a matrix with a row for every vertex or top cell: see "
      "field:flat; and the number of edges of zero dual volume, where plain means are taken."},
     {"sharp_values", mesh_sharp,
      "K:sharp_values(a, \"primal\" | \"dual\", \"vertices\" | \"cells\" [, thesis [, pinv]]) -> "
      "dm.matrix\nThe field of vectors of the values of a 1-form: see form:sharp."},
     {"tangent_values", mesh_tangent,
      "K:tangent_values(X, \"cells\") -> dm.matrix, number\n"
      "Vectors in the top cells without what points out of these cells; and the largest length "
      "that went."},
     {"divergence_values", mesh_divergence,
      "K:divergence_values(X, \"vertices\" | \"cells\" [, flux]) -> dm.vector\n"
      "The divergence at the vertices, with the flux through the boundary or without: see "
      "field:div."},
     {"contract_values", mesh_contract,
      "K:contract_values(k, a, X, \"vertices\" | \"cells\" [, side]) -> dm.vector, number\n"
      "i_X a of a primal k-form by extrusion, side \"central\", \"forward\" or \"backward\": see "
      "form:contract; and the number of cells of zero dual volume, where plain means are taken."},
     {"dual_wedge_values", mesh_dual_wedge,
      "K:dual_wedge_values(k, a, l, b [, rule]) -> dm.vector\n"
      "The product of a dual k-form and a dual l-form, rule \"consistent\" or \"thesis\": see "
      "form:wedge."},
     {NULL, NULL, NULL}};

static const dml_extension more[] = {{DML_MESH, methods}, {NULL, NULL}};

const dml_class dml_class_field = {.more = more};
