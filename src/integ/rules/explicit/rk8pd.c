/* rk8pd.c - Prince and Dormand, from GSL. */
#include "integ/rules/explicit/gsl_step.h"

const dm_method dm_method_rk8pd = {
    .name = "rk8pd",
    .signature = "rk8pd",
    .doc = "Runge-Kutta Prince-Dormand 8(9) with a fixed step, order 8, 13 forces a step; not "
           "symplectic, a strong baseline (GSL).",
    .orders = "8",
    .stages = "13",
    .cost = "13 accelerations",
    .instances = "rk8pd:13:13",
    .traits = DM_EXPLICIT | DM_FORCED,
    .engine = &dm_engine_gsl,
    .table = &gsl_odeiv2_step_rk8pd,
};
