/* sweep.h - arithmetic of fixed-point sweeps over stages that lie side by side: an array
 * [rows][width] holds one stage in each lane. Lanes are added up in the same order whatever made
 * the kernels, so the bits are the same on all backends of a machine; products are fused into
 * sums where the processor can.
 * Speed: steps, J2 satellite by gauss(3): 3.1x, against Newton's method; 6.6x by gauss(6). */
#ifndef DM_SWEEP_H
#define DM_SWEEP_H

#include "integ/stage/workspace/stage_limits.h"

#include <stddef.h>
#include <stdint.h>

enum { DM_SWEEP_WIDTH = 8 }; /* stages at most */

/* coefficients [width] that are a double and what it lacks */
typedef struct {
    double *top, *rest;
} dm_parts;

/* x = start + (base + factor sum_m column_m u[.][m]); without factors the base is the first of
 * the sum, which is then known a product earlier */
typedef struct {
    uint32_t rows, columns;       /* as many columns as stages */
    double *x;                    /* [rows][width] arguments of a kernel */
    const double *base;           /* [rows][width], may be x */
    const double *column;         /* [columns][width] */
    const double *u;              /* [rows][width] */
    const double *factor, *start; /* [rows]; factors NULL: all are 1 */
    const double *unit;           /* [rows] by which squares of moves count; NULL: all are 1 */
} dm_sweep;

/* q += drift + factor sum b_q u_q and p += sum b_p u_p over the stages, in place with
 * compensation (numbers/compensated.h) */
typedef struct {
    uint32_t rows;
    const double *u[2];           /* [rows][width], of q and of p */
    const dm_parts *b[2];         /* [width] */
    const double *factor, *drift; /* [2 rows]; 1 and 0 for p */
    double *state;                /* [4 rows]: q, p, low-order parts of both */
} dm_sweep_end;

typedef struct {
    uint32_t width;
    void (*put)(const dm_sweep *a);
    /* put; own[rows] are the squares of the start and of the last stage, which moves are compared
     * with; returns their sum, the least of them that is not zero, infinite for none */
    double (*set)(const dm_sweep *a, double *own, double *least);
    /* put; returns the sum of squares of what x moved by, times units */
    double (*move)(const dm_sweep *a);
    /* base[rows][width] = low[rows] + c v[rows] */
    void (*line)(double *base, const double *low, const double *v, const dm_parts *c,
                 uint32_t rows);
    /* 0, or NaN where the state is not finite any more */
    double (*finish)(const dm_sweep_end *a);
    /* to[4 rows] = a state that finish has just left */
    void (*copy)(double *to, const double *state, uint32_t rows);
} dm_sweep_row;

/* unit[rows], the squares that `set` left there, become what makes all rows as large as their mean,
 * by the sum of these squares. */
void dm_sweep_find_units(dm_sweep *a, double *unit, double size);

/* The same where some row is much smaller than all and not zero; else there are no units. */
static inline void dm_sweep_judge(dm_sweep *a, double *unit, double size, double least) {
    if (a->unit) a->unit = NULL; /* a store would be waited for by the next sweep */
    if (DM_SWEEP_APART * least < size) dm_sweep_find_units(a, unit, size);
}

/* The larger of moved times scale, of q and p, NaN where one is not finite; scale may be infinite
 * where nothing moved. One by one: a load of both would wait for the store of the one just found.
 * Speed: Kepler (P1-0.6) by gauss(2): 1.1x */
static inline double dm_sweep_relative(const double moved[2], const double scale[2]) {
    const double q = moved[0] > 0.0 ? moved[0] * scale[0] : moved[0];
    const double p = moved[1] > 0.0 ? moved[1] * scale[1] : moved[1];
    return (q > p ? q : p) + 0.0 * (q + p);
}

/* The row for a number of stages up to DM_SWEEP_WIDTH: width 1, 4 or 8, in the widest vectors
 * that serve. */
const dm_sweep_row *dm_sweep_find(uint32_t stages);

#endif
