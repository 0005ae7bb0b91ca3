/* avi.h - asynchronous variational integrators (Lew, Marsden, Ortiz & West 2003): every cell K of
 * the potential has a step h_K of its own. When its time comes the entries that it reads are
 * drifted there with the velocity they have, and get its kick,
 *   p_a += h_K dL_K/dx_a.
 * A heap knows whose time is next; equal times go by the number of the cell. All that is not read
 * stays behind, at the time of its last kick. */
#ifndef DM_AVI_H
#define DM_AVI_H

#include "chain/curvature.h"

/* the cells of one sum of the potential */
typedef struct {
    const dm_sum *sum;
    double factor;
    dm_cell_loop loop; /* slopes by the columns `by` */
    uint8_t by[DM_SUM_COLUMNS];
    uint32_t first; /* number of its first cell among all */
} dm_avi_sum;

typedef struct {
    uint32_t n, sums, cells;
    dm_avi_sum *sum;
    const double *w;  /* [n] inverse masses */
    double *x;        /* (q, v, t): v is not read */
    double *p, *last; /* [n] momenta; the times where q stand */
    double *h, *time; /* [cells] steps, next times */
    double *fired;    /* [cells] kicks so far */
    uint32_t *heap;   /* [cells] */
    double t0;
    double events;
    int half; /* half a kick at t0 */
    double *work;
} dm_avi;

/* The potential sums[count] with factors that are numbers; memory from the arena. The caller then
 * sets x, p, w, h. */
dm_status dm_avi_open(dm_avi *a, const dm_sum *const *sums, const double *factor, uint32_t count,
                      uint32_t n, dm_compile *compile, dm_arena *arena);

/* From t0 on, with x, p and h as they are. */
void dm_avi_start(dm_avi *a, double t0, int half);

/* All kicks up to time t. DM_NOT_FINITE: p is not, DM_STOPPED. */
dm_status dm_avi_run(dm_avi *a, double t, volatile const int *stop);

/* q[n], p[n] at time t, by copies that drift; with `half` what a kick at t itself gave is taken
 * half, as Verlet has it. */
void dm_avi_row(dm_avi *a, double t, double *q, double *p);

/* limit[cells]: 2 / omega of every cell alone at x, with the share of the masses that is its own
 * among the cells around an entry; infinite where nothing moves. c: of the same sums. */
dm_status dm_avi_limits(const dm_avi *a, const dm_curvature *c, double *limit, dm_arena *arena);

/* Pairs of cells with a common entry of which one kicks the other near a multiple of its half
 * period: |omega_K h_L / pi - k| < margin for some k >= 1. */
dm_status dm_avi_resonances(const dm_avi *a, const double *limit, double margin, double *pairs,
                            dm_arena *arena);

#endif
