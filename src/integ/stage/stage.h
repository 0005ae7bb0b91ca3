/* stage.h - one solver for every method whose step is a polynomial velocity and a quadrature.
 * s velocities V_j at nodes gamma_j, L at r points c_i with weights b_i (Galerkin variational
 * integrators, Marsden-West 2001 sec. 2.2.6, Leok 2.4):
 *   Q_i = q0 + h sum_j a_ij V_j,  Qdot_i = sum_j d_ij V_j,  q1 = q0 + h sum_j beta_j V_j,
 *   sum_i b_i [h (a_ij - beta_j) L_q(i) + d_ij L_v(i)] = beta_j p0,  p1 = p0 + h sum_i b_i L_q(i)
 * with d_ij = l_j(c_i), a_ij = int_0^c_i l_j, beta_j = int_0^1 l_j. When the nodes are the points
 * this is the symplectic partitioned Runge-Kutta method with weights b (HLW VI.6.4). */
#ifndef DM_STAGE_H
#define DM_STAGE_H

#include "integ/method/method.h"
#include "integ/method/quadrature.h"
#include "numbers/weight.h"

typedef struct dm_galerkin {
    int s;                                 /* velocities */
    long double node[DM_QUADRATURE_NODES]; /* where they are taken, in [0, 1] */
    dm_quadrature q;                       /* exact to degree s - 1 at least */
    int sweeps;                            /* of the fixed point, a step; 0: to round-off */
    /* 1: r = s, d = 1, beta = b, and a is given instead of the Lagrange polynomials of the nodes */
    int tableau;
    long double a[DM_QUADRATURE_NODES][DM_QUADRATURE_NODES];
} dm_galerkin;

/* Coefficients, row-major; they live in the workspace. */
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
} dm_stage_table;

/* Velocities at the points of q. */
void dm_galerkin_collocation(dm_galerkin *g, const dm_quadrature *q);

/* Curves of degree s with any quadrature of s nodes or more (galerkin.c). */
void dm_galerkin_of(dm_galerkin *g, int s, const dm_quadrature *q);

/* The kinetic energy of the velocities is regular under the quadrature. */
int dm_galerkin_is_regular(const dm_galerkin *g);

/* Doubles of a table, and the table laid into them. */
size_t dm_stage_table_size(size_t s, size_t r);
void dm_stage_table_fill(dm_stage_table *out, const dm_galerkin *g, double *memory);

/* The same, from the model where the last stepper left it one. */
void dm_stage_table_find(dm_stage_table *out, const dm_galerkin *g, const dm_model *m,
                         double *memory);

/* What tells a g without tableau from all others, for numbers to keep; returns how many there
 * are. */
enum { DM_STAGE_KEY = 2 + 3 * DM_QUADRATURE_NODES };
uint32_t dm_stage_key(double *key, const dm_galerkin *g);

/* What the rows of methods.def call. */
unsigned dm_stage_wants(const dm_rule *rule, const dm_model *m);
size_t dm_stage_work(size_t s, size_t r, const dm_model *m);
dm_status dm_stage_open(dm_stepper *stepper, const dm_galerkin *g);
dm_status dm_stage_start(dm_stepper *stepper, double *state, double t, double h);
dm_status dm_stage_step(dm_stepper *stepper, double *state, double t, double h);
size_t dm_stage_memory(dm_stepper *stepper, double **place);

#endif
