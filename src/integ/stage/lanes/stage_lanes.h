/* stage_lanes.h - the usual step of a stage method for 4 or 8 members side by side: sweeps that
 * settle, or Newton's method with chord iterations, both from the steps before. Every lane does
 * what stage_sweep.c and stage.c do for its member alone, operation by operation, and stops when
 * that would; a member whose step goes another way (a first one, a slow or a failing one) takes
 * it alone. */
#ifndef DM_STAGE_LANES_H
#define DM_STAGE_LANES_H

#include "integ/stage/stage_inside.h"

enum { DM_STAGE_LANES_UNKNOWNS = 64 }; /* at most, for Newton's method */

typedef struct dm_stage_lanes dm_stage_lanes;

/* A step of the group in hand for the lanes that are asked; the bits of those whose step is
 * done. */
typedef uint32_t dm_stage_lanes_step(const dm_stage_lanes *w, uint32_t asked);

/* All arrays are [entry][lane], those of stages [stage][entry][lane]; the memory of a step is
 * laid out as that of one member. */
struct dm_stage_lanes {
    const dm_stage *g;
    dm_stage_lanes_step *step;
    dm_lanes members; /* kept for the next ensemble of the model */
    /* what is multiplied by h, a step for every lane: the stepper's own coefficients from `one`
     * on, as many as `entries`, and [groups][1 + entries][lanes] steps and coefficients of all;
     * those of the group in hand */
    const double *one;
    size_t entries;
    double *paces;
    const double *h, *scaled;
    double t, tolerance;
    int max_iterations;
    double *state, *memory; /* of the group in hand */
    double *next;           /* [4n] its end */
    dm_kernel force, factors, velocity, stage, slope;
    /* sweeps: arguments and results of the kernels, M^-1 L_q, bases of positions and momenta, v
     * and h v at the start, u and L_q where lanes ended */
    double *in, *out, *factored, *u, *base, *lift, *v0, *drift, *end_u, *end_f, *zeros;
    /* push.h: its kernel is `stage`, with in and out, v0, end_u and end_f. Newton's method: as
     * in dm_stage; a second curve, matrix and pivots for lanes that renew theirs apart */
    double *x, *curve, *slopes, *other, *root, *dx, *r, *missed, *J, *J2;
    void *pivot, *pivot2;
};

/* One for every kind of processor; products of sweeps are fused into sums as a member alone has
 * it. */
dm_stage_lanes_step dm_stage_sweep_avx, dm_stage_sweep_fma, dm_stage_sweep_avx512,
    dm_stage_sweep_avx512_plain, dm_stage_newton_avx, dm_stage_newton_avx512, dm_stage_push_avx,
    dm_stage_push_avx512;

/* What the rows of methods.def call. */
int dm_stage_widen(dm_stepper *s, dm_lanes *x);
void dm_stage_advance_lanes(dm_stepper *s, dm_lanes *x, double t, const double *h, long count);

#endif
