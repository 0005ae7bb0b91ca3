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

/* What is zero where an operation passes from one formula to another: the operand of abs, sign and
 * where, a - b of min and max. 0: it is one formula wherever it is finite. */
dm_node dm_break_of(dm_graph *g, const dm_expr *e);

/* What must be > 0, or 0 at most, where an operation is to be finite: the operand of roots,
 * logarithms and powers that are no whole numbers. 0: none. */
dm_node dm_edge_of(const dm_graph *g, const dm_expr *e);

/* A readable listing, one assignment a line, inputs by the names given (NULL: x1, x2, ...).
 * Writes through `put` so that no file is needed. */
typedef void dm_put(void *ud, const char *text, size_t length);
void dm_print(dm_graph *g, const dm_node *roots, uint32_t m, const char *const *names, dm_put *put,
              void *ud);

#endif
