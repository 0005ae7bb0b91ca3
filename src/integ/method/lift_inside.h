/* lift_inside.h - the workspace of a lift, for its files only. */
#ifndef DM_LIFT_INSIDE_H
#define DM_LIFT_INSIDE_H

#include "integ/method/lift.h"

/* At the head of the workspace, behind it the arrays, then the workspace of the base. In the
 * memory: a mark, the bound of p (see regauge) and the steps since that was set, the state of the
 * run [4n], the lifted one that it came of [4n], the memory of the base. */
typedef struct {
    dm_stepper base;
    const dm_group *group;
    const dm_homogeneous *above; /* NULL: the lift of polynomials */
    uint32_t n, d;
    double *lifted;     /* [dm_state_size] */
    double *in, *X, *J; /* [2n + 1], [n*d], [d] of the kernels between both; X: what `up` gives */
    double *gram;       /* [d*d + 2d] X^T X, the momentum, pivots */
    double *below;      /* [2n + d] what `above->down` gives */
    double *gauge;      /* [n*d + 2n] of lift_gauge.c */
    double *memory, *of_base;
    size_t base_memory;
    dm_lanes wide; /* members of the base side by side, where they are */
} dm_lift;

enum { DM_LIFT_MARK, DM_LIFT_BOUND, DM_LIFT_SINCE, DM_LIFT_STATE };

/* steps from one look at multiples of q to the next */
enum { DM_LIFT_SELDOM = 64 };

static inline dm_lift *dm_lift_of(const dm_stepper *s) {
    return (dm_lift *)(void *)s->work;
}

/* l->lifted of a state of the run: what was left with it, or a new one. */
dm_status dm_lift_enter(dm_lift *l, const double *state);

/* After a step of the base: keeps p, or multiples of q, from becoming large. */
dm_status dm_lift_settle(dm_lift *l);

/* p = X (X^T X)^-1 mu, the least one with J = mu, into the lifted state; with its bound. */
dm_status dm_lift_momentum(dm_lift *l, const double *q, const double *mu);

/* After a step of a collective lift: p without what moves nothing, where that is large. */
dm_status dm_lift_regauge(dm_lift *l);

/* The state of the run, and the memory of what it came of. */
void dm_lift_leave(dm_lift *l, double *state);

/* For the engine: see stepper.h. */
int dm_lift_widen(dm_stepper *s, dm_lanes *x);
void dm_lift_advance_lanes(dm_stepper *s, dm_lanes *x, double t, const double *h, long count);

#endif
