#include "run/interpolate.h"

#include <math.h>
#include <string.h>

/* A copy of the state goes h further; the state itself stays. */
static dm_status step_by(dm_stepper *s, double *out, const double *state, double t, double h) {
    memmove(out, state, dm_state_size(s->model->n) * sizeof *out);
    if (h == 0.0) return DM_OK;
    return s->engine->step(s, out, t, h);
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

/* h with t(h) = target; t(0) is known, t grows with h; `whole` is long enough */
static dm_status find_step(dm_stepper *s, double *out, const double *state, double target,
                           double whole) {
    enum { TRIES = 60 };
    const size_t own = 4 * (size_t)s->model->n;
    const double t0 = state[own], close = 2e-16 * fmax(fabs(target), fabs(t0));
    point a = {0.0, t0, 1.0 / s->engine->pace(s, state)}, b = {.h = a.slope * (target - t0)};
    double last = INFINITY;
    if (!(fabs(b.h) < fabs(whole))) b.h = whole;
    for (int k = 0; k < TRIES; k++) {
        const dm_status status = step_by(s, out, state, t0, b.h);
        if (status != DM_OK) return status;
        b.t = out[own];
        const double gap = fabs(b.t - target);
        if (gap <= close || (gap >= last && gap <= 1e3 * close)) return DM_OK;
        /* two points as close as round-off tell no slope: the one before is as good as any */
        if (gap >= last && last <= 1e3 * close) return step_by(s, out, state, t0, a.h);
        if (b.t == a.t) return DM_NO_CONVERGENCE;
        b.slope = 1.0 / s->engine->pace(s, out);
        const double next = interpolate(&a, &b, target);
        a = b;
        b.h = next;
        last = gap;
    }
    return DM_NO_CONVERGENCE;
}

/* what steps leave to each other is put away, as for a start */
static dm_status step_apart(dm_stepper *s, double *out, const double *state, double t, double h) {
    double *place;
    const size_t size = s->aside ? dm_stepper_memory(s, &place) : 0;
    if (!size || s->engine->keyed) return step_by(s, out, state, t, h);
    memcpy(s->aside, place, size * sizeof *place);
    dm_status status = dm_stepper_start(s, out, t, h);
    if (status == DM_OK) status = step_by(s, out, state, t, h);
    memcpy(place, s->aside, size * sizeof *place);
    return status;
}

dm_status dm_interpolate(dm_stepper *s, double *out, const double *state, double t, double target,
                         double h) {
    return s->rule->method->traits & DM_OWN_TIME ? find_step(s, out, state, target, h)
                                                 : step_apart(s, out, state, t, target - t);
}

dm_status dm_interpolate_finely(dm_stepper *s, double *out, const double *state, double t,
                                double target) {
    enum { MOST = 64 };
    dm_status status = DM_NO_CONVERGENCE;
    for (int parts = 2; parts <= MOST && status == DM_NO_CONVERGENCE; parts *= 2) {
        const double h = (target - t) / parts;
        status = step_apart(s, out, state, t, h);
        for (int i = 1; i < parts && status == DM_OK; i++)
            status = step_apart(s, out, out, t + i * h, h);
    }
    return status;
}

double dm_time_slack(const dm_stepper *s, double h, double from, double to) {
    const double length = s->rule->method->traits & DM_OWN_TIME ? to - from : h;
    return DM_TIME_SLACK * length + 0x1p-51 * fabs(to);
}
