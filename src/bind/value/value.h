/* value.h - the values that a script computes with: numbers, symbols, hyper-dual numbers,
 * and vectors and matrices of them. The same script code works on all three. */
#ifndef DML_VALUE_H
#define DML_VALUE_H

#include "bind/core/bind.h"
#include "graph/graph.h"

typedef enum { DML_NUMBER, DML_SYMBOL, DML_HYPERDUAL } dml_kind;

/* f, df/da, df/db, d2f/dadb along two directions a, b: exact second derivatives
 * (Fike & Alonso 2011). */
typedef struct {
    double f, a, b, ab;
} dml_hyperdual;

typedef struct {
    dml_kind kind;
    uint32_t serial; /* of the trace that a symbol belongs to */
    union {
        double number;
        dm_node node;
        dml_hyperdual hyper;
    } as;
} dml_scalar;

/* The scalar at arg; 0 when it is none of the three. */
int dml_toscalar(lua_State *L, int arg, dml_scalar *out);
/* A number becomes a plain Lua number. */
void dml_pushscalar(lua_State *L, const dml_scalar *x);

/* op(a, b, c) in whatever kind the operands need; raises when symbols of two traces meet or
 * a symbol outlived its trace. */
dml_scalar dml_apply(lua_State *L, dm_op op, const dml_scalar *a, const dml_scalar *b,
                     const dml_scalar *c);

/* op on the values at 1 and 2: the result is pushed where both are symbols of the newest trace,
 * or one of them a number, which is most of what a trace does. 0: they are something else. */
int dml_symbolic(lua_State *L, dm_op op);

/* Is the metamethod that runs asked by math.max or math.min, which takes it from there? */
int dml_inmax(lua_State *L);

/* Push a new vector or matrix of zeros, owned by Lua; returns its entries (row-major). */
double *dml_pushvector(lua_State *L, uint32_t n);
double *dml_pushmatrix(lua_State *L, uint32_t rows, uint32_t columns);
/* Push a vector of n scalars: all of one kind, or numbers that are lifted to it. */
void dml_pushscalars(lua_State *L, const dml_scalar *x, uint32_t n);

/* A table, or what says by __list in its metatable that it reads as one: a column of a path. */
int dml_islist(lua_State *L, int arg);
/* A key of the plain table at arg that is none of 1 .. n, as text on top of the stack; NULL, and
 * nothing is pushed: there is none. Who reads n entries would drop what stands there. */
const char *dml_surplus(lua_State *L, int arg, lua_Integer n);
/* Raises so of `what`, "a list". */
void dml_refuse_surplus(lua_State *L, const char *what, const char *more, lua_Integer n);
/* Length of the vector, matrix row or table at arg, 1 for a scalar, -1 for all else. Raises where a
 * list has more behind its entries. */
long dml_length(lua_State *L, int arg);
/* The same without that look, for lists that are read by the million. */
long dml_bare_length(lua_State *L, int arg);
/* Entry i (from 0) of what dml_length measured. Raises when it is no scalar. */
dml_scalar dml_entry(lua_State *L, int arg, uint32_t i);
/* The same into *x; 0, with *type what stands there instead, where it is no scalar. */
int dml_tryentry(lua_State *L, int arg, uint32_t i, dml_scalar *x, const char **type);

/* out = the first entries, at most n, of a vector or plain table that are finite numbers; gives how
 * many. */
uint32_t dml_readplain(lua_State *L, int arg, double *out, uint32_t n);
/* n finite numbers from the vector or table at arg; messages call it `name`. A bare number
 * will do where n is 1. */
void dml_vectorarg(lua_State *L, int arg, const char *name, double *out, uint32_t n);

#endif
