/* kahan_li.c - Kahan and Li's compositions of order 6 and 8. */
#include "integ/rules/compositions/composition.h"

static const dm_scheme schemes[] = {
    /* Kahan & Li 1997, HLW (V.3.11) */
    {6,
     9,
     DM_GAMMA,
     {0.39216144400731413928, 0.33259913678935943860, -0.70624617255763935981,
      0.08221359629355080023}},
    /* Kahan & Li 1997, HLW (V.3.13) */
    {8,
     17,
     DM_GAMMA,
     {0.13020248308889008088, 0.56116298177510838456, -0.38947496264484728641,
      0.15884190655515560090, -0.39590389413323757734, 0.18453964097831570709,
      0.25837438768632204729, 0.29501172360931029887}},
    {0}};

const dm_method dm_method_kahan_li = {
    .name = "kahan-li",
    .signature = "kahan-li(6|8 [, base])",
    .doc = "Kahan and Li's compositions of order 6 (9 stages) and 8 (17 stages). HLW (V.3.11), "
           "(V.3.13).",
    .orders = "6, 8",
    .stages = "9, 17",
    .cost = "9, 17 forces; else steps of the base",
    .instances = "kahan-li(6):9:9; kahan-li(8):17:17; kahan-li(6, midpoint):9:0",
    DM_COMPOSED(schemes),
};
