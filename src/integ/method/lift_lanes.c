/* lift_lanes.c - members of an ensemble on a group side by side: lifted states in lanes of the
 * base, from the start of a burst to its end.
 * Speed: bodies, heavy tops by gauss(2): 3x, against a member after the other. */
#include "integ/method/cache.h"
#include "integ/method/lanes.h"
#include "integ/method/lift_inside.h"

#include <string.h>

/* Lanes of the base, and states and memories of the run beside them, as many. */
static int open_members(dm_lift *l, dm_stepper *s, dm_lanes *x) {
    double *place;
    const size_t kept = dm_stepper_memory(s, &place);
    if (!dm_lanes_open_told(x, s->model, (uint32_t)dm_state_size(l->n), kept)) return 0;
    if (x->lanes != l->wide.lanes || !l->wide.failed) return 0;
    if (x->groups > l->wide.groups) x->groups = l->wide.groups;
    x->paced = l->wide.paced;
    return 1;
}

/* Those of the model's last ensemble by a rule that leaves as much. */
int dm_lift_widen(dm_stepper *s, dm_lanes *x) {
    static const char maker;
    dm_lift *l = dm_lift_of(s);
    const dm_engine *e = l->base.engine;
    dm_kernel kept;
    if (!e->widen || !e->widen(&l->base, &l->wide)) return 0;
    const uint32_t paced = (uint32_t)l->wide.paced; /* 0 or 1 */
    const uint32_t which = ((uint32_t)l->base_memory * 2 + paced) * 16 + l->wide.lanes;
    if (dm_cache_find(&kept, s->model, &maker, which)) {
        memcpy(x, kept.pool, sizeof *x);
        x->groups = x->groups > l->wide.groups ? l->wide.groups : x->groups;
        return 1;
    }
    dm_lanes *made = dm_arena_take(s->model->source.arena, sizeof *made);
    if (!made || !open_members(l, s, made)) return 0;
    dm_cache_add(s->model, &maker, which, &(dm_kernel){.pool = made}, made->lanes);
    *x = *made;
    return 1;
}

/* what member i leaves to its next step: to the stepper, and back */
static void get_memory(const dm_lanes *x, uint32_t i, double *memory) {
    const double *from = dm_lanes_memory(x, i);
    for (size_t k = 0; k < x->memory_size; k++) memory[k] = from[k * x->lanes];
}

static void put_memory(const dm_lanes *x, uint32_t i, const double *memory) {
    double *to = dm_lanes_memory(x, i);
    for (size_t k = 0; k < x->memory_size; k++) to[k * x->lanes] = memory[k];
}

/* member i into its lane of the base */
static void enter_member(dm_lift *l, dm_lanes *x, uint32_t i) {
    dm_lanes *wide = &l->wide;
    x->done[i] = 0;
    wide->failed[i] = DM_STOPPED;
    if (x->failed[i] != DM_OK) return;
    dm_lanes_get(x, l->n, i, x->alone);
    get_memory(x, i, l->memory);
    x->failed[i] = dm_lift_enter(l, x->alone);
    if (x->failed[i] != DM_OK) return;
    wide->failed[i] = DM_OK;
    put_memory(x, i, l->memory);
    dm_lanes_put(wide, l->n, i, l->lifted);
    put_memory(wide, i, l->of_base);
}

/* and back */
static void leave_member(dm_lift *l, dm_lanes *x, uint32_t i) {
    dm_lanes_get(&l->wide, l->n, i, l->lifted);
    get_memory(x, i, l->memory);
    get_memory(&l->wide, i, l->of_base);
    dm_lift_leave(l, x->alone);
    dm_lanes_put(x, l->n, i, x->alone);
    put_memory(x, i, l->memory);
}

/* what a step of member i may ask for: p or q changed without the element and its momentum */
static dm_status settle_member(dm_lift *l, dm_lanes *x, uint32_t i) {
    dm_lanes_get(&l->wide, l->n, i, l->lifted);
    get_memory(x, i, l->memory);
    const dm_status status = dm_lift_settle(l);
    put_memory(x, i, l->memory);
    dm_lanes_put(&l->wide, l->n, i, l->lifted);
    return status;
}

/* |p|^2 of the members of a group */
static void find_squares(const dm_lift *l, const dm_lanes *wide, uint32_t group, double *out) {
    const uint32_t lanes = wide->lanes;
    const double *p = dm_lanes_member(wide, l->n, group * lanes) + l->n * lanes;
    for (uint32_t k = 0; k < lanes; k++) out[k] = 0.0;
    for (uint32_t i = 0; i < l->n; i++, p += lanes)
        for (uint32_t k = 0; k < lanes; k++) out[k] += p[k] * p[k];
}

/* Most steps ask for nothing: they are counted, by |p| or by their number. */
static void settle_group(dm_lift *l, dm_lanes *x, uint32_t group) {
    const uint32_t lanes = x->lanes, first = group * lanes;
    double square[8];
    if (!l->above) find_squares(l, &l->wide, group, square);
    for (uint32_t k = 0; k < lanes; k++) {
        const uint32_t i = first + k;
        if (l->wide.failed[i] != DM_OK) continue;
        double *memory = dm_lanes_memory(x, i), *since = memory + DM_LIFT_SINCE * lanes;
        const int rests =
            l->above ? *since + 1.0 < DM_LIFT_SELDOM : square[k] <= memory[DM_LIFT_BOUND * lanes];
        if (rests)
            *since += 1.0;
        else
            l->wide.failed[i] = settle_member(l, x, i);
    }
}

/* one step of the base for all; who fails keeps what it has */
static void step_members(dm_lift *l, dm_lanes *x, double t, const double *h) {
    const uint32_t all = x->groups * x->lanes;
    l->base.engine->advance_lanes(&l->base, &l->wide, t, h, 1);
    for (uint32_t g = 0; g < x->groups && l->n > l->d; g++) settle_group(l, x, g);
    for (uint32_t i = 0; i < all; i++) {
        if (x->failed[i] != DM_OK) continue;
        x->failed[i] = l->wide.failed[i];
        x->done[i] += x->failed[i] == DM_OK;
    }
}

void dm_lift_advance_lanes(dm_stepper *s, dm_lanes *x, double t, const double *h, long count) {
    dm_lift *l = dm_lift_of(s);
    const uint32_t all = x->groups * x->lanes;
    uint32_t entered[DM_LANES_GROUPS * 8], many = 0;
    l->wide.groups = x->groups;
    for (uint32_t i = 0; i < all; i++) {
        enter_member(l, x, i);
        if (l->wide.failed[i] == DM_OK) entered[many++] = i;
    }
    for (long k = 0; k < count; k++) step_members(l, x, t + (double)k * *h, h);
    for (uint32_t i = 0; i < many; i++)
        if (x->done[entered[i]]) leave_member(l, x, entered[i]);
}
