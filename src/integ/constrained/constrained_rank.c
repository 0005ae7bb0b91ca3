/* constrained_rank.c - which constraint cannot be held at a point of a step. */
#include "integ/constrained/constrained_inside.h"

/* Rolling conditions are held at the Gauss points, where G is not known, and, with the momentum,
 * at the end. */
uint32_t dm_constrained_dependent(dm_constrained *g, int ended) {
    const uint32_t last = ended || !g->l ? g->K : g->K - 1;
    const dm_constraints *c = g->constraints;
    uint32_t lost = 0;
    for (uint32_t k = 0; k <= last && !lost; k++)
        lost = dm_constraints_dependent(c, dm_constrained_holonomic(g, k),
                                        dm_constrained_rolling(g, k), g->scratch);
    for (uint32_t k = 0; k < g->K && !lost && !g->k; k++)
        lost = dm_constraints_dependent(c, NULL, g->roll + k * g->l * (1 + 3 * (size_t)g->n),
                                        g->scratch);
    return lost;
}
