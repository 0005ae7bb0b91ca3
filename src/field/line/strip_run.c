/* strip_run.c - levels one after the other. A run is a function of its start: what one step leaves
 * to the next are the levels before, for the guess. */
#include "field/line/strip_run.h"

#include <math.h>
#include <string.h>

enum { BURST = 16 }; /* steps between looks at the stop flag */

/* The start, and the last one also where `every` does not divide the steps. */
long dm_strip_plan_rows(const dm_strip_plan *plan) {
    return 1 + (plan->steps + plan->every - 1) / plan->every;
}

/* a guess of the upper level by what `known` levels tell: a parabola, a line, or the start */
static void extrapolate(dm_strip_room *room, long known) {
    const size_t size = dm_cell_upper(&room->strip->layout, 0);
    const double *u = room->memory, *a = room->old, *b = room->old + size;
    double *guess = room->memory + size;
    for (size_t i = 0; i < size && known == 2; i++) guess[i] = 2.0 * u[i] - a[i];
    for (size_t i = 0; i < size && known > 2; i++) guess[i] = 3.0 * (u[i] - a[i]) + b[i];
}

/* upper becomes lower, and that is remembered */
static void shift(dm_strip_room *room) {
    const size_t size = dm_cell_upper(&room->strip->layout, 0);
    memcpy(room->old + size, room->old, size * sizeof *room->old);
    memcpy(room->old, room->memory, size * sizeof *room->old);
    memcpy(room->memory, room->memory + size, size * sizeof *room->memory);
}

/* held values stay those of the lower level */
static void keep_held(dm_strip_room *room) {
    const dm_strip *s = room->strip;
    const uint32_t n = s->layout.values;
    for (uint32_t k = 0; k < n; k++) {
        const double *lower = room->memory + dm_cell_lower(&s->layout, k);
        double *upper = room->memory + dm_cell_upper(&s->layout, k);
        for (uint32_t i = 0; i < s->nodes; i++)
            if (s->held[(size_t)i * n + k]) upper[i] = lower[i];
        if (dm_strip_is_ring(s)) upper[s->nodes] = upper[0];
    }
}

/* what a run knows between steps */
typedef struct {
    const dm_strip_plan *plan;
    dm_strip_record *rows;
    dm_strip_outcome *outcome;
    double t, before, h;   /* of the level in hand, of the one before; height of the slab */
    double energy, target; /* target: of S_t - S_h, known after the first slab */
} runner;

/* -S_h and S_t of the slab */
static void read_energy(dm_strip_room *room, runner *r) {
    double sums[2];
    dm_strip_sum(room, &room->strip->energy, 2, sums);
    r->energy = sums[0];
    if (r->outcome->done == 0 || !room->strip->autonomous) r->target = sums[0];
}

/* The lower level, its momenta, and the energy of the slab below it. */
static void record(dm_strip_room *room, runner *r) {
    const size_t n = dm_strip_unknowns(room->strip), row = (size_t)r->outcome->rows++;
    dm_strip_get(room, 0, r->rows->u + row * n);
    if (r->rows->p) memcpy(r->rows->p + row * n, room->p, n * sizeof *room->p);
    if (r->rows->energy) r->rows->energy[row] = r->energy;
    r->rows->t[row] = r->t;
}

/* the last good level, whose energy was not asked for: its slab is put back for it */
static void record_last(dm_strip_room *room, runner *r) {
    const size_t size = dm_cell_upper(&room->strip->layout, 0);
    memcpy(room->memory + size, room->memory, size * sizeof *room->memory);
    memcpy(room->memory, room->old, size * sizeof *room->memory);
    dm_strip_set(room, DM_STRIP_TIME, r->before);
    dm_strip_set(room, DM_STRIP_HEIGHT, r->t - r->before);
    if (r->rows->energy) read_energy(room, r);
    shift(room);
    record(room, r);
}

/* the first cell of the upper level, from 1, that is turned inside out; 0: none */
static uint32_t find_tangled(const dm_strip_room *room) {
    const dm_strip *s = room->strip;
    if (!s->moving) return 0;
    const double *y = room->memory + dm_cell_upper(&s->layout, s->moving - 1);
    for (uint32_t c = 0; c < s->cells; c++)
        if (!(s->width + y[c + 1] - y[c] > 0.0)) return c + 1;
    return 0;
}

/* Is the level behind so many steps recorded? */
static int is_row(const dm_strip_plan *plan, long step) {
    return step % plan->every == 0 || step == plan->steps;
}

/* one slab more; room->memory is not usable after a failure but for the lower level */
static dm_status step(dm_strip_room *room, runner *r) {
    const dm_strip_plan *plan = r->plan;
    const long k = r->outcome->done;
    dm_strip_set(room, DM_STRIP_TIME, r->t);
    dm_strip_set(room, DM_STRIP_HEIGHT, r->h);
    extrapolate(room, k + 1 > 2 && plan->is_free ? 2 : k + 1);
    keep_held(room);
    dm_status status =
        dm_strip_solve(room, plan->is_free && k > 0 ? &r->h : NULL, r->target, &r->outcome->solve);
    r->outcome->h = r->h;
    if (status != DM_OK) return status;
    r->outcome->tangled = find_tangled(room);
    if (r->outcome->tangled) return DM_NO_CONVERGENCE;
    if (r->rows->energy && (plan->is_free || k == 0 || is_row(plan, k + 1))) read_energy(room, r);
    if (k == 0 && r->rows->energy) r->rows->energy[0] = r->energy;
    if (r->rows->p) dm_strip_momenta(room, room->p);
    shift(room);
    r->outcome->done++;
    r->before = r->t;
    r->t = plan->is_free ? r->t + r->h : plan->t0 + plan->h * (double)r->outcome->done;
    return DM_OK;
}

/* the start, and the guess of the level above it */
static void begin(dm_strip_room *room, runner *r) {
    const size_t n = dm_strip_unknowns(room->strip), upper = dm_cell_upper(&room->strip->layout, 0);
    dm_strip_put(room, 0, r->rows->u);
    dm_strip_put(room, upper, r->plan->guess ? r->plan->guess : r->rows->u);
    if (r->rows->p) memcpy(room->p, r->rows->p, n * sizeof *room->p);
    r->rows->t[0] = r->plan->t0;
    if (r->rows->energy) r->rows->energy[0] = NAN;
    r->outcome->rows = 1;
    room->checked = 0;
}

/* Rows are written as they come: those before a failure are whole. */
dm_status dm_strip_go(dm_strip_room *room, const dm_strip_plan *plan, dm_strip_record *rows,
                      dm_strip_outcome *outcome) {
    runner r = {.plan = plan, .rows = rows, .outcome = outcome, .t = plan->t0, .h = plan->h};
    dm_status status = DM_OK;
    *outcome = (dm_strip_outcome){.h = plan->h};
    begin(room, &r);
    while (status == DM_OK && outcome->done < plan->steps) {
        status = step(room, &r);
        if (status != DM_OK) break;
        if (is_row(plan, outcome->done)) record(room, &r);
        if (plan->stop && outcome->done % BURST == 0 && *plan->stop) status = DM_STOPPED;
    }
    if (status != DM_OK && outcome->done && !is_row(plan, outcome->done)) record_last(room, &r);
    return status;
}
