/* newton.h - solve r(x) = 0 to round-off from a start near the root.
 * One Jacobian is kept while the increments shrink by ten or more an iteration, then it is
 * taken anew; when that does not help the iteration is damped by a line search on |r|. */
#ifndef DM_NEWTON_H
#define DM_NEWTON_H

#include "base/status.h"
#include "base/written_out.h"
#include "linalg/band.h"

#include <math.h>
#include <stddef.h>
#include <stdint.h>

/* A matrix that is the same at every x, whose factors stay from solve to solve: J as the problem
 * has it, pivots [m]. `made`: they are there; `equation` is asked for J as ever, and leaves it. */
typedef struct dm_newton_constant {
    double *J;
    uint32_t *pivot;
    int made;
} dm_newton_constant;

/* At most 128 bytes: callers fill one in for every step, and compilers zero larger ones slowly. */
typedef struct {
    uint32_t m; /* unknowns */
    int max_iterations;
    /* r[m] at x; when J is not NULL also J[m*m] = dr/dx, row-major. A NaN in r is "outside the
     * domain": the search steps back from there. Other failures end the solve. */
    dm_status (*equation)(void *ctx, double *r, double *J, const double *x);
    void *ctx;
    const double *size;  /* size of the terms of r at the last x, to tell round-off; may be NULL */
    const dm_band *band; /* J is such a band, and made so by `equation`; NULL: dense */
    dm_newton_constant *constant; /* NULL: J is not known to be constant */
    /* [period], repeated: where r surely has a value; a start where it has none is drawn there.
     * NULL: no such place is known */
    const double *inside;
    uint32_t period;
    int near_identity; /* dr/dx is nearly 1: begin with J = 1 while that shrinks fast */
    double tolerance;  /* of the last increment, relative to the size of unknowns */
    /* Unknowns much smaller than the largest are judged each by its own size: |x_i|, and as that
     * may pass through 0, at least DM_NEWTON_BESIDE |place[i % places]| / |over|: x_i over is a
     * displacement of place. NULL: |x_i| alone. The last ones, `shared` of them, are judged by the
     * largest unknown always: multipliers, say. */
    uint32_t places, shared;
    const double *place;
    double over;
    /* J is exact: where increments of a new one, or small ones, do not shrink any more they are
     * noise: no other matrix is taken, and the smaller unknowns are not waited for. Not for what
     * lanes solve, too. */
    int exact;
} dm_newton_problem;

typedef struct {
    int iterations;
    int jacobians;   /* taken: 0 when J = 1 was enough */
    int outside;     /* increments that were shortened as r has no value where they lead */
    double residual; /* max |r| where it was last evaluated */
} dm_newton_report;

/* Doubles of workspace for m unknowns. */
size_t dm_newton_work(uint32_t m);

/* x[m] holds the start and then the root; work[0 .. m) is then the last increment: the
 * equation was last evaluated at x - work, so what depends on x to first order needs no
 * evaluation more. DM_NO_CONVERGENCE, DM_SINGULAR, DM_NOT_FINITE: x is not usable. */
dm_status dm_newton(double *x, const dm_newton_problem *problem, double *work,
                    dm_newton_report *report);

/* Factors of a matrix that is nearly dr/dx, of an earlier solve: the problem's band, or dense. */
typedef struct {
    const double *J;
    const uint32_t *pivot;
} dm_newton_factors;

/* The same with these factors alone, while increments shrink by ten or more: DM_NO_CONVERGENCE
 * where they do not. work: 4m doubles of it are used. */
dm_status dm_newton_kept(double *x, const dm_newton_problem *problem,
                         const dm_newton_factors *factors, double *work, dm_newton_report *report);

/* Is some x_i + dx_i much smaller than `size`, the largest of m, and not zero? Then an iteration of
 * another's making that has settled by the largest goes on until the small ones have, too. */
DM_WRITTEN_OUT int dm_newton_has_small(const double *x, const double *dx, uint32_t m, double size) {
    int some = 0;
    for (uint32_t i = 0; i < m; i++) {
        const double own = fabs(x[i]) + fabs(dx[i]);
        some |= (own * 0x1p10 < size) & (own > 0.0);
    }
    return some;
}

/* All zero at the start of the iteration. */
typedef struct {
    double step; /* the last increment, relative to the own sizes */
    int waited;  /* iterations */
} dm_newton_wait;

/* Have they at x + dx, each by its own size, or is it no use to wait? */
int dm_newton_small_settled(dm_newton_wait *wait, const dm_newton_problem *problem, const double *x,
                            const double *dx);

#endif
