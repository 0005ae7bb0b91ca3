#include "integ/method/method.h"

/* The workspace was counted by the same engine, of the same model (dm_rule_engine). */
dm_status dm_stepper_open(dm_stepper *s) {
    s->engine = dm_rule_engine(s->rule, s->model);
    return s->engine->open(s);
}

dm_status dm_stepper_start(dm_stepper *s, double *state, double t, double h) {
    s->report.trouble = (dm_trouble){0};
    return s->engine->start ? s->engine->start(s, state, t, h) : DM_OK;
}

size_t dm_stepper_memory(dm_stepper *s, double **place) {
    return s->engine->memory ? s->engine->memory(s, place) : 0;
}

void dm_stepper_close(dm_stepper *s) {
    if (s->engine && s->engine->close) s->engine->close(s);
}

/* Engines that keep things in registers or arrays from step to step have a loop of their own. */
dm_status dm_advance(dm_stepper *s, double *state, double t, double h, long count, long *done) {
    return (s->engine->advance ? s->engine->advance : dm_advance_by_step)(s, state, t, h, count,
                                                                          done);
}

/* Times are computed from the number of the step, never summed. */
dm_status dm_advance_by_step(dm_stepper *s, double *state, double t, double h, long count,
                             long *done) {
    for (*done = 0; *done < count; ++*done) {
        const dm_status status = s->engine->step(s, state, t + (double)*done * h, h);
        if (status != DM_OK) return status;
    }
    return DM_OK;
}

/* One test for all entries, without a branch for each. */
int dm_state_is_finite(const double *state, uint32_t n) {
    const size_t size = dm_state_size(n), fours = size & ~(size_t)3;
    double sum[4] = {0.0}; /* 0 * infinity is NaN; four sums do not wait for each other */
    for (size_t i = 0; i < fours; i += 4)
        for (size_t k = 0; k < 4; k++) sum[k] += 0.0 * state[i + k];
    for (size_t i = fours; i < size; i++) sum[0] += 0.0 * state[i];
    return sum[0] + sum[1] + sum[2] + sum[3] == 0.0;
}
