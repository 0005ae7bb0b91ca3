/* inertia_line.h - values of d2L/dv2 along a line: where one is lost, or grows without bound. */
#ifndef DM_INERTIA_LINE_H
#define DM_INERTIA_LINE_H

#include "run/inertia/inertia.h"

/* A place: position q[n] at time t, at s of a chord; the velocity that it has no mass for, as a
 * change of q[n]; the block that this is of, and what is none there. v[n] is a velocity, NULL where
 * M does not depend on it. */
typedef struct {
    const dm_inertia *x;
    const double *v;
    double *q, *lost, *there, *tried, *normal; /* [n] each */
    double t, s, none, from, to;
    uint32_t block;
    int inverse; /* values are those of the inverse */
} dm_inertia_spot;

/* Of the values at both ends of the way: what is none. */
#define DM_INERTIA_NONE 1e-12

/* What has room[5n]. */
dm_inertia_spot dm_inertia_spot_in(const dm_inertia *x, const double *v, double *room);

/* The size of the product of the values of the block there. */
double dm_inertia_value_at(const dm_inertia_spot *at, const double *q, double t);

/* Those of all blocks, where the place is put on the chord, at s. */
void dm_inertia_put_on(dm_inertia_spot *at, const dm_chord *c, double s);
void dm_inertia_find_on(dm_inertia_spot *at, const dm_chord *c, double s, double *out);

/* The least of the block on that part of the chord, or one that is none, by the golden section, and
 * its place. */
double dm_inertia_least_on(dm_inertia_spot *at, const dm_chord *c);

/* Can a velocity be carried to coordinates, and one w[d] as such a change, at the place, to
 * at->lost: on a group, by steps of that size to both sides. */
int dm_inertia_can_carry(const dm_inertia *x);
#define DM_INERTIA_SHORT 1e-4
void dm_inertia_carry(dm_inertia_spot *at, const double *w);

/* Does M grow without bound on the way, so that no motion comes through (inertia_pole.c)? The
 * values of blocks at its ends and in its middle are known. */
int dm_inertia_has_pole(dm_inertia_spot *at, const dm_chord *way);

#endif
