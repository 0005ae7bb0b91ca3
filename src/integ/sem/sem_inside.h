/* sem_inside.h - what the files of integ/sem share. */
#ifndef DM_SEM_INSIDE_H
#define DM_SEM_INSIDE_H

#include "integ/method/stage_table.h"
#include "integ/sem/sem.h"
#include "integ/sem/sem_sweep.h"

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
    double *v0;     /* [n] velocity at the start, a first guess where none goes on */
    int begun_at;   /* v0 is that of `state` */
    double *z;      /* [s n + 1] V and h */
    double *kept;   /* [s n + 1] the best so far */
    double *R, *dz; /* [s n + 1] */
    double *J, *LU; /* [(s n + 1)^2], at z and of the last increment */
    double *end;    /* [n] h sum_i b_i L_q(i), what the momentum gains */
    uint32_t *pivot;
    int factored;           /* LU holds factors of this step */
    double slope;           /* dh/dE of it, where they are not needed for that */
    double *scratch;        /* of Newton's method for V alone, or of the Legendre transform */
    double *places;         /* see sem_places.h */
    double *warm;           /* see sem_warm.h; behind the places */
    dm_kernel kernel;       /* of a step of one point, eval NULL: none */
    int by_velocity;        /* and its residuals are velocities, not momenta */
    dm_sem_sweeps sweeps;   /* of such a step of many coordinates, bend.eval NULL: none */
    double *in, *out;       /* arguments and outputs of the kernel, or of the sweeps */
    const dm_kernel *stage; /* of the tables; NULL: not needed so far */

    double energy;        /* E_d at the last z */
    double size, size_of; /* largest term of the momentum equations; sum of those of E_d */
    long evaluations;
} dm_sem;

/* V_j = v0, found when it is asked for first, and h into z. */
dm_status dm_sem_guess(dm_sem *e, double h);

/* A step begins at this state. */
void dm_sem_begin(dm_sem *e, const double *state);

/* At z: R[s n] of the momentum equations, E_d, the gain of momentum; where J is not NULL its
 * columns of V in rows of `width` numbers, and for width = s n + 1 the column of h and the row of
 * E_d as well. R[s n] = E_d - E for that width. */
void dm_sem_equation(dm_sem *e, double *R, double *J, const double *z, uint32_t width);

/* Is a step made by the kernel of one point, or by sweeps? */
static inline int dm_sem_is_written(const dm_sem *e) {
    return e->kernel.eval || e->sweeps.bend.eval;
}

/* The kernel of the tables is there from here on. */
dm_status dm_sem_prepare(dm_sem *e);

/* V for the length h, behind which E_d and the gain of momentum are those of the step. */
dm_status dm_sem_fixed(dm_sem *e, dm_stepper *s, double h);

/* V and h, which must end in [low, high], from h on; goes_on: from the steps before. */
dm_status dm_sem_solve(dm_sem *e, dm_stepper *s, double h, double low, double high, int goes_on);

/* The same by the kernel of one point or by sweeps, where one of them is there. */
dm_status dm_sem_solve_written(dm_sem *e, dm_stepper *s, double h, double low, double high,
                               int goes_on);

/* dm_sem_fixed by sweeps from the guess in z; 0: they did not find it. */
int dm_sem_fixed_swept(dm_sem *e, dm_stepper *s);

/* The same where Newton's method fails: the root in [low, high] next to h, or, *flagged = 1, the h
 * that makes |E_d - E| least. */
dm_status dm_sem_fallback(dm_sem *e, dm_stepper *s, double h, double low, double high,
                          int *flagged);

/* Round-off of h, from the last increment of dm_sem_solve; 0 where there was none. */
double dm_sem_conditioning(dm_sem *e);

/* One whole step by the kernel from a state that the last one led to; 0: not a thing has changed,
 * and it is to be made as any other. */
int dm_sem_go_on(dm_sem *e, dm_stepper *s, double *state);

#endif
