/* curve_segment.h - one curve segment evaluated: its points, its ends, and the derivatives of
 * G(y) = Ld(y) - p1 . d+(y) + p0 . d-(y) in y = (q, v), by one sweep back through the points:
 * with F = (v, a), k_i = dG/dF_i and y_i = dG/dY_i, k_i = (h minus_i p0 - h plus_i p1, 0) + h
 * sum_j>i a_ji y_j,   y_i = (0, kq_i) + (kv_i . a + h weight_i L)_y(Y_i) (and the like for push
 * and lift), and with the tangents T_i = dY_i/dy G_yy = sum_i T_i^T (kv_i . a + h weight_i L)_yy
 * T_i. All exact. Forces and rolling constraints do work along the segment: dLd becomes the
 * one-form sigma_d = dLd + h sum_i weight_i C(Y_i) . T_i, which need not be closed, and C enters
 * y_i as L_y does; G_y and G_yy then stand for the form and its derivative. */
#ifndef DM_CURVE_SEGMENT_H
#define DM_CURVE_SEGMENT_H

#include "integ/curve/curve.h"
#include "integ/curve/curve_field.h"
#include "integ/curve/curve_written.h"
#include "numbers/weight.h"

typedef struct {
    const dm_curve *curve;
    const dm_model *m;
    dm_field field;
    uint32_t n;
    size_t points, inputs;
    double h;                          /* of the coefficients: the same numbers forward and back */
    dm_weight *to_q, *to_v, *lift;     /* [s*s] h a, h push, h^2 lift; lift NULL: none */
    dm_weight *plus_q, *minus_q;       /* [s] of the ends, times h */
    dm_weight *plus_lift, *minus_lift; /* [s] times h^2 */
    double *weight;                    /* [s] of Ld, times h */
    double *plus_v, *next_v;           /* [s] of arrival and next, times h */
    double *x;                         /* [s][inputs] of the field's kernels: q, v, t, a, u, l */
    double *force;                     /* [s][force.outputs] */
    double *factors;                   /* [s][N*N] of S; none where the field is solved */
    uint32_t *pivot;                   /* [s][N] */
    double *gradient;                  /* [s][2n] y_i */
    double *pull;                      /* [2n] outputs of the kernels */
    double *second;                    /* [outputs of `curve`] */
    double *tangent;                   /* [s][2n*2n] T_i */
    double *push;                      /* [s][n*2n] da_i/dy */
    double *some;                      /* [2n*2n + 2N] scratch */
    double *held;                      /* [controls] of this step, set by the caller */
    double *plus, *minus;              /* [n] d+ - q, d- - q */
    double *arrival;                   /* [n] v + h sum plus a: the velocity at d+ */
    double *next;                      /* [n] v + h sum (plus - minus) a: v of the next segment */
    double *slope;                     /* [2n] sum of y_i: G_y without p0 - p1 */
    double *hessian;                   /* [2n*2n] G_yy */
    double *plus_tangent, *minus_tangent;        /* [n*2n] of d+ - q, d- - q */
    double *arrival_tangent, *departure_tangent; /* [n*2n] of the velocities there, less v */
    double *momentum, *change, *a_y, *end; /* [n*2n] L_vy, its use; [N*2n] w_y; inputs of L_vy */
    dm_written written;                    /* of a recipe, which has no points */
    double *share;                         /* [substeps] of h, set by the caller; sum 1 */
} dm_segment;

/* Doubles of a segment; make its kernels, lay it out. */
size_t dm_segment_work(const dm_curve *c, const dm_model *m);
dm_status dm_segment_open(dm_segment *g, const dm_curve *c, const dm_model *m, double *memory);

/* Points, ends, `arrival` and `next` for q + shift, v (shift NULL: 0), step h around time t. */
typedef struct {
    const double *q, *shift, *v;
    double t, h;
} dm_segment_place;
dm_status dm_segment_run(dm_segment *g, const dm_segment_place *at);

/* slope, after run; p0 NULL: 0. */
void dm_segment_gradient(dm_segment *g, const double *p1, const double *p0);

/* Columns first .. 2n-1 of hessian; plus_tangent, minus_tangent; after gradient. */
void dm_segment_hessian(dm_segment *g, uint32_t first);

/* The same with G_yy = D+^T P+ - D-^T P-, P = (L_v)_y at the ends: what it is where Ld is the
 * action of the flow and p0, p1 are its momenta, so that it errs by h^p relative. No second
 * derivatives of the field. */
void dm_segment_estimate(dm_segment *g, uint32_t first);

/* x = S^-1 x and S^-T x at point i, x[N]; without constraints S is the mass, and symmetric. */
void dm_segment_divide(const dm_segment *g, size_t i, double *x);
void dm_segment_divide_transposed(const dm_segment *g, size_t i, double *x);

/* Ld, after run. Needs DM_WANT_VALUE. */
double dm_segment_action(const dm_segment *g);

/* What rolling constraints do along the segment, by time to both ends: out[2][rolling]. */
void dm_segment_impulses(const dm_segment *g, double *out);

/* ---- the same of a recipe, by kernels of the whole segment (curve_segment_written.c) ---- */

size_t dm_written_segment_work(const dm_curve *c, const dm_model *m);
dm_status dm_written_segment_open(dm_segment *g, double *memory);
dm_status dm_written_segment_run(dm_segment *g, const dm_segment_place *at);
void dm_written_segment_gradient(dm_segment *g, const double *p1, const double *p0);
void dm_written_segment_hessian(dm_segment *g);
double dm_written_segment_action(const dm_segment *g);
void dm_written_segment_impulses(const dm_segment *g, double *out);

#endif
