/* gsl_step.h - explicit Runge-Kutta baselines from GSL, with a fixed step. They are not
 * symplectic: their use is comparison. The first-order form is Hamilton's, generated from L:
 *   q' = v(q, p, t), the inverse Legendre transform,  p' = L_q(q, v, t),
 * so that no derivative of L_v by t is needed and the state of a run is taken as it is. */
#ifndef DM_GSL_STEP_H
#define DM_GSL_STEP_H

#include "integ/method/method.h"

#include <gsl/gsl_odeiv2.h>

/* A row's table is the address of GSL's pointer to a type of steps. */
extern const dm_engine dm_engine_gsl;

#endif
