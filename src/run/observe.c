#include "run/observe.h"

#include <math.h>
#include <string.h>

uint32_t dm_observer_width(const dm_observer *o) {
    uint32_t width = 0;
    for (uint32_t i = 0; i < o->count; i++)
        width += o->list[i].kernel  ? o->list[i].kernel->outputs
                 : o->list[i].parts ? o->list[i].count
                                    : 1;
    return width;
}

/* x = (q, v, t, p); the search for v begins at rest, or, where that fails, at p: never at what
 * was seen before, so that a number depends on its state alone */
static dm_status place(dm_observer *o, const double *state, double t) {
    const uint32_t n = o->model->n;
    memcpy(o->x, state, n * sizeof *o->x);
    o->x[2 * n] = t;
    memcpy(o->x + 2 * n + 1, state + n, n * sizeof *o->x);
    if (!o->work) return DM_OK;
    memset(o->x + n, 0, n * sizeof *o->x);
    const dm_status status = dm_legendre_inverse(o->model, o->x + n, state, state + n, t, o->work);
    if (status == DM_OK) return DM_OK;
    memcpy(o->x + n, state + n, n * sizeof *o->x);
    return dm_legendre_inverse(o->model, o->x + n, state, state + n, t, o->work);
}

/* the inputs of an observable */
static const double *inputs_of(const dm_observer *o, const dm_observable *what) {
    const uint32_t n = o->model->n, params = o->model->params;
    double *own = o->x + 3 * n + 1;
    const int phase = (o->model->structure & DM_HAMILTONIAN) != 0; /* of (q, p, t) */
    if (!what->of_model || !(params || phase)) return o->x;
    memcpy(own, o->x, (2 * n + 1) * sizeof *own);
    if (phase) memcpy(own + n, o->x + 2 * n + 1, n * sizeof *own);
    if (params) memcpy(own + 2 * n + 1, o->params, params * sizeof *own);
    return own;
}

/* Constant outputs are written anew every time, since rows lie at different places. */
dm_status dm_observe(dm_observer *o, double *out, const double *state, double t) {
    const dm_status status = place(o, state, t);
    if (status != DM_OK) return status;
    for (uint32_t i = 0; i < o->count; i++) {
        const dm_observable *what = o->list + i;
        if (what->kernel) {
            dm_kernel_prepare(what->kernel, out);
            dm_kernel_eval(what->kernel, inputs_of(o, what), out);
            out += what->kernel->outputs;
        } else if (what->parts) {
            what->parts->engine->parts(what->parts, out, state, t, what->entry, what->count);
            out += what->count;
        } else {
            *out++ = state[what->entry];
        }
    }
    return DM_OK;
}

/* An infinite number is one that a script may mean: a slope, or a logarithm of 0. */
dm_status dm_observe_row(dm_observer *o, double *out, const double *state, double t) {
    const dm_status status = dm_observe(o, out, state, t);
    const uint32_t width = dm_observer_width(o);
    if (status != DM_OK || o->gaps) return status;
    for (uint32_t i = 0; i < width; i++) {
        if (!isnan(out[i])) continue;
        o->missing = i + 1, o->missed = t;
        return DM_NO_VALUE;
    }
    return DM_OK;
}
