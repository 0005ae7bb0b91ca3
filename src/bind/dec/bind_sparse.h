/* bind_sparse.h - `dm.sparse`, the matrix behind an operator, as the other bindings see it. */
#ifndef DML_SPARSE_H
#define DML_SPARSE_H

#include "bind/core/bind.h"
#include "linalg/sparse/solvers.h"

#define DML_SPARSE "dm.sparse"
#define DML_FACTOR "dm.factor"

/* The matrix at arg; raises when it is none. Its arrays lie in an arena that user value 1 keeps. */
const dm_sparse *dml_checksparse(lua_State *L, int arg);

/* Push an empty matrix and give the arena for its arrays; dml_sparsedone says how making it ended:
 * it raises, or leaves the matrix alone on top. */
dm_sparse *dml_newsparse(lua_State *L, dm_arena **arena);
void dml_sparsedone(lua_State *L, dm_status status);

/* n numbers of the vector or table at arg, where they stand or in a copy that is pushed; messages
 * call it `name`. */
const double *dml_numbersat(lua_State *L, int arg, const char *name, int32_t n);

/* x = A^-1 b by a dm.factor, which was checked: for loops in C that ask it again and again.
 * Conjugate gradients begin at 0, so that x depends on b alone. */
dm_status dml_factorsolve(void *factor, double *x, const double *b);
uint32_t dml_factorunknowns(const void *factor);

/* The loaded library of solvers (dm/sparse.so, looked for beside the program at the first call), or
 * NULL, *why says why. */
const dm_solvers *dml_solvers(const char **why);

#endif
