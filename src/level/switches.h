/* switches.h - the inside of a level set, for the files of this room only. */
#ifndef DM_SWITCHES_H
#define DM_SWITCHES_H

#include "level/level.h"

/* The switches of all nodes of a graph, at most DM_SWITCHES: of[] their operands. */
uint32_t dm_switches_find(dm_graph *g, dm_node *of, dm_switch *kind);

/* l->change[n] = A^T (A A^T)^-1 y for `count` rows of A and l->y; its length, NAN where the rows
 * depend on each other. */
double dm_level_normal_step(dm_level *l, const double *rows, uint32_t count);

#endif
