/* stage_lanes.h - the usual step of a stage method for 4 or 8 members side by side: sweeps that
 * settle, Newton's method with chord iterations, or a step of one point, all from the steps before.
 * Every lane does what the stepper does for its member alone, operation by operation, and stops
 * when that would; a member whose step goes another way (a first one, a slow or a failing one)
 * takes it alone.
 * Speed: ensembles, member beside alone: 3x to 6x less a step. */
#ifndef DM_STAGE_LANES_H
#define DM_STAGE_LANES_H

#include "integ/stage/lanes/one_point.h"
#include "integ/stage/sweep/stage_sweep.h"

enum { DM_STAGE_LANES_UNKNOWNS = 64 }; /* at most, for Newton's method */

typedef struct dm_stage_lanes dm_stage_lanes;

/* A step of the group in hand for the lanes that are asked; the bits of those whose step is
 * done: their state and memory are new, those of the others as they were. */
typedef uint32_t dm_stage_lanes_step(const dm_stage_lanes *w, uint32_t asked);

/* Sweeps: as in dm_stage_sweeps, but [stage][entry][lane]. Constant outputs of kernels are in
 * their arrays from the opening on. */
typedef struct {
    dm_kernel force, factors, velocity;
    double *in, *out, *factored; /* arguments and results, [r][.] */
    double *u;                   /* [r][n] M^-1 L_q, for M that is not diagonal */
    double *base, *lift;         /* [r][n] bases of positions, momenta */
    double *v0, *drift;          /* [n] v and h v at the start */
    double *end_u, *end_f;       /* [r][n] u and L_q of the lanes that have ended */
    double *zeros;               /* [r][n] */
    double *unit; /* [2][n] by which squares of moves of positions and momenta count */
} dm_lanes_sweeps;

/* Newton's method, m = s n unknowns, beside dm_stage_newton. */
typedef struct {
    dm_kernel stage, slope;
    double *r, *dx;      /* [m] residual, last increment of every lane */
    double *J, *pivot;   /* [m][m], [m] factors of the matrix of every lane, and its rows */
    double *J2, *pivot2; /* the same of lanes that renew theirs apart from the others */
    double *other;       /* a curve and slopes of such lanes */
    double *made;        /* [1] the h that J is of, 0: of none; asked where L is quadratic */
} dm_lanes_newton;

/* Those of the model's last ensemble stay with the model. */
struct dm_stage_lanes {
    const dm_stage *g; /* of the stepper whose members these are, for what all have alike */
    dm_stage_lanes_step *step;
    dm_lanes members;
    /* [groups][1 + entries][lanes] the step h of every member, 0 before its first, and behind it
     * the coefficients times powers of h, as the stepper's own from group.one on */
    double *paces;
    size_t entries;
    dm_stage_group group; /* in hand */
    dm_stage_newton newton;
    dm_lanes_newton matrix;
    dm_lanes_sweeps sweeps;
    dm_one_point one_point;
};

/* One for every kind of processor; products of sweeps are fused into sums as a member alone has
 * it. */
dm_stage_lanes_step dm_stage_sweep_avx, dm_stage_sweep_fma, dm_stage_sweep_avx512,
    dm_stage_sweep_avx512_plain, dm_stage_newton_avx, dm_stage_newton_avx512, dm_one_point_avx,
    dm_one_point_avx512;

/* What the rows of methods.def call. */
int dm_stage_widen(dm_stepper *s, dm_lanes *x);
void dm_stage_advance_lanes(dm_stepper *s, dm_lanes *x, double t, const double *h, long count);

#endif
