/* interpolate.h - the state at a time between two steps, by a shorter step from the one before. */
#ifndef DM_INTERPOLATE_H
#define DM_INTERPOLATE_H

#include "integ/method/method.h"

/* out = the state at time `target`, from `state` at time t <= target, by one step of a length of
 * its own, which takes up nothing of the steps before and leaves nothing to those behind. Methods
 * with a time of their own find that length, at most h, by secants to round-off. */
dm_status dm_interpolate(dm_stepper *s, double *out, const double *state, double t, double target,
                         double h);

/* The same by two, four ... steps, where the one did not converge. */
dm_status dm_interpolate_finely(dm_stepper *s, double *out, const double *state, double t,
                                double target);

/* of a step: a time asked for this near to its end is its end */
static const double DM_TIME_SLACK = 1e-9;

/* The same in time, of a step of length h from `from` to `to`: h is no time where steps have a time
 * of their own, and times are rounded where they have become large. */
double dm_time_slack(const dm_stepper *s, double h, double from, double to);

#endif
