/* lie_lanes.h - the usual step in the natural chart for 4 or 8 members side by side: Newton's
 * method by chord iterations from the steps before. Every lane does what lie.c does for its member
 * alone, operation by operation; a member whose step goes another way (a first one, one that wants
 * damping or leaves the chart) takes it alone.
 * Speed: ensembles, lie(2) of heavy tops: 4x, against a member after the other. */
#ifndef DM_LIE_LANES_H
#define DM_LIE_LANES_H

#include "integ/lie/lie_inside.h"
#include "integ/method/lanes.h"

typedef struct dm_lie_lanes dm_lie_lanes;
typedef uint32_t dm_lie_lanes_step(const dm_lie_lanes *w, uint32_t asked);

/* Those of the model's last ensemble stay with the model. [..][lanes] of a group: */
struct dm_lie_lanes {
    dm_lie group;  /* in hand, with kernels of its own: */
    dm_group wide; /* the group with kernels for lanes */
    dm_lanes members;
    dm_lie_lanes_step *step;
    double tolerance;
    int max_iterations;
    double *r, *dx;      /* [m] residual, last increment of every lane */
    double *r2;          /* [m] residual of lanes that take a matrix apart from the others */
    double *J, *pivot;   /* [m*m], [m] factors of the matrix of every lane, and its rows */
    double *J2, *pivot2; /* the same of those lanes */
    double *gain, *mu;   /* [d] P and p0 + P where every lane was last evaluated */
    double *mu_V;        /* [d*m] and the derivative of both there that its matrix has */
    double *ones;        /* [1] the size of an angle */
};

/* One for every width of registers. */
dm_lie_lanes_step dm_lie_step_avx, dm_lie_step_avx512;

/* For the engine: see stepper.h. */
int dm_lie_widen(dm_stepper *s, dm_lanes *x);
void dm_lie_advance_lanes(dm_stepper *s, dm_lanes *x, double t, const double *h, long count);

#endif
