/* even.h - a graph whose roundings have no mean, for what is kept over many steps. */
#ifndef DM_EVEN_H
#define DM_EVEN_H

#include "graph/graph.h"

/* out[m] = roots of g in a graph of its own, in the same arena and verbatim, where c x is top x +
 * rest x for a number c of more than 24 bits (numbers/weight.h), and sums add the rests by
 * themselves, last. The rounding of c x, and of a sum with it where x is a difference of positions,
 * has a mean where c is near a ratio of small numbers, as h = 0.05 is. And x^(-3/2) is the cube of
 * x^(-1/2): kernels of the same function then err by the same mean. NULL without memory. */
dm_graph *dm_even_graph(dm_graph *g, const dm_node *roots, uint32_t m, dm_node *out);

#endif
