/* sequence.h - sequences known by an equation: x with R(y, x) = 0, then y' = next(y, x), again
 * and again. Discrete Euler-Lagrange equations of any order are such: y is the window of points
 * that are known, x the next one. */
#ifndef DM_SEQUENCE_H
#define DM_SEQUENCE_H

#include "code/kernel.h"
#include "linalg/solve/newton.h"

#include <signal.h>

typedef struct {
    uint32_t n, m;      /* numbers of y and of x; inputs of the kernels are y[n], then x[m] */
    dm_kernel equation; /* -> R[m] */
    dm_kernel tangent;  /* -> R[m], dR/dx[m*m] */
    dm_kernel next;     /* -> y'[n] */
    dm_kernel start;    /* y alone -> x[m], where Newton's method begins */
    dm_kernel scale;    /* y alone -> sizes[m] of what x is added to; outputs = 0: none */
    dm_kernel inside;   /* -> numbers that are > 0 at an allowed root; outputs = 0: all are */
} dm_sequence;

typedef struct {
    long steps, every; /* a row of y every so many steps, and the last */
    double tolerance;  /* of the last increment, relative to max |x| */
    int max_iterations;
    const volatile sig_atomic_t *stop; /* may be NULL */
} dm_sequence_plan;

typedef struct {
    long done, rows;         /* valid also after a failure */
    uint32_t outside;        /* the number of the condition that the root breaks, from 1; 0: none */
    dm_newton_report newton; /* of the last step */
} dm_sequence_report;

long dm_sequence_rows(const dm_sequence_plan *plan);

/* Doubles of workspace. */
size_t dm_sequence_work(const dm_sequence *r);

/* rows[0 .. n) holds the start; dm_sequence_rows() rows of n numbers are filled. A step that
 * fails leaves the rows before it and, as the last one, the last good state. */
dm_status dm_sequence_run(double *rows, const dm_sequence *r, const dm_sequence_plan *plan,
                          double *work, dm_sequence_report *report);

#endif
