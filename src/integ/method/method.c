#include "integ/method/method.h"

#include "mech/constraints.h"

unsigned dm_method_needs(const dm_model *m) {
    unsigned needs = 0;
    if (m->constraints && m->constraints->holonomic) needs |= DM_HOLONOMIC;
    if (m->constraints && m->constraints->rolling) needs |= DM_ROLLING;
    if (m->constraints && m->constraints->forced) needs |= DM_FORCED;
    return needs;
}

dm_status dm_advance(dm_stepper *s, double *state, double t, double h, long count, long *done) {
    if (s->method->advance) return s->method->advance(s, state, t, h, count, done);
    return dm_advance_by_step(s, state, t, h, count, done);
}

dm_status dm_advance_by_step(dm_stepper *s, double *state, double t, double h, long count,
                             long *done) {
    for (*done = 0; *done < count; ++*done) {
        const dm_status status = s->method->step(s, state, t + (double)*done * h, h);
        if (status != DM_OK) return status;
    }
    return DM_OK;
}

int dm_state_is_finite(const double *state, uint32_t n) {
    const size_t size = dm_state_size(n), whole = size & ~(size_t)3;
    double sum[4] = {0.0}; /* 0 * infinity is NaN; four sums do not wait for each other */
    for (size_t i = 0; i < whole; i += 4)
        for (size_t k = 0; k < 4; k++) sum[k] += 0.0 * state[i + k];
    for (size_t i = whole; i < size; i++) sum[0] += 0.0 * state[i];
    return sum[0] + sum[1] + sum[2] + sum[3] == 0.0;
}
