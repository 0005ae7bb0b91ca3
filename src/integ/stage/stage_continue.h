/* stage_continue.h - a step whose equation Newton's method does not solve from free flight, by way
 * of shorter ones. */
#ifndef DM_STAGE_CONTINUE_H
#define DM_STAGE_CONTINUE_H

#include "integ/method/method.h"

/* Solves for the stages of a step h from this state, and keeps them; begins at those that were
 * kept, of a step that is shorter by `ratio`, or with 0 at free flight. */
typedef dm_status dm_stage_try(dm_stepper *s, const double *state, double t, double h,
                               double ratio);

/* The stages of a step h: from free flight; where there is no convergence, those of h/16, h/8, ...
 * h, each from the one before, so that what is found belongs to the motion of small steps. Where
 * twice the step fails ratios are less, down to 1.001: what fails then is a fold, beyond which no
 * root belongs to that motion. */
dm_status dm_stage_continue(dm_stepper *s, dm_stage_try *solve, const double *state, double t,
                            double h);

#endif
