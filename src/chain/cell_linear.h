/* cell_linear.h - slopes of a sum over cells that are linear in the entries they read, as those of
 * |dA|^2: output k of cell i is
 *   y = scale w_i (((x_a +- x_b) +- x_c) +- ...),
 * w_i a number of the data of the cell. The sum has the order of the compacted graph and `scale` is
 * a power of two, so the bits are those of the kernel that it stands for; what it saves is the way
 * through a kernel's inputs and outputs. */
#ifndef DM_CELL_LINEAR_H
#define DM_CELL_LINEAR_H

#include "algebra/body_sum.h"

enum { DM_LINEAR_TERMS = 8 };

/* entry first + step * index[cell], or of the cell itself where index is NULL */
typedef struct {
    const uint32_t *index;
    uint32_t first, step;
    double sign; /* 1 or -1; 1 in the first term */
} dm_linear_term;

typedef struct {
    uint32_t terms;
    dm_linear_term term[DM_LINEAR_TERMS];
    const double *weight; /* [cells]; NULL: 1 */
    double scale;         /* a power of two or its negative; any number where weight is NULL */
} dm_cell_linear;

/* Reads roots[outputs] of a compacted graph whose inputs are the columns column[] of s. *out is
 * NULL where one of them is of another kind. */
dm_status dm_cell_linear_read(dm_cell_linear **out, const dm_sum *s, const uint8_t *column,
                              dm_graph *g, const dm_node *roots, uint32_t outputs, dm_arena *arena);

/* out[width (i - first)] = factor y of the cells i in [first, first + count); where the width is 2
 * the opposite stands behind each. */
void dm_cell_linear_run(const dm_cell_linear *l, double *out, uint32_t width, const double *x,
                        uint32_t first, uint32_t count, double factor);

/* factor y of these cells to the entries of out that y reads of x, with the signs that it reads
 * them with: the gradient of w (x_a +- x_b +- ...)^2. out is not x. */
void dm_cell_linear_add(const dm_cell_linear *l, double *out, const double *x, uint32_t first,
                        uint32_t count, double factor);

#endif
