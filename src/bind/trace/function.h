/* function.h - `dm.function`: a traced Lua function, its derivatives and their
 * kernels. */
#ifndef DML_FUNCTION_H
#define DML_FUNCTION_H

#include "bind/trace/trace.h"

/* What can be evaluated: nodes, made when first asked for, and their kernel. */
enum { DML_VALUE, DML_JACOBIAN, DML_HESSIAN, DML_PARTS };
typedef struct {
    const dm_node *nodes;
    dm_kernel kernel;
    double *out;
} dml_function_part;

typedef struct {
    dm_graph *graph; /* in the arena that user value 1 keeps */
    dm_arena *arena;
    dml_signature s;
    int rank; /* of the value: 0 number, 1 vector, 2 matrix */
    uint32_t rows, columns, inputs;
    double *x; /* [inputs] */
    dml_function_part parts[DML_PARTS];
    const dm_graph
        *alone; /* what the value needs and nothing else, for its bounds; NULL: not made */
    const dm_node *alone_roots; /* [outputs] of it */
} dml_function;

#define DML_FUNCTION "dm.function"

static inline uint32_t dml_outputs(const dml_function *f) {
    return f->rows * f->columns;
}

/* dm.trace and dm.derivative: the function at 1, lengths of its arguments from 2 on. */
int dml_function_trace(lua_State *L);
int dml_function_derivative(lua_State *L);

/* The part at f->x; kept by f. Raises where it is NaN. */
const double *dml_function_evaluate(lua_State *L, dml_function *f, int which, const char *what);

/* The value at x[inputs], which may be NaN. */
const double *dml_function_values(lua_State *L, dml_function *f, const double *x);

/* Arguments from stack index 2 on, fewer or more than f takes: raises. */
void dml_function_checkcount(lua_State *L, const dml_function *f);

/* Does an argument hold symbols or hyper-dual numbers? Then the call does the
 * operations of f again on them. */
int dml_function_isspecial(lua_State *L, const dml_function *f);
int dml_function_replay(lua_State *L, dml_function *f);

/* f:bounds(lo, hi), as a C function (function_bounds.c). */
int dml_function_bounds(lua_State *L);
/* f:clear(x, d, reach, fine), too */
int dml_function_clear(lua_State *L);

/* Make f->alone; raises without memory. */
void dml_function_alone(lua_State *L, dml_function *f);

/* The methods that take a function apart (function_terms.c). */
extern const dml_row dml_function_parts[];

#endif
