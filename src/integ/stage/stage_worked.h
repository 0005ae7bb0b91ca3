/* stage_worked.h - rules of stages on fields with forces f(q, v, t) beside L
 * (chain/virtual_work.h): accelerations u_m at all points of the quadrature are solved for,
 *   M u_m = L_q(Q_m, t_m) + f(Q_m, V_m, t_m),
 *   Q_m = q0 + h c_m v0 + h^2 sum A_mi u_i,   V_m = v0 + h sum R_mi u_i,
 * which is the discrete Lagrange-d'Alembert principle of the rule (Marsden & West 2001, 3.2). */
#ifndef DM_STAGE_WORKED_H
#define DM_STAGE_WORKED_H

#include "integ/method/stepper.h"

extern const dm_engine dm_engine_stage_worked;

#endif
