/* function.c - making a `dm.function`: trace, check, differentiate, build the kernels
 * that are asked for. */
#include "bind/trace/function.h"

#include "algebra/derive.h"
#include "bind/trace/bind_root.h"
#include "code/tape/tape.h"

#include <math.h>
#include <string.h>

/* Of the arena; raises without memory. */
static void *take(lua_State *L, dm_arena *arena, size_t size) {
    void *block = dm_arena_take(arena, size);
    if (!block) luaL_error(L, "not enough memory");
    return block;
}

/* Raises where a graph or kernel could not be made. */
static void check_status(lua_State *L, dm_status status) {
    if (status == DM_NO_MEMORY) luaL_error(L, "not enough memory");
    if (status != DM_OK) luaL_error(L, "the function: %s", dm_status_text(status));
}

/* ---- kernels ---- */

/* Nodes of the value, the Jacobian or the Hessian. */
static const dm_node *derive(lua_State *L, dml_function *f, int which) {
    const uint32_t n = f->inputs, m = dml_outputs(f);
    const dm_node *value = f->parts[DML_VALUE].nodes;
    const size_t size = which == DML_JACOBIAN ? (size_t)m * n : (size_t)n * n + n;
    dm_node *nodes = take(L, f->arena, size * sizeof *nodes);
    if (which == DML_JACOBIAN && m == 1)
        dm_gradient(f->graph, *value, 0, n, nodes);
    else if (which == DML_JACOBIAN)
        dm_jacobian(f->graph, value, m, 0, n, nodes);
    else
        dm_hessian(f->graph, *value, 0, n, nodes + n * n, nodes);
    check_status(L, dm_graph_status(f->graph));
    return nodes;
}

/* Made once, kept by f: the kernel has an output for every node. */
static const dml_function_part *want(lua_State *L, dml_function *f, int which) {
    dml_function_part *p = f->parts + which;
    const uint32_t size[DML_PARTS] = {dml_outputs(f), dml_outputs(f) * f->inputs,
                                      f->inputs * f->inputs};
    if (p->kernel.eval) return p;
    if (!p->nodes) p->nodes = derive(L, f, which);
    p->out = take(L, f->arena, size[which] * sizeof *p->out);
    check_status(L, dm_tape_build(&p->kernel, f->graph, p->nodes, size[which], f->arena));
    dm_kernel_prepare(&p->kernel, p->out);
    return p;
}

/* The numbers stand until the part is evaluated again. */
const double *dml_function_evaluate(lua_State *L, dml_function *f, int which, const char *what) {
    const dml_function_part *p = want(L, f, which);
    dm_root_forget(f->graph);
    dm_kernel_eval(&p->kernel, f->x, p->out);
    for (uint32_t i = 0; i < p->kernel.outputs; i++)
        if (isnan(p->out[i]))
            luaL_error(L, "%s is NaN at this point: is it inside the domain of the function?%s",
                       what, dml_roottrouble(L, f->graph));
    return p->out;
}

const double *dml_function_values(lua_State *L, dml_function *f, const double *x) {
    const dml_function_part *p = want(L, f, DML_VALUE);
    dm_kernel_eval(&p->kernel, x, p->out);
    return p->out;
}

/* ---- making one ---- */

/* lengths of the arguments from stack index `first` on: a number of entries, or
 * "number" */
static void read_lengths(lua_State *L, int first, dml_signature *s) {
    const int given = lua_gettop(L) - first + 1;
    luaL_argcheck(L, given <= DML_MAX_ARGUMENTS, first + DML_MAX_ARGUMENTS, "at most 8 arguments");
    s->arguments = given > 0 ? given : 1;
    s->length[0] = DML_SCALAR_ARGUMENT; /* f(x) of one number when nothing is said */
    for (int k = 0; k < given; k++) {
        const int arg = first + k;
        if (lua_type(L, arg) == LUA_TSTRING && strcmp(lua_tostring(L, arg), "number") == 0) {
            s->length[k] = DML_SCALAR_ARGUMENT;
            continue;
        }
        const lua_Integer n = lua_isinteger(L, arg) ? lua_tointeger(L, arg) : 0;
        luaL_argcheck(L, n >= 1 && n <= 1 << 16, arg,
                      "the number of entries of a vector argument, or \"number\" for a bare "
                      "number, expected");
        s->length[k] = (int)n;
    }
}

/* Is the function at 1 to be traced without a check? "unchecked" behind the lengths is taken off; a
 * dm.function was checked when it was made. */
static int take_unchecked(lua_State *L) {
    const int top = lua_gettop(L), is_text = top > 1 && lua_type(L, top) == LUA_TSTRING;
    const int said = is_text && strcmp(lua_tostring(L, top), "unchecked") == 0;
    if (said) lua_settop(L, top - 1);
    return said || luaL_testudata(L, 1, DML_FUNCTION);
}

/* Lengths of the arguments, from stack index 2 on; none: as many as the function names. */
static void read_function(lua_State *L, dml_signature *s) {
    const dml_function *given = luaL_testudata(L, 1, DML_FUNCTION);
    *s = (dml_signature){.what = "the function"};
    if (!given && !luaL_testudata(L, 1, DML_ROOT)) luaL_checktype(L, 1, LUA_TFUNCTION);
    if (given && lua_gettop(L) == 1)
        *s = given->s, s->outputs = 0;
    else
        read_lengths(L, 2, s);
}

/* trace the function at 1; the new function is on top */
static dml_function *push_function(lua_State *L, const dml_signature *s) {
    dml_traced traced;
    dml_function *f = lua_newuserdatauv(L, sizeof *f, 1);
    *f = (dml_function){.s = *s, .columns = 1};
    f->arena = dml_pusharena(L);
    lua_setiuservalue(L, -2, 1);
    dml_trace(L, 1, s, f->arena, &traced);
    f->graph = traced.graph;
    f->inputs = traced.inputs;
    f->rows = traced.outputs;
    f->rank = traced.bare ? 0 : 1;
    f->parts[DML_VALUE].nodes = traced.out;
    f->x = take(L, f->arena, f->inputs * sizeof *f->x);
    luaL_setmetatable(L, DML_FUNCTION);
    return f;
}

/* (function, lengths ...) -> dm.function */
int dml_function_trace(lua_State *L) {
    dml_signature s;
    const int unchecked = take_unchecked(L);
    read_function(L, &s);
    dml_function *f = push_function(L, &s);
    if (!unchecked) dml_trace_check(L, 1, &s, &want(L, f, DML_VALUE)->kernel, NULL);
    return 1;
}

/* the function whose value is the derivative of the one at 1 */
int dml_function_derivative(lua_State *L) {
    dml_signature s;
    const int unchecked = take_unchecked(L);
    read_function(L, &s);
    dml_function *f = push_function(L, &s);
    const dml_traced traced = {.graph = f->graph,
                               .out = f->parts[DML_VALUE].nodes,
                               .outputs = f->rows};
    dml_refusenans(L, &traced, s.what); /* its derivative would be 0 */
    if (!unchecked) dml_trace_check(L, 1, &s, &want(L, f, DML_VALUE)->kernel, NULL);
    const int one_number = f->s.arguments == 1 && f->s.length[0] == DML_SCALAR_ARGUMENT;
    const dm_node *nodes = derive(L, f, DML_JACOBIAN);
    if (f->rank == 0) {
        f->rank = one_number ? 0 : 1;
        f->rows = f->inputs;
    } else if (!one_number) {
        f->rank = 2;
        f->columns = f->inputs;
    }
    memset(f->parts, 0, sizeof f->parts);
    f->parts[DML_VALUE].nodes = nodes;
    return 1;
}
