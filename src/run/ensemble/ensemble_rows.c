#include "run/ensemble/ensemble_rows.h"

#include <string.h>

/* A row that cannot be watched is not counted. */
dm_status dm_ensemble_rows_add(const dm_ensemble_rows *r, dm_observer *watch, long member,
                               const double *state, double t) {
    double *row = dm_ensemble_rows_of(r, member) + (size_t)r->count[member] * r->width;
    row[0] = t;
    dm_status status = DM_OK;
    if (watch)
        status = dm_observe_row(watch, row + 1, state, t);
    else
        memcpy(row + 1, state, (r->width - 1) * sizeof *row);
    if (status == DM_OK) r->count[member]++;
    return status;
}
