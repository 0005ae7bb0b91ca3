/* one_point.h - two iterations for the acceleration u at the one point of a stage method, written
 * out: for L = T(v) - V(q, t) with constant mass M and few coordinates, M u = L_q(q0 + Z, t), Z
 * = b + w u, by Newton's method from a guess of Z and once more with the same matrix M - w L_qq.
 * As one kernel they cost little more than what has to wait for each other. */
#ifndef DM_PUSH_H
#define DM_PUSH_H

#include "mech/model.h"

enum { DM_PUSH_MOST = 4 }; /* coordinates */

/* It takes q0[n], b[n], Z[n] of the guess, and behind them w, 1 / w and t. */
enum { DM_PUSH_WEIGHT, DM_PUSH_OVER, DM_PUSH_TIME, DM_PUSH_NUMBERS };
static inline uint32_t dm_push_inputs(uint32_t n) {
    return 3 * n + DM_PUSH_NUMBERS;
}

/* It gives L_q[n] at the root, to first order in the last increment, and both increments of u,
 * [n] each. */
static inline uint32_t dm_push_outputs(uint32_t n) {
    return 3 * n;
}

/* The kernel for `lanes` members side by side (1, 4 or 8), from the model where it was made
 * before; 0: there is none. */
int dm_push_kernel(dm_kernel *out, const dm_model *m, uint32_t lanes);

#endif
