/* mass_lanes.h - d2L/dv2 of 4 or 8 members side by side, and whether its values are positive by
 * far, as they mostly are: what a look at each of them alone finds (run/inertia/inertia.h), with
 * its bits. Of M(q, t) on coordinates without constraints.
 * Speed: ensembles, double spherical pendulum midpoint: 1.2x, against looks one by one; 1.02x, at
 * starts and on lines between looks. */
#ifndef DM_MASS_LANES_H
#define DM_MASS_LANES_H

#include "integ/method/lanes.h"
#include "run/inertia/inertia.h"

typedef struct dm_mass_lanes dm_mass_lanes;

/* The lanes whose pivots are all above `far`, of those that are asked; rows and columns of w->M are
 * taken times scale[n][lanes]. Their w->least and w->all are set. All is in the order of blocks. */
typedef uint32_t dm_mass_lanes_pivots(const dm_mass_lanes *w, const double *scale, double far,
                                      uint32_t asked);

/* What looks at members in lanes found: courses of the first one, those of the next so many numbers
 * apart; the least values of blocks and their products, all positive by far; the products in the
 * middle of the line from the last look, NULL: not known; the times. */
typedef struct {
    dm_inertia_course *course;
    size_t apart;
    const double *least, *all, *between; /* [blocks][lanes] */
    const double *t;                     /* [lanes] */
} dm_mass_found;

/* Looks at the members seen[lanes] after so many steps. The lanes, of those that are asked, of
 * which nothing comes but the next look: that is noted. Without mass_bounds. */
typedef uint32_t dm_mass_lanes_quiet(const dm_mass_lanes *w, dm_inertia_seen *seen,
                                     const dm_mass_found *f, long done, uint32_t asked);

/* Those of the model's last ensemble stay with the model. */
struct dm_mass_lanes {
    uint32_t n, lanes;
    dm_blocks blocks;
    dm_kernel mass;         /* of (q, v, t): the lower triangles of the blocks of M, row by row */
    double *in, *M;         /* [2n+1][lanes], [entries][lanes] */
    double *A;              /* [n*n][lanes] */
    double *scale;          /* [groups + 1][n][lanes] of the velocities of the members */
    double *least, *all;    /* [blocks][lanes] the least pivot, the product of all */
    double *t;              /* [lanes] the last entry of `in`, whose first ones are q[n][lanes] */
    double *noted;          /* [blocks][courses][lanes] */
    double *kept;           /* [2][blocks][lanes] of another look */
    dm_inertia_value *told; /* [groups][lanes][blocks] */
    dm_mass_lanes_pivots *pivots;
    dm_mass_lanes_quiet *quiet;
};

/* For the members of such lanes; NULL: there are none, or no memory. */
dm_mass_lanes *dm_mass_lanes_open(const dm_model *m, const dm_lanes *x);

/* The scales of member i; those of DM_MASS_LANES_OWN belong to one member, at several places. */
enum { DM_MASS_LANES_OWN = DM_LANES_GROUPS };
void dm_mass_lanes_put_scale(dm_mass_lanes *w, uint32_t i, const double *scale);

/* A place q[n] at a time for a lane. */
void dm_mass_lanes_put_place(dm_mass_lanes *w, uint32_t lane, const double *q, double t);

/* Looks at a group at the places and times that lie in w->in: as above. */
uint32_t dm_mass_lanes_look(dm_mass_lanes *w, uint32_t group, uint32_t asked);

/* One for every kind of processor. */
dm_mass_lanes_pivots dm_mass_pivots_avx, dm_mass_pivots_avx512;
dm_mass_lanes_quiet dm_mass_quiet_avx, dm_mass_quiet_avx512;

#endif
