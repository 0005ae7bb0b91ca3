/* trail.h - curves along a level set, node by node: the inside of a search, for the files of this
 * room only. */
#ifndef DM_TRAIL_H
#define DM_TRAIL_H

#include "level/folds.h"

/* v: the unit vector of its curve; reach, breaks: how far along it before a switch, and behind a
 * break */
typedef struct {
    double *x, *v, sine, slant, size, reach, breaks;
    int inside;
} dm_footing;

typedef struct {
    const dm_folds *how;
    dm_level *l;
    dm_arena *arena;
    uint32_t spent, random;
    int over; /* found what was enough, or no memory */
    dm_footing spare[4];
    double *v;
} dm_search;

/* at: where it is, before: the node before, left: the last two between which it left the inside */
typedef struct {
    dm_footing at, before, next, left[2];
    double step;
    int has_before, has_left, outside, ended;
} dm_trail;

int dm_footing_take(dm_search *s, dm_footing *p);
void dm_footing_copy(const dm_search *s, dm_footing *to, const dm_footing *from);

/* `to` = the node of from + h v, v[n] unit or NULL, at a distance that fits a step of length
 * `fit`; 0: there is none. */
int dm_footing_step(dm_search *s, dm_footing *to, const double *from, const double *v, double h,
                    double fit);

/* v[n] = a unit vector at random along the set at `at`. 0: none */
int dm_random_tangent(dm_search *s, const dm_footing *at, double *v);

/* Set out from a node in the direction of v; c has memory. */
void dm_trail_begin(dm_search *s, dm_trail *c, const dm_footing *at, const double *v, double step);
int dm_trail_take(dm_search *s, dm_trail *c);

/* Up to `count` nodes; what is found is told. downhill: no further than |sine| falls. */
void dm_trail_follow(dm_search *s, dm_trail *c, int count, int downhill);

/* Tell what lies between two nodes. */
void dm_search_tell(dm_search *s, const dm_footing *a, const dm_footing *b, const dm_trail *left);

#endif
