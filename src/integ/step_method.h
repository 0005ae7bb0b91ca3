/* step_method.h - a step that a script writes: the root x of F(y, x, h) = 0 that Newton's method
 * finds from start(y, h), then y' = next(y, x, h), y = (q, p, t). */
#ifndef DM_STEP_METHOD_H
#define DM_STEP_METHOD_H

#include "code/kernel.h"

/* What a rule says of itself (dm_rule.data). */
typedef struct {
    uint32_t unknowns;
    int order;
} dm_step_row;

/* Its functions for one system, which the caller makes and gives to the stepper (`brought`).
 * Inputs are (q[n], p[d], t, x[m], h), of start and scale (q[n], p[d], t, h). */
typedef struct {
    uint32_t n, d, m;
    dm_kernel equation; /* F[m] */
    dm_kernel tangent;  /* F[m], dF/dx [m*m] */
    dm_kernel next;     /* q'[n], p'[d] */
    dm_kernel start;    /* x[m] */
    dm_kernel inside;   /* numbers that are > 0 at the root meant; outputs 0: none */
    dm_kernel scale;    /* [m], of what the unknowns are added to; outputs 0: 0 */
} dm_step_kernels;

#endif
