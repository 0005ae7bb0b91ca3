/* array.h - vectors and matrices of numbers, symbols or hyper-dual numbers: one layout
 * for all. */
#ifndef DML_ARRAY_H
#define DML_ARRAY_H

#include "bind/value/value.h"

/* Entries are row-major and of one kind. They stand behind the header, or (after an entry
 * of another kind was assigned) in a block that user value 1 keeps. A row view has an
 * owner, kept by user value 1, and reads the owner's entries. */
typedef struct dml_array {
    uint32_t rows, columns; /* a vector has one column */
    int rank;               /* 1: vector, 2: matrix */
    dml_kind kind;
    uint32_t serial; /* of the trace that symbols belong to */
    uint32_t offset; /* of a view, in entries */
    int is_copy;     /* handed out by an object: what is set would be lost, so that raises */
    struct dml_array *owner;
    void *entries;
} dml_array;

/* what arithmetic works on */
typedef struct {
    int rank; /* 0: scalar */
    dml_scalar scalar;
    const dml_array *array;
} dml_operand;

/* Push a new array; entries are zero. */
dml_array *dml_newarray(lua_State *L, int rank, uint32_t rows, uint32_t columns,
                        const dml_scalar *like);

/* The vector or matrix at arg, NULL when it is none; check raises. */
dml_array *dml_toarray(lua_State *L, int arg, int rank);
dml_array *dml_checkarray(lua_State *L, int arg, int rank);

/* A vector from the vector or table at arg: a table is replaced by a vector on the
 * stack. */
const dml_array *dml_vectorat(lua_State *L, int arg);

/* Push a vector that reads and writes row i of the matrix at arg. */
void dml_pushrow(lua_State *L, int arg, uint32_t i);

/* What is on top is a copy: a vector, a matrix, or a table of them. */
void dml_mark_copy(lua_State *L);

/* Raise where an entry that is set would be lost. */
void dml_check_own(lua_State *L, const dml_array *a);

static inline uint32_t dml_size(const dml_array *a) {
    return a->rows * a->columns;
}

/* Kind (and serial) of the entries, as a scalar zero of that kind. */
dml_scalar dml_kindof(const dml_array *a);

/* Numbers of an array of numbers, NULL for another kind. */
double *dml_numbersof(const dml_array *a);

/* Nodes of an array of symbols, NULL for another kind. */
const dm_node *dml_nodesof(const dml_array *a);

dml_scalar dml_get(const dml_array *a, uint32_t i);

/* Entry i = x, lifted to the kind of the array, which must be able to hold it. */
void dml_put(lua_State *L, dml_array *a, uint32_t i, const dml_scalar *x);

/* Entry i = x for the array at stack index arg, which takes the kind of x when it
 * must. */
void dml_assign(lua_State *L, int arg, uint32_t i, const dml_scalar *x);

/* The kind that holds both: numbers are lifted; raises when it cannot be. */
dml_scalar dml_common(lua_State *L, const dml_scalar *a, const dml_scalar *b);

/* x as a scalar of the kind of `like`. */
dml_scalar dml_lift(lua_State *L, const dml_scalar *x, const dml_scalar *like);

/* sum_k a[i + k da] b[j + k db], k < n */
typedef struct {
    const dml_array *array;
    uint32_t first, step;
} dml_run;
dml_scalar dml_inner(lua_State *L, dml_run a, dml_run b, uint32_t n);

/* Metamethods of all four classes (numbers, symbols, hyper-dual numbers, arrays
 * mixed). */
int dml_add(lua_State *L);
int dml_sub(lua_State *L);
int dml_mul(lua_State *L);
int dml_div(lua_State *L);
int dml_pow(lua_State *L);
int dml_unm(lua_State *L);
/* Their rows. */
/* clang-format off */
#define DML_ARITHMETIC                                                                             \
    {"__add", dml_add, NULL}, {"__sub", dml_sub, NULL}, {"__mul", dml_mul, NULL},                  \
    {"__div", dml_div, NULL}, {"__pow", dml_pow, NULL}, {"__unm", dml_unm, NULL}
/* clang-format on */

/* __eq of vectors and matrices. */
int dml_equal(lua_State *L);

/* Shape, for messages: "2 x 3". Pushes it. */
const char *dml_shape(lua_State *L, const dml_array *a);

/* The class of a value of dm, else its type in Lua, for messages. */
const char *dml_kindname(lua_State *L, int arg);

/* Text of a scalar; a symbol shows its expression, cut off when long. */
enum { DML_TEXT = 132 };
void dml_scalartext(lua_State *L, char out[DML_TEXT], const dml_scalar *x);

/* __tostring of vectors and matrices: long ones cut off, with their shape. */
int dml_vectortext(lua_State *L);
int dml_matrixtext(lua_State *L);

#endif
