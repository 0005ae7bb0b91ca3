/* trial.h - steps of curves in any space: q(t; z) with K parameters z, the action by any
 * quadrature, S(z) = sum_j w_j L(q(t_j; z), qdot(t_j; z)), and what it becomes between the ends
 * e0(z), e1(z) (Leok 5.2):
 *   dS/dz + p0 . de0/dz - p1 . de1/dz = 0,  e0(z) = q0,  then q1 = e1(z)
 * for z and p1, K + dim Q unknowns. The curve may have a fast phase w t beside the time: points of
 * the quadrature are then pairs of both, and weights those of two scales (multiscale/filon.h). */
#ifndef DM_TRIAL_H
#define DM_TRIAL_H

#include "integ/method/method.h"
#include "integ/method/quadrature.h"

/* What a rule says of itself (dm_rule.data). */
typedef struct {
    uint32_t parameters; /* K; 0: `each` for every coordinate */
    uint32_t each;
    dm_quadrature q;  /* of a piece; c, b in the unit of a piece */
    uint32_t pieces;  /* equal parts of a step, with q in each */
    uint32_t phases;  /* of the second scale; 0: there is none */
    double frequency; /* w, radians per unit of time */
} dm_trial_row;

/* Its curve for one system, which the caller makes and gives to the stepper (`brought`). Inputs of
 * `point` are (t, phase, h, z[K], l[2n]), outputs q[n], qdot[n], dq/dz[n*K], dqdot/dz[n*K] and,
 * unless the curve is linear in z, the K x K second derivatives of l . (q, qdot). Inputs of `start`
 * are (q[n], v[n], h), outputs z[K]; no outputs: what the space has nearest to a straight line. */
typedef struct {
    uint32_t n, parameters;
    int linear;
    dm_kernel point, start;
} dm_trial_kernels;

extern const dm_method dm_method_trial;

/* K on n coordinates. */
static inline uint32_t dm_trial_parameters(const dm_trial_row *row, uint32_t n) {
    return row->parameters ? row->parameters : row->each * n;
}

#endif
