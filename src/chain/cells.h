/* cells.h - sums over the cells of a mesh (algebra/body_sum.h) as loops, and their gradient with
 * one writer an entry. The slopes of every cell go to a buffer, and entry i of the gradient is the
 * sum of those that belong to it, in the order of cells and columns:
 *   dS/dx_i = sum over (cell K, column c) with x_i in column c of K of d term_K / d column c.
 * So it makes no difference to a bit which thread, lane or backend does which part. */
#ifndef DM_CELLS_H
#define DM_CELLS_H

#include "chain/cell_linear.h"
#include "code/kernel.h"

enum { DM_CELL_BLOCK = 64 }; /* cells that are evaluated at once, and entries that are moved */

/* some functions of the columns of a sum: linear ones as they stand, others by kernels, one cell or
 * `lanes` cells at a time */
typedef struct {
    const dm_sum *sum;
    dm_cell_linear
        *linear; /* [outputs], and then there are no kernels; NULL: some are not linear */
    dm_kernel one, many;
    uint32_t lanes; /* 0: one by one */
    uint32_t columns, outputs;
    uint8_t column[DM_SUM_COLUMNS]; /* [columns] those that the functions depend on */
} dm_cell_loop;

/* roots[outputs] of the term of s. */
dm_status dm_cell_loop_make(dm_cell_loop *l, const dm_sum *s, const dm_node *roots,
                            uint32_t outputs, dm_compile *compile, dm_arena *arena);

/* Doubles of scratch for the next function. */
size_t dm_cell_loop_work(const dm_cell_loop *l);

/* out[output * stride + i - first] of cells i in [first, first + count), any count. */
void dm_cell_loop_run(const dm_cell_loop *l, double *out, size_t stride, const double *x,
                      uint32_t first, uint32_t count, double *work);

/* the gradient of factor_1 S_1 + factor_2 S_2 + ... by x_0 .. x_(m - 1) */
typedef struct dm_cells {
    dm_cell_loop *loop; /* [loops] slopes; no two outputs are equal, or of opposite sign */
    uint32_t loops, m;
    size_t *slot; /* [loops]: slopes of output k of cell i are at slot + width (k cells + i) */
    /* [loops] 2: behind every slope is its opposite, for entries that subtract it; else 1 */
    uint8_t *width;
    size_t slots;
    uint32_t *start; /* [m + 1] of list */
    uint32_t *list;  /* slots of an entry */
    uint8_t *alike;  /* [m / 64 + 1] of 64 entries: how many terms each has; 0: not the same */
    size_t work;     /* doubles of scratch of a thread */
    int shared;      /* threads may run it side by side */
} dm_cells;

/* The sums over cells of g on which root depends, *count of them, and the nodes of d root/d sum in
 * factor[]; NULL: no memory. */
const dm_sum **dm_cells_sums(dm_graph *g, dm_node root, dm_node *factor, uint32_t *count,
                             dm_arena *arena);

/* sums[count] of one graph. DM_TOO_LARGE: more than 2^32 slopes. */
dm_status dm_cells_open(dm_cells *c, const dm_sum *const *sums, uint32_t count, uint32_t m,
                        dm_compile *compile, dm_arena *arena);

/* Part `part` of `parts` of the slopes at x, into slope[slots]; parts share nothing. */
void dm_cells_slopes(const dm_cells *c, double *slope, const double *factor, const double *x,
                     double *work, uint32_t part, uint32_t parts);

/* Entry i of the gradient, once all slopes are there. */
static inline double dm_cells_entry(const dm_cells *c, const double *slope, uint32_t i) {
    double sum = 0.0;
    for (uint32_t k = c->start[i]; k < c->start[i + 1]; k++) sum += slope[c->list[k]];
    return sum;
}

/* The terms that each of `count` entries from i on has; 0: not the same, or not known. */
static inline uint32_t dm_cells_alike(const dm_cells *c, uint32_t i, uint32_t count) {
    if (i % DM_CELL_BLOCK + count > DM_CELL_BLOCK) return 0;
    return c->alike[i / DM_CELL_BLOCK];
}

#endif
