/* blanes_moan.c - Blanes and Moan's Runge-Kutta-Nystroem splittings of order 4 and 6. */
#include "integ/rules/compositions/composition.h"

static const dm_scheme schemes[] = {
    /* Blanes & Moan 2002, SRKN 6b of order 4 */
    {4,
     6,
     DM_KICK_FIRST,
     {0.0829844064174052, 0.245298957184271, 0.396309801498368, 0.604872665711080,
      -0.0390563049223486}},
    /* Blanes & Moan 2002, SRKN 11b of order 6 */
    {6,
     11,
     DM_KICK_FIRST,
     {0.0414649985182624, 0.123229775946271, 0.198128671918067, 0.290553797799558,
      -0.0400061921041533, -0.127049212625417, 0.0752539843015807, -0.246331761062075,
      -0.0115113874206879, 0.357208872795928}},
    /* Blanes & Moan 2002, SRKN 14a of order 6 */
    {6,
     14,
     DM_DRIFT_FIRST,
     {0.0378593198406116, 0.09171915262446165, 0.102635633102435, 0.183983170005006,
      -0.0258678882665587, -0.05653436583288827, 0.314241403071447, 0.004914688774712854,
      -0.130144459517415, 0.143761127168358, 0.106417700369543, 0.328567693746804,
      -0.00879424312851058}},
    {0}};

const dm_method dm_method_blanes_moan = {
    .name = "blanes-moan",
    .signature = "blanes-moan(4|6 [, 6|11|14])",
    .doc = "Blanes and Moan's Runge-Kutta-Nystroem splittings of order 4 (6 stages) and 6 (11 or "
           "14 stages) for separable L with constant mass. Blanes & Moan 2002.",
    .orders = "4, 6",
    .stages = "6, 11, 14",
    .cost = "6, 11, 14 forces",
    .instances = "blanes-moan(4):6:6; blanes-moan(6):11:11; blanes-moan(6, 14):14:14",
    .traits = DM_SYMMETRIC | DM_SYMPLECTIC,
    .engine = &dm_engine_splitting,
    .table = schemes,
    .check = dm_composition_check,
    .order = dm_composition_order,
    .splitting = dm_composition_splitting,
};
