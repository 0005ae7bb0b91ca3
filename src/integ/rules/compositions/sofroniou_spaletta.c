/* sofroniou_spaletta.c - Sofroniou and Spaletta's composition of order 10. */
#include "integ/rules/compositions/composition.h"

static const dm_scheme schemes[] = {
    /* Sofroniou & Spaletta 2005, HLW (V.3.14) */
    {10,
     35,
     DM_GAMMA,
     {0.07879572252168641926, 0.31309610341510852776, 0.02791838323507806611,
      -0.22959284159390709415, 0.13096206107716486317, -0.26973340565451071434,
      0.07497334315589143567, 0.11199342399981020489, 0.36613344954622675119,
      -0.39910563013603589788, 0.10308739852747107732, 0.41143087395589023782,
      -0.00486636058313526176, -0.39203335370863990644, 0.05194250296244964704,
      0.05066509075992449634, 0.04967437063972987905}},
    {0}};

const dm_method dm_method_sofroniou_spaletta = {
    .name = "sofroniou-spaletta",
    .signature = "sofroniou-spaletta(10 [, base])",
    .doc = "Sofroniou and Spaletta's composition of order 10, 35 stages. HLW (V.3.14).",
    .orders = "10",
    .stages = "35",
    .cost = "35 forces; else steps of the base",
    .instances = "sofroniou-spaletta(10):35:35",
    DM_COMPOSED(schemes),
};
