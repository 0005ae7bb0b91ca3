/* curve_inside.h - the workspace of the curve rule, for its files only. */
#ifndef DM_CURVE_INSIDE_H
#define DM_CURVE_INSIDE_H

#include "integ/curve/curve_segment.h"

/* at the head of the workspace */
typedef struct {
    dm_curve curve;
    dm_segment segment;
    const double *state;
    double t, h;
    size_t n, unknowns;
    int estimate;          /* the matrix may err by h^p */
    uint32_t columns;      /* of G_yy, from where on they are wanted */
    double *mass;          /* [n] size of M by rows: what turns velocities into momenta */
    double *z, *y, *p1;    /* [6n] unknowns, and their start; [2n] q - q0, v of the last run; [n] */
    double *next, *memory; /* [4n]; see below */
    double *slope;         /* [2n] of L at the end */
    double *scratch;
    double size, residual; /* of the momenta; of the step equation */
    int ran;               /* the segment is at y */
    int settled;           /* the last increment, at the head of scratch, was at round-off */
    long evaluations;
} dm_curve_step;

/* 2 n, or 3 n where d- is not q */
static inline size_t dm_curve_unknowns(const dm_curve *c, size_t n) {
    return (c->centred ? 3 : 2) * n;
}

/* Points and ends for the unknowns z, unless they are there already. */
dm_status dm_curve_place(dm_curve_step *e, const double *z);

/* Solve it for the step from `state` at time t; the root is in z, the segment at it or one
 * increment away. */
dm_status dm_curve_solve(dm_stepper *s, const double *state, double t, double h);

/* The step equation for dm_newton: r = 0 for z = (v, (p1 - p0) / mass, (q - q0) / h). */
dm_status dm_curve_equation(void *ctx, double *r, double *J, const double *z);

#endif
