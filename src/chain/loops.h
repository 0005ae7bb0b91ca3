/* loops.h - kernels of expressions with sums (algebra/body_sum.h). The sums are leaves S_k of
 * f(x, S), so
 *   df/dx_i = f_i + sum_k f_Sk dS_k/dx_i,
 * where the first part and the factors f_Sk are one kernel of the graph, and the second is a
 * loop over the rounds of each sum with the kernel of the derivatives of its term: in lanes
 * where there are some, in blocks of a fixed size, so that lanes and backends make no
 * difference to a bit. */
#ifndef DM_LOOPS_H
#define DM_LOOPS_H

#include "algebra/body_sum.h"
#include "code/kernel.h"

enum { DM_LOOP_BLOCK = 64, DM_LOOP_COLUMNS = DM_SUM_COLUMNS };

/* *out takes x[inputs of g without sums] and gives root. */
dm_status dm_loops_value(dm_kernel *out, dm_graph *g, dm_node root, dm_compile *compile,
                         dm_arena *arena);

/* The kernel of g that takes the values of the sums behind x, inside of one of dm_loops_value;
 * *x: what it took in the last evaluation. */
const dm_kernel *dm_loops_outer(const dm_kernel *value, const double **x);

/* The same for d root/dx_i, i < m, given nodes[m], the derivatives with the sums held; NULL: they
 * all vanish. */
dm_status dm_loops_gradient(dm_kernel *out, dm_graph *g, dm_node root, const dm_node *nodes,
                            uint32_t m, dm_compile *compile, dm_arena *arena);

/* Lend a team of threads to the sums over pairs of a gradient, NULL: take it back; returns whether
 * there are such sums. The bits are those of one thread. */
struct dm_team;
int dm_loops_lend(const dm_kernel *gradient, struct dm_team *team);

/* Of a gradient that is made of sums over cells of a mesh alone: these, else NULL; and the factors
 * of them at x. */
struct dm_cells;
const struct dm_cells *dm_loops_cells(const dm_kernel *gradient);
const double *dm_loops_factors(const dm_kernel *gradient, const double *x);
int dm_loops_constant(const dm_kernel *gradient); /* the factors are numbers */

#endif
