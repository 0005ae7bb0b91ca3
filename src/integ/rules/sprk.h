/* sprk.h - symplectic partitioned Runge-Kutta methods of any pair of tableaus (a, b), (A, B):
 * Q_i = q0 + h sum_j a_ij V_j,  P_i = p0 + h sum_j A_ij F_j,  P_i = L_v(Q_i, V_i),  F_i =
 * L_q(Q_i, V_i), q1 = q0 + h sum_j b_j V_j,    p1 = p0 + h sum_j B_j F_j, symplectic when b_i
 * A_ij + B_j a_ji = b_i B_j and b = B (HLW VI.4.6, Leok 2.4). With b = B and no zero weight this
 * is a stage method with the points for velocities; where a and A are triangles it is a table of
 * kicks and drifts, which for L = T(v) - V(q) is symplectic with any b and B. */
#ifndef DM_SPRK_H
#define DM_SPRK_H

#include "integ/method/stage_table.h"
#include "integ/split/splitting.h"

enum { DM_SPRK_STAGES = DM_QUADRATURE_NODES };

typedef struct {
    int s;
    long double a[DM_SPRK_STAGES][DM_SPRK_STAGES], b[DM_SPRK_STAGES];
    long double A[DM_SPRK_STAGES][DM_SPRK_STAGES], B[DM_SPRK_STAGES];
    long double c[DM_SPRK_STAGES]; /* times of the stages */
} dm_tableau;

/* The A that makes (a, b) symplectic with B = b: A_ij = b_j (1 - a_ji / b_i); no b_i is zero. */
void dm_tableau_partner(dm_tableau *t);

/* Largest |b_i A_ij + B_j a_ji - b_i B_j|, with sign; *i and *j: where. */
long double dm_tableau_defect(const dm_tableau *t, int *i, int *j);

/* What the row `sprk` of methods.def steps. */
typedef struct {
    int staged; /* b = B, no zero weights: steps any L */
    int stages;
    dm_galerkin g;
    int split; /* triangles: explicit where L = T(v) - V(q) */
    dm_splitting table;
    int order; /* measured; of the explicit form for separable L when it is not staged */
} dm_sprk;

/* 0 when it is neither staged nor split. */
int dm_sprk_of(dm_sprk *out, const dm_tableau *t);

/* Order of a symplectic pair, measured in long double (sprk_order.c); separable: for L = T(v) -
 * V(q) alone. */
int dm_tableau_order(const dm_tableau *t, int separable);

#endif
