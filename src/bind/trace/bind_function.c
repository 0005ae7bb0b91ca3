/* bind_function.c - `dm.function`: a traced Lua function with exact derivatives,
 * called on numbers. */
#include "bind/trace/function.h"
#include "graph/analyse.h"

#include <math.h>
#include <string.h>

/* The function at stack index 1. */
static dml_function *check(lua_State *L) {
    return luaL_checkudata(L, 1, DML_FUNCTION);
}

/* Tables, vectors and numbers count as one argument each. */
void dml_function_checkcount(lua_State *L, const dml_function *f) {
    if (lua_gettop(L) - 1 != f->s.arguments)
        luaL_error(L, "the function takes %d argument%s (got %d)", f->s.arguments,
                   f->s.arguments == 1 ? "" : "s", lua_gettop(L) - 1);
}

/* arguments from index 2 on, all numbers, into f->x */
static void read_numbers(lua_State *L, dml_function *f) {
    static const char *const names[DML_MAX_ARGUMENTS] = {"argument 1", "argument 2", "argument 3",
                                                         "argument 4", "argument 5", "argument 6",
                                                         "argument 7", "argument 8"};
    double *x = f->x;
    for (int k = 0; k < f->s.arguments; k++) {
        const int n = f->s.length[k];
        if (n == DML_SCALAR_ARGUMENT) {
            *x = dml_checknumber(L, k + 2);
            luaL_argcheck(L, isfinite(*x), k + 2, "a finite number expected");
            x++;
        } else {
            dml_vectorarg(L, k + 2, names[k], x, (uint32_t)n);
            x += n;
        }
    }
}

/* what is evaluated, its shape and its name in messages */
typedef struct {
    int which, rank;
    uint32_t rows, columns;
    const char *what;
} request;

/* The room for the result comes first: a finalizer that calls f while room is made
 * cannot then touch what was read or computed. */
static int answer(lua_State *L, dml_function *f, const request *r) {
    double number, *out = &number;
    dml_function_checkcount(L, f);
    if (r->rank)
        out = r->rank == 1 ? dml_pushvector(L, r->rows) : dml_pushmatrix(L, r->rows, r->columns);
    read_numbers(L, f);
    const double *y = dml_function_evaluate(L, f, r->which, r->what);
    memcpy(out, y, (size_t)r->rows * r->columns * sizeof *y);
    if (!r->rank) lua_pushnumber(L, number);
    return 1;
}

/* On symbols and hyper-dual numbers its operations are done again. */
static int function_call(lua_State *L) {
    dml_function *f = check(L);
    if (dml_function_isspecial(L, f)) return dml_function_replay(L, f);
    return answer(L, f, &(request){DML_VALUE, f->rank, f->rows, f->columns, "the value"});
}

/* Of a function that gives one number. */
static int function_gradient(lua_State *L) {
    dml_function *f = check(L);
    if (f->rank != 0)
        return luaL_error(L, "the function gives %d numbers: use f:jacobian(...)",
                          (int)dml_outputs(f));
    return answer(L, f, &(request){DML_JACOBIAN, 1, f->inputs, 1, "the gradient"});
}

/* Rows: entries of the result; columns: all inputs. */
static int function_jacobian(lua_State *L) {
    dml_function *f = check(L);
    return answer(L, f, &(request){DML_JACOBIAN, 2, dml_outputs(f), f->inputs, "the Jacobian"});
}

/* Of a function that gives one number, symmetric. */
static int function_hessian(lua_State *L) {
    dml_function *f = check(L);
    if (dml_outputs(f) != 1)
        return luaL_error(L, "a Hessian is of a function that gives one number (this one gives %d)",
                          (int)dml_outputs(f));
    return answer(L, f, &(request){DML_HESSIAN, 2, f->inputs, f->inputs, "the Hessian"});
}

/* ---- what it looks like ---- */

/* A piece of text to the buffer. */
static void put(void *ud, const char *text, size_t length) {
    luaL_addlstring(ud, text, length);
}

/* In the language of graphviz. */
static int function_graph(lua_State *L) {
    dml_function *f = check(L);
    luaL_Buffer b;
    luaL_buffinit(L, &b);
    dm_print(f->graph, f->parts[DML_VALUE].nodes, dml_outputs(f), NULL, put, &b);
    luaL_pushresult(&b);
    return 1;
}

/* Of the compacted value, without inputs and constants. */
static int function_operations(lua_State *L) {
    dml_function *f = check(L);
    lua_pushinteger(L, dm_operations(f->graph, f->parts[DML_VALUE].nodes, dml_outputs(f)));
    return 1;
}

/* Shapes of arguments and result. */
static int function_tostring(lua_State *L) {
    dml_function *f = check(L);
    const int n = (int)dm_operations(f->graph, f->parts[DML_VALUE].nodes, dml_outputs(f));
    const char *of = f->inputs == 1 ? "" : "s", *operations = n == 1 ? "" : "s";
    lua_pushfstring(L, "function of %d number%s", (int)f->inputs, of);
    if (f->rank == 0) lua_pushstring(L, " to a number");
    if (f->rank == 1) lua_pushfstring(L, " to a vector of %d", (int)f->rows);
    if (f->rank == 2) lua_pushfstring(L, " to a matrix of %d x %d", (int)f->rows, (int)f->columns);
    lua_pushfstring(L, " (%d operation%s, derivatives exact)", n, operations);
    lua_concat(L, 3);
    return 1;
}

static const dml_row meta[] = {{"__call", function_call, NULL},
                               {"__tostring", function_tostring, NULL},
                               {NULL, NULL, NULL}};
static const dml_row methods[] =
    {{"gradient", function_gradient,
      "f:gradient(x, ...) -> dm.vector\n"
      "The exact derivatives by all numbers of all arguments, for a function that gives one "
      "number. Raises where they are NaN."},
     {"jacobian", function_jacobian,
      "f:jacobian(x, ...) -> dm.matrix\n"
      "The exact derivatives of every output (row) by every input (column)."},
     {"hessian", function_hessian,
      "f:hessian(x, ...) -> dm.matrix\n"
      "The exact second derivatives of a function that gives one number: symmetric, inputs x "
      "inputs."},
     {"bounds", dml_function_bounds,
      "f:bounds(lo, hi) -> lo, hi\n"
      "Bounds of f where its argument is anywhere between lo and hi, numbers, or lists entry by "
      "entry; of a function of several arguments both are lists of them. By interval arithmetic, "
      "rounded outwards: f never leaves them, and they close in on f as the box shrinks. A number, "
      "or a list where f gives a vector (of rows: a matrix). Infinite where f may leave its domain "
      "in the box. Raises where an end is NaN or lo > hi."},
     {"clear", dml_function_clear,
      "f:clear(x, d, reach, fine) -> list\n"
      "Intervals { from1, to1, from2, to2, ... } of t in which no entry of f, a function of one "
      "vector, is zero at x + t d, |t| <= reach: by f:bounds, looked at down to intervals of "
      "fine (1 + |t|). Entries whose bounds exclude a zero hardly anywhere are left out."},
     {"graph", function_graph,
      "f:graph() -> string\n"
      "The expression graph, one assignment a line; x1, x2, ... are the inputs, numbered through "
      "all arguments."},
     {"operations", function_operations,
      "f:operations() -> integer\n"
      "Arithmetic operations and function calls of one evaluation."},
     {NULL, NULL, NULL}};
static const dml_row functions[] =
    {{"trace", dml_function_trace,
      "dm.trace(f [, n, ...]) -> dm.function\n"
      "Trace the Lua function f once: n, ... are the numbers of entries of its vector arguments, "
      "or \"number\" for a bare number (one number when nothing is given). The result is called "
      "like f, on vectors, tables or numbers, and has exact derivatives; upvalues keep the values "
      "they have now. f gives a number, or a vector or table of numbers. Raises when f branches on "
      "an argument, or returns no number; that is found by calls of f at points of all sizes, "
      "which \"unchecked\" behind the lengths leaves out."},
     {"derivative", dml_function_derivative,
      "dm.derivative(f [, n, ...]) -> dm.function\n"
      "The exact derivative of f, a Lua function of a vector of n entries (arguments as for "
      "dm.trace) or a dm.function: called on x it gives the gradient as a vector; the matrix of "
      "derivatives where f gives a vector; a number where f takes and gives one number. Raises as "
      "dm.trace does."},
     {NULL, NULL, NULL}};

static const dml_extension more[] = {
    {DML_FUNCTION, dml_function_parts},
    {NULL, NULL},
};

const dml_class dml_class_function = {
    .name = DML_FUNCTION,
    .doc = "dm.function: a traced function with exact derivatives, made by dm.trace or "
           "dm.derivative\n"
           "called on vectors, tables or numbers; also inside another traced function",
    .meta = meta,
    .methods = methods,
    .functions = functions,
    .more = more,
};
