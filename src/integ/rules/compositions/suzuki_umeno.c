/* suzuki_umeno.c - Suzuki and Umeno's composition of order 8. */
#include "integ/rules/compositions/composition.h"

static const dm_scheme schemes[] = {
    /* Suzuki & Umeno 1993, HLW (V.3.12) */
    {8,
     15,
     DM_GAMMA,
     {0.74167036435061295345, -0.40910082580003159400, 0.19075471029623837995,
      -0.57386247111608226666, 0.29906418130365592384, 0.33462491824529818378,
      0.31529309239676659663}},
    {0}};

const dm_method dm_method_suzuki_umeno = {
    .name = "suzuki-umeno",
    .signature = "suzuki-umeno(8 [, base])",
    .doc = "Suzuki and Umeno's composition of order 8, 15 stages. HLW (V.3.12).",
    .orders = "8",
    .stages = "15",
    .cost = "15 forces; else steps of the base",
    .instances = "suzuki-umeno(8):15:15",
    DM_COMPOSED(schemes),
};
