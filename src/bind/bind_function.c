/* bind_function.c - `dm.function`: a traced Lua function with exact derivatives, called on numbers. */
#include "bind/array.h"
#include "bind/call.h"
#include "bind/state.h"
#include "expr/analyse.h"
#include "expr/derive.h"
#include "expr/tape.h"

#include <math.h>
#include <string.h>

static const char *const TNAME = "dm.function";

/* one thing that can be evaluated: its nodes, made when first asked for, and their kernel */
typedef struct {
    const dm_node *nodes;
    dm_kernel kernel;
    double *out;
} part;

enum { VALUE, JACOBIAN, HESSIAN, PARTS };

typedef struct {
    dm_graph *graph; /* in the arena that user value 1 keeps */
    dm_arena *arena;
    dml_signature s;
    int rank; /* of the value: 0 number, 1 vector, 2 matrix */
    uint32_t rows, columns, inputs;
    double *x;
    part parts[PARTS];
} function;

static function *check(lua_State *L) {
    return luaL_checkudata(L, 1, TNAME);
}

static uint32_t outputs(const function *f) {
    return f->rows * f->columns;
}

static void *take(lua_State *L, dm_arena *arena, size_t size) {
    void *block = dm_arena_take(arena, size);
    if (!block) luaL_error(L, "not enough memory");
    return block;
}

static void check_status(lua_State *L, dm_status status) {
    if (status == DM_NO_MEMORY) luaL_error(L, "not enough memory");
    if (status != DM_OK) luaL_error(L, "f: %s", dm_status_text(status));
}

/* ---- kernels ---- */

static const dm_node *derive(lua_State *L, function *f, int which) {
    const uint32_t n = f->inputs, m = outputs(f);
    const dm_node *value = f->parts[VALUE].nodes;
    dm_node *nodes =
        take(L, f->arena, (size_t)m * n * n * sizeof *nodes + n * sizeof *nodes);
    if (which == JACOBIAN && m == 1)
        dm_gradient(f->graph, *value, 0, n, nodes);
    else if (which == JACOBIAN)
        dm_jacobian(f->graph, value, m, 0, n, nodes);
    else
        dm_hessian(f->graph, *value, 0, n, nodes + n * n, nodes);
    check_status(L, dm_graph_status(f->graph));
    return nodes;
}

static const part *want(lua_State *L, function *f, int which) {
    part *p = f->parts + which;
    const uint32_t size[PARTS] = {outputs(f), outputs(f) * f->inputs,
                                  f->inputs * f->inputs};
    if (p->kernel.eval) return p;
    if (!p->nodes) p->nodes = derive(L, f, which);
    p->out = take(L, f->arena, size[which] * sizeof *p->out);
    check_status(L, dm_tape_build(&p->kernel, f->graph, p->nodes, size[which], f->arena));
    dm_kernel_prepare(&p->kernel, p->out);
    return p;
}

static const double *evaluate(lua_State *L, function *f, int which, const char *what) {
    const part *p = want(L, f, which);
    dm_kernel_eval(&p->kernel, f->x, p->out);
    for (uint32_t i = 0; i < p->kernel.outputs; i++)
        if (isnan(p->out[i]))
            luaL_error(
                L, "%s is NaN at this point: is it inside the domain of the function?",
                what);
    return p->out;
}

/* ---- making one ---- */

/* lengths of the arguments from stack index `first` on: a number of entries, or "number" */
static void read_lengths(lua_State *L, int first, dml_signature *s) {
    const int given = lua_gettop(L) - first + 1;
    luaL_argcheck(L, given <= DML_MAX_ARGUMENTS, first + DML_MAX_ARGUMENTS,
                  "at most 8 arguments");
    s->arguments = given > 0 ? given : 1;
    s->length[0] = DML_SCALAR_ARGUMENT; /* f(x) of one number when nothing is said */
    for (int k = 0; k < given; k++) {
        const int arg = first + k;
        if (lua_type(L, arg) == LUA_TSTRING &&
            strcmp(lua_tostring(L, arg), "number") == 0) {
            s->length[k] = DML_SCALAR_ARGUMENT;
            continue;
        }
        const lua_Integer n = lua_isinteger(L, arg) ? lua_tointeger(L, arg) : 0;
        luaL_argcheck(L, n >= 1 && n <= 1 << 16, arg,
                      "the number of entries of a vector argument, or \"number\" for a "
                      "bare number, expected");
        s->length[k] = (int)n;
    }
}

static void read_function(lua_State *L, dml_signature *s) {
    const function *given = luaL_testudata(L, 1, TNAME);
    *s = (dml_signature){.what = "the function"};
    if (!given) luaL_checktype(L, 1, LUA_TFUNCTION);
    if (given && lua_gettop(L) == 1)
        *s = given->s, s->outputs = 0;
    else
        read_lengths(L, 2, s);
}

/* trace the function at 1; the new function is on top */
static function *push_function(lua_State *L, const dml_signature *s) {
    dml_traced traced;
    function *f = lua_newuserdatauv(L, sizeof *f, 1);
    *f = (function){.s = *s, .columns = 1};
    f->arena = dml_pusharena(L);
    lua_setiuservalue(L, -2, 1);
    dml_trace(L, 1, s, f->arena, &traced);
    f->graph = traced.graph;
    f->inputs = traced.inputs;
    f->rows = traced.outputs;
    f->rank = traced.bare ? 0 : 1;
    f->parts[VALUE].nodes = traced.out;
    f->x = take(L, f->arena, f->inputs * sizeof *f->x);
    luaL_setmetatable(L, TNAME);
    return f;
}

static int trace_new(lua_State *L) {
    dml_signature s;
    read_function(L, &s);
    function *f = push_function(L, &s);
    dml_trace_check(L, 1, &s, &want(L, f, VALUE)->kernel, NULL);
    return 1;
}

/* the function whose value is the derivative of the one at 1 */
static int derivative_new(lua_State *L) {
    dml_signature s;
    read_function(L, &s);
    function *f = push_function(L, &s);
    dml_trace_check(L, 1, &s, &want(L, f, VALUE)->kernel, NULL);
    const int one_number = f->s.arguments == 1 && f->s.length[0] == DML_SCALAR_ARGUMENT;
    const dm_node *nodes = derive(L, f, JACOBIAN);
    if (f->rank == 0) {
        f->rank = one_number ? 0 : 1;
        f->rows = f->inputs;
    } else if (!one_number) {
        f->rank = 2;
        f->columns = f->inputs;
    }
    memset(f->parts, 0, sizeof f->parts);
    f->parts[VALUE].nodes = nodes;
    return 1;
}

/* ---- calls ---- */

static void push_result(lua_State *L, int rank, uint32_t rows, uint32_t columns,
                        const double *y) {
    if (rank == 0)
        lua_pushnumber(L, *y);
    else
        memcpy(rank == 1 ? dml_pushvector(L, rows) : dml_pushmatrix(L, rows, columns), y,
               (size_t)rows * columns * sizeof *y);
}

static void check_count(lua_State *L, const function *f) {
    if (lua_gettop(L) - 1 != f->s.arguments)
        luaL_error(L, "the function takes %d argument%s (got %d)", f->s.arguments,
                   f->s.arguments == 1 ? "" : "s", lua_gettop(L) - 1);
}

/* arguments from index 2 on, all numbers, into f->x */
static void read_numbers(lua_State *L, function *f) {
    double *x = f->x;
    check_count(L, f);
    for (int k = 0; k < f->s.arguments; k++) {
        const int n = f->s.length[k];
        if (n == DML_SCALAR_ARGUMENT) {
            *x = luaL_checknumber(L, k + 2);
            luaL_argcheck(L, isfinite(*x), k + 2, "a finite number expected");
            x++;
        } else {
            lua_pushfstring(L, "argument %d", k + 1);
            dml_vectorarg(L, k + 2, lua_tostring(L, -1), x, (uint32_t)n);
            lua_pop(L, 1);
            x += n;
        }
    }
}

/* does an argument hold symbols or hyper-dual numbers? */
static int is_special(lua_State *L, const function *f) {
    dml_scalar x;
    for (int arg = 2; arg <= lua_gettop(L) && arg < 2 + f->s.arguments; arg++) {
        const dml_array *a = dml_toarray(L, arg, 1);
        if (a && !dml_numbersof(a)) return 1;
        if (!a && dml_toscalar(L, arg, &x) && x.kind != DML_NUMBER) return 1;
        for (long i = 0, n = lua_istable(L, arg) ? dml_length(L, arg) : 0; i < n; i++)
            if (dml_entry(L, arg, (uint32_t)i).kind != DML_NUMBER) return 1;
    }
    return 0;
}

/* arguments of any kind */
static void read_scalars(lua_State *L, const function *f, dml_scalar *x) {
    for (int k = 0; k < f->s.arguments; k++) {
        const int n = f->s.length[k] == DML_SCALAR_ARGUMENT ? 1 : f->s.length[k];
        if (dml_length(L, k + 2) != n)
            luaL_error(L, "argument %d must have %d entries (got %d)", k + 1, n,
                       (int)dml_length(L, k + 2));
        for (int i = 0; i < n; i++) *x++ = dml_entry(L, k + 2, (uint32_t)i);
    }
}

/* 1 for every node that the outputs need */
static const uint8_t *needed_nodes(lua_State *L, const function *f, uint32_t size) {
    const dm_node *out = f->parts[VALUE].nodes;
    uint8_t *needed = lua_newuserdatauv(L, size, 0);
    memset(needed, 0, size);
    for (uint32_t i = 0; i < outputs(f); i++) needed[out[i]] = 1;
    for (dm_node n = size; n-- > 0;) {
        const dm_expr *e = dm_graph_at(f->graph, n);
        for (int k = 0; needed[n] && k < dm_op_operands(e->op); k++)
            needed[e->as.arg[k]] = 1;
    }
    return needed;
}

/* node n of the graph of f, done again on the values y of its operands */
static dml_scalar replay(lua_State *L, const function *f, dm_node n, const dml_scalar *x,
                         const dml_scalar *y) {
    const dm_expr e = *dm_graph_at(f->graph, n);
    if (e.op == DM_OP_INPUT) return x[e.as.input];
    if (e.op == DM_OP_CONSTANT)
        return (dml_scalar){.kind = DML_NUMBER, .as.number = e.as.value};
    return dml_apply(L, e.op, y + e.as.arg[0], y + e.as.arg[1], y + e.as.arg[2]);
}

/* f inside another traced function, or on hyper-dual numbers: its operations done again there */
static int call_special(lua_State *L, function *f) {
    const uint32_t m = outputs(f), size = dm_graph_size(f->graph);
    const dm_node *out = f->parts[VALUE].nodes;
    check_count(L, f);
    luaL_checkstack(L, 10, NULL);
    dml_scalar *x = lua_newuserdatauv(L, (f->inputs + (size_t)size) * sizeof *x, 0);
    dml_scalar *y = x + f->inputs, kind = {.kind = DML_NUMBER};
    read_scalars(L, f, x);
    const uint8_t *needed = needed_nodes(L, f, size);
    for (dm_node n = 0; n < size; n++)
        if (needed[n]) y[n] = replay(L, f, n, x, y);
    if (f->rank == 0) {
        dml_pushscalar(L, y + out[0]);
        return 1;
    }
    for (uint32_t i = 0; i < m; i++) kind = dml_common(L, &kind, y + out[i]);
    dml_array *result = dml_newarray(L, f->rank, f->rows, f->columns, &kind);
    for (uint32_t i = 0; i < m; i++) dml_put(L, result, i, y + out[i]);
    return 1;
}

static int function_call(lua_State *L) {
    function *f = check(L);
    if (is_special(L, f)) return call_special(L, f);
    read_numbers(L, f);
    push_result(L, f->rank, f->rows, f->columns, evaluate(L, f, VALUE, "the value"));
    return 1;
}

static int function_gradient(lua_State *L) {
    function *f = check(L);
    if (f->rank != 0)
        return luaL_error(L, "the function gives %d numbers: use f:jacobian(...)",
                          (int)outputs(f));
    read_numbers(L, f);
    push_result(L, 1, f->inputs, 1, evaluate(L, f, JACOBIAN, "the gradient"));
    return 1;
}

static int function_jacobian(lua_State *L) {
    function *f = check(L);
    read_numbers(L, f);
    push_result(L, 2, outputs(f), f->inputs, evaluate(L, f, JACOBIAN, "the Jacobian"));
    return 1;
}

static int function_hessian(lua_State *L) {
    function *f = check(L);
    if (outputs(f) != 1)
        return luaL_error(
            L, "a Hessian is of a function that gives one number (this one gives %d)",
            (int)outputs(f));
    read_numbers(L, f);
    push_result(L, 2, f->inputs, f->inputs, evaluate(L, f, HESSIAN, "the Hessian"));
    return 1;
}

/* ---- what it looks like ---- */

static void put(void *ud, const char *text, size_t length) {
    luaL_addlstring(ud, text, length);
}

static int function_graph(lua_State *L) {
    function *f = check(L);
    luaL_Buffer b;
    luaL_buffinit(L, &b);
    dm_print(f->graph, f->parts[VALUE].nodes, outputs(f), NULL, put, &b);
    luaL_pushresult(&b);
    return 1;
}

static int function_operations(lua_State *L) {
    function *f = check(L);
    lua_pushinteger(L, dm_operations(f->graph, f->parts[VALUE].nodes, outputs(f)));
    return 1;
}

static int function_tostring(lua_State *L) {
    function *f = check(L);
    const int n = (int)dm_operations(f->graph, f->parts[VALUE].nodes, outputs(f));
    const char *of = f->inputs == 1 ? "" : "s", *operations = n == 1 ? "" : "s";
    lua_pushfstring(L, "function of %d number%s", (int)f->inputs, of);
    if (f->rank == 0) lua_pushstring(L, " to a number");
    if (f->rank == 1) lua_pushfstring(L, " to a vector of %d", (int)f->rows);
    if (f->rank == 2)
        lua_pushfstring(L, " to a matrix of %d x %d", (int)f->rows, (int)f->columns);
    lua_pushfstring(L, " (%d operation%s, derivatives exact)", n, operations);
    lua_concat(L, 3);
    return 1;
}

static const dml_row meta[] = {{"__call", function_call, NULL},
                               {"__tostring", function_tostring, NULL},
                               {NULL, NULL, NULL}};
static const dml_row methods[] = {
    {"gradient", function_gradient,
     "f:gradient(x, ...) -> dm.vector\n"
     "The exact derivatives by all numbers of all arguments, for a function that gives "
     "one number. Raises "
     "where they are NaN."},
    {"jacobian", function_jacobian,
     "f:jacobian(x, ...) -> dm.matrix\n"
     "The exact derivatives of every output (row) by every input (column)."},
    {"hessian", function_hessian,
     "f:hessian(x, ...) -> dm.matrix\n"
     "The exact second derivatives of a function that gives one number: symmetric, "
     "inputs x inputs."},
    {"graph", function_graph,
     "f:graph() -> string\n"
     "The expression graph, one assignment a line; x1, x2, ... are the inputs, numbered "
     "through all "
     "arguments."},
    {"operations", function_operations,
     "f:operations() -> integer\nArithmetic operations and function calls of one "
     "evaluation."},
    {NULL, NULL, NULL}};
static const dml_row functions[] = {
    {"trace", trace_new,
     "dm.trace(f [, n, ...]) -> dm.function\n"
     "Trace the Lua function f once: n, ... are the numbers of entries of its vector "
     "arguments, or "
     "\"number\" for a bare number (one number when nothing is given). The result is "
     "called like f, on "
     "vectors, tables or numbers, and has exact derivatives; upvalues keep the values "
     "they have now. f gives "
     "a number, or a vector or table of numbers. Raises when f branches on an argument, "
     "or returns no "
     "number."},
    {"derivative", derivative_new,
     "dm.derivative(f [, n, ...]) -> dm.function\n"
     "The exact derivative of f, a Lua function of a vector of n entries (arguments as "
     "for dm.trace) or a "
     "dm.function: called on x it gives the gradient as a vector; the matrix of "
     "derivatives where f gives a "
     "vector; a number where f takes and gives one number. Raises as dm.trace does."},
    {NULL, NULL, NULL}};

void dml_open_function(lua_State *L) {
    dml_newclass(
        L, TNAME,
        "dm.function: a traced function with exact derivatives, made by dm.trace or "
        "dm.derivative\n"
        "called on vectors, tables or numbers; also inside another traced function",
        meta, methods, NULL);
    dml_setfunctions(L, functions);
}
