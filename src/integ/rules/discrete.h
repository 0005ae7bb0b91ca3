/* discrete.h - the discrete Lagrangian of a stage method between two given points, beside its
 * steps: Ld(q0, q1) = ext h sum_i b_i L(Q_i, Qdot_i)  over the V_j with  h sum_j beta_j V_j = q1
 * - q0, with Q_i, Qdot_i of stage.h. The multiplier of that condition is the momentum p0, so
 * that the stage equations are met by (V, p0), -D1 Ld = p0, D2 Ld = p0 + h sum_i b_i L_q(i), and
 * -D1D2 Ld = dp0/dq1 by the same matrix (Leok 2.4; with P_i = L_v(i) the discrete
 * Hamilton-Pontryagin principle, Leok 5.2, Cuell-Patrick 2009). A force f is added to L_q wherever
 * that stands (discrete Lagrange-d'Alembert, Leok 2.8.2): the curve is that of the forced step, Ld
 * the action along it, and p0 = -D1 Ld - F1, p1 = D2 Ld + F2, F1 and F2 by the same quadrature. */
#ifndef DM_DISCRETE_H
#define DM_DISCRETE_H

#include "integ/method/stage_table.h"

/* Where and for what. */
typedef struct {
    const dm_model *model; /* with DM_WANT_STAGE, DM_WANT_VALUE and, forced, DM_WANT_FORCE_CURVE */
    const dm_galerkin *basis;
    const double *q0, *q1;
    double h, t; /* step, time of q0 */
    /* equal parts of the step, with the basis, a collocation, in each: the curve is smooth in them
     * and continuous. 0 is 1 */
    uint32_t pieces;
} dm_discrete_problem;

/* What is found; the arrays are in the workspace. */
typedef struct {
    double value;            /* Ld */
    const double *p0, *p1;   /* [n]: -D1 Ld - F1, D2 Ld + F2 */
    const double *two_form;  /* [n*n]: dp0/dq1, row q0, column q1; without a force -D1D2 Ld */
    double mass;             /* largest |L_vv| at the last point */
    uint32_t points;         /* r, times the pieces */
    const double *q, *v, *p; /* [r][n]: Q_i, Qdot_i, L_v there */
    double residual;         /* of the equations, max norm */
    int iterations;
} dm_discrete;

/* Doubles of workspace. */
size_t dm_discrete_work(const dm_galerkin *g, uint32_t n, uint32_t pieces);

/* Newton to round-off from the straight line. DM_SINGULAR, DM_NO_CONVERGENCE, DM_NOT_FINITE:
 * nothing is found. */
dm_status dm_discrete_solve(dm_discrete *out, const dm_discrete_problem *problem, double *work);

#endif
