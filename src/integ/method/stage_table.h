/* stage_table.h - a rule of stages as numbers: velocities V_j at nodes, L at the points c_i of a
 * quadrature, and the coefficients of stage/stage.h that follow from them. */
#ifndef DM_STAGE_TABLE_H
#define DM_STAGE_TABLE_H

#include "integ/method/method.h"
#include "integ/method/quadrature.h"
#include "numbers/weight.h"

/* A stage method as its papers give it, in long double. */
typedef struct dm_galerkin {
    int s;                                 /* velocities; 0: none, it is no rule of stages */
    long double node[DM_QUADRATURE_NODES]; /* where they are taken, in [0, 1] */
    dm_quadrature q;                       /* exact to degree s - 1 at least */
    int sweeps;                            /* of the fixed point, a step; 0: to round-off */
    /* 1: r = s, d = 1, beta = b, and a is given instead of the Lagrange polynomials of the nodes */
    int tableau;
    long double a[DM_QUADRATURE_NODES][DM_QUADRATURE_NODES]; /* last: see dm_stage_basis */
} dm_galerkin;

/* The coefficients of stage.h, row-major, in the memory they were laid into; the same for every
 * step. A single velocity is a constant: d = 1 for s = 1. */
typedef struct {
    uint32_t s, r;
    dm_weight *a, *d; /* [r*s] */
    dm_weight *b, *c; /* [r] */
    dm_weight *reach; /* [r] sums of the rows of a: c, but for some tableaus */
    dm_weight *beta;  /* [s] */
    dm_weight *node;  /* [s] */
    /* [r*r], [r]: Q_i = q0 + h reach_i v0 + h^2 sum_m A_im M^-1 L_q(m), and q1 = q0 + h v0 + h^2
     * sum_m mean_m M^-1 L_q(m), for L = T(v) - V(q) */
    dm_weight *A, *mean;
    dm_weight *rate; /* [r*r]: velocities at the points, v0 + h sum_m rate_im M^-1 L_q(m) */
} dm_stage_table;

/* Velocities at the points of q. */
void dm_galerkin_collocation(dm_galerkin *g, const dm_quadrature *q);

/* The basis of a rule, from the model where it was found before: zeros of a polynomial are dear
 * next to a few steps. */
void dm_stage_basis(dm_galerkin *out, const dm_rule *rule, const dm_model *m);

/* Doubles of a table, and the table laid into them. */
size_t dm_stage_table_size(size_t s, size_t r);
void dm_stage_table_fill(dm_stage_table *out, const dm_galerkin *g, double *memory);

/* The same, from the model where the last stepper left it one. */
void dm_stage_table_find(dm_stage_table *out, const dm_galerkin *g, const dm_model *m,
                         double *memory);

/* What tells a g without tableau from all others, for numbers to keep; returns how many there
 * are. */
enum { DM_STAGE_KEY = 2 + 6 * DM_QUADRATURE_NODES };
uint32_t dm_stage_key(double *key, const dm_galerkin *g);

#endif
