/* trace.h - a Lua function called once with symbols becomes a graph.
 * Comparison, floor, %, // on symbols raise and say what to use. What the graph cannot see
 * (==, truth tests) is found by dml_trace_check, which compares the kernel with plain calls. */
#ifndef DML_TRACE_H
#define DML_TRACE_H

#include "bind/value/trace_log.h"
#include "bind/value/value.h"
#include "code/kernel.h"

enum { DML_SCALAR_ARGUMENT = -1, DML_MAX_ARGUMENTS = 8 };

/* What a traced function takes and gives; the graph's inputs are numbered through all
 * arguments. */
typedef struct {
    const char *what; /* "L" of the system: named in every message */
    int arguments;
    int length[DML_MAX_ARGUMENTS]; /* entries of each vector, or DML_SCALAR_ARGUMENT */
    int outputs;    /* DML_SCALAR_ARGUMENT: a number; n: that many; 0: any number of them */
    int keeps_sums; /* dm.sum_over may stay a loop in the graph (algebra/body_sum.h) */
    int may_branch; /* derivatives = "hyperdual" is a way out for one that branches */
    int may_grow;   /* a graph that grows too large is no error: dml_traced.graph is then NULL */
    /* vectors of very many entries: symbols are not made, nil stands in their place, and the graph
     * has nodes for scalars alone. Such a trace has no log */
    int lazy;
    dm_node (*capture)(lua_State *L, dml_frame *f, uint32_t serial, dm_node node);
    void *request; /* both as in dml_frame */
    /* where it is checked it may not be a number, when called and when traced */
    int may_be_outside;
} dml_signature;

/* Call the function at stack index fn with symbols in a graph of `arena`. Raises the
 * function's own error, or one that names the cause: the wrong kind of result ("must return
 * a number, got nil"), a branch, a symbol of another trace, too large a graph. The stack is
 * left as it was. */
void dml_trace(lua_State *L, int fn, const dml_signature *s, dm_arena *arena, dml_traced *out);

/* The same with a log. Where the function does what it did in *last (or NULL), *out is *last,
 * and nothing was made; its memory must be held by the caller until then. */
void dml_retrace(lua_State *L, int fn, const dml_signature *s, dm_arena *arena,
                 const dml_traced *last, dml_traced *out);

/* Compare `kernel` (of the traced outputs) with plain calls of the function: at `at`
 * (NULL: nowhere), where a mismatch, a NaN or an error of the function is raised, and at
 * random points around it, where only a mismatch of finite values is. The message names the
 * likely cause: ==, a truth test, a global that changes, random numbers. */
void dml_trace_check(lua_State *L, int fn, const dml_signature *s, const dm_kernel *kernel,
                     const double *at);

/* The same at `at` alone, for a trace that was compared before. */
void dml_trace_check_start(lua_State *L, int fn, const dml_signature *s, const dm_kernel *kernel,
                           const double *at);

/* In one point beside `at`, which may be an equilibrium where many a function has the same
 * value; the inputs from `moved` on, parameters that the function may look at by ==, are as in
 * `at`. */
void dml_trace_check_beside(lua_State *L, int fn, const dml_signature *s, const dm_kernel *kernel,
                            const double *at, size_t moved);

/* The function on numbers: pushes nothing, fills out[outputs]; raises as dml_trace does. */
void dml_call_numbers(lua_State *L, int fn, const dml_signature *s, const double *in, double *out,
                      uint32_t outputs);

/* Raise where the trace of `what` has an entry that is no finite number whatever its arguments
 * are. */
void dml_refusenans(lua_State *L, const dml_traced *traced, const char *what);

/* What cannot be traced: callback kernels on hyper-dual numbers, for a function that gives
 * one number. Outputs by order: 0: the value; 1: the gradient [inputs]; 2: gradient and
 * Hessian [inputs + inputs * inputs]. A Lua error inside is kept: the kernel writes NaN, and
 * dml_hyperdual_rethrow raises the user's own error afterwards. The callback is a userdata,
 * pushed by new; it keeps the function alive. */
typedef struct dml_callback dml_callback;
dml_callback *dml_hyperdual_new(lua_State *L, int fn, const dml_signature *s);
void dml_hyperdual_kernel(dml_callback *c, int order, dm_kernel *out);
void dml_hyperdual_rethrow(lua_State *L, dml_callback *c);

/* Are the first `size` nodes of both graphs the same? */
int dml_samenodes(const dm_graph *a, const dm_graph *b, uint32_t size);

#endif
