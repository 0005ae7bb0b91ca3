/* lanes.c - memory and packing of members side by side, [entry][lane] from the start of a block
 * to its end.
 * Speed: steps, leapfrog ensemble of Kepler orbits: 19x, against one member after the other. */
#include "integ/method/lanes.h"

#include "code/native/jit.h"

#include <math.h>
#include <string.h>

/* bytes that stay in the first-level cache; enough groups hide the latency of a stage */
enum { NEAR = 24576 };

/* At least one, at most as many as states beside each other stay near. */
static uint32_t choose_groups(uint32_t size, uint32_t lanes) {
    const size_t fit = NEAR / ((size_t)size * lanes * sizeof(double));
    return fit < 1 ? 1 : fit > DM_LANES_GROUPS ? DM_LANES_GROUPS : (uint32_t)fit;
}

/* States first, then the saved ones and one member's, then parameters; states begin at zero, so
 * that a lane without a member is harmless. */
int dm_lanes_open(dm_lanes *x, const dm_model *m, uint32_t size) {
    const uint32_t lanes = dm_jit_lanes();
    if (lanes < 4) return 0;
    *x = (dm_lanes){.lanes = lanes, .groups = choose_groups(size, lanes)};
    const size_t one = dm_state_size(m->n), members = (size_t)lanes * x->groups;
    const size_t all = members * one;
    x->state =
        dm_arena_take(m->source.arena, (2 * all + one + members * m->params) * sizeof *x->state);
    if (!x->state) return 0;
    x->kept = x->state + all;
    x->alone = x->kept + all;
    x->params = x->alone + one;
    memset(x->state, 0, all * sizeof *x->state);
    return 1;
}

int dm_lanes_open_told(dm_lanes *x, const dm_model *m, uint32_t size, size_t memory_size) {
    dm_arena *arena = m->source.arena;
    if (!dm_lanes_open(x, m, size)) return 0;
    const size_t members = (size_t)x->lanes * x->groups;
    x->memory_size = memory_size;
    x->memory = dm_arena_take(arena, members * memory_size * sizeof *x->memory);
    x->failed = dm_arena_take(arena, members * sizeof *x->failed);
    x->trouble = dm_arena_take(arena, members * sizeof *x->trouble);
    x->done = dm_arena_take(arena, members * sizeof *x->done);
    if (!x->memory || !x->failed || !x->trouble || !x->done) return 0;
    memset(x->memory, 0, members * memory_size * sizeof *x->memory);
    return 1;
}

/* one step of member i by the stepper itself */
static void step_alone(dm_stepper *s, dm_lanes *x, uint32_t i, double t, double h) {
    const uint32_t n = s->model->n;
    const size_t size = x->memory_size;
    double *place, *memory = dm_lanes_memory(x, i);
    dm_stepper_memory(s, &place);
    dm_lanes_get(x, n, i, x->alone);
    for (size_t k = 0; k < size; k++) place[k] = memory[k * x->lanes];
    s->report.trouble = (dm_trouble){0};
    x->failed[i] = s->engine->step(s, x->alone, t, h);
    x->trouble[i] = s->report.trouble;
    if (x->failed[i] != DM_OK) return;
    dm_lanes_put(x, n, i, x->alone);
    for (size_t k = 0; k < size; k++) memory[k * x->lanes] = place[k];
    x->done[i]++;
}

void dm_lanes_advance_group(dm_stepper *s, dm_lanes *x, uint32_t group, double t, const double *h,
                            long count, dm_lanes_step *step, void *method) {
    const uint32_t first = group * x->lanes;
    uint32_t asked = 0;
    for (uint32_t l = 0; l < x->lanes; l++) {
        x->done[first + l] = 0;
        if (x->failed[first + l] == DM_OK) asked |= 1u << l;
    }
    for (long k = 0; k < count && asked; k++) {
        const double now = t + (double)k * *h;
        const uint32_t ready = step(method, asked, now);
        for (uint32_t l = 0; l < x->lanes; l++) {
            if (!(asked >> l & 1)) continue;
            if (ready >> l & 1)
                x->done[first + l]++;
            else
                step_alone(s, x, first + l, now, h[l]);
            if (x->failed[first + l] != DM_OK) asked &= ~(1u << l);
        }
    }
}

/* Entries of a member are as far apart as there are lanes; 4 n of them are q, p and low parts.
 * Taken by four: ensembles.lua, start, one step, end: 1.02x. */
void dm_lanes_put(dm_lanes *x, uint32_t n, uint32_t i, const double *state) {
    double *to = dm_lanes_member(x, n, i);
    const size_t lanes = x->lanes;
    for (size_t k = 0; k < n; k++, state += 4, to += 4 * lanes) {
        to[0] = state[0], to[lanes] = state[1];
        to[2 * lanes] = state[2], to[3 * lanes] = state[3];
    }
    for (size_t k = 0; k < DM_STATE_OWN; k++) to[k * lanes] = state[k];
}

/* And back into one state. */
void dm_lanes_get(const dm_lanes *x, uint32_t n, uint32_t i, double *state) {
    const double *from = dm_lanes_member(x, n, i);
    const size_t lanes = x->lanes;
    for (size_t k = 0; k < n; k++, state += 4, from += 4 * lanes) {
        state[0] = from[0], state[1] = from[lanes];
        state[2] = from[2 * lanes], state[3] = from[3 * lanes];
    }
    for (size_t k = 0; k < DM_STATE_OWN; k++) state[k] = from[k * lanes];
}

/* their sum is not, where one is not */
int dm_lanes_are_finite(const dm_lanes *x, uint32_t n) {
    const size_t count = x->groups * dm_state_size(n) * x->lanes;
    double sum[8] = {0.0}, all = 0.0;
    for (size_t i = 0; i + 8 <= count; i += 8)
        for (int k = 0; k < 8; k++) sum[k] += x->state[i + (size_t)k];
    for (size_t i = count / 8 * 8; i < count; i++) all += x->state[i];
    for (int k = 0; k < 8; k++) all += sum[k];
    return isfinite(all);
}

/* NaN and infinity survive the product with zero. */
int dm_lanes_is_finite(const dm_lanes *x, uint32_t n, uint32_t i) {
    const double *from = dm_lanes_member(x, n, i);
    double sum = 0.0; /* 0 * infinity is NaN */
    for (size_t k = 0; k < dm_state_size(n); k++) sum += 0.0 * from[k * x->lanes];
    return sum == 0.0;
}
