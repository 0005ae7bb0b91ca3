#include "run/ensemble/ensemble_rows.h"

#include <string.h>

/* A row that cannot be watched is not counted. */
dm_status dm_ensemble_rows_add(const dm_ensemble_rows *r, dm_observer *watch, long member,
                               const double *state, double t) {
    double *row = dm_ensemble_rows_of(r, member) + (size_t)r->count[member] * r->width;
    const uint32_t watched = watch ? dm_observer_width(watch) : 0;
    const uint32_t states = watch && !r->beside ? 0 : r->width - 1 - watched;
    row[0] = t;
    memcpy(row + 1, state, states * sizeof *row);
    const dm_status status = watch ? dm_observe_row(watch, row + 1 + states, state, t) : DM_OK;
    if (status == DM_OK) r->count[member]++;
    return status;
}
