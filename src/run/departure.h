/* departure.h - how far the rows of a run are from a resolved flow, whose rows are so dense that a
 * polynomial through eight of them is the flow. */
#ifndef DM_DEPARTURE_H
#define DM_DEPARTURE_H

#include <stdint.h>

/* Rows (t, numbers) of one run: data[rows][width]. Those of a flow lie at even times. */
typedef struct {
    const double *data;
    long rows;
    uint32_t width;
} dm_run_table;

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

/* largest[count] = max |own - flow|; scratch[3 * count]. NaN where a number is none, 0 without
 * rows. Returns the time where it came to a bound, infinite where it did not. */
double dm_departure_find(double *largest, const dm_departure *d, const dm_run_table *own,
                         const dm_run_table *flow, double *scratch);

/* Greatest less least value of a column of a flow up to the time `until`, between rows, too. */
double dm_flow_range(const dm_run_table *flow, uint32_t column, double until);

/* The largest power of two s such that every s-th row of a flow tells the others, columns
 * column[count], to `share` of their ranges; up to `most`. scratch[5 * count]. */
long dm_flow_stride(const dm_run_table *flow, const uint32_t *column, uint32_t count, double share,
                    long most, double *scratch);

#endif
