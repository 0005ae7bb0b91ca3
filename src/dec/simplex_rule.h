/* simplex_rule.h - integrals over simplices of any dimension (Grundmann & Moeller 1978), for the de
 * Rham map: exact for polynomials of odd degree 2 s + 1, by nodes that no order of vertices moves.
 * Weights of both signs: their moduli add up to some 3^s at most, so high degrees lose digits. */
#ifndef DM_SIMPLEX_RULE_H
#define DM_SIMPLEX_RULE_H

#include <stdint.h>

/* Number of nodes of the rule in k dimensions that is exact for degree `order`. */
uint32_t dm_simplex_nodes(uint32_t k, uint32_t order);

/* node[count][k + 1]: barycentric coordinates; weight[count], of sum 1. */
void dm_simplex_rule(double *node, double *weight, uint32_t k, uint32_t order);

#endif
