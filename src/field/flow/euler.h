/* euler.h - flow of an ideal fluid on a surface by its vorticity, a number w at every vertex:
 *   w' = -*(d psi ^ d w),   div grad psi = w.
 * The product of every triangle, the area form of the natural wedge, goes to its corners in
 * thirds, and *v weighs the vertices. psi is a constant on every loop of the boundary: 0, and on
 * holes what keeps the circulation round them. Flows round handles have no psi. With them
 *   w' = -*(beta ^ d w),   beta = d psi + sum b_k eta_k,   b_k' = integral of w eta_k ^ beta,
 * eta_k closed, orthonormal and across all d psi: the part of *beta' = w beta - dp along eta_k. So
 * energy |beta|^2 / 2, enstrophy |w|^2 / 2 and circulation, the sum of *v w, have zero rates; all
 * three are quadratic at most, so the implicit midpoint rule keeps them to round-off (Arakawa 1966;
 * Hairer, Lubich, Wanner IV.2).
 *
 * Between calls w + low is the state, the vorticity and then b; psi, rate and the rest are work. */
#ifndef DM_EULER_H
#define DM_EULER_H

#include "base/arena.h"
#include "base/status.h"

#include <stdint.h>

/* x[n] = A^-1 b[n] by somebody's factors */
typedef struct {
    dm_status (*solve)(void *of, double *x, const double *b);
    void *of;
} dm_linear_solve;

/* Holes: psi = (0 on all loops) + sum c_i g_i, g_i harmonic, 1 on hole i and 0 on other loops, with
 * circulation_i = sum_j (g_i . S g_j) c_j + sum over vertices of g_i *v w, S = -div grad. */
typedef struct {
    uint32_t count;
    const double *g;           /* [count][vertices] */
    const double *inverse;     /* [count][count] of g_i . S g_j */
    const double *circulation; /* [count] */
    double *c, *gap;           /* [count] of the last psi; circulation without that of w */
} dm_euler_holes;

/* Handles: of every eta_k and triangle with corners (a, b, c) the values on (a, b) and (a, c). */
typedef struct {
    uint32_t count;
    const double *eta; /* [count][triangles][2] */
} dm_euler_handles;

enum { DM_EULER_SWEEPS = 500 };

typedef struct {
    uint32_t vertices, triangles;
    const uint32_t *corner; /* [triangles][3] */
    const int8_t *sign;     /* [triangles]: of the orientation against the order of the corners */
    const double *mass;     /* [vertices] |*v| */
    /* [vertices]: the component without a held vertex, from 1; 0: psi is held in this one */
    const uint32_t *component;
    uint32_t components;
    const uint32_t *free; /* [unknowns]: vertices whose psi is solved for; 0 at the others */
    uint32_t unknowns;
    dm_euler_holes holes;
    dm_euler_handles handles;
    dm_linear_solve poisson; /* of -div grad with the free vertices alone, n = unknowns */
    uint32_t size;           /* of a state: vertices + handles */
    double *w, *low;         /* [size] */
    double *psi, *rate;      /* [vertices], [size] of the last dm_euler_rate */
    double *weight;          /* [size] of norms of states: |*v|, and 1 / area for b, by its unit */
    double *mean, *area;     /* [components + 1] */
    double change;           /* |y - x| of the last sweep of a step */
    double *work;
} dm_euler;

/* Arrays for w, c and work; what stands above w is set. DM_NO_MEMORY. */
dm_status dm_euler_open(dm_euler *e, dm_arena *arena);

/* psi and rate at x[size]. */
dm_status dm_euler_rate(dm_euler *e, const double *x);

/* One step of the implicit midpoint rule, by fixed-point iteration with Anderson's acceleration
 * (1965) to round-off. *sweeps: how many rates it took. DM_NO_CONVERGENCE: h is too long for it. */
dm_status dm_euler_step(dm_euler *e, double h, uint32_t *sweeps);

/* energy, enstrophy, circulation of w. */
dm_status dm_euler_integrals(dm_euler *e, double out[3]);

#endif
