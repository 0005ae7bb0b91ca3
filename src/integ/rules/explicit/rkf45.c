/* rkf45.c - Runge, Kutta and Fehlberg, from GSL. */
#include "integ/rules/explicit/gsl_step.h"

const dm_method dm_method_rkf45 = {
    .name = "rkf45",
    .aliases = "rk45, ode45, dopri5, dopri",
    .signature = "rkf45",
    .doc = "Runge-Kutta-Fehlberg 4(5) with a fixed step, order 5, 6 forces a step; not symplectic, "
           "a baseline (GSL).",
    .orders = "5",
    .stages = "6",
    .cost = "6 accelerations",
    .instances = "rkf45:6:6",
    .traits = DM_EXPLICIT | DM_FORCED,
    .engine = &dm_engine_gsl,
    .table = &gsl_odeiv2_step_rkf45,
};
