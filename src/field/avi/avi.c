/* avi.c - the heap of times and the kicks. */
#include "field/avi/avi.h"

#include "algebra/derive.h"

#include <math.h>
#include <string.h>

enum { LOOK = 4096 }; /* events between two looks at the stop flag */

/* the loop of one sum: slopes by its columns of q */
static dm_status open_sum(dm_avi_sum *s, const dm_sum *sum, uint32_t n, dm_compile *compile,
                          dm_arena *arena) {
    dm_node slope[DM_SUM_COLUMNS], roots[DM_SUM_COLUMNS];
    uint32_t outputs = 0;
    dm_gradient(sum->term, sum->value, 0, sum->columns, slope);
    for (uint32_t c = 0; c < sum->columns; c++) {
        if (!slope[c] || sum->column[c].data || sum->column[c].first >= n) continue;
        s->by[outputs] = (uint8_t)c;
        roots[outputs++] = slope[c];
    }
    s->loop = (dm_cell_loop){.sum = sum};
    s->sum = sum;
    return outputs ? dm_cell_loop_make(&s->loop, sum, roots, outputs, compile, arena) : DM_OK;
}

static double *take(dm_arena *arena, size_t count) {
    double *x = dm_arena_take(arena, (count + 1) * sizeof *x);
    if (x) memset(x, 0, (count + 1) * sizeof *x);
    return x;
}

dm_status dm_avi_open(dm_avi *a, const dm_sum *const *sums, const double *factor, uint32_t count,
                      uint32_t n, dm_compile *compile, dm_arena *arena) {
    size_t work = 0;
    *a = (dm_avi){.n = n};
    a->sum = dm_arena_take(arena, (count + 1) * sizeof *a->sum);
    if (!a->sum) return DM_NO_MEMORY;
    memset(a->sum, 0, (count + 1) * sizeof *a->sum);
    for (uint32_t k = 0; k < count; k++) {
        dm_avi_sum *s = a->sum + a->sums;
        const dm_status status = open_sum(s, sums[k], n, compile, arena);
        if (status != DM_OK) return status;
        if (!s->loop.outputs) continue; /* the kinetic energy */
        s->factor = factor[k];
        s->first = a->cells;
        a->cells += sums[k]->bodies;
        a->sums++;
        const size_t need = dm_cell_loop_work(&s->loop) + s->loop.outputs;
        if (need > work) work = need;
    }
    a->x = take(arena, 2 * (size_t)n + 1);
    a->p = take(arena, n);
    a->last = take(arena, n);
    a->h = take(arena, a->cells);
    a->time = take(arena, a->cells);
    a->fired = take(arena, a->cells);
    a->work = take(arena, work);
    a->heap = dm_arena_take(arena, (a->cells + 1) * sizeof *a->heap);
    if (!a->x || !a->p || !a->last || !a->h || !a->time || !a->fired || !a->work || !a->heap)
        return DM_NO_MEMORY;
    return DM_OK;
}

/* ---- the heap ---- */

static int is_before(const dm_avi *a, uint32_t k, uint32_t l) {
    const double s = a->time[k], t = a->time[l];
    return s < t || (s == t && k < l);
}

/* the one at the top has another time */
static void sink(dm_avi *a, uint32_t at) {
    const uint32_t cell = a->heap[at];
    for (;;) {
        uint32_t child = 2 * at + 1;
        if (child >= a->cells) break;
        if (child + 1 < a->cells && is_before(a, a->heap[child + 1], a->heap[child])) child++;
        if (!is_before(a, a->heap[child], cell)) break;
        a->heap[at] = a->heap[child];
        at = child;
    }
    a->heap[at] = cell;
}

/* ---- kicks ---- */

static const dm_avi_sum *sum_of(const dm_avi *a, uint32_t cell) {
    const dm_avi_sum *s = a->sum + a->sums - 1;
    while (cell < s->first) s--;
    return s;
}

static int is_held(const dm_sum *s, size_t entry) {
    return s->held && s->held[entry];
}

/* the entries that a cell reads, at time t */
static void drift(dm_avi *a, const dm_avi_sum *s, uint32_t i, double t) {
    for (uint32_t k = 0; k < s->loop.columns; k++) {
        const dm_column *c = s->sum->column + s->loop.column[k];
        if (c->data || c->first >= a->n) continue;
        const size_t at = dm_sum_entry(s->sum, c, i, 0);
        a->x[at] += (t - a->last[at]) * (a->w[at] * a->p[at]);
        a->last[at] = t;
    }
}

/* p += h dL/dx of one cell, where its entries stand */
static void kick(dm_avi *a, const dm_avi_sum *s, uint32_t i, double h, double *p) {
    double *y = a->work, *scratch = y + s->loop.outputs;
    dm_cell_loop_run(&s->loop, y, 1, a->x, i, 1, scratch);
    for (uint32_t k = 0; k < s->loop.outputs; k++) {
        const size_t at = dm_sum_entry(s->sum, s->sum->column + s->by[k], i, 0);
        if (!is_held(s->sum, at)) p[at] += (h * s->factor) * y[k];
    }
}

void dm_avi_start(dm_avi *a, double t0, int half) {
    a->t0 = t0;
    a->half = half;
    a->events = 0;
    a->x[2 * (size_t)a->n] = t0;
    for (uint32_t i = 0; i < a->n; i++) a->last[i] = t0;
    for (uint32_t k = 0; half && k < a->cells; k++) {
        const dm_avi_sum *s = sum_of(a, k);
        kick(a, s, k - s->first, 0.5 * a->h[k], a->p);
    }
    for (uint32_t k = 0; k < a->cells; k++) {
        a->heap[k] = k;
        a->fired[k] = 0;
        a->time[k] = t0 + a->h[k];
    }
    for (uint32_t k = a->cells / 2; k-- > 0;) sink(a, k);
}

/* as far as rounding tells times apart */
static double slack(double h) {
    return 1e-10 * h;
}

dm_status dm_avi_run(dm_avi *a, double t, volatile const int *stop) {
    for (long event = 1; a->cells; event++) {
        const uint32_t cell = a->heap[0];
        const double now = a->time[cell], h = a->h[cell];
        if (now > t + slack(h)) break;
        const dm_avi_sum *s = sum_of(a, cell);
        a->x[2 * (size_t)a->n] = now;
        drift(a, s, cell - s->first, now);
        kick(a, s, cell - s->first, h, a->p);
        a->fired[cell]++;
        a->time[cell] = a->t0 + (a->fired[cell] + 1) * h;
        a->events++;
        sink(a, 0);
        if (event % LOOK == 0 && stop && *stop) return DM_STOPPED;
    }
    for (uint32_t i = 0; i < a->n; i++)
        if (!isfinite(a->p[i]) || !isfinite(a->x[i])) return DM_NOT_FINITE;
    return DM_OK;
}

void dm_avi_row(dm_avi *a, double t, double *q, double *p) {
    memcpy(p, a->p, a->n * sizeof *p);
    for (uint32_t k = 0; a->half && k < a->cells; k++) {
        const dm_avi_sum *s = sum_of(a, k);
        const double at = a->t0 + a->fired[k] * a->h[k];
        if (fabs(at - t) <= slack(a->h[k])) kick(a, s, k - s->first, -0.5 * a->h[k], p);
    }
    for (uint32_t i = 0; i < a->n; i++) q[i] = a->x[i] + (t - a->last[i]) * (a->w[i] * a->p[i]);
}
