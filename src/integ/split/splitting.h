/* splitting.h - explicit kick-drift schemes for L = T(v) - V(q, t) with constant mass:
 * kick b_1, drift a_1, kick b_2, ..., drift a_s, kick b_(s+1), with force L_q and v =
 * M^-1 (p - shift).
 * Every explicit rule is one such table: Stoermer-Verlet, its compositions,
 * Runge-Kutta-Nystroem splittings. */
#ifndef DM_SPLITTING_H
#define DM_SPLITTING_H

#include "integ/method/method.h"

enum { DM_SPLITTING_STAGES = 40 };

typedef struct dm_splitting {
    int stages;                        /* s drifts, s + 1 kicks */
    double b[DM_SPLITTING_STAGES + 1]; /* kicks, sum 1 */
    double a[DM_SPLITTING_STAGES];     /* drifts, sum 1 */
} dm_splitting;

/* Reads the kicks and drifts of a row. */
extern const dm_engine dm_engine_splitting;

/* True when the rule has kicks and drifts and they step the model. */
int dm_splitting_steps(const dm_rule *rule, const dm_model *m);

/* True when L can be stepped explicitly: separable with constant, regular mass, no constraints. */
int dm_splitting_fits(const dm_model *m);

/* Table of the composition of Stoermer-Verlet steps gamma_1 h, ..., gamma_s h;
 * neighbouring kicks are merged. */
void dm_splitting_compose(dm_splitting *out, const double *gamma, int s);

#endif
