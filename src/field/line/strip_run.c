/* strip_run.c - levels one after the other. A run is a function of its start: what one step leaves
 * to the next are the levels before, for the guess. */
#include "field/line/strip_run.h"

#include <math.h>
#include <string.h>

enum { BURST = 16, LOOK = 64 };      /* slabs between looks at the stop flag, at the energy */
static const double GROWN = 0x1p104; /* energy over that of the start: no digit of it is left */

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
    dm_strip_ending at;
} runner;

/* -S_h and S_t of the slab */
static void read_energy(dm_strip_room *room, runner *r) {
    double sums[2];
    dm_strip_sum(room, &room->strip->energy, 2, sums);
    r->at.energy = sums[0];
    if (r->at.done > 0 && room->strip->autonomous) return;
    r->at.target = sums[0];
    if (r->at.done == 0) r->at.scale = dm_strip_size(room, &room->strip->energy);
}

/* sum of |p u_t|, which no instability outgrows by its energy */
static double motion_of(const dm_strip_room *room, double h) {
    const dm_strip *s = room->strip;
    const uint32_t n = s->layout.values;
    double sum = 0.0;
    for (uint32_t i = 0; i < s->nodes; i++)
        for (uint32_t k = 0; k < n; k++)
            sum += fabs(room->p[(size_t)i * n + k] * dm_strip_moved(room, i, k));
    return sum / h;
}

/* Has the energy, read just now, grown as no motion makes it? Errors of a motion that leaves an
 * unstable rest are far below p u_t. */
static int is_blown_up(dm_strip_room *room, runner *r) {
    if (!room->strip->autonomous) return 0;
    const double off = fabs(r->at.energy - r->at.target);
    r->at.most = fmax(r->at.most, motion_of(room, r->at.h));
    return off > GROWN * r->at.scale && off > 0.1 * r->at.most;
}

/* The lower level, its momenta, and the energy of the slab below it. */
static void record(dm_strip_room *room, runner *r) {
    const size_t n = dm_strip_unknowns(room->strip), row = (size_t)r->outcome->rows++;
    dm_strip_get(room, 0, r->rows->u + row * n);
    if (r->rows->p) memcpy(r->rows->p + row * n, room->p, n * sizeof *room->p);
    if (r->rows->energy) r->rows->energy[row] = r->at.energy;
    r->rows->t[row] = r->at.t;
}

/* the last good level, whose energy was not asked for: its slab is put back for it */
static void record_last(dm_strip_room *room, runner *r) {
    const size_t size = dm_cell_upper(&room->strip->layout, 0);
    memcpy(room->memory + size, room->memory, size * sizeof *room->memory);
    memcpy(room->memory, room->old, size * sizeof *room->memory);
    dm_strip_set(room, DM_STRIP_TIME, r->at.before);
    dm_strip_set(room, DM_STRIP_HEIGHT, r->at.t - r->at.before);
    if (r->rows->energy) read_energy(room, r);
    memcpy(room->memory, room->memory + size, size * sizeof *room->memory);
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

/* Is the level behind so many slabs of this run recorded? */
static int is_row(const dm_strip_plan *plan, long step) {
    return step % plan->every == 0 || step == plan->steps;
}

/* Is the energy of the slab above so many slabs, from t0, wanted? */
static int is_wanted(const runner *r) {
    if (!r->rows->energy) return 0;
    return r->plan->is_free || r->at.done == 0 || (r->at.done + 1) % LOOK == 0 ||
           is_row(r->plan, r->outcome->done + 1);
}

/* what follows a level that is solved: its energy and momenta, then it is the lower one */
static dm_status finish(dm_strip_room *room, runner *r) {
    const dm_strip_plan *plan = r->plan;
    const int wanted = is_wanted(r);
    if (wanted) read_energy(room, r);
    if (r->at.done == 0 && r->rows->energy) r->rows->energy[0] = r->at.energy;
    if (r->rows->p) dm_strip_momenta(room, room->p);
    const int blown_up = wanted && is_blown_up(room, r);
    shift(room);
    r->outcome->done++;
    r->at.done++;
    r->at.before = r->at.t;
    r->at.t = plan->is_free ? r->at.t + r->at.h : plan->t0 + plan->h * (double)r->at.done;
    return blown_up ? DM_BLOW_UP : DM_OK;
}

/* one slab more; room->memory is not usable after a failure but for the lower level */
static dm_status step(dm_strip_room *room, runner *r) {
    const int is_free = r->plan->is_free;
    const long known = r->at.done + 1;
    double h = r->at.h;
    dm_strip_set(room, DM_STRIP_TIME, r->at.t);
    dm_strip_set(room, DM_STRIP_HEIGHT, h);
    extrapolate(room, known > 2 && is_free ? 2 : known);
    keep_held(room);
    const dm_status status =
        dm_strip_solve(room, is_free && known > 1 ? &h : NULL, r->at.target, &r->outcome->solve);
    r->outcome->h = h;
    if (status != DM_OK) return status;
    r->outcome->tangled = find_tangled(room);
    if (r->outcome->tangled) return DM_NO_CONVERGENCE;
    r->at.h = h;
    return finish(room, r);
}

/* the start, and the guess of the level above it, or the levels before */
static void begin(dm_strip_room *room, runner *r) {
    const dm_strip_plan *plan = r->plan;
    const size_t n = dm_strip_unknowns(room->strip), upper = dm_cell_upper(&room->strip->layout, 0);
    r->at = plan->from ? *plan->from : (dm_strip_ending){.t = plan->t0, .h = plan->h};
    dm_strip_put(room, 0, r->rows->u);
    dm_strip_put(room, upper, plan->guess ? plan->guess : r->rows->u);
    for (int k = 0; k < 2 && plan->from; k++) dm_strip_put_old(room, k, plan->old + (size_t)k * n);
    if (r->rows->p) memcpy(room->p, r->rows->p, n * sizeof *room->p);
    r->rows->t[0] = r->at.t;
    if (r->rows->energy) r->rows->energy[0] = plan->from ? r->at.energy : NAN;
    r->outcome->rows = 1;
    room->checked = plan->from && plan->from->done > 0;
}

/* Rows are written as they come: those before a failure are whole. */
dm_status dm_strip_go(dm_strip_room *room, const dm_strip_plan *plan, dm_strip_record *rows,
                      dm_strip_outcome *outcome) {
    runner r = {.plan = plan, .rows = rows, .outcome = outcome};
    dm_status status = DM_OK;
    *outcome = (dm_strip_outcome){.h = plan->h};
    begin(room, &r);
    while (status == DM_OK && outcome->done < plan->steps) {
        const long done = outcome->done;
        status = step(room, &r);
        if (outcome->done > done && is_row(plan, outcome->done)) record(room, &r);
        if (status == DM_OK && plan->stop && outcome->done % BURST == 0 && *plan->stop)
            status = DM_STOPPED;
    }
    if (status != DM_OK && outcome->done && !is_row(plan, outcome->done)) record_last(room, &r);
    outcome->ending = r.at;
    return status;
}
