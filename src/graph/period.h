/* period.h - inputs that a graph sees through sines and cosines alone. */
#ifndef DM_PERIOD_H
#define DM_PERIOD_H

#include "graph/graph.h"

/* Have the nodes n with roots[n] != 0 the period 2 pi in an input? So where it enters them by sin,
 * cos and tan of whole multiples of it, with other inputs beside it; 0 also where they do not
 * depend on it. roots[dm_graph_size], scratch[dm_graph_size]. */
int dm_has_period(const dm_graph *g, const unsigned char *roots, uint32_t input,
                  unsigned char *scratch);

#endif
