/* virtual_work.h - forces on a field beside those of its Lagrangian (friction, driving, boundaries
 * that let waves out), as sums over cells (algebra/body_sum.h) of their virtual work,
 *   W = sum over cells and values c of f_c(q, v, t) dq_c,
 * where dq_c are columns that are `varied`. The force on a cell reads q and v of that cell alone,
 * so its derivatives are blocks of values x values; entries that are held have none. */
#ifndef DM_VIRTUAL_WORK_H
#define DM_VIRTUAL_WORK_H

#include "chain/cells.h"

/* one output of a loop: what it is added to */
typedef struct {
    uint32_t first; /* f, or f_q, f_v, of entry first + step * cell */
    uint32_t at;    /* derivative by value `at` of the cell */
    int by;         /* DM_WORK_FORCE, DM_WORK_BY_Q, DM_WORK_BY_V */
} dm_work_output;

enum { DM_WORK_FORCE, DM_WORK_BY_Q, DM_WORK_BY_V };

/* one sum: its forces, and these with their derivatives */
typedef struct {
    const dm_sum *sum;
    dm_cell_loop force, slopes;
    dm_work_output *output; /* [slopes.outputs], forces first */
    const uint32_t *cell;   /* [sum->bodies] ascending, from 0; NULL: all cells */
} dm_work_sum;

typedef struct dm_work {
    uint32_t n, values; /* entries of q, of which a cell has `values` */
    uint32_t sums;
    dm_work_sum *sum;
    int reads_q, reads_v;
    int constant; /* the derivatives are numbers */
    int shared;   /* threads may run it side by side */
    size_t room;  /* doubles of scratch */
} dm_work;

/* The sums of g that are virtual work; w->sums = 0: there are none. */
dm_status dm_work_open(dm_work *w, const dm_graph *g, uint32_t n, dm_compile *compile,
                       dm_arena *arena);

/* f[i - first] of the entries i in [first, first + count), which are whole cells, at x = (q, v, t);
 * with f_q, f_v (both or neither NULL) the rows of their blocks, [count][values]. scratch[room]. */
void dm_work_force(const dm_work *w, double *f, double *f_q, double *f_v, const double *x,
                   uint32_t first, uint32_t count, double *scratch);

/* Doubles of scratch for the next function; w may be NULL. */
size_t dm_work_room(const dm_work *w);

/* The forces at x on all entries, added to f[n]; w may be NULL: none. */
void dm_work_add(const dm_work *w, double *f, const double *x, double *scratch);

#endif
