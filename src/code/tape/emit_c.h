/* emit_c.h - a graph as readable C: for programs without dmlua, and for the compiler of the
 * system. */
#ifndef DM_EMIT_C_H
#define DM_EMIT_C_H

#include "graph/analyse.h"

/* Write `void name(const double *in, double *out)` for the roots, compacted: one constant a
 * line, inputs under their names (NULL: x1, x2, ...), out[m]. It calls the C library's functions
 * and, for x^(-1/2), x^(-3/2), reciprocal_root, reciprocal_root3; with those of functions.h
 * instead, -ffp-contract=off and -fno-tree-slp-vectorize it has the bits of the tape. 0 where an
 * operation has no C text; nothing is complete then. */
int dm_emit_c(dm_graph *g, const dm_node *roots, uint32_t m, const char *name,
              const char *const *names, dm_put *put, void *ud);

/* What stands before their text, `body`, in a file: the library, and the reciprocal roots that
 * it calls as root and division. */
void dm_emit_c_head(dm_put *put, void *ud, const char *body);

#endif
