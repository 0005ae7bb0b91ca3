/* avi.c - drifts, kicks, and what may fire next. */
#include "field/avi/avi_inside.h"

#include <math.h>
#include <string.h>

enum { LOOK = 4096 }; /* events between two looks at the stop flag */

static double *take(dm_arena *arena, size_t count) {
    double *x = dm_arena_take(arena, (count + 1) * sizeof *x);
    if (x) memset(x, 0, (count + 1) * sizeof *x);
    return x;
}

dm_status dm_avi_open(dm_avi *a, const dm_sum *const *sums, const dm_avi_factors *f, uint32_t count,
                      uint32_t n, dm_compile *compile, dm_arena *arena) {
    *a = (dm_avi){.n = n, .factors = *f};
    a->sum = dm_arena_take(arena, (count + 1) * sizeof *a->sum);
    if (!a->sum) return DM_NO_MEMORY;
    for (uint32_t k = 0; k < count; k++) {
        dm_avi_sum *s = a->sum + a->sums;
        const dm_status status = dm_avi_sum_open(s, sums[k], n, compile, arena);
        if (status != DM_OK) return status;
        if (!s->kicks) continue; /* the kinetic energy */
        s->factor = f->value[k];
        s->which = k;
        s->first = a->cells;
        a->cells += sums[k]->bodies;
        a->sums++;
    }
    const size_t cells = (size_t)a->cells + 1;
    a->x = take(arena, 2 * (size_t)n + 1);
    a->p = take(arena, n);
    a->h = take(arena, a->cells);
    a->at = dm_arena_take(arena, ((size_t)n + 1) * sizeof *a->at);
    a->cell = dm_arena_take(arena, cells * sizeof *a->cell);
    a->ready = dm_arena_take(arena, cells * sizeof *a->ready);
    a->later = dm_arena_take(arena, cells * sizeof *a->later);
    if (!a->x || !a->p || !a->h || !a->at || !a->cell || !a->ready || !a->later)
        return DM_NO_MEMORY;
    return DM_OK;
}

/* ---- kicks ---- */

/* what a sum is multiplied by at time t */
static inline double factor_at(const dm_avi *a, const dm_avi_sum *s, double t) {
    const dm_avi_factors *f = &a->factors;
    if (!f->of_t) return s->factor;
    f->in[f->at] = t;
    dm_kernel_eval(f->of_t, f->in, f->out);
    return f->out[s->which];
}

/* the entries of a cell, at time t */
static inline void drift(dm_avi *a, const uint32_t *entry, uint32_t reads, double t) {
    for (uint32_t r = 0; r < reads; r++) {
        dm_avi_entry *e = a->at + entry[r];
        e->x += (t - e->last) * (e->w * e->p);
        e->last = t;
    }
}

/* p += h dL/dx of one cell at time t, where its entries stand; what is held keeps its p */
static inline void kick(dm_avi *a, const dm_avi_sum *s, uint32_t i, double h, double t) {
    const uint32_t *entry = s->entry + (size_t)i * s->reads;
    dm_avi_slopes(a, s, i, t);
    const double scale = h * factor_at(a, s, t);
    for (uint32_t k = 0; k < s->kicks; k++) {
        dm_avi_entry *e = a->at + entry[s->kick[k].entry];
        const double by = scale * s->y[s->kick[k].output];
        if (e->w != 0.0) e->p += s->kick[k].minus ? -by : by;
    }
}

/* as far as rounding tells times apart */
static double slack(double h) {
    return 1e-10 * h;
}

dm_status dm_avi_start(dm_avi *a, double t0, int half, dm_arena *arena) {
    const dm_status status = a->near ? DM_OK : dm_avi_find_near(a, arena);
    if (status != DM_OK) return status;
    a->t0 = t0;
    a->half = half;
    a->events = 0;
    for (uint32_t i = 0; i < a->n; i++) a->at[i] = (dm_avi_entry){a->x[i], a->p[i], a->w[i], t0};
    for (uint32_t k = 0; k < a->cells; k++) {
        a->cell[k] = (dm_avi_cell){.time = t0 + a->h[k], .h = a->h[k]};
        const dm_avi_sum *s = dm_avi_sum_of(a, k);
        if (half) kick(a, s, k - s->first, 0.5 * a->h[k], t0);
    }
    dm_avi_order(a);
    return DM_OK;
}

/* ---- where a run stands ---- */

size_t dm_avi_state_size(const dm_avi *a) {
    return 3 * (size_t)a->n + a->cells;
}

void dm_avi_state(const dm_avi *a, double *state) {
    double *p = state + a->n, *last = p + a->n, *fired = last + a->n;
    for (uint32_t i = 0; i < a->n; i++)
        state[i] = a->at[i].x, p[i] = a->at[i].p, last[i] = a->at[i].last;
    for (uint32_t k = 0; k < a->cells; k++) fired[k] = a->cell[k].fired;
}

/* A cell that has fired so often is due behind t, and was before. */
static int is_due(double t0, double t, double fired, double h) {
    return fired >= 0.0 && fired == floor(fired) && t0 + fired * h <= t + 2.0 * slack(h) &&
           t0 + (fired + 1.0) * h > t;
}

dm_status dm_avi_resume(dm_avi *a, double t0, int half, const double *state, double t,
                        dm_arena *arena) {
    const double *p = state + a->n, *last = p + a->n, *fired = last + a->n;
    const dm_status status = a->near ? DM_OK : dm_avi_find_near(a, arena);
    if (status != DM_OK) return status;
    a->t0 = t0;
    a->half = half;
    a->events = 0;
    double longest = 0.0;
    for (uint32_t k = 0; k < a->cells; k++) {
        if (!is_due(t0, t, fired[k], a->h[k])) return DM_NOT_FINITE;
        a->cell[k] =
            (dm_avi_cell){.time = t0 + (fired[k] + 1.0) * a->h[k], .h = a->h[k], .fired = fired[k]};
        longest = fmax(longest, a->h[k]);
    }
    for (uint32_t i = 0; i < a->n; i++) {
        if (!(last[i] >= t0 && last[i] <= t + 2.0 * slack(longest))) return DM_NOT_FINITE;
        a->at[i] = (dm_avi_entry){state[i], p[i], a->w[i], last[i]};
    }
    dm_avi_order(a);
    return DM_OK;
}

/* ---- events ---- */

/* Cell k has another time: those that it was before may come first now. The newest that may fire is
 * the next one, since what it reads is in the cache. */
static inline void pass_on(dm_avi *a, uint32_t k) {
    const uint32_t *near = a->near + a->near_start[k], *end = a->near + a->near_start[k + 1];
    dm_avi_cell *cell = a->cell;
    uint32_t top = a->readies, before = 0;
    for (; near < end; near++) {
        const uint32_t l = *near, is = (uint32_t)dm_avi_is_before(cell, l, k);
        before += is;
        cell[l].blocked -= is;
        a->ready[top] = l;
        top += is && !cell[l].blocked;
    }
    cell[k].blocked = before;
    a->ready[top] = k;
    a->readies = top + !before;
}

/* A cell is among those that may fire once at most; beyond the end it waits for the next call. */
dm_status dm_avi_run(dm_avi *a, double t, volatile const int *stop) {
    uint32_t later = 0;
    long event = 0;
    while (a->readies) {
        const uint32_t k = a->ready[--a->readies];
        dm_avi_cell *cell = a->cell + k;
        const double now = cell->time;
        if (now > t + slack(cell->h)) {
            a->later[later++] = k;
            continue;
        }
        const dm_avi_sum *s = dm_avi_sum_of(a, k);
        const uint32_t i = k - s->first;
        drift(a, s->entry + (size_t)i * s->reads, s->reads, now);
        kick(a, s, i, cell->h, now);
        cell->fired++;
        cell->time = a->t0 + (cell->fired + 1) * cell->h;
        pass_on(a, k);
        a->events++;
        if (++event % LOOK == 0 && stop && *stop) return DM_STOPPED;
    }
    memcpy(a->ready, a->later, later * sizeof *a->ready);
    a->readies = later;
    for (uint32_t i = 0; i < a->n; i++)
        if (!isfinite(a->at[i].p) || !isfinite(a->at[i].x)) return DM_NOT_FINITE;
    return DM_OK;
}

/* half of a kick that was at t is taken back, in the copy */
static void take_half_back(const dm_avi *a, uint32_t k, double t, double *p) {
    const dm_avi_sum *s = dm_avi_sum_of(a, k);
    const uint32_t *entry = s->entry + (size_t)(k - s->first) * s->reads;
    dm_avi_slopes(a, s, k - s->first, t);
    const double scale = -0.5 * a->h[k] * factor_at(a, s, t);
    for (uint32_t j = 0; j < s->kicks; j++) {
        const double by = scale * s->y[s->kick[j].output];
        const uint32_t at = entry[s->kick[j].entry];
        if (a->w[at] != 0.0) p[at] += s->kick[j].minus ? -by : by;
    }
}

void dm_avi_row(dm_avi *a, double t, double *q, double *p) {
    for (uint32_t i = 0; i < a->n; i++) p[i] = a->at[i].p;
    for (uint32_t k = 0; a->half && k < a->cells; k++) {
        const double at = a->t0 + a->cell[k].fired * a->h[k];
        if (fabs(at - t) <= slack(a->h[k])) take_half_back(a, k, t, p);
    }
    for (uint32_t i = 0; i < a->n; i++) {
        const dm_avi_entry *e = a->at + i;
        q[i] = e->x + (t - e->last) * (e->w * e->p);
    }
}
