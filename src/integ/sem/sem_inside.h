/* sem_inside.h - what the files of integ/sem share. */
#ifndef DM_SEM_INSIDE_H
#define DM_SEM_INSIDE_H

#include "integ/method/stage_table.h"
#include "integ/sem/sem.h"

/* What a step equation is made of and what was found, laid into the workspace of a stepper. */
typedef struct {
    dm_stage_table table;
    const dm_model *m;
    uint32_t n, velocities, unknowns; /* dim Q, s n, s n + 1 */
    const double *state;              /* where the step begins */
    double E;                         /* that it is to have */
    double first, least;              /* h of the run, and no shorter step is taken */
    double pace;                      /* dt/dh of the last step on the side */
    dm_status begun;                  /* why the energy of the first step was not found */

    double *x;      /* [2n+1] arguments of the kernels */
    double *at;     /* [2n + 3n*n] outputs of the stage kernel */
    double *w;      /* [n] sum_j a_ij V_j of a point, and [2n] for products */
    double *v0;     /* [n] velocity at the start */
    double *z;      /* [s n + 1] V and h */
    double *kept;   /* [s n + 1] the best so far */
    double *R, *dz; /* [s n + 1] */
    double *J, *LU; /* [(s n + 1)^2], at z and of the last increment */
    double *end;    /* [n] h sum_i b_i L_q(i), what the momentum gains */
    uint32_t *pivot;
    int factored;    /* LU holds factors of this step */
    double *scratch; /* of Newton's method for V alone, or of the Legendre transform */
    double *places;  /* see sem.c */

    double energy;        /* E_d at the last z */
    double size, size_of; /* largest term of the momentum equations; sum of those of E_d */
    long evaluations;
} dm_sem;

/* At z: R[s n] of the momentum equations, E_d, the gain of momentum; where J is not NULL its
 * columns of V in rows of `width` numbers, and for width = s n + 1 the column of h and the row of
 * E_d as well. R[s n] = E_d - E for that width. */
void dm_sem_equation(dm_sem *e, double *R, double *J, const double *z, uint32_t width);

/* V for the length h, behind which E_d and the gain of momentum are those of the step. */
dm_status dm_sem_fixed(dm_sem *e, dm_stepper *s, double h);

/* V and h from h on, which must end in [low, high]. */
dm_status dm_sem_solve(dm_sem *e, dm_stepper *s, double h, double low, double high);

/* The same where Newton's method fails: the root in [low, high] next to h, or, *flagged = 1, the h
 * that makes |E_d - E| least. */
dm_status dm_sem_fallback(dm_sem *e, dm_stepper *s, double h, double low, double high,
                          int *flagged);

/* Round-off of h, from the last increment of dm_sem_solve; 0 where there was none. */
double dm_sem_conditioning(dm_sem *e);

#endif
