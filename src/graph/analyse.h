/* analyse.h - what can be read off a graph without evaluating it. */
#ifndef DM_ANALYSE_H
#define DM_ANALYSE_H

#include "graph/graph.h"

#include <stdio.h>

/* True when some root depends on an input in first .. first+n-1. */
int dm_depends(dm_graph *g, const dm_node *roots, uint32_t m, uint32_t first, uint32_t n);

/* out[n]: 1 where none of the roots depends on that input, from `first` on. */
void dm_independent(uint8_t *out, dm_graph *g, const dm_node *roots, uint32_t m, uint32_t first,
                    uint32_t n);

/* Operations (not leaves) needed for all roots together. */
uint32_t dm_operations(dm_graph *g, const dm_node *roots, uint32_t m);

/* How often each operation is needed: counts[DM_OP_COUNT]. */
void dm_operation_counts(dm_graph *g, const dm_node *roots, uint32_t m, uint32_t *counts);

/* A readable listing, one assignment a line, inputs by the names given (NULL: x1, x2, ...).
 * Writes through `put` so that no file is needed. */
typedef void dm_put(void *ud, const char *text, size_t length);
void dm_print(dm_graph *g, const dm_node *roots, uint32_t m, const char *const *names, dm_put *put,
              void *ud);

#endif
