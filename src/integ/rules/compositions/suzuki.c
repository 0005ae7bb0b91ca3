/* suzuki.c - Suzuki's composition of order 4. */
#include "integ/rules/compositions/composition.h"

static const dm_scheme schemes[] = {
    /* Suzuki 1990, HLW (II.4.5) */
    {4, 5, DM_GAMMA, {0.41449077179437573714, 0.41449077179437573714}},
    {0}};

const dm_method dm_method_suzuki = {
    .name = "suzuki",
    .signature = "suzuki(4 [, base])",
    .doc = "Suzuki's composition of order 4, 5 stages. Suzuki 1990; HLW (II.4.5).",
    .orders = "4",
    .stages = "5",
    .cost = "5 forces; else steps of the base",
    .instances = "suzuki(4):5:5",
    DM_COMPOSED(schemes),
};
