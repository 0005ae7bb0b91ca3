/* hyper_model.c - the kernels of mech/model.h from a function that runs on hyper-dual
 * numbers. */
#include "bind/model/bind_system.h"

#include <math.h>
#include <string.h>

typedef struct {
    dm_kernel value, slope, curve; /* f; df; df and d2f in all inputs */
    uint32_t n, inputs;
    double *buffer; /* inputs + inputs^2 */
} hyper;

/* dL/dq, dL/dv: of x = (q, v, t) the derivative by t is left out. */
static void eval_slope(const void *pool, const double *x, double *out) {
    const hyper *c = pool;
    dm_kernel_eval(&c->slope, x, c->buffer);
    memcpy(out, c->buffer, 2 * c->n * sizeof *out);
}

/* out = hessian rows [row, row+n) and columns [column, column+n) */
static double *block(double *out, const hyper *c, uint32_t row, uint32_t column) {
    const double *hessian = c->buffer + c->inputs;
    for (uint32_t i = 0; i < c->n; i++, out += c->n)
        memcpy(out, hessian + (row + i) * c->inputs + column, c->n * sizeof *out);
    return out;
}

/* Slopes and all second derivatives by q and v. */
static void eval_stage(const void *pool, const double *x, double *out) {
    const hyper *c = pool;
    dm_kernel_eval(&c->curve, x, c->buffer);
    memcpy(out, c->buffer, 2 * c->n * sizeof *out);
    out = block(out + 2 * c->n, c, 0, 0);
    out = block(out, c, 0, c->n);
    block(out, c, c->n, c->n);
}

/* dL/dq */
static void eval_force(const void *pool, const double *x, double *out) {
    const hyper *c = pool;
    dm_kernel_eval(&c->slope, x, c->buffer);
    memcpy(out, c->buffer, c->n * sizeof *out);
}

/* v . dL/dv - L */
static void eval_energy(const void *pool, const double *x, double *out) {
    const hyper *c = pool;
    double L;
    dm_kernel_eval(&c->value, x, &L);
    dm_kernel_eval(&c->slope, x, c->buffer);
    out[0] = -L;
    for (uint32_t i = 0; i < c->n; i++) out[0] += x[c->n + i] * c->buffer[c->n + i];
}

/* d2L/dv2 out of the whole Hessian. */
static void eval_mass(const void *pool, const double *x, double *out) {
    const hyper *c = pool;
    dm_kernel_eval(&c->curve, x, c->buffer);
    memcpy(out, c->buffer + c->n, c->n * sizeof *out);
    block(out + c->n, c, c->n, c->n);
}

/* Slopes and second derivatives by q0 and q1. */
static void eval_pair(const void *pool, const double *x, double *out) {
    const hyper *c = pool;
    dm_kernel_eval(&c->curve, x, c->buffer);
    memcpy(out, c->buffer, 2 * c->n * sizeof *out);
    block(out + 2 * c->n, c, 0, c->n);
}

/* c is its pool. */
static dm_kernel kernel(const hyper *c, dm_eval *eval, uint32_t outputs) {
    return (dm_kernel){.eval = eval,
                       .pool = c,
                       .inputs = c->inputs,
                       .outputs = outputs,
                       .backend = "hyperdual"};
}

/* What of `want` is missing; kernels live as long as the callback. */
void dml_hyperdual_model(lua_State *L, dml_model *m, unsigned want, int pair) {
    const uint32_t n = m->n, inputs = pair ? 2 * n : 2 * n + 1;
    hyper *c = dm_arena_take(m->arena, sizeof *c);
    double *buffer = dm_arena_take(m->arena, (inputs + (size_t)inputs * inputs) * sizeof *buffer);
    if (!c || !buffer) luaL_error(L, "not enough memory");
    *c = (hyper){.n = n, .inputs = inputs, .buffer = buffer};
    dml_hyperdual_kernel(m->callback, 0, &c->value);
    dml_hyperdual_kernel(m->callback, 1, &c->slope);
    dml_hyperdual_kernel(m->callback, 2, &c->curve);
    m->model.value = c->value;
    m->model.slope = kernel(c, eval_slope, 2 * n);
    m->model.stage = kernel(c, eval_stage, 2 * n + 3 * n * n);
    m->model.force = kernel(c, eval_force, n);
    m->model.energy = kernel(c, eval_energy, 1);
    m->model.mass = kernel(c, eval_mass, n + n * n);
    m->model.pair = kernel(c, eval_pair, 2 * n + n * n);
    m->model.has |= want;
}

/* the kernel is the function: it need only be a number, and the same one when asked again */
void dml_check_callback(lua_State *L, dml_model *m, const char *what, const double *x,
                        int may_be_outside) {
    double once = 0.0, again = 0.0;
    dm_kernel_eval(&m->model.value, x, &once);
    dm_kernel_eval(&m->model.value, x, &again);
    dml_rethrow(L, m);
    if (once != once && may_be_outside) return;
    if (once != once)
        luaL_error(L,
                   "%s is NaN at the start: is the start inside its domain (a logarithm, root or "
                   "quotient)?",
                   what);
    if (once != again)
        luaL_error(L,
                   "%s gives %f and then %f at the same point: does it use random numbers, or a "
                   "counter?",
                   what, once, again);
}
