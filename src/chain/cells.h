/* cells.h - sums over the cells of a mesh (algebra/body_sum.h) as loops, and their gradient: the
 * slopes of a cell are added to the entries that it has, so entry i of the gradient is the sum of
 * those that belong to it, in the order of sums, cells and columns:
 *   dS/dx_i = sum over (cell K, column c) with x_i in column c of K of d term_K / d column c.
 * Threads do it by chain/cell_ranges.h or chain/cell_lists.h, with the same bits. */
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

/* what entries of the gradient get of the slopes of a sum: entry first + step * index[cell], or of
 * the cell itself where index is NULL, gets sign times an output of the loop */
typedef struct {
    const uint32_t *index;
    uint32_t first, step, output;
    double sign; /* 1 or -1 */
} dm_cell_share;

/* the gradient of one sum */
typedef struct {
    dm_cell_loop loop; /* slopes; no two outputs are equal, or of opposite sign */
    dm_cell_share *share;
    uint32_t shares;
    uint32_t step; /* of all shares, which have an index; 0: they differ, or some have none */
    /* all slopes are linear, and every entry gets one of them with the sign that it is read with
     * there, times `turned` */
    int direct;
    double turned;
} dm_cell_slopes;

/* the gradient of factor_1 S_1 + factor_2 S_2 + ... by x_0 .. x_(m - 1) */
typedef struct dm_cells {
    dm_cell_slopes *sum; /* [sums] */
    uint32_t sums, m;
    const uint8_t *held; /* [coordinates] entries that are DM_HELD have no slope; NULL: none */
    uint32_t coordinates;
    struct dm_cell_ranges **ranges; /* of entries, for threads; empty until they ask for them */
    struct dm_cell_lists *lists;    /* the same */
    size_t work;                    /* doubles of scratch of a thread */
    int shared;                     /* threads may run it side by side */
} dm_cells;

/* The sums over cells of g on which root depends, *count of them, and the nodes of d root/d sum in
 * factor[]; NULL: no memory. */
const dm_sum **dm_cells_sums(dm_graph *g, dm_node root, dm_node *factor, uint32_t *count,
                             dm_arena *arena);

/* sums[count] of one graph. */
dm_status dm_cells_open(dm_cells *c, const dm_sum *const *sums, uint32_t count, uint32_t m,
                        dm_compile *compile, dm_arena *arena);

/* out[m] = the gradient at x; factor[sums], work[]. */
void dm_cells_gradient(const dm_cells *c, double *out, const double *factor, const double *x,
                       double *work);

/* The slopes of cells [first, first + cells) of a sum, to their entries of out[m]. */
void dm_cells_add(const dm_cell_slopes *d, double *out, double factor, const double *x,
                  uint32_t first, uint32_t cells, double *work);

/* Entries of out[m] from `from` to `to` that are held have no slope. */
void dm_cells_hold(const dm_cells *c, double *out, uint32_t from, uint32_t to);

/* The entry that cell i has in a share. */
static inline size_t dm_cell_share_entry(const dm_cell_share *s, uint32_t i) {
    return s->first + (size_t)s->step * (s->index ? s->index[i] : i);
}

#endif
