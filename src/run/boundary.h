/* boundary.h - stationary points of a sum over windows of neighbours, sum_s f(x_s, ...,
 * x_s+N-1), some numbers being given: Newton's method on the whole sequence, its matrix being a
 * band. */
#ifndef DM_BOUNDARY_H
#define DM_BOUNDARY_H

#include "code/kernel.h"
#include "linalg/band.h"

#include <signal.h>

typedef struct {
    uint32_t sites, block, window; /* numbers of sites, of a site, sites of a window (<= sites) */
    dm_kernel slope;               /* x[window * block] -> df/dx */
    dm_kernel hessian;             /* -> df/dx, d2f/dx2 by rows */
    const uint8_t *given;          /* [sites * block] 1: stays as it is */
    double tolerance;              /* of the last increment, relative to max |x| */
    int max_iterations;
    const volatile sig_atomic_t *stop; /* may be NULL */
} dm_boundary;

typedef struct {
    int iterations;
    double residual; /* largest |d sum / dx| of what is not given */
} dm_boundary_report;

/* Doubles of workspace. */
size_t dm_boundary_work(const dm_boundary *p);

/* x[sites * block]: a first guess, then the solution; not usable after a failure. */
dm_status dm_boundary_solve(double *x, const dm_boundary *p, double *work,
                            dm_boundary_report *report);

#endif
