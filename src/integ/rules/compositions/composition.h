/* composition.h - symmetric compositions of a symmetric second-order rule, and Runge-Kutta-Nystroem
 * splittings: what their rows share. HLW = Hairer, Lubich & Wanner 2006, V.3.2. */
#ifndef DM_COMPOSITION_H
#define DM_COMPOSITION_H

#include "integ/split/splitting.h"

enum { DM_GAMMA, DM_KICK_FIRST, DM_DRIFT_FIRST };

/* Coefficients of one order and number of stages. A row's table is a list of them, which ends with
 * order 0; a rule without an order takes the first. */
typedef struct {
    int order;
    int stages; /* force evaluations per step */
    int kind;   /* DM_GAMMA: multiples of the base step; else kicks and drifts of their own */
    /* gamma_1, ..., or the alternating kicks and drifts, up to where palindrome and sum = 1 fix
     * the rest */
    double half[20];
} dm_scheme;

/* Steps of the base rule, the last argument or verlet, where there are no kicks and drifts. */
extern const dm_engine dm_engine_composition;

/* Fields of the rows. */
const char *dm_composition_check(const dm_rule *rule);
int dm_composition_order(const dm_rule *rule);
int dm_composition_splitting(dm_splitting *out, const dm_rule *rule);

/* What the rows of compositions have alike. */
#define DM_COMPOSED(schemes)                                                                       \
    .traits = DM_SYMMETRIC | DM_SYMPLECTIC | DM_CONSTRAINTS, .engine = &dm_engine_composition,     \
    .table = schemes, .check = dm_composition_check, .order = dm_composition_order,                \
    .splitting = dm_composition_splitting

#endif
