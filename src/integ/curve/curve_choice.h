/* curve_choice.h - substeps of a one-step method that are chosen at the start of every step, from
 * its state, and held for all of it: Newton's method and derivatives see one method. Choices are
 * whole numbers, so that the step is symplectic wherever the choice does not change. */
#ifndef DM_CURVE_CHOICE_H
#define DM_CURVE_CHOICE_H

#include "mech/model.h"

/* As it was traced for one dim Q: of (q[n], v[n], h, t) at the start of a step a weight for every
 * substep, rounded to a whole number, 0: it is left out; or, where it is `bare`, one number, of
 * substeps that are all the same. A rule has the graph alone, since threads share the rule: every
 * stepper has a kernel of its own. */
typedef struct dm_curve_choice {
    uint32_t n;
    uint32_t serial; /* no two have the same */
    int bare, outputs;
    dm_graph *graph;
    const dm_node *out; /* [outputs] */
} dm_curve_choice;

/* Its kernel for a stepper on this model, in the model's arena. */
dm_status dm_curve_choice_build(dm_kernel *out, const dm_curve_choice *c, const dm_model *m);

/* share[count] of a step, sum 1, of the outputs of the kernel; 0 where they are no weights. */
int dm_curve_shares(const dm_curve_choice *c, double *share, int count, const double *out);

#endif
