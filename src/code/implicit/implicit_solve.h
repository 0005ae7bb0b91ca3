/* implicit_solve.h - Newton's method for one implicit function, from starts that depend on x
 * alone. */
#ifndef DM_IMPLICIT_SOLVE_H
#define DM_IMPLICIT_SOLVE_H

#include "algebra/implicit.h"
#include "code/kernel.h"

typedef struct {
    uint32_t r, n, starts;
    int has_branch, most;    /* iterations */
    uint64_t angles;         /* bit i: unknown i is an angle, kept within a turn of 0 */
    dm_kernel equation;      /* (y[r], x[n], ...) to F[r], F_y[r*r], branch */
    dm_kernel slope;         /* to F_x[r*n] */
    dm_kernel start;         /* the same inputs to [starts*r]; no eval: constants */
    double *in, *out;        /* of `equation` */
    double *stride;          /* [r] of the scattered starts */
    double *by_x;            /* of `slope` */
    double *from;            /* [starts*r] */
    double *inverse, *other; /* [r*r] (dF/dy)^-1 at y, at the trial point */
    double *dy, *next, *trial, *best, *scratch; /* [r] */
    uint32_t *pivot;
    dm_root_trouble *trouble; /* NULL: nobody asks */
} dm_root_solver;

/* Kernels by `compile` in `arena`, that of F_x by `slopes`; troubles are noted in those of f where
 * `noted`. */
dm_status dm_root_solver_build(dm_root_solver *out, const dm_implicit *f, dm_compile *compile,
                               dm_compile *slopes, dm_arena *arena, int noted);

/* y[r] = the root at x[n], to round-off; inverse[r*r] = (dF/dy)^-1 there (may be NULL). NaN and
 * the reason where there is none: Newton's method, damped so that it follows its flow, from
 * every start of the function, then from points scattered around the first one; the first root
 * on the branch is taken. */
dm_root_outcome dm_root_solve(dm_root_solver *s, const double *x, double *y, double *inverse);

/* The same from y itself, which is near; where that does not lead to a root soon, as above. */
dm_root_outcome dm_root_solve_near(dm_root_solver *s, const double *x, double *y, double *inverse);

/* dy/dx[r*n] = -J^-1 F_x at the root that was found last. */
void dm_root_slope(const dm_root_solver *s, double *slope, const double *inverse);

#endif
