/* anderson.h - fixed points x = g(x) by Anderson's acceleration (1965): the next x is the mean of
 * the last values g(x_j) whose residuals g(x_j) - x_j, with the same weights, are least. On a
 * linear g that is GMRES (Walker, Ni 2011), so it also goes on where plain iteration diverges. */
#ifndef DM_ANDERSON_H
#define DM_ANDERSON_H

#include <stddef.h>
#include <stdint.h>

enum { DM_ANDERSON_MEMORY = 10 };

typedef struct {
    uint32_t n;
    const double *weight; /* [n] of the norm of residuals */
    uint32_t kept, next;  /* how many pairs, and the place of the next one */
    int begun;
    double *x, *y;   /* [n] the point and g there */
    double *f, *g;   /* [n] residual and value of the last point */
    double *df, *dg; /* [DM_ANDERSON_MEMORY][n] differences of residuals and values */
} dm_anderson;

/* Doubles of workspace for n unknowns. */
size_t dm_anderson_work(uint32_t n);

/* Begin at 0: *x[n] is the point, and the caller writes g(x) to *y[n] before each _next. */
void dm_anderson_begin(dm_anderson *a, double *work, uint32_t n, const double *weight, double **x,
                       double **y);
void dm_anderson_next(dm_anderson *a);

#endif
