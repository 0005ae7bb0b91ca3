/* arith.c - + - * / ^ and unary minus on scalars, vectors and matrices of every kind. */
#include "bind/core/missing_key.h"
#include "bind/value/array.h"
#include "bind/value/trace_log.h"

#include <math.h>

/* operand at arg; a table is taken as a vector and replaced by one */
static int read_operand(lua_State *L, int arg, dml_operand *out) {
    const int class = dml_classof(L, arg);
    out->rank = 0;
    if (class == DML_CLASS_VECTOR || class == DML_CLASS_MATRIX) {
        out->array = lua_touserdata(L, arg);
        return out->rank = class == DML_CLASS_VECTOR ? 1 : 2;
    }
    if (dml_toscalar(L, arg, &out->scalar)) return 1;
    if (!lua_istable(L, arg)) return 0;
    out->array = dml_vectorat(L, arg);
    return out->rank = 1;
}

/* What a user calls the value: our classes by name, else Lua's word. */
static const char *type_name(lua_State *L, int arg) {
    if (luaL_getmetafield(L, arg, "__name") == LUA_TSTRING) return lua_tostring(L, -1);
    if (lua_type(L, arg) == LUA_TSTRING)
        return lua_pushfstring(L, "the string \"%s\"", lua_tostring(L, arg));
    return luaL_typename(L, arg);
}

/* Lua's own message has no names of our classes, and a nil of a misspelt field is told here. */
static void refuse_operands(lua_State *L, dm_op op) {
    const char *a = type_name(L, 1), *b = type_name(L, 2), *hint = dml_text_hint(L, 1);
    if (!*hint) hint = dml_text_hint(L, 2);
    luaL_where(L, 1);
    if (!*lua_tostring(L, -1)) luaL_where(L, 2); /* the string library is between */
    lua_pushfstring(L, "%scannot compute %s %s %s%s", lua_tostring(L, -1), a, dm_op_text(op), b,
                    hint);
    dml_explain(L);
    lua_error(L);
}

/* 1: both were scalars of a trace, and the result is pushed */
static int read_operands(lua_State *L, dm_op op, dml_operand *a, dml_operand *b) {
    if (dml_symbolic(L, op)) return 1;
    lua_settop(L, 2);
    luaL_checkstack(L, 10, NULL);
    if (!read_operand(L, 1, a) || !read_operand(L, 2, b)) refuse_operands(L, op);
    return 0;
}

static dml_scalar kind_of(const dml_operand *x) {
    return x->rank ? dml_kindof(x->array) : x->scalar;
}

static dml_scalar entry_of(const dml_operand *x, uint32_t i) {
    return x->rank ? dml_get(x->array, i) : x->scalar;
}

/* numbers of an operand; step 0 repeats a scalar. NULL when it holds another kind */
static const double *numbers_of(const dml_operand *x, uint32_t *step) {
    *step = x->rank ? 1 : 0;
    if (x->rank) return dml_numbersof(x->array);
    return x->scalar.kind == DML_NUMBER ? &x->scalar.as.number : NULL;
}

/* out = a op b entry by entry, where a scalar stands for all entries. The loops have no calls in
 * them, so that the compiler makes vectors of them. */
static void number_loop(double *out, dm_op op, const dml_operand *a, const dml_operand *b,
                        uint32_t n) {
    uint32_t da, db;
    const double *x = numbers_of(a, &da), *y = numbers_of(b, &db);
    if (!x || !y) return;
    switch (op) {
    case DM_OP_ADD:
        for (uint32_t i = 0; i < n; i++) out[i] = x[i * da] + y[i * db];
        break;
    case DM_OP_SUB:
        for (uint32_t i = 0; i < n; i++) out[i] = x[i * da] - y[i * db];
        break;
    case DM_OP_MUL:
        for (uint32_t i = 0; i < n; i++) out[i] = x[i * da] * y[i * db];
        break;
    default:
        for (uint32_t i = 0; i < n; i++) out[i] = dm_op_value(op, x[i * da], y[i * db], 0);
    }
}

/* nodes of an operand, step 0 repeats a scalar; a number becomes a constant. NULL: a vector of
 * numbers */
static const dm_node *nodes_of(lua_State *L, const dml_operand *x, uint32_t *step, dml_frame *frame,
                               dm_node *alone) {
    *step = x->rank ? 1 : 0;
    if (x->rank) return dml_nodesof(x->array);
    *alone = x->scalar.kind == DML_NUMBER ? dml_constant(L, frame, x->scalar.as.number)
                                          : x->scalar.as.node;
    return alone;
}

/* 0: a vector of numbers is among them */
static int symbol_loop(lua_State *L, dml_array *out, dm_op op, const dml_operand *a,
                       const dml_operand *b) {
    dml_frame *frame = dml_findframe(L, out->serial);
    if (!frame) return 0;
    uint32_t da, db;
    dm_node alone[2], *nodes = out->entries;
    const dm_node *x = nodes_of(L, a, &da, frame, alone);
    const dm_node *y = nodes_of(L, b, &db, frame, alone + 1);
    if (!x || !y) return 0;
    for (uint32_t i = 0; i < dml_size(out); i++)
        nodes[i] = dml_operation(L, frame, op, x[i * da], y[i * db], 0);
    dml_checkgraph(L, frame);
    return 1;
}

/* entry by entry; a scalar meets every entry */
static int elementwise(lua_State *L, dm_op op, const dml_operand *a, const dml_operand *b) {
    const dml_array *shape = a->rank ? a->array : b->array;
    const dml_scalar ka = kind_of(a), kb = kind_of(b), kind = dml_common(L, &ka, &kb);
    dml_array *out = dml_newarray(L, shape->rank, shape->rows, shape->columns, &kind);
    const uint32_t n = dml_size(shape);
    if (kind.kind == DML_NUMBER) {
        number_loop(out->entries, op, a, b, n);
        return 1;
    }
    if (kind.kind == DML_SYMBOL && symbol_loop(L, out, op, a, b)) return 1;
    for (uint32_t i = 0; i < n; i++) {
        const dml_scalar x = entry_of(a, i), y = entry_of(b, i);
        const dml_scalar z = dml_apply(L, op, &x, &y, NULL);
        dml_put(L, out, i, &z);
    }
    return 1;
}

/* a (rows x n) times b (n x columns), or a vector b */
static int product(lua_State *L, const dml_array *a, const dml_array *b) {
    if (a->columns != b->rows)
        return luaL_error(L, "cannot multiply %s by %s", dml_shape(L, a), dml_shape(L, b));
    const dml_scalar ka = dml_kindof(a), kb = dml_kindof(b), kind = dml_common(L, &ka, &kb);
    dml_array *out = dml_newarray(L, b->rank, a->rows, b->columns, &kind);
    for (uint32_t i = 0; i < a->rows; i++)
        for (uint32_t j = 0; j < b->columns; j++) {
            const dml_run row = {a, i * a->columns, 1}, column = {b, j, b->columns};
            dml_checkstop(L);
            const dml_scalar sum = dml_inner(L, row, column, a->columns);
            dml_put(L, out, i * b->columns + j, &sum);
        }
    return 1;
}

/* Both are scalars of any kind: one operation. */
static int apply_scalars(lua_State *L, dm_op op, const dml_operand *a, const dml_operand *b) {
    const dml_scalar z = dml_apply(L, op, &a->scalar, &b->scalar, NULL);
    dml_pushscalar(L, &z);
    return 1;
}

/* + and -: of arrays of one shape, of scalars, of a vector and a number, which goes to every
 * entry. Of a matrix and a number it is refused: a multiple of the identity is meant as often. */
static int sum(lua_State *L, dm_op op) {
    dml_operand a, b;
    if (read_operands(L, op, &a, &b)) return 1;
    if (!a.rank && !b.rank) return apply_scalars(L, op, &a, &b);
    if (a.rank + b.rank == 2 && a.rank != b.rank)
        return luaL_error(L, "cannot compute matrix %s number: use dm.identity(n) * x",
                          dm_op_text(op));
    if (a.rank && b.rank &&
        (a.rank != b.rank || a.array->rows != b.array->rows ||
         a.array->columns != b.array->columns))
        return luaL_error(L, "cannot compute %s %s %s: the shapes differ", dml_shape(L, a.array),
                          dm_op_text(op), dml_shape(L, b.array));
    return elementwise(L, op, &a, &b);
}

int dml_add(lua_State *L) {
    return sum(L, DM_OP_ADD);
}

int dml_sub(lua_State *L) {
    return sum(L, DM_OP_SUB);
}

/* A number scales; matrix * matrix and matrix * vector are products; two vectors have none:
 * v:dot(w), v:cross(w), v:outer(w) are named. */
int dml_mul(lua_State *L) {
    dml_operand a, b;
    if (lua_istable(L, 2) && luaL_getmetafield(L, 2, "__mul") != LUA_TNIL) {
        lua_insert(L, 1); /* a form: it is multiplied by a symbol */
        lua_settop(L, 3);
        lua_call(L, 2, 1);
        return 1;
    }
    if (read_operands(L, DM_OP_MUL, &a, &b)) return 1;
    if (!a.rank && !b.rank) return apply_scalars(L, DM_OP_MUL, &a, &b);
    if (!a.rank || !b.rank) return elementwise(L, DM_OP_MUL, &a, &b);
    if (a.rank == 2) return product(L, a.array, b.array);
    return luaL_error(L,
                      b.rank == 1
                          ? "vector * vector is ambiguous: use a:dot(b), a:cross(b) or a:outer(b)"
                          : "vector * matrix is not defined: use m:transpose() * v");
}

/* Only by scalars. */
int dml_div(lua_State *L) {
    dml_operand a, b;
    if (read_operands(L, DM_OP_DIV, &a, &b)) return 1;
    if (!a.rank && !b.rank) return apply_scalars(L, DM_OP_DIV, &a, &b);
    if (a.rank && b.rank)
        return luaL_error(L,
                          b.rank == 2
                              ? "cannot divide by a matrix: use m:solve(v) or m:inverse()"
                              : "cannot divide by a vector: use a:map(f) or a loop over entries");
    if (b.rank == 2) return luaL_error(L, "cannot divide a number by a matrix: use m:inverse()");
    return elementwise(L, DM_OP_DIV, &a, &b);
}

/* Scalars alone have powers; what a power of an array might mean is named. */
int dml_pow(lua_State *L) {
    dml_operand a, b;
    if (read_operands(L, DM_OP_POW, &a, &b)) return 1;
    if (!a.rank && !b.rank) return apply_scalars(L, DM_OP_POW, &a, &b);
    return luaL_error(L, "a power of a vector or matrix is ambiguous: use v:dot(v), m * m, "
                         "m:inverse(), or v:map(function(x) return x^2 end)");
}

/* Entries of any kind; -x of a symbol is a node. */
int dml_unm(lua_State *L) {
    dml_operand a;
    lua_settop(L, 1);
    luaL_checkstack(L, 10, NULL);
    if (!read_operand(L, 1, &a)) return luaL_typeerror(L, 1, "number, vector or matrix");
    if (!a.rank) {
        const dml_scalar z = dml_apply(L, DM_OP_NEG, &a.scalar, NULL, NULL);
        dml_pushscalar(L, &z);
        return 1;
    }
    const dml_scalar kind = dml_kindof(a.array);
    dml_array *out = dml_newarray(L, a.rank, a.array->rows, a.array->columns, &kind);
    for (uint32_t i = 0; i < dml_size(out); i++) {
        const dml_scalar x = dml_get(a.array, i), z = dml_apply(L, DM_OP_NEG, &x, NULL, NULL);
        dml_put(L, out, i, &z);
    }
    return 1;
}
