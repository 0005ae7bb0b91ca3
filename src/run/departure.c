#include "run/departure.h"

#include "base/largest.h"

#include <math.h>

enum { NODES = 8 };

/* rows first .. first + count - 1 of a flow, and the weights of their values at a time */
typedef struct {
    long first;
    uint32_t count;
    double weight[NODES];
} stencil;

/* 1 / prod_(i != k) (k - i) over eight nodes */
static const double below[NODES] = {-1.0 / 5040.0, 1.0 / 720.0, -1.0 / 240.0, 1.0 / 144.0,
                                    -1.0 / 144.0,  1.0 / 240.0, -1.0 / 720.0, 1.0 / 5040.0};

/* weight[k] = prod_(i != k) (s - i) / (k - i), nodes i = 0 .. 7: products from both sides */
static void find_weights(double *weight, double s) {
    double left = 1.0, right = 1.0;
#pragma GCC unroll 8
    for (int k = 0; k < NODES; k++) {
        weight[k] = left * below[k];
        left *= s - (double)k;
    }
#pragma GCC unroll 8
    for (int k = NODES; k-- > 0;) {
        weight[k] *= right;
        right *= s - (double)k;
    }
}

/* the same over fewer nodes */
static void find_some_weights(double *weight, double s, uint32_t count) {
    for (uint32_t k = 0; k < count; k++) {
        weight[k] = 1.0;
        for (uint32_t i = 0; i < count; i++)
            if (i != k) weight[k] *= (s - (double)i) / ((double)k - (double)i);
    }
}

/* the rows nearest to t, as many before as behind it where there are so many */
static stencil stencil_at(const dm_run_table *flow, double t) {
    const double t0 = flow->data[0];
    const double dt = flow->rows > 1 ? flow->data[flow->width] - t0 : 1.0;
    const double place = (t - t0) / dt;
    const long last = flow->rows - 1, here = place < (double)last ? (long)place : last;
    stencil out = {.count = flow->rows < NODES ? (uint32_t)flow->rows : NODES};
    const long first = dm_lesser(here - (long)(out.count - 1) / 2, flow->rows - out.count);
    out.first = first > 0 ? first : 0;
    if (out.count == NODES)
        find_weights(out.weight, place - (double)out.first);
    else
        find_some_weights(out.weight, place - (double)out.first, out.count);
    return out;
}

static double value_at(const dm_run_table *flow, const stencil *at, uint32_t column) {
    const double *y = flow->data + (size_t)at->first * flow->width + column;
    double sum = 0.0;
    for (uint32_t k = 0; k < at->count; k++, y += flow->width) sum += at->weight[k] * *y;
    return sum;
}

/* what the parabola through three numbers has at its top or bottom, where that lies between the
 * outer ones; the middle one else */
static double turn(double before, double here, double after) {
    const double bend = before - 2.0 * here + after, rise = 0.5 * (after - before);
    if ((here - before) * (after - here) >= 0.0 || !(fabs(bend) > 0.0)) return here;
    return here - 0.5 * rise * rise / bend;
}

/* has one of the numbers come to its bound? */
static int is_beyond(const double *bound, const double *largest, uint32_t count) {
    for (uint32_t k = 0; bound && k < count; k++)
        if (!(largest[k] <= bound[k])) return 1;
    return 0;
}

/* |here| and what lies between the last three, which are as far apart; they move on */
static void note(double *largest, double *last, double *before, double here, int between) {
    *largest = dm_largest(*largest, here);
    if (between) *largest = dm_largest(*largest, turn(*before, *last, here));
    *before = *last;
    *last = here;
}

double dm_departure_find(double *largest, const dm_departure *d, const dm_run_table *own,
                         const dm_run_table *flow, double *scratch) {
    const uint32_t count = d->count;
    double *last = scratch, *before = last + count;
    for (uint32_t k = 0; k < count; k++) largest[k] = last[k] = before[k] = 0.0;
    for (long i = 0; i < own->rows && flow->rows; i++) {
        const double *row = own->data + (size_t)i * own->width;
        if (!(row[0] <= d->until)) break;
        const stencil at = stencil_at(flow, row[0]);
        for (uint32_t k = 0; k < count; k++)
            note(largest + k, last + k, before + k,
                 row[d->own[k]] - value_at(flow, &at, d->flow[k]), d->between && i > 1);
        if (is_beyond(d->bound, largest, count)) return row[0];
    }
    return INFINITY;
}

void dm_follow_begin(dm_follow *f) {
    for (uint32_t k = 0; k < 3 * f->count; k++) f->largest[k] = 0.0;
    f->due = f->beyond = 0;
    f->seen = -1;
    f->t[0] = f->t[1] = NAN;
}

static const double EVEN = 1e-6; /* of their distance: so evenly do looks lie */

void dm_follow_look(dm_follow *f, const double *numbers, double t, long steps) {
    double *largest = f->largest, *last = largest + f->count, *before = last + f->count;
    const int known = f->flow.rows > 0 && t <= f->until, dense = known && !f->beyond;
    const double apart = t - f->t[1];
    const int even = fabs(apart - (f->t[1] - f->t[0])) <= EVEN * apart;
    stencil at = {.count = 0};
    if (known) at = stencil_at(&f->flow, t);
    for (uint32_t k = 0; k < f->count; k++) {
        const uint32_t column = f->column[k];
        if (!numbers || column == DM_NO_COLUMN)
            largest[k] = dm_largest(largest[k], numbers ? numbers[k] : NAN);
        else if (known)
            note(largest + k, last + k, before + k, numbers[k] - value_at(&f->flow, &at, column),
                 even && (dense ? f->dense : f->sparse) > 1);
    }
    f->t[0] = f->t[1];
    f->t[1] = t;
    if (known && is_beyond(f->bound, largest, f->count)) f->beyond = 1;
    const long every = known && !f->beyond ? f->dense : f->sparse;
    f->due = steps + every - steps % every;
    f->seen = steps;
}

double dm_flow_range(const dm_run_table *flow, uint32_t column, double until) {
    const double *y = flow->data + column;
    const uint32_t width = flow->width;
    double least = INFINITY, most = -INFINITY;
    for (long i = 0; i < flow->rows && flow->data[(size_t)i * width] <= until; i++, y += width) {
        const int inside = i > 0 && i + 1 < flow->rows;
        const double best = inside ? turn(y[-(long)width], *y, y[width]) : *y;
        const double low = best < *y ? best : *y, high = best > *y ? best : *y;
        if (low < least) least = low;
        if (high > most) most = high;
    }
    return most >= least ? most - least : 0.0;
}

long dm_flow_stride(const dm_run_table *flow, const uint32_t *column, uint32_t count, double share,
                    long most, double *scratch) {
    double *bound = scratch + 4 * (size_t)count;
    long stride = 1;
    for (uint32_t k = 0; k < count; k++)
        bound[k] = share * dm_flow_range(flow, column[k], INFINITY) + 1e-300;
    const dm_departure d = {.own = column,
                            .flow = column,
                            .count = count,
                            .bound = bound,
                            .until = INFINITY};
    while (2 * stride <= most && flow->rows > 2 * NODES * stride) {
        const long next = 2 * stride;
        const dm_run_table thin = {.data = flow->data,
                                   .rows = (flow->rows - 1) / next + 1,
                                   .width = flow->width * (uint32_t)next};
        if (dm_departure_find(scratch, &d, flow, &thin, scratch + count) < INFINITY) break;
        stride = next;
    }
    return stride;
}
