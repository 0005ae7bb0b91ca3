/* yoshida.c - Yoshida's compositions of order 4 and 6. */
#include "integ/rules/compositions/composition.h"

static const dm_scheme schemes[] = {
    /* Yoshida 1990, HLW (II.4.4) */
    {4, 3, DM_GAMMA, {1.35120719195965763405}},
    /* Yoshida 1990, solution A, HLW (V.3.11) */
    {6, 7, DM_GAMMA, {0.78451361047755726382, 0.23557321335935813368, -1.17767998417887100695}},
    {0}};

const dm_method dm_method_yoshida = {
    .name = "yoshida",
    .aliases = "ruth, forest-ruth",
    .signature = "yoshida(4|6 [, base])",
    .doc = "Yoshida's compositions of order 4 (3 stages) and 6 (7 stages). Explicit when L "
           "separates, else steps of the base rule (verlet). Yoshida 1990; HLW (II.4.4), (V.3.11).",
    .orders = "4, 6",
    .stages = "3, 7",
    .cost = "3, 7 forces; else steps of the base",
    .instances = "yoshida(4):3:3; yoshida(6):7:7; yoshida(4, midpoint):3:0",
    DM_COMPOSED(schemes),
};
