/* bind_mesh.h - `dm.mesh`: a simplicial complex with its metric, as the other bindings see it. */
#ifndef DML_MESH_H
#define DML_MESH_H

#include "bind/core/bind.h"
#include "dec/complex.h"
#include "dec/metric.h"

#define DML_MESH "dm.mesh"

/* Complex and metric lie in an arena that user value 1 keeps; nothing changes after it is made. */
typedef struct {
    dm_complex K;
    dm_metric metric;
    int measured;         /* it has a metric */
    uint32_t ambient;     /* N of the points, 0: there are none */
    double *points;       /* [count[0]][ambient] */
    size_t bytes;         /* of the arena */
    int manifold;         /* it is one; -1: nobody has asked yet */
    uint32_t folds, fold; /* facets with two top cells on one side of them in R^n; one of these */
    int ringed; /* every cell of codimension 2 has one loop or fan of top cells round it */
} dml_mesh;

/* The mesh at arg; raises when it is none. */
dml_mesh *dml_checkmesh(lua_State *L, int arg);

/* The degree at arg, from 0 to the dimension; raises. */
uint32_t dml_checkdegree(lua_State *L, int arg, const dml_mesh *m);

/* Raises where the mesh has no coherent orientation, with the facet of more than two top cells
 * where that is why: (cell, dual) is to be positive. */
void dml_needorientation(lua_State *L, const dml_mesh *m);

/* Raises where the mesh has no metric. */
void dml_needmetric(lua_State *L, const dml_mesh *m);

/* dm.complex{...}: read, build, measure. */
int dml_mesh_new(lua_State *L);

/* K:integrals(k, f, dual, order, chart): the de Rham map. */
int dml_mesh_integrals(lua_State *L);

/* Push Euler's number, which can be called as the method mesh:euler (mesh_euler.c). */
int dml_mesh_pusheuler(lua_State *L, const dml_mesh *m);

/* Push "{2, 5, 9}": vertices of a cell, from 1. */
const char *dml_pushcell(lua_State *L, const uint32_t *vertex, uint32_t count);
const char *dml_pushface(lua_State *L, const dm_complex *K, uint32_t k, uint32_t cell);

#endif
