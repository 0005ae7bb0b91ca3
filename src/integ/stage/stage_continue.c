/* stage_continue.c - continuation in h. */
#include "integ/stage/stage_continue.h"

#include <math.h>

enum { SHORTEST = 16 /* part of a step that it begins with */, MOST = 200 /* steps tried */ };
static const double LEAST = 1.002; /* ratio of two steps; where that is too much is a fold */

/* Is there a way to go on? A root beyond the edge of the domain of L belongs to another motion. */
static int may_go_on(dm_status status) {
    return status == DM_NO_CONVERGENCE || status == DM_SINGULAR;
}

/* Ratios are 2 until that fails, then 2^(1/4) at most: their fourth root where one is too much,
 * their square where it is not. */
static dm_status go_on(dm_stepper *s, dm_stage_try *solve, const double *state, double t,
                       double h) {
    const double fourth = sqrt(sqrt(2.0));
    double part = 1.0 / SHORTEST, factor = 2.0;
    dm_status status = solve(s, state, t, part * h, 0.0);
    for (int k = 0; status == DM_OK && part < 1.0; k++) {
        const double next = fmin(part * factor, 1.0);
        status = solve(s, state, t, next * h, next / part);
        if (status == DM_OK) {
            part = next;
            if (factor < fourth) factor *= factor;
        } else if (may_go_on(status) && factor > LEAST && k < MOST) {
            factor = sqrt(sqrt(factor));
            status = DM_OK;
        }
    }
    return status;
}

/* The report of a failure is that of the first try. */
dm_status dm_stage_continue(dm_stepper *s, dm_stage_try *solve, const double *state, double t,
                            double h) {
    const dm_status status = solve(s, state, t, h, 0.0);
    if (!may_go_on(status)) return status;
    const dm_report first = s->report;
    const dm_status again = go_on(s, solve, state, t, h);
    if (again == DM_OK || again == DM_STOPPED) return again;
    s->report = first;
    return status;
}
