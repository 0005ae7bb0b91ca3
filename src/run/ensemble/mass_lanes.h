/* mass_lanes.h - d2L/dv2 of 4 or 8 members side by side, and whether its values are positive by
 * far, as they mostly are: what a look at each of them alone finds (run/inertia/inertia.h), with
 * its bits. Of M(q, t) on coordinates without constraints.
 * Speed: ensembles, double spherical pendulum midpoint: 1.2x, against looks one by one. */
#ifndef DM_MASS_LANES_H
#define DM_MASS_LANES_H

#include "integ/method/stepper.h"

typedef struct dm_mass_lanes dm_mass_lanes;

/* The lanes whose pivots are all above `far`, of those that are asked; rows and columns of w->M are
 * taken times scale[n][lanes]. Their w->least and w->all are set. */
typedef uint32_t dm_mass_lanes_pivots(const dm_mass_lanes *w, const double *scale, double far,
                                      uint32_t asked);

/* Those of the model's last ensemble stay with the model. */
struct dm_mass_lanes {
    uint32_t n, lanes;
    dm_kernel mass;      /* of (q, v, t): the lower triangle of M, row by row */
    double *in, *M;      /* [2n+1][lanes], [n(n+1)/2][lanes] */
    double *A;           /* [n*n][lanes] */
    double *scale;       /* [groups][n][lanes] of the velocities of the members */
    double *least, *all; /* [lanes] the least pivot, the product of all */
    double *t;           /* [lanes] the last entry of `in` */
    dm_mass_lanes_pivots *pivots;
};

/* For the members of such lanes; NULL: there are none, or no memory. */
dm_mass_lanes *dm_mass_lanes_open(const dm_model *m, const dm_lanes *x);

/* The scales of member i. */
void dm_mass_lanes_put_scale(dm_mass_lanes *w, uint32_t i, const double *scale);

/* Looks at a group at q[n][lanes] and times w->t: as above. */
uint32_t dm_mass_lanes_look(dm_mass_lanes *w, uint32_t group, const double *q, uint32_t asked);

/* One for every kind of processor. */
dm_mass_lanes_pivots dm_mass_pivots_avx, dm_mass_pivots_avx512;

#endif
