/* splitting_loop.h - kicks and drifts as a loop in machine code (code/tape/loop.h). One loop serves
 * every table of the same shape and every h: coefficients are inputs. */
#ifndef DM_SPLITTING_LOOP_H
#define DM_SPLITTING_LOOP_H

#include "integ/method/lanes.h"
#include "integ/split/splitting.h"

typedef struct dm_splitting_loop dm_splitting_loop;

/* `count` steps of h from t on */
typedef struct {
    const dm_splitting *table;
    const double *c; /* [stages + 1] time of kick k is t + c_k h */
    double h, t;
    long count;
    uint32_t many; /* parameters of the model */
    const double *params;
} dm_splitting_burst;

/* Doubles that a run needs. */
size_t dm_splitting_loop_work(const dm_model *m);

/* In the arena of the model, which keeps it (cache.h); plain: sums without compensation. NULL:
 * there is none. */
dm_splitting_loop *dm_splitting_loop_open(const dm_model *m, const dm_splitting *table, int plain);

/* The same loop for members side by side; 0: there is none. */
int dm_splitting_loop_widen(dm_splitting_loop *l, const dm_model *m, dm_lanes *x);

/* A burst, with no look at what comes out. */
void dm_splitting_loop_run(const dm_splitting_loop *l, const dm_model *m, double *state,
                           const dm_splitting_burst *burst, double *work);
void dm_splitting_loop_run_lanes(const dm_splitting_loop *l, const dm_model *m, dm_lanes *x,
                                 const dm_splitting_burst *burst, double *work);

#endif
