/* one_point.h - two iterations for the acceleration u at the one point of a stage method, written
 * out: for L = T(v) - V(q, t) with constant mass M and few coordinates, M u = L_q(q0 + Z, t), Z
 * = b + w u, by Newton's method from a guess of Z and once more with the same matrix M - w L_qq.
 * As one kernel they cost little more than what has to wait for each other.
 * Speed: one_stage, alone and member, up to four coordinates: 1.6x to 2.6x, against sweeps. */
#ifndef DM_ONE_POINT_H
#define DM_ONE_POINT_H

#include "integ/stage/workspace/stage_warm.h"

enum { DM_ONE_POINT_MOST = 4 }; /* coordinates */

/* It takes q0[n], b[n], Z[n] of the guess, and behind them w, 1 / w and t. */
enum { DM_ONE_POINT_WEIGHT, DM_ONE_POINT_OVER, DM_ONE_POINT_TIME, DM_ONE_POINT_NUMBERS };
static inline uint32_t dm_one_point_inputs(uint32_t n) {
    return 3 * n + DM_ONE_POINT_NUMBERS;
}

/* It gives L_q[n] at the root, to first order in the last increment, and both increments of u,
 * [n] each. */
static inline uint32_t dm_one_point_outputs(uint32_t n) {
    return 3 * n;
}

/* The kernel for `lanes` members side by side (1, 4 or 8), from the model where it was made
 * before; 0: there is none. */
int dm_one_point_kernel(dm_kernel *out, const dm_model *m, uint32_t lanes);

/* The kernel and what it is given and gives, for the members of a group; its constant outputs are
 * in `out` from the opening on. */
typedef struct dm_one_point {
    dm_kernel kernel;
    double *in, *out; /* [inputs], [outputs] of a group */
    double heaviest;  /* largest entry of M, for the report of one member */
    int known;        /* of one member: its step in hand began from the memory */
} dm_one_point;

enum { DM_ONE_POINT_CALLS = 6 }; /* of the kernel in a step, at most */

/* The memory of these steps, group.memory, has at its head what that of stage_warm.h has: h, number
 * of P, the state at the end of the last step [4n]; then the next Z [n] and P [TERMS][n]. With P_0
 * the last Z and P_j the polynomial of degree j through j + 1 of them at the next point, a new Z
 * has the differences D_j = Z - P_(j-1) and the new P_j = P_(j-1) + D_j; so that (K + 1) Z - sum of
 * P_i, i < K, is the new P_K, and waits for nothing but Z. Differences are taken up to the
 * parabola's and then as long as they get much smaller. */
static inline size_t dm_one_point_doubles(uint32_t n) {
    return DM_WARM_END + (4 + 1 + DM_WARM_TERMS) * (size_t)n;
}

#endif
