/* step_method.h - a step that a script writes: the root x of F(y, x, h) = 0 that Newton's method
 * finds from start(y, h), then y' = next(y, x, h). y = (q, p, t, parts): parts are numbers of its
 * own, which begin(q, p, h) sets. */
#ifndef DM_STEP_METHOD_H
#define DM_STEP_METHOD_H

#include "integ/method/method.h"

/* What a rule says of itself (dm_rule.data). */
typedef struct {
    uint32_t unknowns, parts;
    /* of these, at the end: impulses of holonomic constraints and of rolling ones; their rows of F
     * are what shall be zero behind the step. The first dim G unknowns are then x of q exp(x). */
    uint32_t holonomic, rolling;
    int fixed; /* a step of a discrete Lagrangian: its h is in it, and its order is that of Ld */
    int order;
    int sums; /* `next` gives what q and p gain, which is summed with low-order parts */
} dm_step_row;

/* The row of methods.def, whose t grows by h, that of steps whose `next` gives t: a method with a
 * time of its own; and that of steps of discrete Lagrangians, which hold constraints. */
extern const dm_method dm_method_step, dm_method_step_timed, dm_method_step_tied;

static inline int dm_is_step(const dm_method *m) {
    return m == &dm_method_step || m == &dm_method_step_timed || m == &dm_method_step_tied;
}

/* Its functions for one system, which the caller makes and gives to the stepper (`brought`).
 * Inputs are (q[n], p[d], t, parts[w], x[m], h), of start and scale (q[n], p[d], t, parts[w], h),
 * of begin (q[n], p[d], h). */
typedef struct {
    uint32_t n, d, w, m;
    dm_kernel equation; /* F[m] */
    dm_kernel tangent;  /* F[m], dF/dx [m*m] */
    dm_kernel next;     /* q'[n], p'[d], t', parts'[w], how far off the group, squared */
    dm_kernel start;    /* x[m] */
    dm_kernel begin;    /* parts[w]; outputs 0: they begin at 0 */
    dm_kernel inside;   /* numbers that are > 0 at the root meant; outputs 0: none */
    dm_kernel scale;    /* [m], of what the unknowns are added to; outputs 0: 0 */
} dm_step_kernels;

#endif
