#include "run/departure.h"

#include "base/largest.h"

#include <limits.h>
#include <math.h>
#include <string.h>
#ifdef __x86_64__
#include <emmintrin.h>
#endif

enum { NODES = 8 };

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
__attribute__((noinline)) static void make_stencil(dm_stencil *s, const dm_run_table *flow,
                                                   double t, double t0, double dt) {
    const double place = (t - t0) / dt;
    const long last = flow->rows - 1, here = place < (double)last ? (long)place : last;
    s->t = t, s->t0 = t0, s->dt = dt, s->rows = flow->rows;
    s->count = flow->rows < NODES ? (uint32_t)flow->rows : NODES;
    const long first = dm_lesser(here - (long)(s->count - 1) / 2, flow->rows - s->count);
    s->first = first > 0 ? first : 0;
    if (s->count == NODES)
        find_weights(s->weight, place - (double)s->first);
    else
        find_some_weights(s->weight, place - (double)s->first, s->count);
}

/* unless it is that of the member before */
static inline void find_stencil(dm_stencil *s, const dm_run_table *flow, double t) {
    const double t0 = flow->data[0];
    const double dt = flow->rows > 1 ? flow->data[flow->width] - t0 : 1.0;
    if (s->count && s->t == t && s->t0 == t0 && s->dt == dt && s->rows == flow->rows) return;
    make_stencil(s, flow, t, t0, dt);
}

/* the value of one column */
static double find_value(const dm_run_table *flow, const dm_stencil *at, uint32_t column) {
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
    dm_stencil at = {0};
    for (uint32_t k = 0; k < count; k++) largest[k] = last[k] = before[k] = 0.0;
    for (long i = 0; i < own->rows && flow->rows; i++) {
        const double *row = own->data + (size_t)i * own->width;
        if (!(row[0] <= d->until)) break;
        find_stencil(&at, flow, row[0]);
        for (uint32_t k = 0; k < count; k++) {
            const double value = find_value(flow, &at, d->flow[k]);
            note(largest + k, last + k, before + k, row[d->own[k]] - value, d->between && i > 1);
        }
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

/* ---- two columns at once, with the bits of one after the other ---- */

typedef double pair __attribute__((vector_size(16)));
typedef long long pair_of_yes __attribute__((vector_size(16)));

enum { SOME = 8 }; /* columns whose values are found side by side */

__attribute__((always_inline)) static inline pair load(const double *x) {
    pair out;
    memcpy(&out, x, sizeof out);
    return out;
}

/* by name: of the operators compilers make a branch for each number */
__attribute__((always_inline)) static inline pair pick(pair_of_yes yes, pair a, pair b) {
#ifdef __x86_64__
    const __m128d which = (__m128d)yes;
    return (pair)_mm_or_pd(_mm_and_pd(which, (__m128d)a), _mm_andnot_pd(which, (__m128d)b));
#else
    return (pair)((yes & (pair_of_yes)a) | (~yes & (pair_of_yes)b));
#endif
}

/* dm_largest */
__attribute__((always_inline)) static inline pair largest_of(pair so_far, pair x) {
    const pair size = (pair)((pair_of_yes)x & LLONG_MAX);
    const pair larger = pick(size <= so_far, so_far, size);
    return pick(so_far == so_far, larger, so_far);
}

/* turn; of what is no number any more nothing is asked */
__attribute__((always_inline)) static inline pair turn_of(pair before, pair here, pair after) {
    const pair bend = before - 2.0 * here + after, rise = 0.5 * (after - before);
    const pair top = pick(bend == 0.0, here, here - 0.5 * rise * rise / bend);
    return pick((here - before) * (after - here) < 0.0, top, here);
}

/* the values of `count` columns, even, that follow each other in the flow */
__attribute__((always_inline)) static inline void find_pairs(pair *sum, const double *y,
                                                             size_t width, const double *weight,
                                                             const uint32_t nodes,
                                                             const uint32_t count) {
#pragma GCC unroll 8
    for (uint32_t k = 0; k < nodes; k++, y += width)
        for (uint32_t i = 0; i < count / 2; i++) sum[i] += weight[k] * load(y + 2 * (size_t)i);
}

/* note for these columns */
__attribute__((always_inline)) static inline void note_pairs(double *largest, uint32_t apart,
                                                             const double *numbers, const double *y,
                                                             size_t width, const dm_stencil *at,
                                                             int between, const uint32_t count) {
    pair sum[SOME / 2] = {{0.0}};
    if (at->count == NODES) /* a number that the compiler knows */
        find_pairs(sum, y, width, at->weight, NODES, count);
    else
        find_pairs(sum, y, width, at->weight, at->count, count);
    for (uint32_t i = 0; i < count / 2; i++, largest += 2, numbers += 2) {
        double *last = largest + apart, *before = last + apart;
        const pair here = load(numbers) - sum[i], then = load(last);
        pair most = largest_of(load(largest), here);
        if (between) most = largest_of(most, turn_of(load(before), then, here));
        memcpy(largest, &most, sizeof most);
        memcpy(before, &then, sizeof then);
        memcpy(last, &here, sizeof here);
    }
}

/* ---- a look ---- */

/* columns from k on that follow each other in the flow, too */
static uint32_t count_neighbours(const dm_follow *f, uint32_t k) {
    uint32_t count = 1;
    while (count < SOME && k + count < f->count && f->column[k + count] == f->column[k] + count)
        count++;
    return count;
}

/* column k, and as many of its neighbours as go side by side; how many */
static uint32_t compare_some(const dm_follow *f, uint32_t k, const double *numbers,
                             const dm_stencil *at, int between) {
    const uint32_t count = count_neighbours(f, k), apart = f->count;
    const size_t width = f->flow.width;
    const double *y = f->flow.data + (size_t)at->first * width + f->column[k];
    double *largest = f->largest + k;
    numbers += k;
    if (count == 8) {
        note_pairs(largest, apart, numbers, y, width, at, between, 8);
    } else if (count >= 4) {
        note_pairs(largest, apart, numbers, y, width, at, between, 4);
        return 4;
    } else if (count >= 2) {
        note_pairs(largest, apart, numbers, y, width, at, between, 2);
        return 2;
    } else {
        const double value = find_value(&f->flow, at, f->column[k]);
        note(largest, largest + apart, largest + 2 * (size_t)apart, *numbers - value, between);
    }
    return count;
}

/* Two coordinates, one after the other: nothing is to be counted. Speed: stability maps,
 * Henon-Heiles by verlet. */
static int are_two(const dm_follow *f) {
    return f->count == 2 && f->column[0] != DM_NO_COLUMN && f->column[1] == f->column[0] + 1;
}

/* numbers that are compared, and those that are not */
static void compare(dm_follow *f, const double *numbers, const dm_stencil *at, int between) {
    if (at && are_two(f)) {
        const double *y = f->flow.data + (size_t)at->first * f->flow.width + f->column[0];
        note_pairs(f->largest, 2, numbers, y, f->flow.width, at, between, 2);
        return;
    }
    for (uint32_t k = 0, count = 1; k < f->count; k += count, count = 1)
        if (f->column[k] == DM_NO_COLUMN)
            f->largest[k] = dm_largest(f->largest[k], numbers[k]);
        else if (at)
            count = compare_some(f, k, numbers, at, between);
}

void dm_follow_look(dm_follow *f, const double *numbers, double t, long steps, dm_stencil *at) {
    const int known = f->flow.rows > 0 && t <= f->until;
    const double apart = t - f->t[1];
    const int even = fabs(apart - (f->t[1] - f->t[0])) <= EVEN * apart;
    const long so_far = known && !f->beyond ? f->dense : f->sparse;
    if (known) find_stencil(at, &f->flow, t);
    for (uint32_t k = 0; !numbers && k < f->count; k++) f->largest[k] = NAN;
    if (numbers) compare(f, numbers, known ? at : NULL, even && so_far > 1);
    f->t[0] = f->t[1];
    f->t[1] = t;
    if (known && is_beyond(f->bound, f->largest, f->count)) f->beyond = 1;
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
