/* bind_extremum.c - dm.extremum: the value of a function at its stationary point, whose
 * derivatives in a Lagrangian are then made by the envelope property (algebra/extremum.h). */
#include "algebra/body_sum.h"
#include "algebra/extremum.h"
#include "algebra/implicit.h"
#include "bind/trace/trace.h"
#include "bind/value/trace_log.h"

#include <math.h>

enum { MOST = 64, POINTS = 24 };

/* values of the nodes up to `last` for the inputs `in` */
static double evaluate(const dm_graph *g, dm_node last, const double *in, double *work) {
    for (dm_node k = 0; k <= last; k++) {
        const dm_expr *e = dm_graph_at(g, k);
        if (e->op == DM_OP_CONSTANT)
            work[k] = e->as.value;
        else if (e->op == DM_OP_INPUT)
            work[k] = in[e->as.input];
        else if (e->op == DM_OP_IMPLICIT) /* of other nodes, see keep */
            work[k] = NAN;
        else
            work[k] =
                dm_op_value(e->op, work[e->as.arg[0]], work[e->as.arg[1]], work[e->as.arg[2]]);
    }
    return work[last];
}

/* f at (x, y + e in entry a, t), with the inputs of e->of in `at` */
static double off_by(const dm_extremum *e, double *at, uint32_t a, double step, double *work) {
    at[e->n + a] += step;
    const double f = evaluate(e->of, e->f, at, work);
    at[e->n + a] -= step;
    return f;
}

/* is the value that of f at y, and f stationary there? Compared at points where they are finite. */
static void check_at(lua_State *L, const dm_graph *g, const dm_extremum *e, const double *x,
                     double *at, double *work) {
    const double step = 1e-4, value = evaluate(g, e->value, x, work);
    for (uint32_t i = 0; i < e->n; i++) at[i] = x[i];
    for (uint32_t i = e->n; i < dm_graph_inputs(g); i++) at[i + e->m] = x[i];
    for (uint32_t a = 0; a < e->m; a++) at[e->n + a] = evaluate(g, e->y[a], x, work);
    const double f = off_by(e, at, 0, 0.0, work), size = fmax(1.0, fabs(f));
    if (isfinite(value) && isfinite(f) && fabs(f - value) > 1e-8 * size)
        luaL_error(L, "dm.extremum: f(x, y) is %f at a point where the value is %f", f, value);
    for (uint32_t a = 0; a < e->m; a++) {
        const double up = off_by(e, at, a, step, work), down = off_by(e, at, a, -step, work),
                     slope = (up - down) / (2 * step);
        const double bend = fabs(up - 2 * f + down) / (step * step);
        if (isfinite(slope) && isfinite(bend) && fabs(slope) > 1e-5 * (size + bend))
            luaL_error(L, "dm.extremum: f is not stationary at y: its derivative by y[%d] is %f",
                       (int)a + 1, slope);
    }
}

/* Raises where the function is not stationary in y where it should be. */
static void check(lua_State *L, const dm_graph *g, const dm_extremum *e) {
    const uint32_t inputs = dm_graph_inputs(g);
    const size_t room = (size_t)dm_graph_size(g) + dm_graph_size(e->of);
    double *x = lua_newuserdatauv(L, (2 * (size_t)inputs + e->m + room) * sizeof *x, 0);
    double *at = x + inputs, *work = at + inputs + e->m;
    for (int k = 0; k < POINTS; k++) {
        for (uint32_t i = 0; i < inputs; i++) x[i] = 0.4 + 0.35 * sin(1.7 * k + 2.3 * i);
        check_at(L, g, e, x, at, work);
    }
    lua_pop(L, 1);
}

/* y at 3 as nodes of the trace; 0 when one is of another kind */
static int read_y(lua_State *L, dml_frame *frame, uint32_t m, dm_node *y) {
    for (uint32_t a = 0; a < m; a++) {
        const dml_scalar x = dml_entry(L, 3, a);
        if (x.kind == DML_NUMBER)
            y[a] = dml_constant(L, frame, x.as.number);
        else if (x.kind == DML_SYMBOL && x.serial == frame->serial)
            y[a] = x.as.node;
        else
            return 0;
    }
    return 1;
}

/* trace f(q, v, y, t) on symbols of its own; with functions that are only known by an equation
 * the formula stays alone */
static void keep(lua_State *L, dml_frame *frame, dm_node value, uint32_t m) {
    dml_traced traced;
    const int n = (int)(dm_graph_inputs(frame->graph) - 1) / 2;
    dm_node *y = dm_arena_take(frame->arena, m * sizeof *y);
    if (!y) luaL_error(L, "not enough memory");
    if (!read_y(L, frame, m, y)) return;
    const dml_signature s = {.what = "the function of dm.extremum",
                             .arguments = 4,
                             .length = {n, n, (int)m, DML_SCALAR_ARGUMENT},
                             .outputs = DML_SCALAR_ARGUMENT};
    dml_trace(L, 2, &s, frame->arena, &traced);
    dml_checkgraph(L, frame);
    if (dm_has_roots(dml_owngraph(L, frame), &value, 1) ||
        dm_has_roots(traced.graph, traced.out, 1))
        return;
    const dm_extremum e = {.value = value,
                           .n = 2 * (uint32_t)n,
                           .m = m,
                           .y = y,
                           .of = traced.graph,
                           .f = traced.out[0]};
    check(L, dml_owngraph(L, frame), &e);
    dm_extremum_keep(dml_owngraph(L, frame), &e);
}

/* are the n entries at `arg` the inputs of the trace from number `first` on? */
static int are_inputs(lua_State *L, int arg, dm_graph *g, const dml_frame *frame, uint32_t first,
                      uint32_t n) {
    if (dml_length(L, arg) != (long)n) return 0;
    for (uint32_t i = 0; i < n; i++) {
        const dml_scalar x = dml_entry(L, arg, i);
        if (x.kind != DML_SYMBOL || x.serial != frame->serial ||
            x.as.node != dm_input(g, first + i))
            return 0;
    }
    return 1;
}

/* is this the Lagrangian of a system, at its own q and v? With sums that stay loops it is left
 * as it is. */
static int fits(lua_State *L, dml_frame *frame) {
    if (!frame || !frame->keeps_sums) return 0;
    dm_graph *g = dml_owngraph(L, frame);
    const uint32_t n = (dm_graph_inputs(g) - 1) / 2;
    return !dm_sums(g) && are_inputs(L, 4, g, frame, 0, n) && are_inputs(L, 5, g, frame, n, n);
}

/* (value, f, y, q, v): the value with the derivatives of the function at its stationary point. */
static int extremum(lua_State *L) {
    dml_scalar value;
    lua_settop(L, 5);
    luaL_argcheck(L, dml_toscalar(L, 1, &value), 1, "a number expected");
    luaL_checktype(L, 2, LUA_TFUNCTION);
    const long m = dml_length(L, 3);
    luaL_argcheck(L, m >= 1 && m <= MOST, 3, "a list of 1 to 64 numbers expected");
    dml_frame *frame = value.kind == DML_SYMBOL ? dml_findframe(L, value.serial) : NULL;
    if (fits(L, frame)) keep(L, frame, value.as.node, (uint32_t)m);
    lua_settop(L, 1);
    return 1;
}

static const dml_row functions[] =
    {{"extremum", extremum,
      "dm.extremum(value, f, y, q, v) -> value\n"
      "Says of the value that a Lagrangian returns at its own arguments q and v that it is f(q, v, "
      "y, t) at the y (a list) for which f is stationary: its derivatives are then made from those "
      "of f (f_x, and f_xx - f_xy f_yy^-1 f_yx), which is less to compute than those of a formula "
      "with y eliminated. Raises when f(q, v, y, t) is not the value, or not stationary at y. "
      "Changes nothing anywhere else."},
     {NULL, NULL, NULL}};

const dml_class dml_class_extremum = {
    .functions = functions,
};
