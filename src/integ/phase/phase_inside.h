/* phase_inside.h - what a step of stages of H works on. dm_phase lies at the head of
 * stepper->work, its arrays behind it. Arrays of stages are [entry][width], a stage in each lane:
 * entries of x are q[n], p[n], t, of u V[n], F[n]. */
#ifndef DM_PHASE_INSIDE_H
#define DM_PHASE_INSIDE_H

#include "integ/phase/phase.h"
#include "integ/phase/phase_modes.h"
#include "integ/stage/sweep/stage_sweep.h"
#include "integ/stage/workspace/stage_limits.h"

typedef struct {
    const dm_model *m;
    uint32_t n, r, width;    /* width: lanes of an array; of more than eight stages, r */
    int count;               /* sweeps a step; 0: to round-off */
    const dm_sweep_row *row; /* sums for so many stages; NULL: more than eight, no sweeps */
    dm_stage_table table;
    double h, t;           /* of the step in hand; h: what the coefficients are of */
    double *state;         /* its start, in place its end */
    dm_weight *ha, *hA;    /* [r*r] of q and of p */
    dm_weight *hb, *hc;    /* [r] */
    dm_stage_kernel field; /* V, F for all stages at once; lanes 0: one by one */
    double *x, *u;         /* [2n + 1][width], [2n][width]: its arguments and results */
    /* of the sweeps, [q, p]: the sums, what coefficients lack, the first guess */
    dm_sweep sum[2], rest[2], ahead[2];
    double *whole[2], *lacking[2];  /* [r][width] columns of h a, h A and what they lack */
    double *flying[2], *further[2]; /* [r][width] columns of a E, A E; times h (sweep.h) */
    double *after;                  /* [width] h c */
    double *base;     /* [2n][width] low-order parts of the start, then with `lacking` */
    double *none;     /* [2n][width] zeros */
    double *ones;     /* [2n] */
    double *unit;     /* [2n] by which squares of moves count, where that is not all one */
    dm_parts b, line; /* [width] h b; zeros */
    dm_sweep_end end;
    /* Newton's method: displacements Z[r][2n] of the stages, the field and its derivatives there
     * [r][2n + 4n^2], arguments [2n + 1] */
    double *root, *curve, *at;
    dm_phase_modes modes; /* of phase_chord.c */
    double *modes_memory;
    int sought; /* they were looked for */
    double *scratch, size;
    double *before;               /* [4n] the state, should the end not be finite */
    double *memory;               /* what a step leaves to the next one: DM_SWEPT_..., u */
    long evaluations;             /* of kernels, in the step in hand */
    struct dm_phase_lanes *lanes; /* members side by side, where they are */
} dm_phase;

enum { DM_PHASE_SWEEPS = 100 }; /* at most */

/* The contraction of sweeps, squared, that calls for Newton's method, which costs as many sweeps as
 * there are unknowns, squared: with many of them sweeps may contract slowly. */
static inline double dm_phase_slow(const dm_phase *g) {
    enum { FEW_UNKNOWNS = 24 };
    return 2 * g->n * g->r > FEW_UNKNOWNS ? 0.55 * 0.55 : DM_SWEEP_SLOW;
}

static inline dm_phase *dm_phase_of(const dm_stepper *stepper) {
    return (dm_phase *)(void *)stepper->work;
}

/* Doubles of workspace; lay it out; coefficients of a step h. */
size_t dm_phase_work(const dm_rule *rule, const dm_model *m);
dm_status dm_phase_open(dm_stepper *stepper);
void dm_phase_scale(dm_phase *g, double h);

/* How many numbers from the first on the coefficients times h of sweeps are, one array. */
size_t dm_phase_scaled(const dm_phase *g, const double **first);

/* u at the stages of a step, by sweeps or by Newton's method. DM_NO_CONVERGENCE of sweeps: they
 * contract too slowly. */
dm_status dm_phase_sweep(dm_phase *g, dm_stepper *stepper);
dm_status dm_phase_newton(dm_phase *g, dm_stepper *stepper);

/* Z[r][2n] by chords, where there are some for this rule, from a guess. */
int dm_phase_has_chords(dm_phase *g);
dm_status dm_phase_chords(dm_phase *g, dm_stepper *stepper, double *Z);

/* R[r][2n] of the equations at Z; its largest entry. */
double dm_phase_residual(dm_phase *g, double *R, const double *Z);

/* The derivatives [2n][2n] of the field at the state displaced by Z[2n], `after` its time. */
const double *dm_phase_derivative(dm_phase *g, const double *Z, double after);

/* The memory: as that of stage_sweep.h. */
size_t dm_phase_memory_size(const dm_phase *g);
int dm_phase_memory_fits(const dm_phase *g);

#endif
