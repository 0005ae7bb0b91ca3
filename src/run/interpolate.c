#include "run/interpolate.h"

#include <math.h>
#include <string.h>

static dm_status step_by(dm_stepper *s, double *out, const double *state, double t, double h) {
    memcpy(out, state, dm_state_size(s->model->n) * sizeof *out);
    if (h == 0.0) return DM_OK;
    s->h = h;
    return s->method->step(s, out, t);
}

/* a length of step, the time it leads to, and dh/dt there */
typedef struct {
    double h, t, slope;
} point;

/* h at time t of the cubic through both, from b */
static double interpolate(const point *a, const point *b, double t) {
    const double d = a->t - b->t, w = (t - b->t) / d, u = 1.0 - w;
    return b->h + (a->h - b->h) * w * w * (3.0 - 2.0 * w) +
           d * w * u * (b->slope * u - a->slope * w);
}

/* h with t(h) = target; t(0) is known, t grows with h */
static dm_status find_step(dm_stepper *s, double *out, const double *state, double target) {
    enum { TRIES = 60 };
    const size_t own = 4 * (size_t)s->model->n;
    const double t0 = state[own], close = 2e-16 * fmax(fabs(target), fabs(t0));
    const double whole = s->h;
    point a = {0.0, t0, 1.0 / s->method->pace(s, state)}, b = {.h = a.slope * (target - t0)};
    double last = INFINITY;
    if (!(fabs(b.h) < fabs(whole))) b.h = whole;
    for (int k = 0; k < TRIES; k++) {
        const dm_status status = step_by(s, out, state, t0, b.h);
        if (status != DM_OK) return status;
        b.t = out[own];
        const double gap = fabs(b.t - target);
        if (gap <= close || (gap >= last && gap <= 1e3 * close)) return DM_OK;
        if (b.t == a.t) return DM_NO_CONVERGENCE;
        b.slope = 1.0 / s->method->pace(s, out);
        const double next = interpolate(&a, &b, target);
        a = b;
        b.h = next;
        last = gap;
    }
    return DM_NO_CONVERGENCE;
}

/* what the method keeps from step to step is of the run, not of the step on the side */
static void swap_memory(dm_stepper *s, int back) {
    double *place;
    const size_t size = s->aside && s->method->memory ? s->method->memory(s, &place) : 0;
    if (!size) return;
    memcpy(back ? place : s->aside, back ? s->aside : place, size * sizeof *place);
}

dm_status dm_land(dm_stepper *s, double *out, const double *state, double t, double target) {
    const double h = s->h;
    swap_memory(s, 0);
    const dm_status status = s->method->traits & DM_OWN_TIME
                                 ? find_step(s, out, state, target)
                                 : step_by(s, out, state, t, target - t);
    s->h = h;
    swap_memory(s, 1);
    return status;
}
