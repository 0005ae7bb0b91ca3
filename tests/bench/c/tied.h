/* tied.h - the implicit midpoint step with multipliers as one would write it in C for any
 * Lagrangian and any holonomic constraints with hand-written derivatives: unknowns v = (q1 -
 * q0)/h and impulses I, p0 = L_v - h/2 L_q - G(q0)^T I at ((q0 + q1)/2, v),  g(q1) = 0, then p1
 * = p0 + h L_q + G(q0)^T I, put onto G(q1) v1 = 0; Newton with the exact matrix, to round-off. */
#ifndef BENCH_TIED_H
#define BENCH_TIED_H

#include "newton.h"

enum { TIED_M = 2 };

typedef struct {
    double g[TIED_M], G[TIED_M * NEWTON_N];
} constraints;

typedef struct {
    implicit_model model;
    int ties;
    void (*constrain)(constraints *out, const double *q);
} tied_model;

extern const tied_model tied_sphere, tied_double;

/* as newton_run */
int tied_run(double *q, double *p, const tied_model *m, long steps, long *iterations);

#endif
