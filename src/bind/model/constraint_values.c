/* constraint_values.c - the traces of constraints and forces beside the functions themselves, and
 * their values. */
#include "bind/model/model_constraints.h"

#include "base/random.h"
#include "bind/model/model_cache.h"
#include "code/tape/tape.h"

#include <math.h>
#include <string.h>

/* (q, t) or (q, v, t) out of (q, v, t) */
static void arguments_of(const dml_model *m, int which, const double *x, double *out) {
    const size_t n = m->n;
    memcpy(out, x, (2 * n + 1) * sizeof *x);
    if (which == DML_CONSTRAINT) out[n] = x[2 * n];
}

/* the constraint function as it was traced, on the tape; made once for all comparisons. NULL: no
 * memory for it */
static const dm_kernel *find_traced_kernel(dml_model *m, int which) {
    dm_kernel *kernel = m->constraint_kernel + which;
    const dml_traced *one = m->constraint + which;
    const int made = kernel->eval ||
                     dm_tape_build(kernel, one->graph, one->out, one->outputs, m->arena) == DM_OK;
    return made ? kernel : NULL;
}

static const dm_kernel *traced_kernel(lua_State *L, dml_model *m, int which) {
    const dm_kernel *kernel = find_traced_kernel(m, which);
    if (!kernel) luaL_error(L, "not enough memory");
    return kernel;
}

/* Raises at x what differs. */
void dml_checkconstraints(lua_State *L, int arg, dml_model *m, const double *x) {
    if (!m->constrained.graph) return;
    const int top = lua_gettop(L);
    arg = lua_absindex(L, arg);
    const size_t room = 2 * (size_t)m->n + 1;
    double *at = lua_newuserdatauv(L, (room + 2 * m->constrained.controls) * sizeof *at, 0);
    double *u = at + room, *held = u + m->constrained.controls;
    memset(at, 0, (room + 2 * m->constrained.controls) * sizeof *at);
    for (int i = 0; i < DML_CONSTRAINT_FUNCTIONS; i++) {
        if (!m->constraint[i].graph) continue;
        const dm_kernel *kernel = traced_kernel(L, m, i);
        const double *here = i == DML_MAP ? NULL : x; /* x = (q0, q1) is no (q, p) */
        if (x) arguments_of(m, i, x, at);
        if (x && i == DML_CONTROL) {
            dm_kernel_prepare(kernel, held);
            dm_kernel_eval(kernel, at, held);
        }
        if (m->constrained.controls) memcpy(u, held, m->constrained.controls * sizeof *u);
        const dml_signature s = dml_function_signature(m, dml_checksystem(L, arg)->pair, i);
        dml_push_constraint_function(L, arg, i);
        if (m->checked)
            dml_trace_check_start(L, lua_gettop(L), &s, kernel, here ? at : NULL);
        else
            dml_trace_check(L, lua_gettop(L), &s, kernel, here ? at : NULL);
        lua_pop(L, 1);
    }
    lua_settop(L, top);
}

/* inputs and outputs of all of them, one after the other; NULL: no memory */
static double *take_room(dml_model *m) {
    const size_t n = m->n, inputs = 2 * n + 1 + 2 * m->constrained.controls;
    size_t most = 0;
    for (int i = 0; i < DML_CONSTRAINT_FUNCTIONS; i++)
        most = m->constraint[i].outputs > most ? m->constraint[i].outputs : most;
    if (!m->room) m->room = dm_arena_take(m->arena, (inputs + most) * sizeof *m->room);
    if (m->room) memset(m->room, 0, (inputs + most) * sizeof *m->room);
    return m->room;
}

double dml_constraintsum(dml_model *m, int which, const double *x) {
    const uint32_t controls = m->constrained.controls;
    const dm_kernel *kernel = find_traced_kernel(m, which);
    const dm_kernel *control = controls ? find_traced_kernel(m, DML_CONTROL) : NULL;
    double *at = take_room(m), sum = 0.0;
    if (!kernel || !at || (controls && !control)) return NAN;
    double *u = at + 2 * (size_t)m->n + 1, *held = u + controls, *out = held + controls;
    arguments_of(m, which, x, at);
    if (control) {
        dm_kernel_prepare(control, held);
        dm_kernel_eval(control, x, held);
        memcpy(u, held, controls * sizeof *u);
    }
    dm_kernel_prepare(kernel, out);
    dm_kernel_eval(kernel, at, out);
    for (uint32_t i = 0; i < kernel->outputs; i++)
        sum += (1 + dm_random_uniform(4, (uint64_t)which, i)) * (isfinite(out[i]) ? out[i] : 1.0);
    return sum;
}

void dml_addforces(lua_State *L, dml_model *m, const double *x, double *p0, double *p1) {
    const size_t n = m->n;
    if (!m->constrained.graph || !m->constraints.forced) return;
    dml_want(L, m, DM_WANT_CONSTRAINT_FORCE, NULL);
    double *at = lua_newuserdatauv(L, (4 * n + 1 + 2 * n) * sizeof *at, 0), *F = at + 4 * n + 1;
    memset(at, 0, (4 * n + 1) * sizeof *at);
    memcpy(at, x, 2 * n * sizeof *at);
    dm_kernel_prepare(&m->constraints.force, F);
    dm_kernel_eval(&m->constraints.force, at, F);
    for (size_t i = 0; i < 2 * n; i++)
        if (!isfinite(F[i]))
            luaL_error(L, "force %d is not finite at (q0, q1): is it inside its domain?",
                       (int)i + 1);
    for (size_t i = 0; i < n; i++) p0[i] -= F[i];
    for (size_t i = 0; p1 && i < n; i++) p1[i] += F[n + i];
    lua_pop(L, 1);
}
