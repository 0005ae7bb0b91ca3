/* curve_choice.h - substeps of a one-step method that are chosen at the start of every step, from
 * its state, and held for all of it: Newton's method and derivatives see one method. Choices are
 * whole numbers, so that the step is symplectic wherever the choice does not change. */
#ifndef DM_CURVE_CHOICE_H
#define DM_CURVE_CHOICE_H

#include "code/kernel.h"

/* The kernel takes (q[n], v[n], h, t) at the start of a step and gives a weight for every substep,
 * rounded to a whole number, 0: it is left out; or, where it is `bare`, one number, of substeps
 * that are all the same. */
typedef struct dm_curve_choice {
    uint32_t n;
    int bare, outputs; /* of the kernel */
    dm_kernel kernel;
} dm_curve_choice;

/* share[count] of a step, sum 1, of the outputs of the kernel; 0 where they are no weights. */
int dm_curve_shares(const dm_curve_choice *c, double *share, int count, const double *out);

#endif
