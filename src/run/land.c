#include "run/land.h"

#include <math.h>
#include <string.h>

static dm_status step_by(dm_stepper *s, double *out, const double *state, double t,
                         double h) {
    memcpy(out, state, dm_state_size(s->model->n) * sizeof *out);
    if (h == 0.0) return DM_OK;
    s->h = h;
    return s->method->step(s, out, t);
}

/* h with t(h) = target; t(0) is known, t grows with h nearly linearly */
static dm_status find_step(dm_stepper *s, double *out, const double *state,
                           double target) {
    enum { TRIES = 60 };
    const size_t own = 4 * (size_t)s->model->n;
    const double close = 2e-16 * fmax(fabs(target), fabs(state[own]));
    double a = 0.0, ta = state[own], b = s->h, last = INFINITY;
    for (int k = 0; k < TRIES; k++) {
        const dm_status status = step_by(s, out, state, state[own], b);
        if (status != DM_OK) return status;
        const double tb = out[own], gap = fabs(tb - target);
        if (gap <= close || (gap >= last && gap <= 1e3 * close)) return DM_OK;
        if (tb == ta) return DM_NO_CONVERGENCE;
        const double next = b + (target - tb) * (b - a) / (tb - ta);
        a = b, ta = tb, b = next, last = gap;
    }
    return DM_NO_CONVERGENCE;
}

dm_status dm_land(dm_stepper *s, double *out, const double *state, double t,
                  double target) {
    const double h = s->h;
    const dm_status status = s->method->traits & DM_OWN_TIME
                                 ? find_step(s, out, state, target)
                                 : step_by(s, out, state, t, target - t);
    s->h = h;
    return status;
}
