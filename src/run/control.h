/* control.h - steps as long as their error allows: each is made whole and in two halves. */
#ifndef DM_CONTROL_H
#define DM_CONTROL_H

#include "integ/method/method.h"
#include "run/hidden.h"

typedef struct dm_control {
    double tolerance;   /* of a step: |error of y_i| over the largest |y_i| so far, y = (q, p) */
    double largest;     /* step; infinite: any */
    const double *ends; /* growing times at which steps end; NULL: none */
    long end_count;
    dm_hidden *hidden; /* what steps must not jump over; NULL: nothing is looked for */
    double *room;      /* dm_control_room doubles */
    double reach;      /* the time that the run goes to: no step is longer than what is left */
    /* Between steps: where the run is, the step that comes next, how many ends are behind it, and
     * how many steps were taken although they were too short to be halved. */
    double t, h;
    double half; /* time of the middle of the last step */
    long passed, forced;
    long rejected, unseen; /* steps made in vain so far; those that would have jumped */
    double place;          /* a feature that no step could be made small enough for; NaN: none */
} dm_control;

size_t dm_control_room(uint32_t n);

/* The state in the middle of the last step, at c->half. */
const double *dm_control_middle(const dm_control *c, uint32_t n);

/* Before the first step, at time t, of length h if that is short enough. */
void dm_control_begin(dm_control *c, const dm_stepper *s, const double *state, double t, double h);

/* One step in place, by c->t. On failure the state is unchanged: DM_TOO_SHORT where even the
 * shortest step is not accurate, or jumps over what c->place tells. */
dm_status dm_control_step(dm_control *c, dm_stepper *s, double *state);

#endif
