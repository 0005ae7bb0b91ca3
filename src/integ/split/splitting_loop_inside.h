/* splitting_loop_inside.h - what making and running such a loop have in common. */
#ifndef DM_SPLITTING_LOOP_INSIDE_H
#define DM_SPLITTING_LOOP_INSIDE_H

#include "integ/split/fused.h"
#include "integ/split/splitting_loop.h"

/* A step by where its kicks are: kicks at both ends       head: kick, drift, force, kick;
 * bodies: drift, force, kick; the factors of the
 *                            force are carried, those of the start are a part of their own
 * kick at the beginning    bodies: force, kick, drift kick at the end          bodies: drift,
 * force, kick at neither               bodies: drift, force, kick; tail: drift Without
 * compensation kicks at both ends become one where L does not see the time (DM_LOOP_MERGED):
 * bodies: drift, force, kick; a kick alone at the start and, for the momentum that is shown, at
 * the end of a call. */
enum {
    DM_LOOP_KICK_FIRST = 1,
    DM_LOOP_KICK_LAST = 2,
    DM_LOOP_KICKS_AT_BOTH_ENDS = 3,
    DM_LOOP_MORE_STAGES = 4,
    DM_LOOP_SCALED = 8,
    DM_LOOP_PLAIN = 16, /* sums without low parts */
    DM_LOOP_MERGED = 32
};

/* what members side by side have: made once, for every run */
typedef struct {
    dm_loop loop, kick;    /* kick: of merged steps, alone */
    double *wide, *spread; /* carried values [groups][size][lanes], coefficients */
    dm_lanes lanes;
} dm_splitting_wide;

struct dm_splitting_loop {
    unsigned shape;
    dm_kicks kicks;
    uint32_t size; /* of the carried values: q, p, and unless merged their low parts, factors */
    dm_loop_part part[DM_LOOP_PARTS], kick[DM_LOOP_PARTS];
    dm_loop one, one_kick; /* for one member */
    dm_splitting_wide many;
};

enum { /* doubles */
       DM_LOOP_OF_STEP = 5 + 4 * DM_SPLITTING_STAGES,
       DM_LOOP_COEFFICIENTS = 1024 /* have room: of some steps where L depends on t */
};

/* carried values at most, one factor a coordinate */
static inline size_t dm_splitting_loop_carried(uint32_t n) {
    return 5 * (size_t)n;
}

static inline int dm_splitting_loop_ends(unsigned shape) {
    return (int)(shape & DM_LOOP_KICKS_AT_BOTH_ENDS);
}

#endif
