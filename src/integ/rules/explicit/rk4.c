/* rk4.c - the classical Runge-Kutta method, from GSL. */
#include "integ/rules/explicit/gsl_step.h"

const dm_method dm_method_rk4 = {
    .name = "rk4",
    .signature = "rk4",
    .doc = "Classical Runge-Kutta of order 4, two half steps, 11 forces a step; not symplectic, a "
           "baseline (GSL).",
    .orders = "4",
    .stages = "4",
    .cost = "11 accelerations: GSL takes it whole and in two halves",
    .instances = "rk4:4:11",
    .traits = DM_EXPLICIT | DM_FORCED,
    .engine = &dm_engine_gsl,
    .table = &gsl_odeiv2_step_rk4,
};
