/* matrix_solve.h - determinants and linear systems of a `dm.matrix` of any kind of entries, and
 * eigenvalues of numbers (matrix_eigen.c). */
#ifndef DML_MATRIX_SOLVE_H
#define DML_MATRIX_SOLVE_H

#include "bind/value/array.h"

/* Raise where m is not square; where one of a[n] is not finite. */
void dml_checksquare(lua_State *L, const dml_array *m);
void dml_checkfinite(lua_State *L, const double *a, size_t n);

/* The square matrix m at stack index `arg`; each pushes its result. Singular matrices
 * raise. */
void dml_det(lua_State *L, const dml_array *m);
/* x with m x = b for a vector or matrix b. */
void dml_solve(lua_State *L, const dml_array *m, const dml_array *b);

/* Real and imaginary parts of the eigenvalues: two vectors, sorted. Numbers only. */
void dml_eigenvalues(lua_State *L, const dml_array *m);

/* Values k, sorted, and vectors x, columns of a matrix, with a x = k b x, x^T b x = 1: of two
 * symmetric matrices of numbers, b positive definite. */
void dml_modes(lua_State *L, const dml_array *a, const dml_array *b);

#endif
