/* newton.h - solve r(x) = 0 to round-off from a start near the root.
 * One Jacobian is kept while the increments shrink by ten or more an iteration, then it is
 * taken anew; when that does not help the iteration is damped by a line search on |r|. */
#ifndef DM_NEWTON_H
#define DM_NEWTON_H

#include "base/status.h"
#include "linalg/band.h"

#include <stddef.h>
#include <stdint.h>

typedef struct {
    uint32_t m; /* unknowns */
    /* r[m] at x; when J is not NULL also J[m*m] = dr/dx, row-major. A NaN in r is "outside the
     * domain": the search steps back from there. Other failures end the solve. */
    dm_status (*equation)(void *ctx, double *r, double *J, const double *x);
    void *ctx;
    const double *size;  /* size of the terms of r at the last x, to tell round-off; may be NULL */
    const dm_band *band; /* J is such a band, and made so by `equation`; NULL: dense */
    int near_identity;   /* dr/dx is nearly 1: begin with J = 1 while that shrinks fast */
    /* [period], repeated: where r surely has a value; a start where it has none is drawn there.
     * NULL: no such place is known */
    const double *inside;
    uint32_t period;
    double tolerance; /* of the last increment, relative to max |x| */
    int max_iterations;
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

#endif
