/* departure.h - how far a run is from a resolved flow, whose rows are so dense that a polynomial
 * through eight of them is the flow: of rows that were kept, or while it is made. */
#ifndef DM_DEPARTURE_H
#define DM_DEPARTURE_H

#include "run/observe.h"

#include <stdint.h>

/* Rows (t, numbers) of one run: data[rows][width]. Those of a flow lie at even times. */
typedef struct {
    const double *data;
    long rows;
    uint32_t width;
} dm_run_table;

/* How the polynomial through the rows nearest to a time is made of them; kept, since members that
 * go side by side are looked at at one time. All zero before the first. */
typedef struct {
    double t, t0, dt; /* of the look; of the flow's rows */
    long rows, first; /* rows of the flow; the first of those that are taken */
    uint32_t count;   /* of these; 0: there was none yet */
    double weight[8];
} dm_stencil;

/* What is compared: column own[k] of a run with column flow[k] of the flow, k < count, at rows up
 * to the time `until`. Where rows leave steps out the largest value lies between them: `between`
 * looks for it there, by parabolas. */
typedef struct {
    const uint32_t *own, *flow;
    uint32_t count;
    double until;
    const double *bound; /* [count]; NULL: none */
    int between;
} dm_departure;

/* largest[count] = max |own - flow|; scratch[2 * count]. NaN where a number is none, 0 without
 * rows. Returns the time where it came to a bound, infinite where it did not. */
double dm_departure_find(double *largest, const dm_departure *d, const dm_run_table *own,
                         const dm_run_table *flow, double *scratch);

/* A run beside its flow while it is made, number by number of what is observed of it: where a
 * number is beyond its bound the run is looked at more seldom from there on, where none is known of
 * the flow it is looked at by itself. */
typedef struct {
    dm_run_table flow;      /* rows 0: not known */
    const uint32_t *column; /* [count] of the flow; DM_NO_COLUMN: the number by itself */
    const double *bound;    /* [count]; NULL: none */
    uint32_t count;
    double until;       /* the flow is known up to there */
    long dense, sparse; /* steps between looks, and where one is beyond its bound */
    long due, seen;     /* steps after which it is looked at next, was looked at last; -1: never */
    int beyond;         /* has a number come to its bound? */
    double t[2];        /* times of the last two looks of one distance, NaN: there was none */
    /* [count] so far; behind it [2][count] what these looks found, [count] for what is observed */
    double *largest;
} dm_follow;

#define DM_NO_COLUMN UINT32_MAX

/* Forget what was found: a run begins. */
void dm_follow_begin(dm_follow *f);

/* After so many steps the run has these numbers[count] at t; NULL: it has none. */
void dm_follow_look(dm_follow *f, const double *numbers, double t, long steps, dm_stencil *at);

/* The same of its state, unless it was looked at there. */
static inline void dm_follow_state(dm_follow *f, dm_observer *aside, const double *state, double t,
                                   long steps, dm_stencil *at) {
    double *numbers = f->largest + 3 * (size_t)f->count;
    if (f->seen == steps) return;
    const dm_status status = dm_observe(aside, numbers, state, t);
    dm_follow_look(f, status == DM_OK ? numbers : NULL, t, steps, at);
}

/* Greatest less least value of a column of a flow up to the time `until`, between rows, too. */
double dm_flow_range(const dm_run_table *flow, uint32_t column, double until);

/* The largest power of two s such that every s-th row of a flow tells the others, columns
 * column[count], to `share` of their ranges; up to `most`. scratch[5 * count]. */
long dm_flow_stride(const dm_run_table *flow, const uint32_t *column, uint32_t count, double share,
                    long most, double *scratch);

#endif
