/* avi.h - asynchronous variational integrators (Lew, Marsden, Ortiz & West 2003): every cell K of
 * the potential has a step h_K of its own. When its time comes the entries that it reads are
 * drifted there with the velocity they have, and get its kick,
 *   p_a += h_K dL_K/dx_a.
 * Equal times go by the number of the cell. All that is not read stays behind, at the time of its
 * last kick.
 *
 * There is no queue of times: a cell may fire as soon as it is before all its neighbours, the cells
 * with which it has an entry in common that moves (avi_order.c). Events that share no entry commute
 * to the last bit, so the bits are those of the order of times. */
#ifndef DM_AVI_H
#define DM_AVI_H

#include "chain/curvature.h"

/* an entry of q, in half a line of the cache: inverse mass, and the time where x stands */
typedef struct {
    double x, p, w, last;
} dm_avi_entry;

/* its next time is t0 + (fired + 1) h; `blocked`: neighbours that come before it */
typedef struct {
    double time, h, fired;
    uint32_t blocked;
} dm_avi_cell;

/* a kick: minus output, or output, of the loop, for one of the entries of a cell */
typedef struct {
    uint8_t entry, output, minus;
} dm_avi_kick;

/* what the sums are multiplied by: numbers, or functions of the time of a kick */
typedef struct {
    const double *value;   /* [sums], at the start */
    const dm_kernel *of_t; /* [sums] outputs of in, whose entry `at` is t; NULL: numbers */
    double *in, *out;
    uint32_t at;
} dm_avi_factors;

/* the cells of one sum of the potential */
typedef struct {
    const dm_sum *sum;
    double factor;                 /* at the start */
    uint32_t which;                /* of the factors */
    dm_cell_loop loop;             /* slopes; no two outputs are equal, or of opposite sign */
    uint32_t first;                /* number of its first cell among all */
    uint32_t reads;                /* entries that a cell reads or kicks */
    uint8_t by[DM_SUM_COLUMNS];    /* [reads] their columns */
    uint32_t *entry;               /* [cells][reads] */
    uint8_t place[DM_SUM_COLUMNS]; /* [loop.columns] among these; OF_DATA, OF_TIME */
    dm_avi_kick kick[DM_SUM_COLUMNS];
    uint32_t kicks;
    uint8_t (*term)[DM_LINEAR_TERMS]; /* [outputs] of linear ones: places of their terms */
    double *in, *y;                   /* [loop.columns], [outputs]: what is worked on */
} dm_avi_sum;

typedef struct {
    uint32_t n, sums, cells;
    dm_avi_sum *sum;
    dm_avi_factors factors;
    const double *w; /* [n] inverse masses; 0: held */
    double *x;       /* (q, v, t) of the start: v is not read */
    double *p;       /* [n] momenta of the start */
    double *h;       /* [cells] steps */
    dm_avi_entry *at;
    dm_avi_cell *cell;
    uint32_t *near_start, *near; /* neighbours of cell k: near[near_start[k]] .. */
    uint32_t *ready, *later;     /* [cells] that may fire, and those whose time is beyond the end */
    uint32_t readies;
    double t0;
    double events;
    int half; /* half a kick at t0 */
} dm_avi;

/* The potential sums[count] with their factors; memory from the arena. The caller then sets w, and
 * x, p, h. */
dm_status dm_avi_open(dm_avi *a, const dm_sum *const *sums, const dm_avi_factors *f, uint32_t count,
                      uint32_t n, dm_compile *compile, dm_arena *arena);

/* From t0 on, with w, x, p and h as they are. DM_NO_MEMORY, DM_TOO_LARGE: too many neighbours. */
dm_status dm_avi_start(dm_avi *a, double t0, int half, dm_arena *arena);

/* Where a run stands between two calls: x, p and time of every entry, how often every cell has
 * fired. dm_avi_state_size numbers. */
size_t dm_avi_state_size(const dm_avi *a);
void dm_avi_state(const dm_avi *a, double *state);

/* As dm_avi_start, but from such a state on, at time t: what follows has the bits of a run that
 * never stopped. DM_NOT_FINITE: it is no state of a run at t. */
dm_status dm_avi_resume(dm_avi *a, double t0, int half, const double *state, double t,
                        dm_arena *arena);

/* All kicks up to time t. DM_NOT_FINITE: p is not, DM_STOPPED. */
dm_status dm_avi_run(dm_avi *a, double t, volatile const int *stop);

/* q[n], p[n] at time t, by copies that drift; with `half` what a kick at t itself gave is taken
 * half, as Verlet has it. */
void dm_avi_row(dm_avi *a, double t, double *q, double *p);

/* 2 / omega of every cell at x without the others: limit[cells] with the share of the masses that
 * is its own among the cells around an entry, which bounds its step; alone[cells] with all of these
 * masses, as it oscillates between kicks of the others. Infinite where nothing moves. c: of the
 * same sums. */
dm_status dm_avi_limits(const dm_avi *a, const dm_curvature *c, double *limit, double *alone,
                        dm_arena *arena);

/* Pairs of cells with a common entry of which one kicks the other near a multiple of its half
 * period: what steps h_K turn the oscillation of K by in a time h_L is within margin pi of k pi, k
 * >= 1 (Fong, Darve, Lew 2008). Behind dm_avi_start. */
double dm_avi_resonances(const dm_avi *a, const double *alone, double margin);

#endif
