/* sem_sweep.h - sweeps for the velocity v and the length h of a symplectic-energy-momentum step
 * with one point, for more coordinates than sem_kernel.h takes and L = T(v) - V(q) with constant
 * mass. They give what that kernel does.
 * Speed: energy_scales, outer solar system by sem(1): 15x, against the tables of any degree. */
#ifndef DM_SEM_SWEEP_H
#define DM_SEM_SWEEP_H

#include "integ/sem/sem_kernel.h"

enum { DM_SEM_WIDTH = 4 };
typedef double dm_sem_wide __attribute__((vector_size(32), aligned(8), may_alias));

/* Kernels, arrays and numbers of one stepper. Behind the n numbers of an array of its own there are
 * zeros up to a whole vector. */
typedef struct {
    const dm_model *m;              /* its potential: -V and L_q[n] of (q, v, t) */
    dm_kernel bend;                 /* L_qq x of (q, x, t); eval NULL: there are no sweeps */
    uint32_t wide;                  /* vectors of an array [n] */
    const double *full;             /* M^-1 [n*n]; NULL: it is diagonal */
    double *x, *potential;          /* arguments of both; -V, before the force */
    dm_sem_wide *inverse;           /* [n] the diagonal */
    const dm_sem_wide *q, *low, *p; /* [n] where the step begins */
    dm_sem_wide *shifted, *v;       /* [n] p0 less what L has linear in v; the guess */
    dm_sem_wide *force, *pull;      /* [n] L_q; p0 + h/2 L_q, and for products */
    dm_sem_wide *w, *R;             /* [n] M^-1 of that, and v - w */
    dm_sem_wide *from, *gain;       /* [n] M^-1 p0, and w less that */
    dm_sem_wide *bent, *turn;       /* [n] L_qq x, and dv/dh */
    double h, E, energy, twice;     /* E_d is to be E and was `energy`, at L_v . v */
    double inverse_slope, bow;      /* dh/dE_d, and 1/(2h) */
    double scale[2];                /* 1 over |w|^2 and over the terms of E_d, squared */
} dm_sem_sweeps;

/* Is L of that kind? The potential is then wanted of the model. */
int dm_sem_sweep_fits(const dm_model *m);

/* Doubles of the arrays; the kernels, and the arrays laid into `memory`. Without kernels there are
 * no sweeps, and the tables serve. */
size_t dm_sem_sweep_size(const dm_model *m);
void dm_sem_sweep_open(dm_sem_sweeps *w, const dm_model *m, double *memory);

/* From `state` and a guess z of v and h to out[dm_sem_outputs], whose E_d is w->E; moves = 0: h is
 * given. How many sweeps; 0: they contract too slowly, or leave the domain. */
int dm_sem_sweep(dm_sem_sweeps *w, const double *state, const double *z, double *out, int moves);

#endif
