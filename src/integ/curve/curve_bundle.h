/* curve_bundle.h - the discrete tangent bundle (V, d+, d-) of curve segments (Cuell-Patrick
 * 2008, definition 2): V has the coordinates (q, v), d-(q, v) and d+(q, v) are the ends of a
 * segment. D[2n*2n] has the rows of T d-, then those of T d+. */
#ifndef DM_CURVE_BUNDLE_H
#define DM_CURVE_BUNDLE_H

#include "integ/curve/curve_segment.h"

typedef struct {
    dm_segment segment;
    const dm_curve *curve;
    uint32_t n;
    double h;
    double *zero, *some, *D; /* [n]; [4n]; [2n*2n] */
    double *scratch;
} dm_bundle;

/* An element of V, and the time of its point q. */
typedef struct {
    const double *q, *v;
    double t;
} dm_element;

/* Doubles of a bundle; make its kernels, lay it out. The model needs DM_WANT_VALUE and a
 * second-order field. */
size_t dm_bundle_work(const dm_curve *c, const dm_model *m);
dm_status dm_bundle_open(dm_bundle *b, const dm_curve *c, const dm_model *m, double h,
                         double *memory);

/* minus = d-, plus = d+. */
dm_status dm_bundle_ends(dm_bundle *b, double *minus, double *plus, const dm_element *e);

/* D = (T d-, T d+). */
dm_status dm_bundle_tangents(dm_bundle *b, double *D, const dm_element *e);

/* Ld, and p0, p1 with dLd = p1 dq1 - p0 dq0: both discrete Legendre transforms. */
dm_status dm_bundle_momenta(dm_bundle *b, double *p0, double *p1, double *action,
                            const dm_element *e);

/* y = (dq, dv) with T d-(y) = minus, T d+(y) = plus: dq^- for plus = 0, dq^+ for minus = 0. */
dm_status dm_bundle_lift(dm_bundle *b, double *y, const double *minus, const double *plus,
                         const dm_element *e);

/* The element (q, v) whose ends are q0 and q1, its point at time t. */
dm_status dm_bundle_find(dm_bundle *b, double *q, double *v, const double *ends[2], double t);

/* The smallest singular value of half a D, T d- or T d+: not 0 for a submersion. */
double dm_bundle_submersion(dm_bundle *b, const double *half);

/* How far the kernels of T d- and T d+ are from meeting: the smallest singular value of ((T d+ +
 * T d-)/2, (T d+ - T d-)/h), which tends to the identity with h (proposition 1); *limit (may be
 * NULL) is its distance from that, the largest entry. */
dm_status dm_bundle_transversality(dm_bundle *b, double *least, double *limit, const dm_element *e);

/* The first h, from a hundredth to a thousand of the bundle's own, at which the kernels meet; 0
 * when there is none. */
double dm_bundle_largest_step(dm_bundle *b, const dm_element *e);

#endif
