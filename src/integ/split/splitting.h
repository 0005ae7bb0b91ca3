/* splitting.h - explicit kick-drift schemes for L = T(v) - V(q, t) with constant mass:
 * kick b_1, drift a_1, kick b_2, ..., drift a_s, kick b_(s+1), with force L_q and v =
 * M^-1 (p - shift).
 * Every explicit rule is one such table: Stoermer-Verlet, its compositions,
 * Runge-Kutta-Nystroem splittings. */
#ifndef DM_SPLITTING_H
#define DM_SPLITTING_H

#include "integ/method/method.h"

enum { DM_SPLITTING_STAGES = 40 };

typedef struct {
    int stages;                        /* s drifts, s + 1 kicks */
    double b[DM_SPLITTING_STAGES + 1]; /* kicks, sum 1 */
    double a[DM_SPLITTING_STAGES];     /* drifts, sum 1 */
} dm_splitting;

/* True when L can be stepped explicitly: separable with constant, regular mass, no constraints. */
int dm_splitting_fits(const dm_model *m);

/* Table of the composition of Stoermer-Verlet steps gamma_1 h, ..., gamma_s h;
 * neighbouring kicks are merged. */
void dm_splitting_compose(dm_splitting *out, const double *gamma, int s);

/* Table of the composition named by a rule ("verlet", "kahan-li(8)" ...): 0 when it is none of
 * multiples of the base step. */
int dm_splitting_named(dm_splitting *out, const dm_rule *rule);

/* Doubles of workspace, the table included. */
size_t dm_splitting_work(const dm_model *m);

/* Lay the table into s->work; the model needs DM_WANT_FORCE and a constant mass. */
void dm_splitting_open(dm_stepper *s, const dm_splitting *table);

/* `count` steps; the force after a step is the force before the next one, so a step costs
 * s evaluations.
 * Positions and momenta are summed with compensation. */
dm_status dm_splitting_advance(dm_stepper *s, double *state, double t, double h, long count,
                               long *done);
dm_status dm_splitting_step(dm_stepper *s, double *state, double t, double h);

/* The same for members side by side: widen and advance_lanes of method.h. */
int dm_splitting_widen(dm_stepper *s, dm_lanes *x);
void dm_splitting_advance_lanes(dm_stepper *s, dm_lanes *x, double t, const double *h, long count);

#endif
