/* curve_field.h - the second-order field of a Lagrangian and its exact derivatives as kernels.
 * The acceleration a(q, v, t) is what makes the Euler-Lagrange defect vanish, E(q, v, a, t) =
 * L_q - L_vq v - L_vv a - L_vt = 0, and is not written out: with M = L_vv and M u = k, (k . a)_y
 * = (u . E)_y,   a_y = M^-1 E_y, (k . a)_yy = (u . E)_yy + B^T a_y + (B^T a_y)^T,   B = (u .
 * E)_ay,   y = (q, v), u and a held. */
#ifndef DM_CURVE_FIELD_H
#define DM_CURVE_FIELD_H

#include "mech/model.h"

/* Each takes (q[n], v[n], t, a[n], u[n], l). */
typedef struct {
    dm_kernel force;    /* a[n] where the mass is constant, else (E + M a)[n], M[n*n] */
    dm_kernel gradient; /* (u . E + l L)_y [2n] */
    dm_kernel curve;    /* (u . E + l L)_yy [2n*2n], E_y[n*2n], B[n*2n] */
    dm_kernel tangent;  /* E_y[n*2n] */
    dm_kernel momentum; /* L_vy[n*2n] */
} dm_field;

static inline size_t dm_field_inputs(size_t n) {
    return 4 * n + 2;
}

/* In the model's arena, kept by the model; DM_TOO_LARGE where there is no graph. */
dm_status dm_field_build(dm_field *out, const dm_model *m);

#endif
