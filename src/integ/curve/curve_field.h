/* curve_field.h - the second-order field of a Lagrangian, with forces and constraints, and its
 * exact derivatives as kernels. At a point (q, v, t) the acceleration a and the multipliers of the
 * reactions, together w = (a, lambda, mu), make R(q, v, t, w) vanish:
 *   L_q - L_vq v - L_vv a - L_vt + f + G^T lambda + E^T mu,  (g(q, t))'',  phi(q, v, t)',
 * the last two along the curve. R is affine in w and not solved in the graph: with S = -R_w,
 * S^T U = (k, 0) and y = (q, v)
 *   w_y = S^-1 R_y,  (k . a)_y = (U . R)_y,
 *   (k . a)_yy = (U . R)_yy + B^T w_y + (B^T w_y)^T,  B = (U . R)_wy,
 * U and w held. Without constraints S is the mass matrix. The work of f and of E^T mu, which is no
 * differential, is C = (f + E^T mu, 0). */
#ifndef DM_CURVE_FIELD_H
#define DM_CURVE_FIELD_H

#include "mech/constraints.h"

/* Each takes (q[n], v[n], t, w[N], U[N], l, u[controls]). */
typedef struct {
    uint32_t n, N, rolling; /* dim Q; with the multipliers; those of rolling constraints */
    int solved;             /* S is the constant mass: `force` gives a, and B is zero */
    dm_kernel force;        /* a[n] where it is solved, else R at w = 0 [N], S[N*N] */
    dm_kernel gradient;     /* (U . R + l L)_y + l C [2n] */
    dm_kernel curve;        /* (U . R + l L)_yy + l C_y [2n*2n], R_y[N*2n], B[N*2n], l E^T[n*l] */
    dm_kernel tangent;      /* R_y[N*2n] */
    dm_kernel momentum;     /* L_vy[n*2n] */
} dm_field;

/* n and the number of constraints */
uint32_t dm_field_rows(const dm_model *m);

/* Entries of what the kernels take. */
size_t dm_field_inputs(const dm_model *m);

/* Outputs of `curve`. */
size_t dm_field_curve(const dm_model *m);

/* n, N, rolling, solved alone: no kernels. */
void dm_field_shape(dm_field *out, const dm_model *m);

/* In the model's arena, kept by the model; DM_TOO_LARGE where there is no graph. */
dm_status dm_field_build(dm_field *out, const dm_model *m);

#endif
