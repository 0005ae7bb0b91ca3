/* mclachlan.c - McLachlan's composition of order 4. */
#include "integ/rules/compositions/composition.h"

static const dm_scheme schemes[] = {
    /* McLachlan 1995, five stages */
    {4, 5, DM_GAMMA, {0.28, 0.62546642846767004501}},
    {0}};

const dm_method dm_method_mclachlan = {
    .name = "mclachlan",
    .signature = "mclachlan(4 [, base])",
    .doc =
        "McLachlan's composition of order 4, 5 stages with small error constant. McLachlan 1995.",
    .orders = "4",
    .stages = "5",
    .cost = "5 forces; else steps of the base",
    .instances = "mclachlan(4):5:5",
    DM_COMPOSED(schemes),
};
