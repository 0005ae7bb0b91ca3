/* observe.h - numbers read off a state: kernels of (q, v, t, p), and entries of the state. */
#ifndef DM_OBSERVE_H
#define DM_OBSERVE_H

#include "integ/method/method.h"

typedef struct {
    const dm_kernel *kernel; /* of x = (q[n], v[n], t, p[n]) or of its head; NULL: an entry */
    const dm_stepper *parts; /* not NULL: `count` of its parts from `entry` on (dm_engine.parts) */
    uint32_t entry, count;   /* without it: entry of (q[n], p[n]) */
    /* the kernel is one of the model's, of (q[n], v[n], t, params) or, of an H, (q[n], p[n], t) */
    int of_model;
} dm_observable;

typedef struct {
    const dm_model *model;
    const dm_observable *list;
    uint32_t count;
    double *x;            /* [3n + 1], then as much as a kernel of the model takes */
    const double *params; /* [params of the model] */
    double *work;         /* dm_legendre_work doubles; NULL: no kernel reads v */
    int gaps;             /* rows may have NaN */
    uint32_t missing;     /* number, from 1, that was NaN in dm_observe_row; 0: none */
    double missed;        /* the time of that */
} dm_observer;

/* Numbers that dm_observe writes. */
uint32_t dm_observer_width(const dm_observer *o);

/* out = the observables, one after the other, at a state of a run. The velocity is found from p:
 * DM_SINGULAR or DM_NO_CONVERGENCE where there is none. */
dm_status dm_observe(dm_observer *o, double *out, const double *state, double t);

/* The same of a row that is kept: DM_NO_VALUE where one of them is NaN, unless these are gaps. */
dm_status dm_observe_row(dm_observer *o, double *out, const double *state, double t);

#endif
