/*
** sweep.h - arithmetic of fixed-point sweeps over stages that lie side by side: an array [rows][width] holds
** one stage in each lane. Every lane adds in the same order whatever the processor, so the bits are the same.
*/
#ifndef DM_SWEEP_H
#define DM_SWEEP_H

#include <stdint.h>

enum { DM_SWEEP_WIDTH = 8 }; /* stages at most */

/* sum = base + sum_m column_m u[.][m], then x = start + (low + sum) */
typedef struct {
    uint32_t rows;
    uint32_t columns;
    double *x,
        *sum; /* [rows][width] arguments of the kernel; what they add to the start */
    const double *base; /* [rows][width] */
    const double *top,
        *rest;       /* [columns][width]; rest, the low-order part, may be NULL */
    const double *u; /* [rows][width] */
    const double *start, *low; /* [rows] */
} dm_sweep;

typedef struct {
    uint32_t width;
    /* returns the sum of squares of what the sums moved by */
    double (*move)(const dm_sweep *a);
    /* out[rows] = sum over lanes of (top + rest) u, pairwise */
    void (*collect)(double *out, const dm_sweep *a);
    /* out[rows][width] = factor[rows] u */
    void (*scale)(double *out, const double *factor, const double *u, uint32_t rows);
} dm_sweep_row;

/* The row for a number of stages up to DM_SWEEP_WIDTH: width 1, 4 or 8, in the widest vectors that serve. */
const dm_sweep_row *dm_sweep_find(uint32_t stages);

#endif
