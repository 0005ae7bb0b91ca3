/* ensemble_rows.h - what members of an ensemble leave on their way, when that is asked for. */
#ifndef DM_ENSEMBLE_ROWS_H
#define DM_ENSEMBLE_ROWS_H

#include "run/observe.h"

/* Rows as dm_run keeps them: the start, one state in `every`, the end or the last good state. */
typedef struct {
    long every;     /* >= 1 */
    long room;      /* rows of a member at most (dm_run_rows) */
    uint32_t width; /* t and q[n], p[n], or t and what is watched, or both */
    int beside;     /* both */
    double *data;   /* [members][room][width] */
    long *count;    /* [members] rows there are */
} dm_ensemble_rows;

static inline double *dm_ensemble_rows_of(const dm_ensemble_rows *r, long member) {
    return r->data + (size_t)member * (size_t)r->room * r->width;
}

/* Add the row of a state at time t; watch NULL: q, p alone. */
dm_status dm_ensemble_rows_add(const dm_ensemble_rows *r, dm_observer *watch, long member,
                               const double *state, double t);

#endif
