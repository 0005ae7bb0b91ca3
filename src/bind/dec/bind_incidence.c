/* bind_incidence.c - what operators of a mesh are made of: d as a matrix, masses of cells, and what
 * one number for every cell gives in other degrees. */
#include "bind/dec/bind_mesh.h"
#include "bind/dec/bind_sparse.h"
#include "bind/value/value.h"
#include "dec/incidence.h"

#include <math.h>

/* K:incidence(k) */
static int mesh_incidence(lua_State *L) {
    dm_arena *arena;
    const dml_mesh *m = dml_checkmesh(L, 1);
    const uint32_t k = dml_checkdegree(L, 2, m);
    if (k == m->K.n) luaL_argerror(L, 2, "forms of the highest degree have no d");
    dm_sparse *d = dml_newsparse(L, &arena);
    dml_sparsedone(L, dm_incidence(d, arena, &m->K, k));
    return 1;
}

/* K:boundary_marks(k) */
static int mesh_boundary_marks(lua_State *L) {
    const dml_mesh *m = dml_checkmesh(L, 1);
    const uint32_t k = dml_checkdegree(L, 2, m), count = m->K.count[k];
    unsigned char *mark = lua_newuserdatauv(L, (size_t)count + 1, 0);
    double *out = dml_pushvector(L, count);
    dm_boundary_marks(mark, &m->K, k);
    for (uint32_t i = 0; i < count; i++) out[i] = mark[i];
    return 1;
}

/* |*s| / |s|, with what is zero but for rounding as 0; how many are 0 and negative, and the first
 * of both */
static int mesh_star_weights(lua_State *L) {
    const dml_mesh *m = dml_checkmesh(L, 1);
    const uint32_t k = dml_checkdegree(L, 2, m), count = m->K.count[k];
    uint32_t zero = 0, negative = 0, first_zero = 0, first_negative = 0;
    dml_needmetric(L, m);
    const double *volume = m->metric.volume[k], *dual = m->metric.dual[k];
    double *out = dml_pushvector(L, count), largest = 0.0;
    for (uint32_t i = 0; i < count; i++) largest = fmax(largest, fabs(dual[i]));
    for (uint32_t i = count; i-- > 0;) {
        if (fabs(dual[i]) < 1e-12 * largest) {
            zero++, first_zero = i + 1;
            continue;
        }
        out[i] = dual[i] / volume[i];
        if (out[i] < 0.0) negative++, first_negative = i + 1;
    }
    lua_pushinteger(L, zero);
    lua_pushinteger(L, negative);
    lua_pushinteger(L, first_zero);
    lua_pushinteger(L, first_negative);
    return 5;
}

/* The sum over the top cells S of x_S |*s in S|, for the cells s of degree k. Shares are computed
 * anew for every top cell: keeping them would take 2^(n + 1) doubles each. */
static int mesh_weighted_dual(lua_State *L) {
    const dml_mesh *m = dml_checkmesh(L, 1);
    const uint32_t k = dml_checkdegree(L, 2, m), n = m->K.n, top = m->K.count[n];
    dml_needmetric(L, m);
    const double *x = dml_numbersat(L, 3, "a number for every top cell", (int32_t)top);
    dm_cell_metric *cell = lua_newuserdatauv(L, sizeof *cell, 0);
    double *out = dml_pushvector(L, m->K.count[k]);
    for (uint32_t i = 0; i < top; i++) {
        dm_metric_cell(cell, &m->K, &m->metric, i);
        for (uint32_t set = 1; set < 2u << n; set++) {
            uint32_t bits = 0;
            for (uint32_t b = set; b; b &= b - 1) bits++;
            if (bits == k + 1) out[dm_complex_face(&m->K, n, i, set)] += x[i] * cell->share[set];
        }
    }
    return 1;
}

/* sum over the cells s of degree k of x_s |*v in s|, for the vertices v */
static int mesh_lumped(lua_State *L) {
    const dml_mesh *m = dml_checkmesh(L, 1);
    const uint32_t k = dml_checkdegree(L, 2, m), count = m->K.count[k];
    dml_needmetric(L, m);
    const double *x = dml_numbersat(L, 3, "a number for every cell", (int32_t)count);
    dm_cell_metric *cell = lua_newuserdatauv(L, sizeof *cell, 0);
    double *out = dml_pushvector(L, m->K.count[0]);
    uint32_t room[DM_DIMENSION + 1];
    for (uint32_t i = 0; i < count; i++) {
        if (x[i] == 0.0) continue;
        const uint32_t *vertex = dm_complex_vertices(&m->K, k, i, room);
        if (k == 0)
            out[i] += x[i];
        else
            dm_metric_simplex(cell, &m->K, &m->metric, k, i);
        for (uint32_t j = 0; k && j <= k; j++) out[vertex[j]] += x[i] * cell->share[1u << j];
    }
    return 1;
}

/* the component of every vertex, from 1, and how many there are */
static int mesh_component_of(lua_State *L) {
    const dml_mesh *m = dml_checkmesh(L, 1);
    const size_t count = m->K.count[0];
    uint32_t *component = lua_newuserdatauv(L, (count + 1) * sizeof *component, 0);
    uint32_t *work = lua_newuserdatauv(L, (count + 1) * sizeof *work, 0);
    const uint32_t components = dm_complex_components(&m->K, component, work);
    double *out = dml_pushvector(L, (uint32_t)count);
    for (size_t i = 0; i < count; i++) out[i] = component[i] + 1.0;
    lua_pushinteger(L, components);
    return 2;
}

static const dml_row mesh_methods[] = {
    {"weighted_dual", mesh_weighted_dual,
     "K:weighted_dual(k, x) -> dm.vector\n"
     "The dual volumes of the cells of degree k, the part in every top cell S times x_S."},
    {"lumped", mesh_lumped,
     "K:lumped(k, x) -> dm.vector\n"
     "Densities x on the cells of degree k as loads of their vertices: x_s times what of s lies "
     "next to the vertex."},
    {"component_of", mesh_component_of,
     "K:component_of() -> dm.vector, count\n"
     "The component of every vertex, from 1 in the order of first vertices; how many there are."},
    {"incidence", mesh_incidence,
     "K:incidence(k) -> dm.sparse\n"
     "d of k-forms as a matrix of 1 and -1: a row for every (k + 1)-cell, a column for every "
     "k-cell. K:d(k) is the operator."},
    {"boundary_marks", mesh_boundary_marks,
     "K:boundary_marks(k) -> dm.vector\n"
     "1 for the cells of degree k on the boundary, 0 for the others."},
    {"star_weights", mesh_star_weights,
     "K:star_weights(k) -> dm.vector, zeros, negatives, first zero, first negative\n"
     "|*s| / |s| of the cells of degree k, exactly 0 where the dual is below 1e-12 of the largest; "
     "how many are 0 and negative, and the first cells that are."},
    {NULL, NULL, NULL}};

static const dml_extension more[] = {{DML_MESH, mesh_methods}, {NULL, NULL}};

const dml_class dml_class_incidence = {
    .more = more,
};
