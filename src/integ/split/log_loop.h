/* log_loop.h - steps of the logarithmic Hamiltonian as a loop in machine code
 * (code/tape/loop.h). One loop serves every composition and every h: coefficients are inputs. */
#ifndef DM_LOG_LOOP_H
#define DM_LOG_LOOP_H

#include "integ/method/lanes.h"
#include "integ/split/splitting.h"

typedef struct dm_log_loop dm_log_loop;

/* Doubles that a run needs, zero before the first one: coefficients, behind them the h they are
 * for. */
enum { DM_LOG_LOOP_WORK = 4 * DM_SPLITTING_STAGES + 1 };

/* `count` steps of h; the table begins and ends with a drift */
typedef struct {
    const dm_splitting *table;
    double h;
    long count;
} dm_log_burst;

/* In the arena of the model, which keeps it (cache.h); NULL: there is none. */
dm_log_loop *dm_log_loop_open(const dm_model *m);

/* The same loop for members side by side; 0: there is none. */
int dm_log_loop_widen(dm_log_loop *l, const dm_model *m, dm_lanes *x);

/* A burst; a state whose well is not attracting at the end of a step is not finite from then on. */
void dm_log_loop_run(const dm_log_loop *l, double *state, const dm_log_burst *x, double *work);
void dm_log_loop_run_lanes(const dm_log_loop *l, dm_lanes *lanes, const dm_log_burst *x,
                           double *work);

#endif
